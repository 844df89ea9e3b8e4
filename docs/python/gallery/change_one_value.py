# SPDX-License-Identifier: Apache-2.0
"""A pipeline that is kept: only what lies below the changed value runs again."""
import sightglass as sg

p = sg.pipeline(sg.gyroid(size=96).gaussian_smooth(sigma=0.1).contour(values=[0.0]))
for value in (-0.6, 0.0, 0.6):
    picture = p.set("contour", values=[value]).render((480, 360))
    picture.save(f"change_one_value_{value:+.1f}.png")
print(p.explain())

# SPDX-License-Identifier: Apache-2.0
"""A series whose steps are made when they are needed, as four panels and as a film."""
import numpy as np
import sightglass as sg

z, y, x = np.mgrid[-1:1:64j, -1:1:64j, -1:1:64j]


def step(i):
    t = 0.5 * i
    r = np.sqrt(x * x + y * y + z * z)
    bumps = 0.12 * np.sin(8 * np.arctan2(y, x)) * (1 - (z / (r + 1e-9)) ** 2) ** 4
    return sg.uniform((r - 0.55 - np.sin(2 * t) * bumps).astype(np.float32), spacing=(2 / 63,) * 3, name="f")


ds = sg.series([0.5 * i for i in range(4)], step)
shape = ds.contour(values=[0])
panels = sg.scene()
for t in ds.times:
    panels.add(shape.at(t), "surface", color="#d08030")
panels.picture(layout="2x2").render().save("growing.png")
sg.scene().add(shape, "surface", color="#d08030").picture(title="t = {t} s").movie("growing.webm", size=(480, 360))

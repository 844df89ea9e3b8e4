# SPDX-License-Identifier: Apache-2.0
"""An unstructured mesh cut open: whole cells kept, their edges drawn."""
import sightglass as sg

ball = sg.sphere(size=24).unstructured().threshold(max=0)
ball.clip(normal=(1, 0.6, 0.4)).plot("surface", edges=True, map="viridis").save("clip_with_edges.png")

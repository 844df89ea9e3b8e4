# SPDX-License-Identifier: Apache-2.0
"""A height map from a 2-D array: bands of colour, contour lines and their numbers."""
import numpy as np
import sightglass as sg

y, x = np.mgrid[-3:3:121j, -3:3:121j]
height = 3 * (1 - x) ** 2 * np.exp(-x**2 - (y + 1) ** 2) - 10 * (x / 5 - x**3 - y**5) * np.exp(-x**2 - y**2)

ds = sg.uniform(height, spacing=(0.05, 0.05, 1), origin=(-3, -3, 0), name="height", unit="m")
levels = np.arange(-5, 5, 1)
lines = ds.isolines(values=levels)
scene = sg.scene().add(ds.bands(values=levels), "surface", lit=False, map="batlow")
scene.add(lines, "lines", color="#202020").add(lines.line_labels(), "labels").render().save("labelled_isolines.png")

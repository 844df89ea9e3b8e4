# SPDX-License-Identifier: Apache-2.0
"""Arrows of a vector field, as numbers from numpy: a vortex with a jet along its axis."""
import numpy as np
import sightglass as sg

z, y, x = np.mgrid[-1:1:17j, -1:1:17j, -1:1:17j]
r2 = x * x + y * y
velocity = np.stack([-y * np.exp(-2 * r2), x * np.exp(-2 * r2), 0.5 * np.exp(-8 * r2)], axis=-1)

ds = sg.uniform(velocity, components=True, spacing=(1 / 8,) * 3, origin=(-1, -1, -1), name="velocity", unit="m/s")
ds.plot("glyphs", count=900).save("arrows.png")

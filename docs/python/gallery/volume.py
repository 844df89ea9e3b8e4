# SPDX-License-Identifier: Apache-2.0
"""A numpy array as a volume: the sum of three waves, seen through."""
import numpy as np
import sightglass as sg

z, y, x = np.mgrid[-1:1:96j, -1:1:96j, -1:1:96j]
waves = sum(np.sin(12 * np.hypot(np.hypot(x - a, y), z)) for a in (-0.5, 0.0, 0.5)).astype(np.float32)

ds = sg.uniform(waves, spacing=(2 / 95,) * 3, origin=(-1, -1, -1), name="amplitude")
ds.plot("volume", opacity={-3: 0.6, -1.8: 0, 1.8: 0, 3: 0.6}, map="coolwarm").save("volume.png")

# SPDX-License-Identifier: Apache-2.0
"""Patches of cells that refine each other, from arrays, with the levels' edges."""
import numpy as np
import sightglass as sg


def density(lo, shape, h):
    k, j, i = np.indices(shape)
    x, y, z = ((n + 0.5 + first) * h for n, first in zip((i, j, k), lo))
    return np.exp(-30 * ((x - 0.45) ** 2 + (y - 0.45) ** 2 + (z - 0.45) ** 2)).astype(np.float32)


levels = [(h, [(lo, density(lo, shape, h))]) for h, lo, shape in (
    (1 / 8, (0, 0, 0), (8, 8, 8)), (1 / 16, (4, 4, 4), (8, 8, 8)), (1 / 32, (10, 10, 10), (10, 10, 10)))]
ds = sg.amr(levels, name="density")
ds.clip(normal=(1, 1, 0.5), origin=(0.45, 0.45, 0.45)).plot("surface", edges=True, field="density").save("amr_patches.png")

# SPDX-License-Identifier: Apache-2.0
"""OpenVDB's grids: the box of their active voxels, dense."""
from __future__ import annotations

from typing import Any

import numpy as np

from .. import _meshes
from .._data import Data
from .._errors import usage


def wrapped(x: Any, **hints: Any) -> Data:
    """A grid with a linear transform; its background fills the box."""
    if hints:
        raise usage(f"'{next(iter(hints))}' is no hint for grids of OpenVDB", "wrap", "they need none")
    lo, hi = x.evalActiveVoxelBoundingBox()
    if any(b < a for a, b in zip(lo, hi)):
        raise usage("the grid has no active voxels", "wrap")
    dims = [b - a + 1 for a, b in zip(lo, hi)]
    several = isinstance(x.background, (tuple, list))
    one = x.background[0] if several else x.background
    kind = np.uint8 if isinstance(one, bool) else np.int32 if isinstance(one, int) else np.float32
    values = np.empty((*dims, 3) if several else dims, kind)
    x.copyToArray(values, ijk=lo)
    at = x.transform.indexToWorld
    origin = np.array(at(lo))
    columns = np.array([np.array(at([a + (i == k) for i, a in enumerate(lo)])) - origin for k in range(3)]).T
    spacing = np.linalg.norm(columns, axis=0)
    return _meshes.uniform(values, order="xyz", components=several, spacing=spacing, origin=origin, direction=columns / spacing,
                           name=x.name or "values")

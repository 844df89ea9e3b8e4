# SPDX-License-Identifier: Apache-2.0
"""Grids of OpenVDB (the module openvdb, once pyopenvdb) as data, placed as sg.read places those of a file."""
from __future__ import annotations

from typing import Any, Sequence

import numpy as np

from .._data import Data
from .._errors import usage
from .._meshes import uniform

_types = {"float": np.float32, "double": np.float64, "int32": np.int32, "int64": np.int64, "bool": np.bool_, "vec3s": np.float32,
          "vec3d": np.float64, "vec3i": np.int32}
_most_bytes = 8 << 30
_dense_lo, _dense_hi = "dense_box_lo", "dense_box_hi"  # as Sightglass writes them


def wrap(x: Any, /, box: Sequence[Sequence[int]] | None = None) -> Data:
    """A uniform grid with a copy of the values in the box of the active voxels, or in ``box``: first and last voxel, wrap(grid,
    box=((0, 0, 0), (63, 63, 63))). The background fills what is empty; voxels are points. The transform has to be linear."""
    if not hasattr(x, "copyToArray"):
        raise usage(f"an {type(x).__module__.partition('.')[0]}.{type(x).__name__} is not known", "wrap", "a grid of numbers or vectors")
    kind = x.valueTypeName
    if kind not in _types:
        raise usage(f"a grid of {kind}", "wrap", "one of " + ", ".join(_types))
    lo, hi = _box(x, box)
    dims = tuple(int(b - a + 1) for a, b in zip(lo, hi))
    components = (3,) if kind.startswith("vec") else ()
    size = int(np.prod(dims, dtype=object)) * np.dtype(_types[kind]).itemsize * (3 if components else 1)
    if box is None and size > _most_bytes:
        raise usage(f"its box of {dims[0]} x {dims[1]} x {dims[2]} voxels has {size / 2**30:.0f} GiB when dense", "wrap",
                    "a part of it: box=((i, j, k), (i, j, k))")
    values = np.empty((*dims, *components), _types[kind])
    x.copyToArray(values, ijk=lo)
    values = values.transpose(2, 1, 0, *([3] if components else []))
    origin, columns = _placing(x, lo)
    spacing = np.linalg.norm(columns, axis=0)
    return uniform(np.ascontiguousarray(values), spacing=spacing, origin=origin, direction=columns / spacing, components=bool(components),
                   name=x.name or "values")


def _box(x: Any, box: Sequence[Sequence[int]] | None) -> tuple[tuple[int, ...], tuple[int, ...]]:
    if box is not None:
        ends = np.asarray(box)
        if ends.shape != (2, 3) or ends.dtype.kind not in "iu" or (ends[1] < ends[0]).any():
            raise usage(f"box={box!r}", "wrap", "the first and the last voxel, ((i, j, k), (i, j, k))")
        return tuple(ends[0].tolist()), tuple(ends[1].tolist())
    lo, hi = x.evalActiveVoxelBoundingBox()
    empty = any(b < a for a, b in zip(lo, hi))
    told = x.metadata.get(_dense_lo), x.metadata.get(_dense_hi)
    if told[0] and told[1] and (empty or all(a <= b for a, b in zip((*told[0], *hi), (*lo, *told[1])))):
        return tuple(told[0]), tuple(told[1])
    if empty:
        raise usage(f"grid '{x.name}' has no active voxel", "wrap", "one at least, or box=((i, j, k), (i, j, k))")
    return tuple(lo), tuple(hi)


def _placing(x: Any, lo: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Where the first voxel lies, and the steps to the next along each axis, as columns."""
    if not getattr(x.transform, "isLinear", True):
        raise usage(f"grid '{x.name}' has a transform that is not linear ({x.transform.typeName})", "wrap", "frustums are not supported")
    zero = np.array(x.transform.indexToWorld((0.0, 0.0, 0.0)))
    columns = np.stack([np.array(x.transform.indexToWorld(tuple(unit))) - zero for unit in np.eye(3).tolist()], axis=1)
    return zero + columns @ np.array(lo, float), columns

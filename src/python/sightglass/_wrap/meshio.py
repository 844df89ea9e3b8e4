# SPDX-License-Identifier: Apache-2.0
"""meshio's meshes: blocks of cells, whose nodes stand in VTK's order."""
from __future__ import annotations

from typing import Any

import numpy as np

from .. import _meshes
from .._data import Data
from .._errors import usage


def wrapped(x: Any, **hints: Any) -> Data:
    """Cells in the order of the blocks; sets of cells are fields of 0 and 1."""
    from meshio._vtk_common import meshio_to_vtk_type  # type: ignore[import-not-found]

    if hints:
        raise usage(f"'{next(iter(hints))}' is no hint for meshes of meshio", "wrap", "they need none")
    if not hasattr(x, "cells") or not hasattr(x, "point_data"):
        raise usage(f"{type(x).__name__} is not known", "wrap", "meshio.Mesh is")
    points = np.asarray(x.points)
    if not x.cells:
        data = _meshes.points(points)
    else:
        lists = _meshes._Lists()
        for block in x.cells:
            name = "polyhedron" if block.type.startswith("polyhedron") else block.type
            number = 42 if name == "polyhedron" else meshio_to_vtk_type.get(name)
            if number is None:
                raise usage(f"cells of type '{block.type}' are not known", "wrap", "one that VTK has, too")
            lists.add(number, block.data, f"cells '{block.type}'")
        data = Data(_meshes._core.unstructured_mesh(_meshes._lent_positions(points), *lists.arrays()))
    for name, values in x.point_data.items():
        data = data.with_field(name, values, on="points")
    for name, blocks in x.cell_data.items():
        data = data.with_field(name, blocks[0] if len(blocks) == 1 else np.concatenate(blocks), on="cells")
    sizes = [len(block.data) for block in x.cells]
    for name, members in (x.cell_sets or {}).items():
        marks = [np.isin(np.arange(n), m if m is not None else []) for n, m in zip(sizes, members)]
        data = data.with_field(name, np.concatenate(marks).astype(np.uint8), on="cells")
    return data


def to_meshio(data: Data) -> Any:
    """Blocks of neighbouring cells of one type and size."""
    import meshio
    from meshio._vtk_common import vtk_to_meshio_type

    mesh = data if data.kind in ("unstructured", "surface") else data.unstructured()
    ids, offsets, types = mesh.cells
    if (types == 42).any():
        raise usage("polyhedra cannot go to meshio", "to_meshio", "tessellate() them, or write a .vtu file")
    sizes = np.diff(offsets)
    begins = np.flatnonzero(np.concatenate([[True], (types[1:] != types[:-1]) | (sizes[1:] != sizes[:-1])])) if len(types) else np.zeros(0, int)
    ends = np.append(begins[1:], len(types))
    cells = [(vtk_to_meshio_type[int(types[b])], ids[offsets[b]:offsets[e]].reshape(e - b, sizes[b])) for b, e in zip(begins, ends)]
    point_data = {n: mesh[n] for n in mesh.keys() if mesh.on(n) == "points"}
    cell_data = {n: [mesh[n][b:e] for b, e in zip(begins, ends)] for n in mesh.keys() if mesh.on(n) == "cells"}
    return meshio.Mesh(mesh.points, cells, point_data=point_data, cell_data=cell_data)

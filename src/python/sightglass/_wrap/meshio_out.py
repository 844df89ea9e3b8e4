# SPDX-License-Identifier: Apache-2.0
"""Data as meshes of meshio."""
from __future__ import annotations

from typing import Any

import numpy as np

from .._data import Data
from .._errors import say, usage
from .shared import begins_of, fields_of, meshes_only, needed, spread
from .vtk_cells import Triple

_strip, _pixel, _voxel, _several_vertices, _poly_line = 6, 8, 11, 2, 4


def to_meshio(data: Data) -> Any:
    """A Mesh: a block for each run of cells of one type and size, so that they keep their order.

    What meshio does not have becomes what it has: poly-lines lines, strips triangles, pixels quads, voxels hexahedra. Points and fields are
    views, read-only; point numbers too, except where they are reordered. Fields of the whole are ``field_data``; ``mesh.info["units"]``
    keeps the units.
    """
    meshes_only(data, "to_meshio", "to_pandas()" if data.kind == "table" else "one part of it: data.parts[name].to_meshio()")
    meshio = needed("meshio", "to_meshio")
    if data.kind == "amr":
        data = data.unstructured()
    (ids, offsets, types), source = _known_to_meshio(data.cells)
    faces = data.polyhedra
    sizes = np.diff(offsets)
    many = len(types) - 1
    starts = np.flatnonzero(np.concatenate([[len(types) > 0], (types[1:] != types[:-1]) | (sizes[1:] != sizes[:-1])]))
    runs = [(int(a), int(b)) for a, b in zip(starts, [*starts[1:], many + 1])]
    blocks = [_block(ids, offsets, int(types[a]), a, b, faces) for a, b in runs]
    fields = fields_of(data)
    cell_data: dict[str, list[np.ndarray]] = {}
    for f in fields:
        if f.on == "cells":
            values = f.values if source is None else f.values[source]
            cell_data[f.name] = [values[a:b] for a, b in runs]
    try:
        return meshio.Mesh(data.points, blocks, point_data={f.name: f.values for f in fields if f.on == "points"}, cell_data=cell_data,
                           field_data={f.name: f.values for f in fields if f.on == "whole"},
                           info={"units": {f.name: f.unit for f in fields if f.unit}})
    except KeyError as e:  # 5.0 reads wedge15, pyramid13 and hexahedron24 but has no mesh of them
        raise usage(f"meshio {meshio.__version__} knows no mesh with cells of type {e}", "to_meshio", "a newer one, or tessellate()") from e


def _block(ids: np.ndarray, offsets: np.ndarray, number: int, a: int, b: int, faces: Triple) -> tuple[str, Any]:
    common = needed("meshio._vtk_common", "to_meshio")
    if number not in common.vtk_to_meshio_type:
        raise usage(f"cell {a} is of VTK's type {number}", "to_meshio", "types that meshio has; tessellate() makes linear ones")
    name = common.vtk_to_meshio_type[number]
    size = int(offsets[a + 1] - offsets[a])
    if name == "polyhedron":
        face_ids, begins, of_cells = faces
        lists = [[face_ids[begins[f]:begins[f + 1]] for f in range(of_cells[c], of_cells[c + 1])] for c in range(a, b)]
        return f"polyhedron{size}", lists
    rows = ids[offsets[a]:offsets[b]].reshape(b - a, size)
    order = common.vtk_to_meshio_order(number)
    return name, rows if order is None else rows[:, order]


def _known_to_meshio(cells: Triple) -> tuple[Triple, np.ndarray | None]:
    """Cells that meshio has in place of others, and which cell each comes from (None: they are the same)."""
    ids, offsets, types = cells
    if not np.isin(types, (_several_vertices, _poly_line, _strip, _pixel, _voxel)).any():
        return cells, None
    sizes = np.diff(offsets)
    split = {_several_vertices: (1, 1), _poly_line: (3, 2), _strip: (5, 3)}  # the type of the pieces, and their size
    piece = np.array([split.get(int(t), (t, 0))[0] for t in range(256)], np.uint8)[types]
    length = np.array([split.get(t, (0, 0))[1] for t in range(256)])[types]
    counts = np.where(length > 0, np.maximum(sizes - length + 1, 0), 1)
    source = np.repeat(np.arange(len(types)), counts)
    number = np.arange(len(source)) - np.repeat(begins_of(counts)[:-1], counts)  # of a piece in its cell
    of_pieces = np.where(length > 0, length, sizes)[source]
    made = ids[spread(offsets[source] + np.where(length[source] > 0, number, 0), of_pieces)]
    begins = begins_of(of_pieces)
    odd = begins[:-1][(types[source] == _strip) & (number % 2 == 1)]  # every other triangle of a strip runs backwards
    made[odd], made[odd + 1] = made[odd + 1], made[odd].copy()
    new_types = piece[source]
    # The rows of pixels and voxels run the same way, those of quads and hexahedra to and fro.
    for old, new, swaps in ((_pixel, 9, ((2, 3),)), (_voxel, 12, ((2, 3), (6, 7)))):
        boxes = begins[:-1][new_types == old]
        for i, j in swaps:
            made[boxes + i], made[boxes + j] = made[boxes + j], made[boxes + i].copy()
        new_types = np.where(new_types == old, np.uint8(new), new_types)
    if (counts != 1).any():
        say(False, f"to_meshio: {len(types)} cells become {len(source)}, as poly-lines and strips are split")
    return (made, begins, new_types), source if (counts != 1).any() else None

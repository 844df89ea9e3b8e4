# SPDX-License-Identifier: Apache-2.0
"""Meshes of meshio as data."""
from __future__ import annotations

from typing import Any, Iterable, Mapping

import numpy as np

from .._data import Data
from .._errors import say, usage
from .._meshes import _Lists, _positions, points, unstructured
from .gmsh_nodes import order_of
from .meshio_out import to_meshio
from .shared import Field, needed, with_fields

__all__ = ["to_meshio", "wrap"]

_lagrange = {"line": 68, "triangle": 69, "quad": 70, "tetra": 71, "hexahedron": 72, "wedge": 73}


def wrap(x: Any, /, units: Mapping[str, str] | None = None) -> Data:
    """An unstructured mesh with the cells in the order of the blocks; sets of cells and points are fields of 0 and 1.

    Points and fields of points are used where they lie, and so are cells and their fields where there is one block. ``units`` by field;
    else those that to_meshio left in ``mesh.info["units"]``.
    """
    if not hasattr(x, "cells") or not hasattr(x, "point_data"):
        raise usage(f"a meshio.{type(x).__name__} is not known", "wrap", "a meshio.Mesh")
    made = _Lists()
    for block in x.cells:
        if len(block.data):
            _add(made, block.type, block.data)
    xyz = _positions(x.points)
    if made.sizes:
        ids, offsets, types, faces = made.arrays()
        data = unstructured(xyz, (ids, offsets, types), faces=faces)
    else:
        data = points(xyz)
    noted = x.info.get("units", {}) if isinstance(getattr(x, "info", None), dict) else {}
    known = {**noted, **(units or {})}
    return with_fields(data, (f._replace(unit=known.get(f.name, "")) for f in _fields(x, data)))


def _add(made: _Lists, name: str, cells: Any) -> None:
    where = f"wrap: block '{name}'"
    if name.startswith("polyhedron"):
        made.add(42, cells, where)
        return
    common = needed("meshio._vtk_common", "wrap")
    number = common.meshio_to_vtk_type.get(name)
    if number == 7:
        made.add(number, cells if isinstance(cells, np.ndarray) and cells.ndim == 2 else [np.asarray(c) for c in cells], where)
        return
    a = np.asarray(cells)
    if a.ndim != 2:
        raise usage(f"{a.ndim} dimensions", where, "one row of point numbers for each cell")
    if number is not None:
        order = common.meshio_to_vtk_order(name)
    elif name == "pyramid14":  # VTK has no node in the middle of the base; the others stand as in Gmsh
        number, order = 27, [0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12]
        say(False, f"{where}: the node in the middle of the base is left out")
    else:
        shape = name.rstrip("0123456789")
        number, order = _lagrange.get(shape), order_of(shape, a.shape[1]) if shape in _lagrange else None
        if number is None or order is None:
            known = ", ".join(common.meshio_to_vtk_type)
            raise usage(f"cells of type '{name}' are not known", "wrap", f"one of {known}, or of higher order: triangle10, tetra20, ...")
    made.add(number, a if order is None else a[:, order], where)


def _fields(x: Any, data: Data) -> Iterable[Field]:
    for name, values in x.point_data.items():
        yield Field(name, "points", values)
    counts = [len(block.data) for block in x.cells]
    for name, blocks in x.cell_data.items() if counts else ():
        if [len(b) for b in blocks] != counts:
            raise usage(f"it has values for {[len(b) for b in blocks]} cells", f"wrap: cell data '{name}'", f"the blocks have {counts}")
        yield Field(name, "cells", np.asarray(blocks[0]) if len(blocks) == 1 else np.concatenate([np.asarray(b) for b in blocks]))
    for name, members in (getattr(x, "point_sets", None) or {}).items():
        yield Field(name, "points", _marks(members, data.n_points, f"wrap: point set '{name}'"))
    for name, sets in (getattr(x, "cell_sets", None) or {}).items():
        if name == "gmsh:bounding_entities":  # tags of geometry, no cells
            continue
        where = f"wrap: cell set '{name}'"
        yield Field(name, "cells", np.concatenate([_marks(s, n, where) for s, n in zip(sets, counts)] or [np.zeros(0, np.uint8)]))
    for name, values in (x.field_data or {}).items():
        if np.asarray(values).dtype.kind in "iufb":
            yield Field(name, "whole", values)
        else:
            say(False, f"wrap: field data '{name}' is left out, it holds no numbers")


def _marks(members: Any, count: int, where: str) -> np.ndarray:
    marks = np.zeros(count, np.uint8)
    if members is None or not len(members):
        return marks
    chosen = np.asarray(members)
    if chosen.dtype.kind not in "iu" or chosen.min() < 0 or chosen.max() >= count:
        raise usage(f"it names {chosen.min()} to {chosen.max()}", where, f"numbers from 0 to {count - 1}")
    marks[chosen] = 1
    return marks

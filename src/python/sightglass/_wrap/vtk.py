# SPDX-License-Identifier: Apache-2.0
"""Data sets of VTK and PyVista as data."""
from __future__ import annotations

from typing import Any, Callable

import numpy as np

from .. import _core
from .._data import Data
from .._errors import say, usage
from .._groups import table
from .._meshes import _lent_positions, curvilinear, points, rectilinear, uniform, unstructured
from .._numbers import whole
from .vtk_arrays import fields, is_numbers, numbers, unit_of, words
from .vtk_cells import check_shapes, lists, polyhedra
from .vtk_out import to_pyvista, to_vtk
from .shared import unused, with_fields

__all__ = ["to_pyvista", "to_vtk", "wrap"]


def wrap(x: Any, /) -> Data:
    """Image data, rectilinear, structured and unstructured grids, poly data, tables, and trees of them.

    Points, cells and fields are used where VTK holds them. Whoever writes into them through VTK afterwards changes what data hold, and
    whoever makes VTK move them (InsertNextValue, Resize) takes them away: hand over what is finished.
    """
    kinds: dict[str, Callable[[Any], Data]] = {
        "vtkImageData": _image, "vtkRectilinearGrid": _rectilinear, "vtkStructuredGrid": _structured,
        "vtkExplicitStructuredGrid": _as_unstructured, "vtkUnstructuredGrid": _unstructured, "vtkPolyData": _poly_data,
        "vtkPointSet": _points, "vtkTable": _table, "vtkMultiBlockDataSet": _tree, "vtkPartitionedDataSet": _tree,
        "vtkPartitionedDataSetCollection": _tree,
    }
    if hasattr(x, "GetOutputDataObject") and hasattr(x, "Update"):
        raise usage(f"a {x.GetClassName()} makes data but is none", "wrap", "x.Update(), then wrap(x.GetOutputDataObject(0))")
    if hasattr(x, "GetClassName"):
        for base in type(x).__mro__:
            if base.__name__ in kinds:
                data = kinds[base.__name__](x)
                return data if data.kind in ("collection", "table") else _with_its_fields(data, x)
    name = x.GetClassName() if hasattr(x, "GetClassName") else type(x).__qualname__
    raise usage(f"a {name} is not known", "wrap", "one of " + ", ".join(kinds) + ", and what is derived from them")


def _with_its_fields(data: Data, x: Any) -> Data:
    on_cells = fields(x.GetCellData(), "cells") if data.n_cells or data.kind != "points" else []
    return with_fields(data, fields(x.GetPointData(), "points") + on_cells + fields(x.GetFieldData(), "whole"))


def _image(x: Any) -> Data:
    m = x.GetDirectionMatrix()
    direction = np.array([[m.GetElement(i, j) for j in range(3)] for i in range(3)])
    spacing, first = np.array(x.GetSpacing()), np.array(x.GetExtent()[::2])
    dims = _filled(x)
    # VTK's origin is where the point 0, 0, 0 lies; its extent may begin at another.
    return uniform(dims=dims, spacing=spacing, origin=np.array(x.GetOrigin()) + direction @ (spacing * first), direction=direction)


def _filled(x: Any) -> tuple[int, int, int]:
    lo, hi = x.GetExtent()[::2], x.GetExtent()[1::2]
    nx, ny, nz = (b - a + 1 for a, b in zip(lo, hi))
    if min(nx, ny, nz) < 1:
        raise usage(f"it has {nx} x {ny} x {nz} points", f"wrap: {x.GetClassName()}", "one point or more along each axis")
    return nx, ny, nz


def _rectilinear(x: Any) -> Data:
    _filled(x)
    return rectilinear(*(numbers(getattr(x, f"Get{a}Coordinates")(), f"wrap: {a} coordinates") for a in "XYZ"))


def _structured(x: Any) -> Data:
    nx, ny, nz = _filled(x)
    return curvilinear(_positions(x).reshape(nz, ny, nx, 3))


def _positions(x: Any) -> np.ndarray:
    return numbers(x.GetPoints().GetData(), "wrap: points") if x.GetPoints() else np.empty((0, 3))


def _points(x: Any) -> Data:
    return points(_positions(x))


def _unstructured(x: Any) -> Data:
    if not x.GetNumberOfCells():
        return _points(x)
    check_shapes(x)
    types = x.GetCellTypesArray() if hasattr(x, "GetCellTypesArray") else x.GetCellTypes()
    ids, offsets = lists(x.GetCells())
    return unstructured(_positions(x), (ids, offsets, numbers(types, "wrap: cell types")), faces=polyhedra(x))


def _as_unstructured(x: Any) -> Data:
    cells = x.GetCells()
    ids, offsets = lists(cells)
    if x.HasAnyBlankCells():
        say(True, "wrap: blanked cells of the explicit structured grid are shown")
    return unstructured(_positions(x), (ids, offsets, np.full(len(offsets) - 1, 12, np.uint8)))


def _poly_data(x: Any) -> Data:
    """A vertex for each point, or no cells, are points; all else is a surface, whose cells have VTK's numbers."""
    xyz = _positions(x)
    kinds = [lists(cells) if cells.GetNumberOfCells() else None for cells in (x.GetVerts(), x.GetLines(), x.GetPolys(), x.GetStrips())]
    if not any(kinds):
        return points(xyz)
    if kinds[0] and not any(kinds[1:]) and not x.GetCellData().GetNumberOfArrays():  # points have no place for fields of cells
        ids, offsets = kinds[0]
        if len(ids) == len(xyz) and len(offsets) == len(ids) + 1 and np.array_equal(ids, np.arange(len(ids))):
            return points(xyz)
    return Data(_core.surface_mesh(_lent_positions(xyz), [k and (whole(k[0], "point numbers"), whole(k[1], "offsets")) for k in kinds]))


def _table(x: Any) -> Data:
    columns: dict[str, Any] = {}
    units: dict[str, str] = {}
    for i in range(x.GetNumberOfColumns()):
        array = x.GetColumn(i)
        name = unused(array.GetName() or f"column {i}", lambda n: n in columns)
        if is_numbers(array):
            columns[name], units[name] = numbers(array, f"wrap '{name}'"), unit_of(array)
        elif array.IsA("vtkStringArray"):
            columns[name] = np.array(words(array), object)
        else:
            say(False, f"wrap: column '{name}' is left out, a {array.GetClassName()} holds neither numbers nor words")
    return table(columns, units)


def _tree(x: Any) -> Data:
    """Blocks by name; the pieces of one partitioned data set have numbers. Empty blocks are left out."""
    groups = x.IsA("vtkPartitionedDataSetCollection")
    blocks = x.IsA("vtkMultiBlockDataSet")
    count = x.GetNumberOfPartitionedDataSets() if groups else x.GetNumberOfBlocks() if blocks else x.GetNumberOfPartitions()
    found = []
    for i in range(count):
        part = x.GetPartitionedDataSet(i) if groups else x.GetBlock(i) if blocks else x.GetPartitionAsDataObject(i)
        if part is None:
            continue
        data = wrap(part)
        pieces = data.parts if part.IsA("vtkPartitionedDataSet") and not part.IsA("vtkMultiBlockDataSet") else {}
        if len(pieces) == 1:
            data = next(iter(pieces.values()))
        name = x.GetMetaData(i).Get(x.NAME()) if x.HasMetaData(i) and x.GetMetaData(i).Has(x.NAME()) else None
        found.append((name or str(i), data._core))
    return Data(_core.collection(found))

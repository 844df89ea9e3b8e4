# SPDX-License-Identifier: Apache-2.0
"""VTK's objects, and PyVista's, which are VTK's: both share their numbers with data."""
from __future__ import annotations

from typing import Any

import numpy as np

from .. import _groups, _meshes
from .._data import Data
from .._errors import say, usage

_by_kind = {"vtkImageData": "uniform", "vtkRectilinearGrid": "rectilinear", "vtkStructuredGrid": "curvilinear", "vtkPolyData": "polydata",
            "vtkUnstructuredGrid": "unstructured"}


def wrapped(x: Any, **hints: Any) -> Data:
    """vtkImageData, vtkRectilinearGrid, vtkStructuredGrid, vtkPolyData, vtkUnstructuredGrid, their collections, and vtkTable."""
    if hints:
        raise usage(f"'{next(iter(hints))}' is no hint for VTK's objects", "wrap", "they need none")
    kind = next((k for k in _by_kind if x.IsA(k)), None)
    if kind:
        return _with_fields(globals()["_" + _by_kind[kind]](x), x)
    if x.IsA("vtkTable"):
        columns = {}
        for i in range(x.GetNumberOfColumns()):
            column = x.GetColumn(i)
            words = column.IsA("vtkStringArray")
            columns[_name(column, i)] = [column.GetValue(j) for j in range(column.GetNumberOfValues())] if words else _numbers(column)
        return _groups.table(columns)
    if x.IsA("vtkCompositeDataSet"):
        return _groups.collection(_parts(x))
    raise usage(f"{x.GetClassName()} is not known", "wrap", "meshes, their collections and tables are")


def _parts(x: Any) -> dict[str, Data]:
    parts: dict[str, Data] = {}

    def add(name: str, part: Data) -> None:
        unique, n = name, 2
        while unique in parts:
            unique, n = f"{name} #{n}", n + 1
        parts[unique] = part

    if x.IsA("vtkMultiBlockDataSet"):
        for i in range(x.GetNumberOfBlocks()):
            block = x.GetBlock(i)
            name = x.GetMetaData(i).Get(x.NAME()) if x.HasMetaData(i) else None
            if block is not None:
                add(name or f"Block-{i:02d}", wrapped(block))
        return parts
    it = x.NewIterator()
    it.InitTraversal()
    while not it.IsDoneWithTraversal():
        add(str(len(parts)), wrapped(it.GetCurrentDataObject()))
        it.GoToNextItem()
    return parts


def _numbers(array: Any) -> np.ndarray:
    from vtkmodules.util.numpy_support import vtk_to_numpy  # type: ignore[import-not-found]

    return vtk_to_numpy(array)  # holds the array


def _name(array: Any, number: int) -> str:
    return array.GetName() or f"Array {number}"


def _uniform(x: Any) -> Data:
    """Extents that do not begin at 0 move the origin."""
    direction = np.array([[x.GetDirectionMatrix().GetElement(i, j) for j in range(3)] for i in range(3)])
    spacing, extent = np.array(x.GetSpacing()), x.GetExtent()
    origin = np.array(x.GetOrigin()) + direction @ (spacing * extent[::2])
    return _meshes.uniform(dims=x.GetDimensions(), spacing=spacing, origin=origin, direction=direction)


def _rectilinear(x: Any) -> Data:
    return _meshes.rectilinear(*(_numbers(c) for c in (x.GetXCoordinates(), x.GetYCoordinates(), x.GetZCoordinates())))


def _curvilinear(x: Any) -> Data:
    points = _numbers(x.GetPoints().GetData())
    return _meshes.curvilinear(points.reshape(*reversed(x.GetDimensions()), 3))


def _points(x: Any) -> np.ndarray:
    return _numbers(x.GetPoints().GetData()) if x.GetPoints() else np.zeros((0, 3))


def _lists(cells: Any) -> tuple[np.ndarray, np.ndarray]:
    if cells is None or cells.GetNumberOfCells() == 0:
        return np.zeros(0, np.int64), np.zeros(1, np.int64)
    return _numbers(cells.GetConnectivityArray()), _numbers(cells.GetOffsetsArray())


def _polydata(x: Any) -> Data:
    kinds = [(1, x.GetVerts()), (3, x.GetLines()), (7, x.GetPolys()), (6, x.GetStrips())]
    there = [(number, *_lists(cells)) for number, cells in kinds if cells is not None and cells.GetNumberOfCells()]
    points = _points(x)
    if not there:
        return _meshes.points(points)
    if len(there) == 1 and there[0][0] == 7:
        ids, offsets = there[0][1:]
        every = np.diff(offsets) == 3
        return _meshes.surface(points, ids.reshape(-1, 3)) if every.all() else _meshes.surface(points, ids, offsets)
    # Cells of several kinds keep VTK's order: vertices, lines, polygons, strips.
    sizes = np.concatenate([np.diff(offsets) for _, _, offsets in there])
    types = np.concatenate([np.full(len(offsets) - 1, {1: 2, 3: 4}.get(number, number), np.uint8) for number, _, offsets in there])
    return _meshes.unstructured(points, (np.concatenate([ids for _, ids, _ in there]), np.concatenate([[0], np.cumsum(sizes)]), types))


def _unstructured(x: Any) -> Data:
    if x.GetNumberOfCells() == 0:
        return _meshes.points(_points(x))
    ids, offsets = _lists(x.GetCells())
    types = _numbers(x.GetCellTypesArray())
    if not (types == 42).any():
        return _meshes.unstructured(_points(x), (ids, offsets, types))
    stream, begins = _numbers(x.GetFaces()), _numbers(x.GetFaceLocations())
    face_ids: list[np.ndarray] = []
    counts = np.zeros(len(types), np.int64)
    for cell in np.flatnonzero(begins >= 0):
        at = begins[cell] + 1
        counts[cell] = stream[at - 1]
        for _ in range(counts[cell]):
            face_ids.append(stream[at + 1:at + 1 + stream[at]])
            at += 1 + stream[at]
    sizes = np.array([len(f) for f in face_ids])
    faces = np.concatenate(face_ids), np.concatenate([[0], np.cumsum(sizes)]), np.concatenate([[0], np.cumsum(counts)])
    return _meshes.unstructured(_points(x), (ids, offsets, types), faces=faces)


def _with_fields(data: Data, x: Any) -> Data:
    for on, attributes in (("points", x.GetPointData()), ("cells", x.GetCellData()), ("whole", x.GetFieldData())):
        for i in range(attributes.GetNumberOfArrays()):
            array = attributes.GetAbstractArray(i)
            name = _name(array, i)
            if not hasattr(array, "GetDataTypeSize") or array.IsA("vtkStringArray"):
                say(True, f"wrap: '{name}' is left out: it holds words")
            elif array.GetNumberOfTuples():
                data = data.with_field(name, _numbers(array), on=on)
    return data


# ---- and back

def to_vtk(data: Data) -> Any:
    """The object of VTK for a mesh; a vtkMultiBlockDataSet for a collection, a vtkTable for a table. Points and fields are shared: VTK must
    not write into them, and they stay where they are as long as VTK holds them. Lists of cells are copied."""
    from vtkmodules import vtkCommonDataModel as model  # type: ignore[import-not-found]

    if data.kind == "collection":
        blocks = model.vtkMultiBlockDataSet()
        for i, (name, part) in enumerate(data.parts.items()):
            blocks.SetBlock(i, to_vtk(part))
            blocks.GetMetaData(i).Set(blocks.NAME(), name)
        return blocks
    if data.kind == "table":
        return _to_table(data)
    x = _to_mesh(data, model)
    for name in data.keys():
        place = {"points": x.GetPointData, "cells": x.GetCellData, "whole": x.GetFieldData}[data.on(name)]()
        array = _lent(data[name])
        array.SetName(name)
        place.AddArray(array)
    return x


def to_pyvista(data: Data) -> Any:
    """The object of PyVista for it (see to_vtk)."""
    import pyvista  # type: ignore[import-not-found]

    return pyvista.wrap(to_vtk(data))


def _lent(numbers: np.ndarray, kind: int | None = None) -> Any:
    """A VTK array over the same memory."""
    from vtkmodules.util.numpy_support import numpy_to_vtk

    lent = np.ascontiguousarray(numbers)
    array = numpy_to_vtk(lent, deep=False, array_type=kind)
    array._sightglass = lent  # held as long as it
    return array


def _cell_array(ids: np.ndarray, offsets: np.ndarray) -> Any:
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.util.vtkConstants import VTK_ID_TYPE  # type: ignore[import-not-found]
    from vtkmodules.vtkCommonDataModel import vtkCellArray

    def list_of(numbers: np.ndarray) -> Any:  # a copy: of lent ones cell arrays take the memory without its owner
        return numpy_to_vtk(np.ascontiguousarray(numbers, np.int64), deep=True, array_type=VTK_ID_TYPE)

    cells = vtkCellArray()
    cells.SetData(list_of(offsets), list_of(ids))
    return cells


def _to_mesh(data: Data, model: Any) -> Any:
    from vtkmodules.vtkCommonCore import vtkPoints  # type: ignore[import-not-found]

    if data.kind == "uniform":
        x = model.vtkImageData()
        x.SetDimensions(*data.dims)
        x.SetSpacing(*data.spacing)
        x.SetOrigin(*data.origin)
        x.SetDirectionMatrix(*data.direction.ravel())
        return x
    if data.kind == "rectilinear":
        x = model.vtkRectilinearGrid()
        x.SetDimensions(*data.dims)
        for set_axis, axis in zip((x.SetXCoordinates, x.SetYCoordinates, x.SetZCoordinates), data.axes):
            set_axis(_lent(axis))
        return x
    points = vtkPoints()
    points.SetData(_lent(data.points))
    if data.kind == "curvilinear":
        x = model.vtkStructuredGrid()
        x.SetDimensions(*data.dims)
    elif data.kind == "points":
        x = model.vtkPolyData()
        n = data.n_points
        x.SetVerts(_cell_array(np.arange(n), np.arange(n + 1)))
    else:
        mesh = data if data.kind in ("unstructured", "surface") else data.unstructured()
        ids, offsets, types = mesh.cells
        if data.kind == "surface":
            x = model.vtkPolyData()
            for numbers, set_cells in (((1, 2), x.SetVerts), ((3, 4), x.SetLines), ((5, 7, 9), x.SetPolys), ((6,), x.SetStrips)):
                which = np.flatnonzero(np.isin(types, numbers))
                if len(which):  # they stand together, in this order
                    begin, end = which[0], which[-1] + 1
                    set_cells(_cell_array(ids[offsets[begin]:offsets[end]], offsets[begin:end + 1] - offsets[begin]))
        else:
            x = model.vtkUnstructuredGrid()
            _set_cells(x, mesh, ids, offsets, types)
    x.SetPoints(points)
    return x


def _set_cells(x: Any, mesh: Data, ids: np.ndarray, offsets: np.ndarray, types: np.ndarray) -> None:
    from vtkmodules.util.vtkConstants import VTK_ID_TYPE, VTK_UNSIGNED_CHAR

    face_ids, face_offsets, of_cells = mesh.polyhedra
    if not len(face_ids):
        x.SetCells(_lent(types, VTK_UNSIGNED_CHAR), _cell_array(ids, offsets))
        return
    stream: list[int] = []
    begins = np.full(len(types), -1, np.int64)
    for cell in np.flatnonzero(np.diff(of_cells)):
        begins[cell] = len(stream)
        faces = range(of_cells[cell], of_cells[cell + 1])
        stream.append(len(faces))
        for f in faces:
            points = face_ids[face_offsets[f]:face_offsets[f + 1]]
            stream += [len(points), *points.tolist()]
    x.SetCells(_lent(types, VTK_UNSIGNED_CHAR), _cell_array(ids, offsets), _lent(begins, VTK_ID_TYPE),
               _lent(np.array(stream, np.int64), VTK_ID_TYPE))


def _to_table(data: Data) -> Any:
    from vtkmodules.vtkCommonCore import vtkStringArray
    from vtkmodules.vtkCommonDataModel import vtkTable

    table = vtkTable()
    for name in data.keys():
        values = data[name]
        if values.dtype.kind == "U":
            column = vtkStringArray()
            for word in values.tolist():
                column.InsertNextValue(word)
        else:
            column = _lent(values)
        column.SetName(name)
        table.AddColumn(column)
    return table

# SPDX-License-Identifier: Apache-2.0
"""Data as data sets of VTK and PyVista."""
from __future__ import annotations

from typing import Any

import numpy as np

from .._data import Data
from .._errors import say
from .shared import fields_of, needed
from .vtk_arrays import array_of
from .vtk_cells import cell_array, set_cells


def to_vtk(data: Data) -> Any:
    """The data set of VTK: vtkImageData, vtkRectilinearGrid, vtkStructuredGrid, vtkUnstructuredGrid, vtkPolyData, vtkTable, or
    vtkMultiBlockDataSet for a collection; patches that refine each other become unstructured.

    Its arrays are Sightglass's own and keep them alive: VTK may read them as long as it likes and must not write into them. Units go where
    VTK keeps them (vtkDataArray.UNITS_LABEL).
    """
    if data.kind == "collection":
        return _tree(data)
    if data.kind == "table":
        return _table(data)
    if data.kind == "amr":
        say(False, "to_vtk: patches that refine each other become one unstructured mesh")
        data = data.unstructured()
    made = {"uniform": _image, "rectilinear": _rectilinear, "curvilinear": _structured, "unstructured": _unstructured,
            "surface": _poly_data, "points": _points}[data.kind](data)
    places = {"points": made.GetPointData(), "cells": made.GetCellData(), "whole": made.GetFieldData()}
    for name, on, values, unit in fields_of(data):
        places[on].AddArray(array_of(values, name, unit))
    if data.time is not None:
        made.GetInformation().Set(made.DATA_TIME_STEP(), data.time)
    return made


def to_pyvista(data: Data) -> Any:
    """The same for PyVista: ImageData, RectilinearGrid, StructuredGrid, UnstructuredGrid, PolyData, Table or MultiBlock, over the arrays of
    to_vtk: PyVista may read them and must not write into them (``mesh.copy()`` is PyVista's own)."""
    pyvista = needed("pyvista", "to_pyvista")
    return pyvista.wrap(to_vtk(data))


def _model() -> Any:
    return needed("vtkmodules.vtkCommonDataModel", "to_vtk")


def _positions(data: Data) -> Any:
    xyz = needed("vtkmodules.vtkCommonCore", "to_vtk").vtkPoints()
    xyz.SetData(array_of(data.points, "Points"))
    return xyz


def _image(data: Data) -> Any:
    made = _model().vtkImageData()
    made.SetDimensions(*data.dims)
    made.SetSpacing(data.spacing)
    made.SetOrigin(data.origin)
    made.SetDirectionMatrix(*data.direction.ravel().tolist())
    return made


def _rectilinear(data: Data) -> Any:
    made = _model().vtkRectilinearGrid()
    made.SetDimensions(*data.dims)
    for letter, at in zip("XYZ", data.axes):
        getattr(made, f"Set{letter}Coordinates")(array_of(at))
    return made


def _structured(data: Data) -> Any:
    made = _model().vtkStructuredGrid()
    made.SetDimensions(*data.dims)
    made.SetPoints(_positions(data))
    return made


def _unstructured(data: Data) -> Any:
    made = _model().vtkUnstructuredGrid()
    made.SetPoints(_positions(data))
    set_cells(made, data.cells, data.polyhedra)
    return made


def _poly_data(data: Data) -> Any:
    made = _model().vtkPolyData()
    made.SetPoints(_positions(data))
    ids, offsets, types = data.cells
    kind = np.select([types <= 2, types <= 4, types == 6], [0, 1, 3], 2)  # vertices, lines, polygons, strips come in this order
    for k, name in enumerate(("Verts", "Lines", "Polys", "Strips")):
        first, last = np.searchsorted(kind, [k, k + 1])
        if last > first:
            mine = offsets[first:last + 1]
            getattr(made, f"Set{name}")(cell_array(ids[mine[0]:mine[-1]], mine - mine[0] if mine[0] else mine))
    return made


def _points(data: Data) -> Any:
    """With a vertex at each: without cells VTK's filters and renderers see nothing."""
    made = _model().vtkPolyData()
    made.SetPoints(_positions(data))
    made.SetVerts(cell_array(np.arange(data.n_points), np.arange(data.n_points + 1)))
    return made


def _table(data: Data) -> Any:
    made = _model().vtkTable()
    for name in data.keys():
        column = data[name]
        if column.dtype.kind != "U":
            made.AddColumn(array_of(column, name, data.unit(name)))
            continue
        array = needed("vtkmodules.vtkCommonCore", "to_vtk").vtkStringArray()
        array.SetName(name)
        for word in column.tolist():
            array.InsertNextValue(word)
        made.AddColumn(array)
    return made


def _tree(data: Data) -> Any:
    made = _model().vtkMultiBlockDataSet()
    for i, (name, part) in enumerate(data.parts.items()):
        made.SetBlock(i, to_vtk(part))
        made.GetMetaData(i).Set(made.NAME(), name)
    return made

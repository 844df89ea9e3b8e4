# SPDX-License-Identifier: Apache-2.0
"""Cells of VTK as lists of point numbers and back; polyhedra in both of VTK's layouts."""
from __future__ import annotations

from typing import Any

import numpy as np

from .._errors import say, usage
from .shared import begins_of, needed, spread
from .vtk_arrays import array_of, hold, numbers

_lagrange_quads, _lagrange_solids = (70, 77), (72, 73, 79, 80)  # Lagrange and Bezier: quads; hexahedra and wedges

Triple = tuple[np.ndarray, np.ndarray, np.ndarray]


def lists(cells: Any) -> tuple[np.ndarray, np.ndarray]:
    """Point numbers and where each list begins, of a vtkCellArray."""
    return numbers(cells.GetConnectivityArray(), "wrap: point numbers"), numbers(cells.GetOffsetsArray(), "wrap: offsets")


def cell_array(ids: np.ndarray, offsets: np.ndarray) -> Any:
    """A vtkCellArray over both. It makes arrays of its own over their memory, which have to hold it as well."""
    cells = needed("vtkmodules.vtkCommonDataModel", "to_vtk").vtkCellArray()
    ids = np.ascontiguousarray(ids)
    offsets = np.ascontiguousarray(offsets, ids.dtype)  # VTK has one width for both
    cells.SetData(array_of(offsets), array_of(ids))
    hold(cells.GetOffsetsArray(), offsets)
    hold(cells.GetConnectivityArray(), ids)
    return cells


def polyhedra(grid: Any) -> Triple | None:
    """The faces of its polyhedra, as Data.polyhedra gives them; None without any."""
    if hasattr(grid, "GetPolyhedronFaces"):  # from VTK 9.4 on: lists of points, and for each cell a list of faces
        if not grid.GetPolyhedronFaces() or not grid.GetPolyhedronFaces().GetNumberOfCells():
            return None
        ids, begins = (a.astype(np.int64) for a in lists(grid.GetPolyhedronFaces()))
        of_cells, cell_begins = lists(grid.GetPolyhedronFaceLocations())
        places = begins[of_cells]
        sizes = begins[of_cells + 1] - places
        return ids[spread(places, sizes)], begins_of(sizes), cell_begins.astype(np.int64)
    if not grid.GetFaces() or not grid.GetFaces().GetNumberOfTuples():
        return None
    return _of_stream(numbers(grid.GetFaces(), "wrap: faces"), numbers(grid.GetFaceLocations(), "wrap: face locations"))


def _of_stream(stream: np.ndarray, locations: np.ndarray) -> Triple:
    """VTK's older layout: for each polyhedron how many faces it has, and for each face how many points and which. The k-th faces of all
    cells are found together, so that no loop over the cells is needed."""
    has = np.flatnonzero(locations >= 0)
    counts = np.zeros(len(locations), np.int64)
    counts[has] = stream[locations[has]]
    begins = begins_of(counts)
    places, sizes = np.zeros(begins[-1], np.int64), np.zeros(begins[-1], np.int64)
    at = locations + 1
    for k in range(int(counts.max(initial=0))):
        cells = np.flatnonzero(counts > k)
        sizes[begins[cells] + k] = stream[at[cells]]
        places[begins[cells] + k] = at[cells] + 1
        at[cells] += stream[at[cells]] + 1
    return stream[spread(places, sizes)], begins_of(sizes), begins


def _stream(faces: Triple) -> tuple[np.ndarray, np.ndarray]:
    """The inverse: the stream, and where each cell begins in it (-1: no polyhedron)."""
    ids, begins, of_cells = (np.asarray(a, np.int64) for a in faces)
    sizes, counts = np.diff(begins), np.diff(of_cells)
    has = counts > 0
    face_places = np.arange(len(sizes)) + begins[:-1] + np.repeat(np.cumsum(has), counts)  # after the counts that come before
    stream = np.empty(len(ids) + len(sizes) + int(has.sum()), np.int64)
    stream[face_places] = sizes
    stream[spread(face_places + 1, sizes)] = ids
    locations = np.full(len(counts), -1, np.int64)
    locations[has] = face_places[of_cells[:-1][has]] - 1
    stream[locations[has]] = counts[has]
    return stream, locations


def set_cells(grid: Any, cells: Triple, faces: Triple) -> None:
    """Gives a vtkUnstructuredGrid its cells."""
    constants = needed("vtkmodules.util.vtkConstants", "to_vtk")
    ids, offsets, types = cells
    kinds = array_of(types, kind=constants.VTK_UNSIGNED_CHAR)
    if not len(faces[2]):
        grid.SetCells(kinds, cell_array(ids, offsets))
    elif hasattr(grid, "SetPolyhedralCells"):
        of_cells = faces[2].astype(np.int64)
        grid.SetPolyhedralCells(kinds, cell_array(ids, offsets), cell_array(np.arange(of_cells[-1]), of_cells),
                                cell_array(faces[0].astype(np.int64), faces[1].astype(np.int64)))
    else:
        stream, locations = _stream(faces)
        grid.SetCells(kinds, cell_array(ids, offsets), array_of(locations, kind=constants.VTK_ID_TYPE),
                      array_of(stream, kind=constants.VTK_ID_TYPE))


def check_shapes(grid: Any) -> None:
    """Cells that are more than their points say: other orders along their axes, rational weights."""
    degrees = grid.GetCellData().GetHigherOrderDegrees()
    if degrees and degrees.GetNumberOfTuples():
        orders = numbers(degrees, "wrap: orders of cells")
        types = np.array([grid.GetCellType(c) for c in range(len(orders))])
        flat, solid = np.isin(types, _lagrange_quads), np.isin(types, _lagrange_solids)
        uneven = np.flatnonzero(((flat | solid) & (orders[:, 0] != orders[:, 1])) | (solid & (orders[:, 0] != orders[:, 2])))
        if len(uneven):
            raise usage(f"cell {uneven[0]} has the orders {orders[uneven[0]].astype(int).tolist()}", "wrap: HigherOrderDegrees",
                        "the same order along all axes; write it as .vtu and read that, files may have others")
    weights = grid.GetPointData().GetRationalWeights()
    if weights and weights.GetNumberOfTuples() and np.any(numbers(weights, "wrap: weights") != 1):
        say(True, "wrap: rational weights of Bezier cells count as 1; write it as .vtu and read that to have them")

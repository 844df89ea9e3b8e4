# SPDX-License-Identifier: Apache-2.0
"""Cells of VTK, in unstructured grids and in poly data, and back."""
import numpy as np
import pytest
import sightglass as sg

pytest.importorskip("vtkmodules")
from test_wrap_vtk import CUBE, array, fields_everywhere, same  # noqa: E402
from sightglass._wrap.vtk_cells import lists  # noqa: E402
from vtkmodules import vtkCommonCore as core  # noqa: E402
from vtkmodules import vtkCommonDataModel as model  # noqa: E402

CUBE_FACES = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]


def total(data, name):
    table = data.integrate()
    return table["integral"][list(table["field"]).index(name)]


def test_cells_of_all_types_are_those_of_vtk():
    ids, sizes, types = [], [], [*range(1, 17), *range(21, 36)]
    for t in types:
        n = model.vtkGenericCell.InstantiateCell(t).GetNumberOfPoints() or 5
        ids += range(n)
        sizes.append(n)
    ds = sg.unstructured(np.random.default_rng(0).random((30, 3)), (np.array(ids), np.cumsum([0, *sizes]), types))
    grid = ds.to_vtk()
    assert [grid.GetCellType(i) for i in range(len(types))] == types
    assert [grid.GetCell(i).GetNumberOfPoints() for i in range(len(types))] == sizes
    assert all(np.array_equal(a, b) for a, b in zip(sg.wrap(grid).cells, ds.cells))


def test_curved_cells_have_vtks_nodes():
    ds = sg.unstructured(lagrange_nodes(3) * (1, 2, 3), {"lagrange_hexahedron": np.arange(64)[None]}).with_field("one", [1.0], on="cells")
    assert np.isclose(total(ds, "one"), 6)
    back = sg.wrap(ds.to_vtk())
    assert list(back.cells[2]) == [72] and np.isclose(total(back, "one"), 6)


def lagrange_nodes(n):
    """Where vtkLagrangeHexahedron has its nodes, asked of VTK."""
    places = np.zeros(((n + 1) ** 3, 3))
    for k in range(n + 1):
        for j in range(n + 1):
            for i in range(n + 1):
                places[model.vtkHigherOrderHexahedron.PointIndexFromIJK(i, j, k, [n, n, n])] = np.array((i, j, k)) / n
    return places


def test_orders_that_differ_along_the_axes_are_refused():
    grid = sg.unstructured(np.random.default_rng(0).random((12, 3)), {"lagrange_hexahedron": np.arange(12)[None]}).to_vtk()
    grid.GetCellData().SetHigherOrderDegrees(array([[2.0, 1, 1]], "HigherOrderDegrees"))
    with pytest.raises(sg.UsageError, match=r"cell 0 has the orders \[2, 1, 1\]"):
        sg.wrap(grid)


def polyhedral():
    faces = [[[5, 4, 1, 0], [0, 1, 2], [5, 4, 3], [0, 2, 3, 5], [1, 4, 3, 2]], CUBE_FACES]  # a wedge and a cube
    ds = sg.unstructured(CUBE, {"hexahedron": [[0, 1, 3, 2, 4, 5, 7, 6]], "polyhedron": faces, "tetra": [[0, 1, 2, 4]]})
    return ds.with_field("cube", [0.0, 0.0, 1.0, 0.0], on="cells")


def test_polyhedra_keep_their_faces():
    ds = polyhedral()
    grid = ds.to_vtk()
    assert [grid.GetCellType(i) for i in range(4)] == [12, 42, 42, 10]
    assert grid.GetCell(2).GetNumberOfFaces() == 6
    assert [grid.GetCell(1).GetFace(0).GetPointId(k) for k in range(4)] == [5, 4, 1, 0]
    back = sg.wrap(grid)
    for a, b in zip([*back.cells, *back.polyhedra], [*ds.cells, *ds.polyhedra]):
        assert np.array_equal(a, b)
    assert np.isclose(total(back, "cube"), 8)


def test_polyhedra_made_by_vtk():
    grid = model.vtkUnstructuredGrid()
    points = core.vtkPoints()
    for p in CUBE:
        points.InsertNextPoint(p)
    grid.SetPoints(points)
    stream = core.vtkIdList()
    for n in [6, *(n for face in CUBE_FACES for n in (len(face), *face))]:
        stream.InsertNextId(n)
    grid.InsertNextCell(10, 4, (0, 1, 2, 4))
    grid.InsertNextCell(42, stream)
    ds = sg.wrap(grid)
    ids, begins, of_cells = ds.polyhedra
    assert [list(ids[a:b]) for a, b in zip(begins, begins[1:])] == CUBE_FACES and list(of_cells) == [0, 0, 6]
    assert np.isclose(total(ds.with_field("w", [0.0, 1.0], on="cells"), "w"), 8)


def test_polyhedra_as_newer_vtk_holds_them():
    """From 9.4 on, faces are a vtkCellArray, and so are the faces of each cell. Stood in for: it may be an older one that is installed."""
    from sightglass._wrap.vtk_cells import polyhedra, set_cells

    class Grid:
        def SetPolyhedralCells(self, types, cells, face_locations, faces):
            self.face_locations, self.faces = face_locations, faces

        def GetPolyhedronFaces(self):
            return self.faces

        def GetPolyhedronFaceLocations(self):
            return self.face_locations

    ds, grid = polyhedral(), Grid()
    set_cells(grid, ds.cells, ds.polyhedra)
    assert grid.faces.GetNumberOfCells() == 11 and [grid.face_locations.GetCellSize(i) for i in range(4)] == [0, 5, 6, 0]
    assert all(np.array_equal(a, b) for a, b in zip(polyhedra(grid), ds.polyhedra))


def poly_data(verts=(), lines=(), polys=(), strips=()):
    made = model.vtkPolyData()
    points = core.vtkPoints()
    for p in CUBE:
        points.InsertNextPoint(p)
    made.SetPoints(points)
    for name, lists in (("Verts", verts), ("Lines", lines), ("Polys", polys), ("Strips", strips)):
        cells = model.vtkCellArray()
        for one in lists:
            cells.InsertNextCell(len(one), one)
        if lists:
            getattr(made, f"Set{name}")(cells)
    return made


def test_poly_data_of_one_kind_keep_it():
    ds = sg.wrap(poly_data(polys=[(0, 1, 3), (0, 1, 3, 2)]))
    assert ds.kind == "surface" and list(ds.cells[2]) == [5, 9]
    ds = sg.wrap(poly_data(lines=[(0, 1), (1, 3, 2)]))
    assert ds.kind == "surface" and list(ds.cells[2]) == [3, 4] and list(ds.cells[0]) == [0, 1, 1, 3, 2]
    assert sg.wrap(poly_data(verts=[(i,) for i in range(8)])).kind == "points"
    assert sg.wrap(poly_data()).kind == "points" and sg.wrap(model.vtkPolyData()).n_points == 0


def mixed_poly_data():
    mixed = poly_data([(7,), (5, 6)], [(0, 1), (1, 3, 2)], [(0, 1, 3), (0, 1, 3, 2), (0, 1, 3, 2, 6)], [(4, 5, 6, 7)])
    mixed.GetCellData().AddArray(array(np.arange(8.0), "c"))
    return mixed


def test_poly_data_of_several_kinds_are_a_surface_in_vtks_order():
    mixed = mixed_poly_data()
    ds = sg.wrap(mixed)
    assert ds.kind == "surface" and list(ds.cells[2]) == [mixed.GetCellType(i) for i in range(8)] == [1, 2, 3, 4, 5, 9, 7, 6]
    assert list(ds["c"]) == list(range(8)) and list(ds.cells[0][-4:]) == [4, 5, 6, 7]


@pytest.mark.parametrize("without", ["", "Verts", "Lines", "Polys", "Strips"])
def test_poly_data_of_several_kinds_come_back_as_they_went(without):
    mixed = mixed_poly_data()
    if without:
        getattr(mixed, f"Set{without}")(model.vtkCellArray())
        mixed.GetCellData().GetArray("c").SetNumberOfTuples(mixed.GetNumberOfCells())
    back = sg.wrap(mixed).to_vtk()
    assert back.GetClassName() == "vtkPolyData" and back.GetNumberOfCells() == mixed.GetNumberOfCells()
    for name in ("GetVerts", "GetLines", "GetPolys", "GetStrips"):
        for ours, theirs in zip(lists(getattr(back, name)()), lists(getattr(mixed, name)())):
            assert np.array_equal(ours, theirs)
    same(sg.wrap(back), sg.wrap(mixed))
    assert sg.wrap(mixed).plot(size=(64, 48)).array.std() > 0


def test_vertices_with_values_of_their_own_keep_them():
    dots = poly_data(verts=[(i,) for i in range(8)])
    dots.GetCellData().AddArray(array(np.arange(8.0), "c"))
    ds = sg.wrap(dots)
    assert ds.kind == "surface" and ds.on("c") == "cells"
    assert ds.to_vtk().GetClassName() == "vtkPolyData" and ds.to_vtk().GetNumberOfVerts() == 8


@pytest.mark.parametrize("made", [
    lambda: sg.surface(CUBE, [[0, 1, 3], [0, 3, 2]]), lambda: sg.surface(CUBE, [0, 1, 3, 0, 1, 3, 2], [0, 3, 7]),
    lambda: sg.lines(CUBE, [[0, 1], [1, 3, 2]]), lambda: sg.gyroid(size=8).contour(values=[0.1]),
])
def test_surfaces_and_lines_survive(made):
    ds = fields_everywhere(made())
    there = ds.to_vtk()
    assert there.GetClassName() == "vtkPolyData" and there.GetNumberOfCells() == ds.n_cells
    back = sg.wrap(there)
    same(back, ds)
    assert all(np.array_equal(a, b) for a, b in zip(back.cells, ds.cells))


def test_points_have_a_vertex_each_in_vtk():
    ds = sg.points(CUBE).with_field("T", np.arange(8.0))
    there = ds.to_vtk()
    assert there.GetNumberOfVerts() == 8
    same(sg.wrap(there), ds)


def test_strips_of_sightglass_are_strips_of_vtk():
    there = sg.wrap(poly_data(strips=[(4, 5, 6, 7), (0, 1, 2)])).to_vtk()
    assert there.GetCellType(0) == 6 and there.GetCell(0).GetNumberOfPoints() == 4


def test_cells_outside_the_points_are_refused():
    with pytest.raises(sg.Error, match="99"):
        sg.wrap(poly_data(polys=[(0, 1, 99)]))

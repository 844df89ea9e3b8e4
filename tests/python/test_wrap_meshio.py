# SPDX-License-Identifier: Apache-2.0
"""Meshes of meshio as data, and back: cells of all types in the right order, fields, sets, units."""
import gc
import sys

import numpy as np
import pytest
import sightglass as sg

meshio = pytest.importorskip("meshio")

FIVE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], float)
CUBE = np.array([[x, y, z] for z in (0, 2) for y in (0, 2) for x in (0, 2)], float)
CUBE_FACES = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]


def address(a):
    return a.__array_interface__["data"][0]


def total(data, name):
    table = data.integrate()
    return table["integral"][list(table["field"]).index(name)]


def volume_of(data):
    return total(data.with_field("one", np.ones(data.n_cells), on="cells"), "one")


def test_blocks_fields_and_sets():
    blocks = [("tetra", [[0, 1, 2, 3], [1, 2, 3, 4]]), ("triangle", [[0, 1, 2]]), ("vertex", [[4]]), ("tetra", [[0, 1, 2, 4]])]
    mesh = meshio.Mesh(FIVE, blocks, point_data={"p": np.arange(5.0), "A": np.arange(45.0).reshape(5, 3, 3)},
                       cell_data={"c": [[1.0, 2.0], [3.0], [4.0], [5.0]]}, field_data={"inlet": np.array([3, 2])},
                       point_sets={"fixed": [0, 4]}, cell_sets={"wall": [None, [0], [], [0]]})
    ds = sg.wrap(mesh)
    assert ds.kind == "unstructured" and list(ds.cells[2]) == [10, 10, 5, 1, 10] and list(ds.cells[0][8:12]) == [0, 1, 2, 4]
    assert list(ds["c"]) == [1, 2, 3, 4, 5] and ds.on("c") == "cells" and list(ds["p"]) == [0, 1, 2, 3, 4] and ds["A"].shape == (5, 9)
    assert list(ds["wall"]) == [0, 0, 1, 0, 1] and ds.on("wall") == "cells"
    assert list(ds["fixed"]) == [1, 0, 0, 0, 1] and ds.on("fixed") == "points"
    assert list(ds["inlet"]) == [3, 2] and ds.on("inlet") == "whole"
    assert sg.wrap(mesh, units={"p": "Pa"}).unit("p") == "Pa"


def test_one_block_is_shared():
    points, cells, p = np.random.default_rng(0).random((9, 3)), np.array([[0, 1, 2, 3], [4, 5, 6, 7]]), np.arange(9.0)
    c = np.arange(2.0)
    ds = sg.wrap(meshio.Mesh(points, [("tetra", cells)], point_data={"p": p}, cell_data={"c": [c]}))
    assert address(ds.points) == address(points) and address(ds.cells[0]) == address(cells) and address(ds["p"]) == address(p)
    assert address(ds["c"]) == address(c)
    with pytest.raises(ValueError, match="read-only"):
        points[0] = 1
    back = ds.to_meshio()
    assert address(back.points) == address(points) and address(back.cells[0].data) == address(cells)
    assert address(back.point_data["p"]) == address(p)


def test_points_in_a_plane_and_without_cells():
    ds = sg.wrap(meshio.Mesh(FIVE[:, :2], [("line", [[0, 1]])]))
    assert np.array_equal(ds.points[:, 2], np.zeros(5)) and ds.n_cells == 1
    bare = meshio.Mesh(FIVE, [], point_data={"p": np.arange(5.0)})
    bare.cell_data = {"c": []}
    assert sg.wrap(bare).kind == "points" and sg.wrap(bare).keys() == ["p"]


@pytest.mark.parametrize("name, corners, volume", [
    ("tetra", [0, 1, 2, 4], 8 / 6), ("hexahedron", [0, 1, 3, 2, 4, 5, 7, 6], 8), ("wedge", [0, 1, 2, 4, 5, 6], 4),
    ("pyramid", [0, 1, 3, 2, 4], 8 / 3),
])
def test_solids_have_their_volume(name, corners, volume):
    ds = sg.wrap(meshio.Mesh(CUBE, [(name, [corners])]))
    assert volume_of(ds) == pytest.approx(volume)
    back = ds.to_meshio()
    assert back.cells[0].type == name and list(back.cells[0].data[0]) == corners


def test_a_linear_wedge_is_turned_as_meshio_turns_it_for_vtk(tmp_path):
    mesh = meshio.Mesh(CUBE, [("wedge", [[0, 1, 2, 4, 5, 6]])])
    mesh.write(tmp_path / "w.vtu", binary=False)
    assert list(sg.wrap(mesh).cells[0]) == list(sg.read(tmp_path / "w.vtu").cells[0]) == [0, 2, 1, 4, 6, 5]


def vtk_types():
    from meshio._common import num_nodes_per_cell
    from meshio._mesh import topological_dimension
    from meshio._vtk_common import meshio_to_vtk_type
    return [(n, num_nodes_per_cell[n], t) for n, t in meshio_to_vtk_type.items() if n in num_nodes_per_cell and n in topological_dimension]


@pytest.mark.parametrize("name, nodes, number", vtk_types())
def test_types_of_vtk_have_the_nodes_of_the_file(name, nodes, number, tmp_path):
    mesh = meshio.Mesh(np.random.default_rng(1).random((nodes, 3)), [(name, np.arange(nodes)[::-1][None])])
    ds = sg.wrap(mesh)
    assert list(ds.cells[2]) == [number]
    mesh.write(tmp_path / "a.vtu", binary=False)
    assert np.array_equal(ds.cells[0], sg.read(tmp_path / "a.vtu").cells[0])
    back = ds.to_meshio()
    assert back.cells[0].type == name and np.array_equal(back.cells[0].data, mesh.cells[0].data)


@pytest.mark.parametrize("name", ["line5", "line7", "triangle10", "triangle21", "triangle66", "quad16", "quad25", "quad121", "tetra20",
                                  "tetra35", "tetra286", "hexahedron64", "hexahedron125", "hexahedron216", "wedge40", "wedge75",
                                  "wedge126"])
def test_higher_orders_have_the_nodes_of_the_file(name, tmp_path, capsys):
    nodes = meshio._common.num_nodes_per_cell[name]
    points = np.random.default_rng(2).random((nodes, 3))
    meshio.Mesh(points, [(name, np.arange(nodes)[None])]).write(tmp_path / "a.msh", file_format="gmsh22")
    capsys.readouterr()
    here, there = sg.wrap(meshio.read(tmp_path / "a.msh")), sg.read(tmp_path / "a.msh")
    assert list(here.cells[2]) == list(there.cells[2]) and 68 <= here.cells[2][0] <= 73
    assert np.allclose(here.points[here.cells[0]], there.points[there.cells[0]])


def test_a_pyramid_of_14_nodes_has_13():
    ds = sg.wrap(meshio.Mesh(np.random.default_rng(0).random((14, 3)), [("pyramid14", np.arange(14)[None])]))
    assert list(ds.cells[2]) == [27] and list(ds.cells[0]) == [0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12]


def test_polygons_and_polyhedra():
    mesh = meshio.Mesh(CUBE, [("polygon", np.array([[0, 1, 3], [0, 1, 5]])), ("polygon", np.array([[0, 1, 3, 2]])),
                              ("polyhedron8", [CUBE_FACES]), ("hexahedron", [[0, 1, 3, 2, 4, 5, 7, 6]])])
    ds = sg.wrap(mesh)
    assert list(ds.cells[2]) == [7, 7, 7, 42, 12]
    ids, begins, of_cells = ds.polyhedra
    assert [list(ids[a:b]) for a, b in zip(begins, begins[1:])] == CUBE_FACES and list(of_cells) == [0, 0, 0, 0, 6, 6]
    assert volume_of(sg.wrap(meshio.Mesh(CUBE, [("polyhedron8", [CUBE_FACES])]))) == pytest.approx(8)
    back = ds.to_meshio()
    assert [b.type for b in back.cells] == ["polygon", "polygon", "polyhedron8", "hexahedron"]
    assert [list(f) for f in back.cells[2].data[0]] == CUBE_FACES and back.cells[0].data.tolist() == [[0, 1, 3], [0, 1, 5]]
    again = sg.wrap(back)
    assert all(np.array_equal(a, b) for a, b in zip([*again.cells, *again.polyhedra], [*ds.cells, *ds.polyhedra]))


def test_meshes_survive_the_way_there_and_back():
    ds = sg.unstructured(FIVE, (np.array([0, 1, 2, 3, 0, 1, 2, 1, 2, 3, 4]), np.array([0, 4, 7, 11]), np.array([10, 5, 10])))
    ds = (ds.with_field("T", np.arange(5.0), unit="K").with_field("v", np.arange(9.0).reshape(3, 3), unit="m/s", on="cells")
          .with_field("t", [0.5], unit="s", on="whole"))
    mesh = ds.to_meshio()
    assert [b.type for b in mesh.cells] == ["tetra", "triangle", "tetra"] and mesh.info["units"] == {"T": "K", "v": "m/s", "t": "s"}
    back = sg.wrap(mesh)
    assert np.array_equal(back.points, ds.points) and all(np.array_equal(a, b) for a, b in zip(back.cells, ds.cells))
    for name in ds:
        assert np.array_equal(back[name], ds[name]) and back.unit(name) == ds.unit(name) and back.on(name) == ds.on(name)


def test_what_meshio_does_not_have_becomes_what_it_has(volume, caplog):
    grid = sg.uniform(volume, spacing=(1, 2, 3)).with_field("c", np.arange(60.0), on="cells").to_meshio()
    assert [b.type for b in grid.cells] == ["hexahedron"] and len(grid.cell_data["c"][0]) == 60
    assert volume_of(sg.wrap(grid)) == pytest.approx(60 * 6)
    flat = sg.uniform(dims=(3, 4, 1), spacing=(1, 2, 1)).to_meshio()
    assert [b.type for b in flat.cells] == ["quad"] and volume_of(sg.wrap(flat)) == pytest.approx(12)
    ids = np.array([0, 1, 2, 3, 0, 1, 2, 3, 4, 0, 1, 2, 3, 4])
    mixed = sg.unstructured(FIVE, (ids, np.array([0, 4, 9, 12, 14]), np.array([10, 6, 4, 2])))
    with caplog.at_level("INFO", "sightglass"):
        mesh = mixed.with_field("c", [1.0, 2, 3, 4], on="cells").to_meshio()
    assert "4 cells become 8" in caplog.text
    assert [(b.type, b.data.tolist()) for b in mesh.cells] == [("tetra", [[0, 1, 2, 3]]), ("triangle", [[0, 1, 2], [2, 1, 3], [2, 3, 4]]),
                                                               ("line", [[0, 1], [1, 2]]), ("vertex", [[3], [4]])]
    assert [list(c) for c in mesh.cell_data["c"]] == [[1], [2, 2, 2], [3, 3], [4, 4]]
    assert sg.gyroid(size=8).contour(values=[0.1]).to_meshio().cells[0].type == "triangle"
    assert sg.points(FIVE).to_meshio().cells[0].type == "vertex"


@pytest.mark.parametrize("mesh, text", [
    (lambda: meshio.Mesh(FIVE, [("tetra", [[0, 1, 2, 9]])]), "9"),
    (lambda: meshio.Mesh(FIVE, [("triangle", [[0, 1, 2]])], cell_sets={"s": [[7]]}), "cell set 's': it names 7 to 7; numbers from 0 to 0"),
    (lambda: meshio.Mesh(FIVE, [("triangle", [[0, 1, 2]])], point_sets={"s": [-1]}), "point set 's'"),
    (lambda: odd("starship4"), "'starship4' are not known"),
    (lambda: odd("hexahedron63", 63), "'hexahedron63' are not known"),
    (lambda: odd(data=[[1.0]]), "'c': it has values for"),
    (lambda: meshio.CellBlock("tetra", [[0, 1, 2, 3]]), "meshio.CellBlock is not known"),
])
def test_what_cannot_be_meant_is_refused(mesh, text):
    with pytest.raises(sg.Error, match=text):
        sg.wrap(mesh())


def odd(name="triangle", nodes=4, data=None):
    mesh = meshio.Mesh(np.zeros((64, 3)), [("triangle", [[0, 1, 2]])])
    if data is not None:
        mesh.cell_data["c"] = [[1.0, 2.0]]
        return mesh
    mesh.cells[0].type, mesh.cells[0].data = name, np.arange(nodes)[None]
    return mesh


def test_hints_and_kinds_are_checked():
    with pytest.raises(sg.UsageError, match="'time' is no hint for a meshio.Mesh; one of units"):
        sg.wrap(meshio.Mesh(FIVE, []), time=1)
    with pytest.raises(sg.UsageError, match="to_pandas"):
        sg.table({"a": [1.0]}).to_meshio()
    with pytest.raises(sg.UsageError, match="cell 0 is of VTK's type 36"):
        sg.unstructured(FIVE, {36: [[0, 1, 2, 3]]}).to_meshio()


def test_references_are_given_back():
    p = np.arange(5.0)
    mesh = meshio.Mesh(FIVE.copy(), [("tetra", [[0, 1, 2, 3]])], point_data={"p": p})
    sg.wrap(mesh).to_meshio()
    gc.collect()
    before = sys.getrefcount(p), sys.getrefcount(mesh), sys.getrefcount(mesh.points)
    for _ in range(50):
        sg.wrap(sg.wrap(mesh).to_meshio())["p"]
    gc.collect()
    assert (sys.getrefcount(p), sys.getrefcount(mesh), sys.getrefcount(mesh.points)) == before
    mesh.points[0] = 7
    p[0] = 7

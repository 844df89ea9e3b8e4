# SPDX-License-Identifier: Apache-2.0
"""Turned grids, patches, polyhedra, tables, collections and series."""
import gc
import sys

import numpy as np
import pytest
import sightglass as sg


def total(data, name):
    table = data.integrate()
    return table["integral"][list(table["field"]).index(name)]


def test_a_grid_lies_along_its_directions(volume):
    c, s = np.cos(0.3), np.sin(0.3)
    direction = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    ds = sg.uniform(volume, spacing=(1, 2, 4), origin=(10, 20, 30), direction=direction, name="T")
    assert np.allclose(ds.direction, direction) and ds.spacing == (1, 2, 4) and ds.origin == (10, 20, 30)
    i, j, k = 1, 2, 3
    there = ds.points[i + 6 * (j + 5 * k)]
    assert np.allclose(there, np.array([10, 20, 30]) + direction @ (np.array([1, 2, 4]) * (i, j, k)))
    with pytest.raises(sg.UsageError, match="direction of shape"):
        sg.uniform(volume, direction=[1, 2, 3])
    with pytest.raises(sg.UsageError, match="in a plane"):
        sg.uniform(volume, direction=np.ones((3, 3)))


def test_axes_are_coordinates(volume):
    assert np.array_equal(sg.rectilinear([0, 1, 3, 4, 5, 9], [0, 1, 2, 3, 5], [0, 1, 2, 4], volume).axes[0], [0, 1, 3, 4, 5, 9])
    assert np.array_equal(sg.uniform(volume, spacing=(2, 1, 1), origin=(1, 0, 0)).axes[0], [1, 3, 5, 7, 9, 11])
    with pytest.raises(sg.UsageError, match="points"):
        sg.points(np.zeros((1, 3))).axes


def test_patches_cover_what_lies_under_them():
    coarse, fine = np.ones((4, 4, 4), np.float32), np.full((4, 4, 4), 3, np.float32)
    ds = sg.amr([(1.0, [((0, 0, 0), coarse)]), (0.5, [((2, 2, 2), fine)])], name="rho")
    assert ds.kind == "amr" and ds.n_cells == 128 and ds.on("rho") == "cells"
    assert np.isclose(total(ds, "rho"), 56 + 8 * 3)
    flat = sg.amr([((1.0, 2.0), [((0, 0), {"a": np.zeros((3, 2)), "b": np.arange(6).reshape(3, 2)})])])
    assert flat.n_cells == 6 and np.allclose(flat.bounds[1][:2], (2, 6)) and list(flat["b"]) == [0, 1, 2, 3, 4, 5]
    with pytest.raises(sg.UsageError, match="whole share"):
        sg.amr([(1.0, [((0, 0, 0), coarse)]), (0.4, [((2, 2, 2), fine)])])
    with pytest.raises(sg.UsageError, match="axes"):
        sg.amr([(1.0, [((0, 0, 0), coarse)]), (0.5, [((2, 2, 2), fine[0])])])


def test_polyhedra_and_polygons_of_any_size():
    cube = np.array([[x, y, z] for z in (0, 2) for y in (0, 2) for x in (0, 2)], float)
    faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    ds = sg.unstructured(cube, {"polyhedron": [faces], "polygon": [[0, 1, 3], [0, 1, 3, 2]]})
    assert ds.n_cells == 3 and list(ds.cells[2]) == [42, 7, 7]
    ids, begins, of_cells = ds.polyhedra
    assert [list(ids[a:b]) for a, b in zip(begins, begins[1:])] == faces and list(of_cells) == [0, 6, 6, 6]
    again = sg.unstructured(ds.points, ds.cells, faces=ds.polyhedra)
    assert np.array_equal(again.cells[0], ds.cells[0]) and np.array_equal(again.polyhedra[0], ids)
    only = sg.unstructured(cube, {"polyhedron": [faces]}).with_field("one", [1.0], on="cells")
    assert np.isclose(total(only, "one"), 8)
    with pytest.raises(sg.UsageError, match="without faces"):
        sg.unstructured(cube, {"polyhedron": [[]]})
    with pytest.raises(sg.UsageError, match="different numbers"):
        sg.unstructured(cube, {"tetra": [[0, 1, 2, 3], [0, 1, 2]]})


def test_tables_of_numbers_and_words(tmp_path):
    t = sg.table({"t": [0.0, 1.0, 2.0], "site": ["south", None, "north"], "v": np.eye(3)}, units={"t": "s"})
    assert t.kind == "table" and t.unit("t") == "s" and list(t["site"]) == ["south", "", "north"] and t["v"].shape == (3, 3)
    with pytest.raises(sg.UsageError, match="2 rows"):
        sg.table({"a": [1, 2, 3], "b": [1, 2]})
    with pytest.raises(sg.UsageError, match="object"):
        sg.table({"a": [object()]})


def test_collections_of_data(volume):
    ds = sg.collection({"a": sg.uniform(volume), "b": sg.collection([sg.points(np.zeros((2, 3)))])})
    assert ds.kind == "collection" and list(ds.parts) == ["a", "b/0"] and ds.n_points == 122


def ball(step):
    z, y, x = np.mgrid[-6:7, -6:7, -6:7].astype(np.float32)
    return sg.uniform(np.sqrt(x * x + y * y + z * z) - (1 + step), origin=(-6, -6, -6), name="f")


def test_series_load_when_they_are_asked():
    asked = []

    def load(step):
        asked.append(step)
        return ball(step)

    ds = sg.series([0, 0.5, 2], load)
    assert asked == [0] and ds.times == [0, 0.5, 2] and ds.time == 0
    surface = ds.contour(values=[0])
    assert asked == [0]
    assert np.isclose(surface.at(0.6).bounds[1][0], 2, atol=1e-3) and asked == [0, 1]
    assert ds.at(9).time == 2 and sg.uniform(np.zeros((2, 2, 2))).times == []


def test_films_of_series(tmp_path):
    scene = sg.scene().add(sg.series([0, 1, 2], ball).contour(values=[0]), "surface")
    assert scene.movie(tmp_path / "a_{n}.png", size=(64, 48)) == [0, 1, 2]
    first, last = ((tmp_path / f"a_00{i}.png").read_bytes() for i in (0, 2))
    assert first != last


def test_what_load_raises_comes_out():
    class Mine(Exception):
        pass

    def load(step):
        if step == 1:
            raise Mine("run 1 is lost")
        return ball(step) if step == 0 else volume_of_nothing

    volume_of_nothing = "nothing"
    ds = sg.series([0, 1, 2], load)
    with pytest.raises(Mine, match="run 1"):
        ds.at(1)
    with pytest.raises(Mine, match="run 1"):
        ds.contour(values=[0]).at(1)
    with pytest.raises(sg.UsageError, match="gave str"):
        ds.at(2)
    assert ds.at(0).n_points == 13**3
    with pytest.raises(sg.UsageError, match="times"):
        sg.series([], load)
    with pytest.raises(sg.UsageError, match="time series"):
        ball(0).at(1)


def test_series_let_their_functions_go():
    def load(step):
        return ball(step)

    before = sys.getrefcount(load)
    ds = sg.series([0, 1], load)
    surface = ds.contour(values=[0])
    surface.at(1)
    assert sys.getrefcount(load) > before
    del ds, surface
    gc.collect()
    assert sys.getrefcount(load) == before


def test_masked_values_are_nan(caplog):
    masked = np.ma.masked_greater(np.arange(27).reshape(3, 3, 3), 20)
    ds = sg.uniform(masked, name="v")
    assert np.isnan(ds["v"]).sum() == 6 and ds.range("v") == (0, 20)


def test_dlpack_is_taken_as_it_lies():
    class Tensor:
        def __init__(self, a):
            self.a = a

        def __dlpack__(self, **more):
            return self.a.__dlpack__(**more)

        def __dlpack_device__(self):
            return self.a.__dlpack_device__()

    a = np.arange(27.0).reshape(3, 3, 3)
    ds = sg.uniform(Tensor(a), name="v")
    assert ds["v"].__array_interface__["data"][0] == a.__array_interface__["data"][0]

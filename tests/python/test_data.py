# SPDX-License-Identifier: Apache-2.0
import gc
import weakref

import numpy as np
import pytest
import sightglass as sg


def test_a_grid_lies_where_it_is_said(volume):
    ds = sg.uniform(volume, spacing=(0.5, 1, 2), origin=(10, 0, 0), name="T", unit="K")
    assert np.allclose(ds.bounds, [[10, 0, 0], [12.5, 4, 6]])
    assert ds.unit("T") == "K" and ds.on("T") == "points" and ds.range("T") == (0, 22)
    assert "T" in ds and list(ds) == ["T"] and len(ds) == 1
    bare = sg.uniform(dims=(6, 5, 4))
    assert bare.n_points == 120 and bare.n_cells == 60 and bare.keys() == []


def test_vectors_have_a_last_axis():
    v = np.random.default_rng(1).random((4, 5, 6, 3))
    ds = sg.uniform(v, components=True, name="v")
    assert ds["v"].shape == (120, 3) and np.array_equal(ds["v"][7], v[0, 1, 1])


def test_rectilinear_and_curvilinear_grids(volume):
    ds = sg.rectilinear([0, 1, 3, 4, 5, 9], [0, 1, 2, 3, 5], [0, 1, 2, 4], volume)
    assert ds.kind == "rectilinear" and np.allclose(ds.bounds[1], [9, 5, 4])
    z, y, x = np.mgrid[0:4, 0:5, 0:6].astype(float)
    ds = sg.curvilinear(np.stack([x + 0.1 * y, y, z], -1), volume)
    assert ds.kind == "curvilinear" and np.allclose(ds.points[7], [1.1, 1, 0])


def test_meshes_have_the_volume_that_they_should(tetra):
    assert tetra.n_cells == 2
    ids, offsets, types = tetra.cells
    assert list(ids) == [0, 1, 2, 3, 1, 2, 3, 4] and list(offsets) == [0, 4, 8] and list(types) == [10, 10]
    cube = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    mesh = sg.unstructured(cube, {"hexahedron": [[0, 1, 3, 2, 4, 5, 7, 6]]})
    total = mesh.integrate()
    assert total.kind == "table"
    volumes = [total[c] for c in total.keys() if "volume" in c.lower() or "measure" in c.lower() or "size" in c.lower()]
    assert any(np.allclose(v, 1) for v in volumes)


def address(a):
    return a.__array_interface__["data"][0]


def test_points_are_those_that_were_given():
    z, y, x = np.mgrid[0:3, 0:4, 0:5].astype(float)
    xyz = np.stack([x + 0.1 * y, y, z], -1)
    flat = xyz.reshape(-1, 3)
    for ds in (sg.curvilinear(xyz), sg.points(flat), sg.surface(flat, [[0, 1, 2]]), sg.unstructured(flat, {"vertex": [[0]]})):
        assert address(ds.points) == address(xyz) and np.array_equal(ds.points, flat) and not ds.points.flags.writeable
    f32 = sg.curvilinear(xyz.astype(np.float32)).points
    assert f32.dtype == np.float64 and np.array_equal(f32, flat.astype(np.float32))


@pytest.mark.parametrize("ds", [sg.uniform(dims=(5, 4, 3)), sg.rectilinear([0, 1, 3], [0, 2]), sg.points(np.zeros((4, 3), np.float32)),
                                sg.amr([(1.0, [((0, 0), np.ones((4, 4)))])])], ids=lambda ds: ds.kind)
def test_computed_points_are_one_array_as_long_as_somebody_holds_it(ds):
    first = ds.points
    assert ds.points is first and not first.flags.writeable
    with pytest.raises(ValueError):
        first[0] = 1
    gone, copy = weakref.ref(first), first.copy()
    del first
    gc.collect()
    assert gone() is None and np.array_equal(ds.points, copy)


def test_surfaces_lines_and_points():
    xyz = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    assert sg.surface(xyz, [[0, 1, 2], [0, 2, 3]]).n_cells == 2
    assert sg.surface(xyz, [[0, 1, 2, 3]]).n_cells == 1
    assert sg.surface(xyz, [0, 1, 2, 0, 2, 3], [0, 3, 6]).n_cells == 2
    assert sg.lines(xyz).n_cells == 1 and sg.lines(xyz, [[0, 1], [2, 3]]).n_cells == 2
    assert sg.points(xyz[:, :2]).n_points == 4


@pytest.mark.parametrize("cells, text", [
    ({"tetra": [[0, 1, 2, 9]]}, "9"),
    ({"tetra": [[0, 1, 2, -1]]}, "-1"),
    ({"tetra": [0, 1, 2, 3]}, "1 dimensions"),
    ({"tetrahaedron": [[0, 1, 2, 3]]}, "not known"),
    ({"tetra": [[0.0, 1, 2, 3]]}, "whole"),
    ({}, "no cells"),
])
def test_bad_cells_are_refused(cells, text):
    with pytest.raises(sg.Error, match=text):
        sg.unstructured(np.eye(5, 3), cells)


def test_files_go_out_and_come_back(tmp_path, volume):
    ds = sg.uniform(volume, name="T", unit="K", spacing=(1, 2, 3))
    for name in ("a.vti", "a.nrrd", "a.mha"):
        ds.save(tmp_path / name)
        back = sg.read(tmp_path / name)
        assert back.dims == ds.dims and np.array_equal(back[back.keys()[0]], ds["T"])
    with pytest.raises(sg.Error, match="b.xyz"):
        ds.save(tmp_path / "b.xyz")
    assert not (tmp_path / "b.xyz").exists()
    with pytest.raises(sg.DataError, match="gone.vti"):
        sg.read(tmp_path / "gone.vti")


def test_collections_have_parts_and_tables_have_columns(volume):
    ds = sg.uniform(volume)
    both = ds.clip(axis="x", keep="both")
    assert both.kind == "collection" and list(both.parts) == ["inside", "outside"]
    assert sum(p.n_cells for p in both.parts.values()) == both.n_cells
    table = ds.statistics()
    assert table.kind == "table" and len(table[table.keys()[0]]) == 1


def test_whole_numbers_of_scans_are_seen_where_they_lie(tmp_path):
    values = np.arange(60, dtype=np.int16).reshape(3, 4, 5)
    sg.uniform(values, name="v").save(tmp_path / "a.nii")
    back = sg.read(tmp_path / "a.nii")
    assert back[back.keys()[0]].dtype == np.int16

# SPDX-License-Identifier: Apache-2.0
"""Grids of OpenVDB as data: places and values are those of the file as sg.read has it."""
import gc
import sys

import numpy as np
import pytest
import sightglass as sg

try:
    import openvdb as vdb
except ImportError:
    vdb = pytest.importorskip("pyopenvdb")

FIRST = (-2, 5, 7)


def grid(kind=None, values=None, name="density"):
    made = (kind or vdb.FloatGrid)()
    made.copyFromArray(np.arange(1, 61, dtype=np.float32).reshape(3, 4, 5) if values is None else values, ijk=FIRST)
    made.transform = vdb.createLinearTransform(voxelSize=0.5)
    made.name = name
    return made


def same(g, tmp_path):
    vdb.write(str(tmp_path / "a.vdb"), grids=[g])
    here, there = sg.wrap(g), sg.read(tmp_path / "a.vdb")
    assert here.kind == there.kind == "uniform" and here.dims == there.dims and np.allclose(here.points, there.points, atol=1e-12)
    assert here.keys() == there.keys()
    name = here.keys()[0]
    assert here[name].dtype == there[name].dtype and np.array_equal(here[name], there[name])
    return here


def test_voxels_are_points_at_their_place(tmp_path):
    ds = same(grid(), tmp_path)
    assert ds.dims == (3, 4, 5) and ds.spacing == (0.5, 0.5, 0.5) and ds.origin == (-1, 2.5, 3.5)
    assert ds["density"][1] == 21 and ds["density"][3] == 6 and ds["density"][12] == 2  # x is fastest


def test_transforms_that_turn(tmp_path):
    g = grid()
    g.transform.rotate(0.3, vdb.Axis.Z)
    g.transform.translate((1, 2, 3))
    ds = same(g, tmp_path)
    assert np.allclose(ds.points[1], g.transform.indexToWorld((FIRST[0] + 1, *FIRST[1:])))
    assert not np.allclose(ds.direction, np.eye(3))


def test_numbers_of_all_kinds(tmp_path):
    rng = np.random.default_rng(0)
    kinds = [("FloatGrid", rng.random((3, 4, 5)).astype(np.float32), np.float32), ("BoolGrid", rng.random((3, 4, 5)) > 0.5, np.uint8),
             ("Vec3SGrid", rng.random((3, 4, 5, 3)).astype(np.float32), np.float32), ("DoubleGrid", rng.random((3, 4, 5)), np.float64),
             ("Int32Grid", rng.integers(1, 9, (3, 4, 5)).astype(np.int32), np.int32)]
    for name, values, dtype in kinds:
        if hasattr(vdb, name):
            ds = same(grid(getattr(vdb, name), values), tmp_path)
            assert ds["density"].dtype == dtype


def test_tiles_background_and_what_is_not_active(tmp_path):
    g = vdb.FloatGrid(7.0)
    g.fill((0, 0, 0), (31, 15, 7), 2.0)
    g.fill((40, 0, 0), (40, 0, 0), 3.0)
    ds = same(g, tmp_path)
    assert ds.dims == (41, 16, 8) and ds["values"][0] == 2 and ds["values"][35] == 7 and ds["values"][40] == 3
    same(vdb.createLevelSetSphere(radius=3.0, voxelSize=0.5), tmp_path)


def test_a_box_is_chosen():
    ds = sg.wrap(grid(), box=((-2, 5, 7), (-1, 6, 7)))
    assert ds.dims == (2, 2, 1) and list(ds["density"]) == [1, 21, 6, 26] and ds.origin == (-1, 2.5, 3.5)
    around = sg.wrap(grid(), box=((-3, 5, 7), (-2, 5, 7)))
    assert list(around["density"]) == [0, 1] and around.origin == (-1.5, 2.5, 3.5)


def test_the_box_that_sightglass_wrote(tmp_path):
    values = np.zeros((4, 5, 6), np.float32)
    values[1, 2, 3] = 1
    sg.uniform(values, name="q", spacing=(0.5, 0.5, 0.5)).save(tmp_path / "a.vdb")
    ds = sg.wrap(vdb.read(str(tmp_path / "a.vdb"), "q"))
    assert ds.dims == (6, 5, 4) and np.array_equal(ds["q"], values.reshape(-1))


def frustum():
    g = vdb.FloatGrid()
    g.fill((0, 0, 0), (3, 3, 3), 1.0)
    g.transform = vdb.createFrustumTransform((0, 0, 0), (9, 9, 9), 0.5, 10.0)
    return g


def huge():
    g = vdb.FloatGrid()
    for end in (0, 1 << 20):
        g.fill((end,) * 3, (end,) * 3, 1.0)
    return g


@pytest.mark.parametrize("what, hints, text", [
    (lambda: vdb.FloatGrid(), {}, "no active voxel"), (frustum, {}, "not linear"), (huge, {}, "GiB when dense; a part of it: box="),
    (grid, {"box": ((0, 0, 0), (-1, 0, 0))}, "first and the last voxel"), (grid, {"box": 3}, "first and the last voxel"),
    (lambda: vdb.createLinearTransform(), {}, "Transform is not known"), (grid, {"time": 1}, "no hint for a .*FloatGrid; one of box"),
])
def test_what_cannot_be_meant_is_refused(what, hints, text):
    with pytest.raises(sg.UsageError, match=text):
        sg.wrap(what(), **hints)


def test_references_are_given_back():
    g = grid()
    sg.wrap(g)
    gc.collect()
    before = sys.getrefcount(g)
    for _ in range(30):
        sg.wrap(g)["density"]
    gc.collect()
    assert sys.getrefcount(g) == before

# SPDX-License-Identifier: Apache-2.0
"""Whatever is handed in wrongly is refused with what would be right, or mended and said; and given back either way."""
import gc
import sys

import numpy as np
import pytest
import sightglass as sg
from sightglass._operations import names

XYZ = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)


def misaligned(values):
    return np.frombuffer(b"\0" + np.ascontiguousarray(values).tobytes(), "u1")[1:].view(values.dtype).reshape(values.shape)


# Arrays as they come, and what they hold.
ODD = {
    "big-endian": lambda a: a.astype(">f8"), "misaligned": misaligned, "backwards": lambda a: a[::-1].copy()[::-1],
    "every axis backwards": lambda a: a[::-1, ::-1, ::-1].copy()[::-1, ::-1, ::-1], "one number everywhere": lambda a: np.broadcast_to(a[:, :1, :1], a.shape),
    "every second": lambda a: np.repeat(a, 2, axis=2)[:, :, ::2], "columns": lambda a: np.asfortranarray(a), "half": lambda a: a.astype(np.float16),
    "long": lambda a: a.astype(np.longdouble), "read-only": lambda a: np.frombuffer(a.tobytes()).reshape(a.shape),
}


@pytest.mark.parametrize("kind", ODD)
def test_odd_arrays_are_values_positions_and_numbers_of_points(kind):
    a = ODD[kind](np.arange(24.0).reshape(2, 3, 4))
    wanted = np.array(a, float)
    ds = sg.uniform(a, name="v")
    assert np.array_equal(ds["v"], wanted.ravel()) and ds.dims == (4, 3, 2)
    xyz = ODD[kind](np.ascontiguousarray(np.broadcast_to(XYZ[:, None], (4, 2, 3))))[:, 0]
    assert np.allclose(sg.points(xyz).points, np.array(xyz, float))
    for dtype in (">i8", "<i4", "u2", ">u4"):
        ids = np.arange(8, dtype=dtype)[::-2][::-1] // 2  # strides of both signs on the way
        assert sg.unstructured(XYZ, {"tetra": ids[None]}).n_cells == 1
    assert sg.unstructured(XYZ, {"tetra": misaligned(np.arange(4))[None]}).n_cells == 1


NOTHING_OF = {
    "objects": np.array([object()] * 4), "words": np.array(["a"] * 4), "bytes": np.array([b"a"] * 4), "complex": np.ones(4, complex),
    "times": np.array(["2020-01-01"] * 4, "M8[D]"), "records": np.zeros(4, [("a", "f4")]),
}


@pytest.mark.parametrize("kind", NOTHING_OF)
def test_arrays_that_are_no_numbers_are_refused_everywhere(kind):
    bad = NOTHING_OF[kind]
    ds = sg.points(XYZ)
    for use in (lambda: sg.uniform(bad.reshape(2, 2, 1)), lambda: ds.with_field("x", bad), lambda: sg.points(np.stack([bad] * 3, 1)),
                lambda: sg.rectilinear(bad, [0, 1]), lambda: sg.curvilinear(np.stack([bad] * 3, 1)), lambda: sg.amr([(1, [((0, 0), bad.reshape(2, 2))])]),
                lambda: sg.unstructured(XYZ, {"tetra": bad[None]}), lambda: sg.surface(XYZ, bad[None, :3])):
        with pytest.raises(sg.UsageError, match=r"its values are|whole numbers and floats") as refused:
            use()
        assert refused.value.right
    if kind not in ("words", "objects"):  # columns of words are known
        with pytest.raises(sg.UsageError):
            sg.table({"t": bad})


def test_numbers_of_points_are_whole_and_lead_to_points():
    for ids in ([[0, 1, 4]], [[0, 1, -1]], [[0, 1, 2**40]]):
        for use in (lambda: sg.surface(XYZ, ids), lambda: sg.lines(XYZ, ids), lambda: sg.unstructured(XYZ, {"triangle": ids}),
                    lambda: sg.surface(XYZ, ids[0], [0, 3])):
            with pytest.raises(sg.Error, match=str(ids[0][2])):
                use()
    with pytest.raises(sg.UsageError, match="point numbers are whole"):
        sg.unstructured(XYZ, {"triangle": [[0, 1, 2.5]]})
    for offsets in ([0, 4], [0, 2, 1, 3], [1, 3], [-1, 3], []):
        with pytest.raises(sg.Error):
            sg.surface(XYZ, [0, 1, 2], offsets).plot(size=(40, 30))
    with pytest.raises(sg.UsageError, match="cell type 'tetrahedra' is not known"):
        sg.unstructured(XYZ, {"tetrahedra": [[0, 1, 2, 3]]})
    with pytest.raises(sg.Error):
        sg.unstructured(XYZ, ([0, 1, 2, 3], [0, 4], [99]))


def test_arrays_without_values_and_single_numbers():
    none = np.zeros((0, 3))
    for ds in (sg.points(none), sg.lines(none, []), sg.surface(none, np.zeros((0, 3), int)), sg.unstructured(none, (np.zeros(0, int), [0], np.zeros(0, "u1")))):
        assert ds.n_points == 0 and ds.n_cells == 0 and ds.points.shape == (0, 3) and ds.with_field("x", [], on="points")["x"].shape == (0,)
        assert ds.parts and repr(ds) and ds.keys() == []
    assert len(sg.table({"t": []})["t"]) == 0
    for empty in (np.zeros((0, 3, 4)), np.zeros((3, 0)), np.zeros(0)):
        ds = sg.uniform(empty)
        assert ds.n_points == ds.n_cells == 0 and ds["values"].shape == (0,) and ds.contour().n_points == 0
        with pytest.warns(sg.SightglassWarning, match="the picture is empty"):
            ds.plot(size=(40, 30))
    assert sg.rectilinear([], [0, 1]).n_points == 0
    for single in (np.float64(1), np.array(1.0), 1.0):
        for use in (lambda: sg.uniform(single), lambda: sg.points(XYZ).with_field("x", single), lambda: sg.points(single)):
            with pytest.raises(sg.UsageError, match="0 dimensions"):
                use()


@pytest.mark.parametrize("mistake, near", [
    (lambda ds: ds["temprature"], "temperature"), (lambda ds: ds.unit("temprature"), "temperature"), (lambda ds: ds.range("temprature"), "temperature"),
    (lambda ds: ds.contour(field="temprature"), "temperature"), (lambda ds: ds.plot(field="temprature"), "temperature"),
    (lambda ds: ds.contuor(), "contour"), (lambda ds: sg.contuor(ds), "contour"), (lambda ds: ds.contour(vaules=[1]), "values"),
    (lambda ds: ds.plot("sufrace"), "surface"), (lambda ds: ds.plot("surface", opactiy=1), "opacity"), (lambda ds: ds.plot(camera={"veiw": "top"}), "view"),
    (lambda ds: ds.plot(picture={"titel": "x"}), "title"), (lambda ds: ds.contour(topology="trilinaer"), "trilinear"), (lambda ds: sg.read("a.vti", feilds=["a"]), "fields"),
])
def test_unknown_names_are_told_the_nearest(mistake, near):
    ds = sg.uniform(np.arange(27.0).reshape(3, 3, 3), name="temperature")
    with pytest.raises(sg.UsageError, match=f"'?{near}'?"):
        mistake(ds)


def test_files_that_vanish(tmp_path):
    for i in range(3):
        sg.uniform(np.full((3, 3, 3), float(i)), name="v").save(tmp_path / f"a_{i}.vti")
    ds = sg.read(tmp_path / "a_*.vti")
    kept, kept_at_1 = ds.threshold(min=-1), ds.at(1)
    (tmp_path / "a_2.vti").unlink()
    assert ds.times == [0, 1] and kept.at(2).time == 1 and kept.at(2).range("v") == (1, 1)  # the steps are those that are there
    for path in tmp_path.iterdir():
        path.unlink()
    assert kept_at_1["v"].sum() == 27 and ds.contour(values=[0.5]).n_points == 0  # what was read stays
    with pytest.raises(sg.DataError, match="a_0.vti"):
        sg.read(tmp_path / "a_0.vti")
    for f in (lambda: sg.pipeline(ds.contour()).result(), lambda: kept.at(1)):
        with pytest.raises(sg.DataError, match="a_"):
            f()
    with pytest.raises(sg.Error, match="nowhere"):
        ds.save(tmp_path / "nowhere" / "a.vti")
    assert not list(tmp_path.iterdir())


@pytest.mark.filterwarnings("ignore::sightglass.SightglassWarning")
@pytest.mark.parametrize("kind", ["grid", "cells", "points"])
def test_nothing_but_nan_is_refused_or_worked_on_and_drawn(kind):
    grid = sg.uniform(dims=(4, 4, 4))
    ds = {"grid": grid, "cells": grid.unstructured(), "points": sg.points(grid.points)}[kind]
    ds = ds.with_fields({"s": np.full(64, np.nan), "v": np.full((64, 3), np.nan), "t": np.full((64, 9), np.nan)}, on="points")
    slow = {"lic", "advect", "tensor_lic", "surface_lic", "resample"}  # pictures of a million pixels by default
    worked = sum(works(getattr(ds, name)) for name in names("operation") if name not in slow)
    assert worked >= {"grid": 40, "cells": 40, "points": 15}[kind]
    for way in ("auto", "surface", "volume", "lines", "points", "labels", "glyphs", "outline"):
        works(lambda way=way: ds.plot(way, size=(64, 48)).array)
    assert ds.plot(size=(64, 48)).array.shape == (48, 64, 3)
    nowhere = np.full((4, 3), np.nan)
    for data in (sg.points(nowhere), sg.surface(nowhere, [[0, 1, 2]]), sg.unstructured(nowhere, {"tetra": [[0, 1, 2, 3]]})):
        works(lambda data=data: data.plot(size=(64, 48)).array)


def works(f):
    """Whether it does; it may say what is wrong."""
    try:
        f()
    except sg.Error as e:
        assert not isinstance(e, sg.InternalError), e
        return False
    return True


def test_what_is_refused_is_given_back():
    """No reference to an array, nor its being read-only, outlives a mistake."""
    a, ids, bad = np.arange(27.0).reshape(3, 3, 3), np.array([[0, 1, 9]]), np.ones((3, 3, 3), complex)
    xyz = XYZ.copy()

    def load(step):
        raise RuntimeError("no step")

    mistakes = [
        lambda: sg.uniform(a, order="yx"), lambda: sg.uniform(a, spacing=(1, 2)), lambda: sg.uniform(a).with_field("x", a[0, 0]), lambda: sg.surface(xyz, ids),
        lambda: sg.lines(xyz, ids), lambda: sg.unstructured(xyz, {"triangle": ids}), lambda: sg.uniform(bad), lambda: sg.uniform(a).contour(field="x"),
        lambda: sg.uniform(a).contour(vaules=a), lambda: sg.uniform(a).contour(values=bad), lambda: sg.uniform(a).plot("nothing"),
        lambda: sg.table({"a": a[0, 0], "b": a[0, 0, :2]}), lambda: sg.series([0, 1], load), lambda: sg.rectilinear(a[0, 0], a[0, 1], a[0, 2], a[:2]),
        lambda: sg.uniform(a).save("/nowhere/a.vti"), lambda: sg.amr([(1, [((0, 0, 0), a)]), (0.3, [((0, 0, 0), a)])]),
    ]

    def make_them():
        for mistake in mistakes:
            with pytest.raises((sg.Error, TypeError, RuntimeError)):
                mistake()

    held = (a, ids, bad, xyz, load)
    make_them()
    gc.collect()
    before = [sys.getrefcount(o) for o in held]
    for _ in range(20):
        make_them()
    gc.collect()
    assert [sys.getrefcount(o) for o in held] == before
    a[0], ids[0], bad[0], xyz[0] = 1, 1, 1, 1

# SPDX-License-Identifier: Apache-2.0
"""Frames of pandas as tables, and tables and meshes as frames."""
import gc
import os
import subprocess
import sys

import numpy as np
import pytest
import sightglass as sg

pd = pytest.importorskip("pandas")


def address(a):
    return a.__array_interface__["data"][0]


def test_columns_keep_their_types():
    frame = pd.DataFrame({"f": np.array([0.5, 1.5], np.float32), "i": [3, 4], "b": [True, False], "site": ["n", None],
                          "kind": pd.Categorical(["b", None], categories=["a", "b"]), "size": pd.Categorical([10, 20])})
    ds = sg.wrap(frame)
    assert ds.kind == "table" and ds.keys() == list(frame.columns)
    assert ds["f"].dtype == np.float32 and list(ds["f"]) == [0.5, 1.5] and ds["i"].dtype == np.int64 and ds["b"].dtype == np.uint8
    assert list(ds["site"]) == ["n", ""] and list(ds["kind"]) == ["b", ""] and list(ds["size"]) == ["10", "20"]


def test_times_are_seconds_since_1970():
    frame = pd.DataFrame({"t": pd.to_datetime(["1970-01-01T00:00:10.5", "2026-11-27T12:34:56.789012", None]),
                          "z": pd.to_datetime(["1970-01-01T01:00", "1970-01-01T02:00", None]).tz_localize("Europe/Paris"),
                          "d": pd.to_timedelta(["90s", "1ms", None])})
    ds = sg.wrap(frame)
    assert ds["t"][0] == 10.5 and ds.unit("t") == "s" and np.isnan(ds["t"][2])
    assert pd.to_datetime(ds["t"][1], unit="s").round("us") == frame["t"][1]
    assert list(ds["z"][:2]) == [0, 3600] and list(ds["d"][:2]) == [90, 0.001] and np.isnan(ds["d"][2])


def test_types_of_pandas_that_know_missing_values(caplog):
    frame = pd.DataFrame({"i": pd.array([1, None], "Int32"), "j": pd.array([1, 2], "Int16"), "f": pd.array([0.5, None], "Float64"),
                          "b": pd.array([True, False], "boolean"), "s": pd.array(["x", None], "string")})
    with caplog.at_level("INFO", "sightglass"):
        ds = sg.wrap(frame)
    assert ds["i"][0] == 1 and np.isnan(ds["i"][1]) and ds["j"].dtype == np.int16 and np.isnan(ds["f"][1]) and list(ds["b"]) == [1, 0]
    assert list(ds["s"]) == ["x", ""] and "'i': copied, missing values become NaN" in caplog.text


def test_an_index_that_says_something_is_a_column():
    frame = pd.DataFrame({"T": [1.0, 2.0]}, index=pd.Index(["x", "y"], name="station"))
    assert sg.wrap(frame).keys() == ["station", "T"] and list(sg.wrap(frame)["station"]) == ["x", "y"]
    assert sg.wrap(frame, index=False).keys() == ["T"] and sg.wrap(frame.reset_index(drop=True), index=True).keys() == ["index", "T"]
    two = frame.set_index(pd.MultiIndex.from_tuples([("a", 1), ("b", 2)], names=["T", None]))
    assert sg.wrap(two).keys() == ["T #2", "level 1", "T"] and list(sg.wrap(two)["level 1"]) == [1, 2]
    when = pd.DataFrame({"T": [1.0]}, index=pd.to_datetime(["1970-01-02"]))
    assert list(sg.wrap(when)["index"]) == [86400] and sg.wrap(when).unit("index") == "s"


def test_names_of_several_levels_and_series():
    frame = pd.DataFrame(np.eye(2), columns=pd.MultiIndex.from_tuples([("v", "x"), ("v", "y")]))
    assert sg.wrap(frame).keys() == ["v/x", "v/y"]
    assert sg.wrap(pd.Series([1.0, 2.0], name="T")).keys() == ["T"] and list(sg.wrap(pd.Series([1.0, 2.0]))["0"]) == [1, 2]


def test_units_are_those_of_attrs_or_stated():
    frame = pd.DataFrame({"T": [1.0], "p": [2.0]})
    frame.attrs["units"] = {"T": "K", "p": "Pa"}
    ds = sg.wrap(frame, units={"p": "hPa"})
    assert ds.unit("T") == "K" and ds.unit("p") == "hPa"


def test_tables_survive_the_way_there_and_back():
    columns = {"t": [0.0, 1.0], "n": np.array([3, 4], np.int16), "site": ["south", None], "v": np.arange(6.0).reshape(2, 3)}
    ds = sg.table(columns, units={"t": "s", "v": "m/s"})
    frame = ds.to_pandas()
    assert list(frame.columns) == ["t", "n", "site", "v_0", "v_1", "v_2"] and frame["n"].dtype == np.int16 and frame["site"][1] is None
    assert frame.attrs["units"]["t"] == "s" and list(frame["v_2"]) == [2, 5]
    back = sg.wrap(frame)
    assert sorted(back.keys()) == sorted(ds.keys()) and np.array_equal(back["v"], ds["v"]) and list(back["site"]) == ["south", ""]
    assert all(back.unit(name) == ds.unit(name) and back[name].dtype == ds[name].dtype for name in ds)


def test_meshes_are_rows_of_points_or_cells(tetra):
    from sightglass._wrap.pandas import to_pandas

    ds = tetra.with_field("T", np.arange(5.0), unit="K").with_field("c", [1, 2], on="cells").with_field("w", [1.0], on="whole")
    frame = ds.to_pandas()
    assert list(frame.columns) == ["x", "y", "z", "T"] and list(frame["T"]) == [0, 1, 2, 3, 4] and frame.attrs["units"] == {"T": "K"}
    assert np.array_equal(frame[["x", "y", "z"]], tetra.points)
    cells = to_pandas(ds, on="cells")
    assert list(cells.columns) == ["c"] and list(cells["c"]) == [1, 2] and len(to_pandas(tetra, on="cells")) == 2
    with pytest.raises(sg.UsageError, match="'points' or 'cells'"):
        to_pandas(ds, on="faces")
    with pytest.raises(sg.UsageError, match="parts"):
        sg.collection([ds]).to_pandas()


def test_numbers_are_shared():
    v = np.arange(5.0)
    frame = pd.DataFrame({"v": v}, copy=False)
    ds = sg.wrap(frame)
    assert address(ds["v"]) == address(v) == address(frame["v"].to_numpy())
    with pytest.raises(ValueError, match="read-only"):
        v[0] = 1
    again = ds.to_pandas()
    assert address(again["v"].to_numpy()) == address(v)


@pytest.mark.parametrize("frame, text", [
    (pd.DataFrame({"a": [1.0, "x"]}), r"wrap 'a': row 0 holds a float; .*astype\(str\)"),
    (pd.DataFrame([[1, 2]], columns=["a", "a"]), "two columns are named 'a'"),
    (pd.DataFrame(), "no columns"),
    (pd.DataFrame({"a": [1 + 2j]}), "'a': row 0 holds a complex"),
    (pd.Index([1]), "is no table"),
])
def test_what_cannot_be_meant_is_refused(frame, text):
    with pytest.raises(sg.UsageError, match=text):
        sg.wrap(frame)


def test_hints_are_checked():
    with pytest.raises(sg.UsageError, match="'unit' is no hint for a pandas.DataFrame; one of units, index"):
        sg.wrap(pd.DataFrame({"a": [1]}), unit="K")


def test_no_library_is_imported_before_it_is_needed():
    code = ("import sys, sightglass as sg\nsg.wrap(sg.uniform(dims=(2, 2, 2)))\n"
            "others = ('vtkmodules', 'pyvista', 'xarray', 'pandas', 'meshio', 'nibabel', 'pyopenvdb', 'openvdb')\n"
            "print([m for m in others if m in sys.modules])")
    env = {**os.environ, "PYTHONPATH": os.path.dirname(os.path.dirname(sg.__file__))}
    done = subprocess.run([sys.executable, "-B", "-c", code], env=env, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_references_are_given_back():
    v = np.arange(5.0)
    frame = pd.DataFrame({"v": v}, copy=False)
    sg.wrap(frame).to_pandas()
    gc.collect()
    before = sys.getrefcount(v), sys.getrefcount(frame)
    for _ in range(50):
        sg.wrap(sg.wrap(frame).to_pandas())["v"]
    gc.collect()
    assert (sys.getrefcount(v), sys.getrefcount(frame)) == before
    frame.loc[0, "v"] = 7.0  # writable again
    assert v[0] == 7

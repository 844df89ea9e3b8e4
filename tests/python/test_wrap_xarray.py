# SPDX-License-Identifier: Apache-2.0
"""DataArray and Dataset of xarray as data, and grids back: places, values, units, times."""
import gc
import sys

import numpy as np
import pytest
import sightglass as sg

xr = pytest.importorskip("xarray")


def address(a):
    return a.__array_interface__["data"][0]


def lat_lon(lat, lon, **more):
    values = np.arange(float(len(lat) * len(lon))).reshape(len(lat), len(lon))
    return xr.DataArray(values, dims=("lat", "lon"), coords={"lat": lat, "lon": lon}, name="T", attrs={"units": "K"}, **more)


def test_even_coordinates_make_a_uniform_grid_of_the_same_numbers():
    a = lat_lon([40.0, 45.0, 50.0], [10.0, 12.0, 14.0, 16.0])
    ds = sg.wrap(a)
    assert ds.kind == "uniform" and ds.dims == (4, 3, 1) and ds.spacing[:2] == (2, 5) and ds.origin == (10, 40, 0)
    assert ds.unit("T") == "K" and ds.on("T") == "points" and address(ds["T"]) == address(a.values)
    assert np.array_equal(ds.points[5], [12, 45, 0]) and ds["T"][5] == float(a.sel(lat=45, lon=12))


def test_uneven_and_descending_coordinates_make_a_rectilinear_one():
    a = lat_lon([50.0, 45.0, 30.0], [10.0, 12.0, 14.0])
    ds = sg.wrap(a)
    assert ds.kind == "rectilinear" and list(ds.axes[1]) == [50, 45, 30] and list(ds.axes[0]) == [10, 12, 14]
    assert np.array_equal(ds.points[3], [10, 45, 0]) and ds["T"][3] == 3 and address(ds["T"]) == address(a.values)
    falling = sg.wrap(lat_lon([50.0, 45.0, 40.0], [0.0, 1.0]))
    assert falling.kind == "rectilinear" and falling.range("T") == (0, 5)


def test_axes_follow_attributes_names_and_then_the_order(caplog):
    v = np.arange(24.0).reshape(2, 3, 4)
    coordinates = {"a": ("a", [0.0, 1], {"axis": "X"}), "c": ("c", np.arange(4.0), {"units": "degrees_north"}),
                   "b": ("b", np.arange(3.0), {"positive": "down"})}
    marked = xr.DataArray(v, dims=("a", "b", "c"), name="v", coords=coordinates)
    with caplog.at_level("INFO", "sightglass"):
        ds = sg.wrap(marked)
    assert ds.dims == (2, 4, 3) and "copied" in caplog.text
    assert np.array_equal(ds["v"].reshape(3, 4, 2), v.transpose(1, 2, 0))
    assert sg.wrap(xr.DataArray(v, dims=("a", "b", "c"))).dims == (4, 3, 2)
    assert sg.wrap(xr.DataArray(v, dims=("lon", "lat", "level"))).dims == (2, 3, 4)
    assert sg.wrap(xr.DataArray(v, dims=("a", "b", "c")), dims=("b", "a", "c")).dims == (3, 2, 4)
    assert sg.wrap(xr.DataArray(v, dims=("a", "b", "c"))).keys() == ["values"]


def test_positions_of_two_dimensions_make_a_curvilinear_grid():
    y, x = np.mgrid[0:3, 0:4].astype(float)
    d = xr.Dataset({"T": (("level", "j", "i"), np.arange(24.0).reshape(2, 3, 4), {"units": "K"})},
                   coords={"lon": (("j", "i"), x + 0.1 * y), "lat": (("j", "i"), y), "level": [0.0, 100.0]})
    ds = sg.wrap(d)
    assert ds.kind == "curvilinear" and ds.dims == (4, 3, 2) and np.allclose(ds.points[5], [1.1, 1, 0]) and ds.points[17][2] == 100
    lon = d.lon.values.copy()
    lon[0, 1] = np.nan
    with pytest.warns(sg.SightglassWarning, match="2 points have no position"):
        holes = sg.wrap(d.assign_coords(lon=(("j", "i"), lon)))
    assert np.isfinite(holes.points).all()


def test_lists_of_places_are_points():
    a = xr.DataArray([1.0, 2.0, 3.0], dims="station", name="T", coords={"lon": ("station", [5.0, 6, 7]), "lat": ("station", [50.0, 51, 52]),
                                                                        "station": ["a", "b", "c"]})
    ds = sg.wrap(a)
    assert ds.kind == "points" and np.array_equal(ds.points, [[5, 50, 0], [6, 51, 0], [7, 52, 0]]) and list(ds["T"]) == [1, 2, 3]


def over_time(times):
    v = np.arange(12.0 * len(times)).reshape(len(times), 3, 4)
    return xr.DataArray(v, dims=("time", "y", "x"), coords={"time": times}, name="v")


def test_times_are_a_series():
    a = over_time(np.array(["1970-01-01", "1970-01-02", "1970-01-04"], "M8[ns]"))
    ds = sg.wrap(a)
    assert ds.times == [0, 86400, 3 * 86400] and ds.time == 0 and ds["v"][0] == 0
    assert ds.at(80000)["v"][0] == 12 and ds.at(1e9)["v"][-1] == 35
    assert address(ds.at(86400)["v"]) == address(a.values[1])
    assert ds.contour(values=[30.5]).at(3 * 86400).n_cells > 0
    assert sg.wrap(a, time="1970-01-03T20:00")["v"][0] == 24
    assert sg.wrap(a, time=np.datetime64("1970-01-02"))["v"][0] == 12
    assert sg.wrap(over_time([0.0, 0.5])).times == [0, 0.5] and sg.wrap(over_time([0.0, 0.5]), time=0.4)["v"][0] == 12
    assert sg.wrap(over_time([3.0, 1.0])).times == [1, 3] and sg.wrap(over_time([3.0, 1.0]))["v"][0] == 12
    assert sg.wrap(a.drop_vars("time")).times == [0, 1, 2] and sg.wrap(a.drop_vars("time"), time=1)["v"][0] == 12
    assert sg.wrap(a.isel(time=1))["v"][0] == 12 and sg.wrap(a.isel(time=[1])).times == []


def test_times_that_are_equal_leave_the_first():
    with pytest.warns(sg.SightglassWarning, match="not all different"):
        ds = sg.wrap(over_time([1.0, 1.0]))
    assert ds.times == [] and ds["v"][0] == 0


def test_times_of_other_calendars():
    cftime = pytest.importorskip("cftime")
    a = over_time([cftime.DatetimeNoLeap(1970, 3, 1), cftime.DatetimeNoLeap(1970, 3, 2)])
    assert sg.wrap(a).times == [59 * 86400, 60 * 86400]


def test_vectors_have_a_dimension_of_components():
    v = np.random.default_rng(0).random((3, 4, 3))
    d = xr.Dataset({"u": (("y", "x", "component"), v, {"units": "m/s"}), "w": (("component", "y", "x"), v.transpose(2, 0, 1))})
    ds = sg.wrap(d)
    assert ds["u"].shape == (12, 3) and np.array_equal(ds["u"], ds["w"]) and ds.unit("u") == "m/s" and address(ds["u"]) == address(v)
    assert sg.wrap(xr.DataArray(v, dims=("y", "x", "band"), name="c"), components="band")["c"].shape == (12, 3)
    one = sg.wrap(xr.DataArray(v, dims=("y", "x", "band"), name="c"), band=2)
    assert np.array_equal(one["c"], v[..., 2].reshape(-1))


def test_datasets_bring_all_variables_of_their_grids(caplog):
    d = xr.Dataset({"a": (("y", "x"), np.zeros((3, 4))), "b": (("y", "x"), np.ones((3, 4), bool)), "profile": ("y", [1.0, 2, 3]), "n": 3,
                    "words": (("y", "x"), np.full((3, 4), "w")), "y_bnds": (("y", "two"), np.zeros((3, 2))),
                    "when": (("y", "x"), np.full((3, 4), np.datetime64("1970-01-02", "ns")))},
                   coords={"y": ("y", [0.0, 1, 2], {"bounds": "y_bnds"})})
    with caplog.at_level("INFO", "sightglass"):
        ds = sg.wrap(d)
    assert ds.keys() == ["a", "b", "when"] and ds["b"].dtype == np.uint8 and ds["when"][0] == 86400 and ds.unit("when") == "s"
    for name in ("profile", "'n'", "'words'"):
        assert name in caplog.text
    several = sg.wrap(d.assign(c=(("k", "x"), np.zeros((2, 4)))))
    assert several.kind == "collection" and list(several.parts) == ["x x y", "k x x"]


def test_more_than_three_axes_ask_for_a_choice():
    a = xr.DataArray(np.arange(48.0).reshape(2, 2, 3, 4), dims=("member", "z", "y", "x"), coords={"member": [10, 20]}, name="v")
    with pytest.raises(sg.UsageError, match=r"4 axes: member, z, y, x; three at most; choose an entry: wrap\(x, member=0\)"):
        sg.wrap(a)
    assert sg.wrap(a, member=19)["v"][0] == 24 and sg.wrap(a.drop_vars("member"), member=1)["v"][0] == 24


@pytest.mark.parametrize("what, hints, text", [
    (xr.DataArray(np.zeros((2, 2)), dims=("y", "x")), {"lvl": 0}, "no dimension 'lvl'; one of y, x"),
    (xr.DataArray(np.zeros((2, 2)), dims=("y", "x")), {"time": 0}, "no dimension of time"),
    (xr.DataArray(np.zeros((2, 2)), dims=("y", "x")), {"x": 7}, "no entry 7"),
    (xr.DataArray(np.zeros((2, 2)), dims=("y", "x")), {"dims": ("x", "q")}, "no dimension 'q'"),
    (over_time(np.array(["1970-01-01", "1970-01-02"], "M8[ns]")), {"time": "yesterday"}, "'yesterday' is not found"),
    (xr.DataArray(["a", "b"], dims="x"), {}, "no variable of numbers"),
    (xr.DataArray(np.float64(3)), {}, "no variable of numbers"),
    (xr.DataArray(np.zeros((2, 2), complex), dims=("y", "x")), {}, "complex"),
    (xr.Dataset(), {}, "none at all"),
    (xr.Variable("x", [1.0]), {}, "xarray.Variable is not known"),
])
def test_what_cannot_be_meant_is_refused(what, hints, text):
    with pytest.raises(sg.UsageError, match=text):
        sg.wrap(what, **hints)


def test_coordinates_that_turn_back_are_numbered():
    with pytest.warns(sg.SightglassWarning, match="neither grows nor falls"):
        ds = sg.wrap(lat_lon([0.0, 2.0, 1.0], [0.0, 1.0]))
    assert list(ds.axes[1]) == [0, 1, 2]


@pytest.mark.parametrize("kind", ["uniform", "flat", "turned", "rectilinear", "curvilinear"])
def test_grids_survive_the_way_there_and_back(kind):
    z, y, x = np.mgrid[0:4, 0:5, 0:6].astype(float)
    c, s = np.cos(0.3), np.sin(0.3)
    ds = {
        "uniform": lambda: sg.uniform(dims=(6, 5, 4), spacing=(0.5, 1, 2), origin=(1, 2, 3)),
        "flat": lambda: sg.uniform(dims=(6, 5, 1), spacing=(0.5, 1, 2), origin=(1, 2, 3)),
        "turned": lambda: sg.uniform(dims=(6, 5, 4), spacing=(0.5, 1, 2), origin=(1, 2, 3), direction=[[c, -s, 0], [s, c, 0], [0, 0, 1]]),
        "rectilinear": lambda: sg.rectilinear([0, 1, 3, 4, 5, 9], [3, 2, 1, 0, -5], np.array([0, 1, 2, 4], np.float32)),
        "curvilinear": lambda: sg.curvilinear(np.stack([x + 0.1 * y * z, y, z], -1)),
    }[kind]()
    n, m = ds.n_points, ds.n_cells
    ds = (ds.with_field("T", np.arange(n, dtype=np.float32), unit="K")
          .with_field("v", np.arange(3.0 * n).reshape(n, 3), unit="m/s", on="points").with_field("c", np.arange(m), on="cells", unit="1/s")
          .with_field("t", [0.5, 1.5], unit="s", on="whole"))
    d = ds.to_xarray()
    assert d["T"].dims == ("z", "y", "x") and d["v"].dims == ("z", "y", "x", "component") and d["c"].dims == ("z_cell", "y_cell", "x_cell")
    assert d["T"].attrs["units"] == "K" and address(d["T"].values) == address(ds["T"]) and not d["T"].values.flags.writeable
    back = sg.wrap(d)
    assert back.kind == ds.kind and back.dims == ds.dims and np.allclose(back.points, ds.points, atol=1e-12)
    assert sorted(back.keys()) == sorted(ds.keys())
    for name in ds:
        assert np.array_equal(back[name], ds[name]) and back.unit(name) == ds.unit(name) and back.on(name) == ds.on(name)
        assert address(back[name]) == address(ds[name])
    part = sg.wrap(d["T"].isel(x=slice(2, None), y=slice(1, None)))  # a part lies where it did
    assert np.allclose(part.points, ds.points.reshape(*ds.dims[::-1], 3)[:, 1:, 2:].reshape(-1, 3), atol=1e-12)


def test_values_lie_at_their_coordinates(volume):
    grid = sg.rectilinear([0, 1, 3, 4, 5, 9], [0, 1, 2, 3, 5], [0, 1, 2, 4], volume, name="T")
    d = grid.with_field("c", np.arange(60.0), on="cells").to_xarray()
    assert float(d["T"].sel(x=3, y=2, z=1)) == volume[1, 2, 2] and list(d["x_cell"].values) == [0.5, 2, 3.5, 4.5, 7]
    assert float(d["c"].sel(x_cell=2, y_cell=0.5, z_cell=0.5)) == 1


def test_what_has_no_axes_does_not_go_to_xarray(tetra, volume):
    with pytest.raises(sg.UsageError, match="'unstructured' have no axes"):
        tetra.to_xarray()
    with pytest.raises(sg.UsageError, match="to_pandas"):
        sg.table({"a": [1.0]}).to_xarray()
    with pytest.raises(sg.UsageError, match="parts"):
        sg.collection([sg.uniform(volume)]).to_xarray()


def test_the_same_as_the_file(tmp_path):
    pytest.importorskip("scipy")
    a = lat_lon([40.0, 45.0, 52.0], [10.0, 12.0, 14.0, 16.0]).astype(np.float32)
    a.lat.attrs["units"], a.lon.attrs["units"] = "degrees_north", "degrees_east"
    a.to_netcdf(tmp_path / "a.nc", engine="scipy")
    with xr.open_dataset(tmp_path / "a.nc", engine="scipy") as d:
        here = sg.wrap(d)
    there = sg.read(tmp_path / "a.nc")
    assert here.kind == there.kind and np.array_equal(here.points, there.points) and np.array_equal(here["T"], there["T"])
    assert here.unit("T") == there.unit("T") == "K"


def test_references_are_given_back():
    v = np.zeros((2, 3, 4))
    a = xr.DataArray(v, dims=("time", "y", "x"), name="v")
    sg.wrap(a)
    gc.collect()
    before = sys.getrefcount(v), sys.getrefcount(a)
    for _ in range(30):
        sg.wrap(sg.wrap(a).at(1).to_xarray())
    gc.collect()
    assert (sys.getrefcount(v), sys.getrefcount(a)) == before
    v[0] = 1

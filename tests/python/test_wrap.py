# SPDX-License-Identifier: Apache-2.0
"""Objects of other libraries as data, and back: positions, values, units and shared numbers. What is not installed is skipped."""
import gc
import sys

import numpy as np
import pytest
import sightglass as sg


def address(a):
    return a.__array_interface__["data"][0]


def total(data, name):
    table = data.integrate()
    return table["integral"][list(table["field"]).index(name)]


def test_data_and_arrays_are_taken_and_others_refused(volume):
    ds = sg.uniform(volume)
    assert sg.wrap(ds) is ds
    assert address(sg.wrap(volume, name="v")["v"]) == address(volume)
    with pytest.raises(sg.UsageError, match="builtins.dict are not known"):
        sg.wrap({})


# ---- VTK

@pytest.fixture
def vtk():
    pytest.importorskip("vtkmodules")
    from vtkmodules import vtkCommonDataModel
    return vtkCommonDataModel


def test_grids_of_vtk_lie_where_they_did(vtk, volume):
    ds = sg.uniform(volume, spacing=(1, 2, 3), origin=(5, 6, 7), direction=[[0, -1, 0], [1, 0, 0], [0, 0, 1]], name="T")
    image = ds.to_vtk()
    assert image.GetClassName() == "vtkImageData" and image.GetPoint(7) == pytest.approx(tuple(ds.points[7]))
    back = sg.wrap(image)
    assert np.allclose(back.points, ds.points) and address(back["T"]) == address(volume)
    image.SetExtent(2, 7, 0, 4, 0, 3)
    assert np.allclose(sg.wrap(image).points[0], image.GetPoint(0))
    grid = sg.rectilinear([0, 1, 3, 4, 5, 9], [0, 1, 2, 3, 5], [0, 1, 2, 4], volume)
    assert np.allclose(sg.wrap(grid.to_vtk()).points, grid.points)
    z, y, x = np.mgrid[0:4, 0:5, 0:6].astype(float)
    bent = sg.curvilinear(np.stack([x + 0.1 * y * z, y, z], -1), volume)
    again = sg.wrap(bent.to_vtk())
    assert again.kind == "curvilinear" and np.allclose(again.points, bent.points) and again.dims == bent.dims


def test_meshes_of_vtk_keep_their_cells(vtk, tetra):
    mesh = tetra.with_field("c", [1.0, 2.0], on="cells").with_field("p", np.arange(5.0))
    grid = mesh.to_vtk()
    assert grid.GetNumberOfCells() == 2 and grid.GetCell(1).GetPointId(3) == 4 and grid.GetCellType(0) == 10
    back = sg.wrap(grid)
    assert [list(a) for a in back.cells] == [list(a) for a in mesh.cells] and back.on("c") == "cells" and address(back["p"]) == address(mesh["p"])
    cube = np.array([[x, y, z] for z in (0, 2) for y in (0, 2) for x in (0, 2)], float)
    faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    polyhedron = sg.unstructured(cube, {"polyhedron": [faces], "hexahedron": [[0, 1, 3, 2, 4, 5, 7, 6]]}).with_field("one", [1.0, 0.0], on="cells")
    again = sg.wrap(polyhedron.to_vtk())
    assert list(again.cells[2]) == [42, 12] and np.array_equal(again.polyhedra[0], polyhedron.polyhedra[0]) and total(again, "one") == pytest.approx(8)
    surface = sg.gyroid(size=8).contour(values=[0.1])
    assert sg.wrap(surface.to_vtk()).n_cells == surface.n_cells
    mixed = sg.wrap(sg.surface(cube, [0, 1, 3, 0, 1, 3, 2], [0, 3, 7]).to_vtk())
    assert mixed.n_cells == 2 and sg.wrap(sg.points(cube).to_vtk()).n_points == 8
    assert sg.wrap(sg.lines(cube, [[0, 1, 3], [4, 5]]).to_vtk()).n_cells == 2


def test_collections_and_tables_of_vtk(vtk, volume):
    both = sg.collection({"a": sg.uniform(volume), "b": sg.points(np.zeros((2, 3)))})
    blocks = both.to_vtk()
    assert blocks.GetNumberOfBlocks() == 2 and list(sg.wrap(blocks).parts) == ["a", "b"]
    table = sg.table({"t": [0.0, 1.0], "site": ["n", "s"]}).to_vtk()
    back = sg.wrap(table)
    assert list(back["site"]) == ["n", "s"] and list(back["t"]) == [0, 1]
    with pytest.raises(sg.UsageError, match="no hint"):
        sg.wrap(table, time=3)
    with pytest.raises(sg.UsageError, match="vtkPiecewiseFunction"):
        sg.wrap(vtk.vtkPiecewiseFunction())


def test_vtk_holds_numbers_as_long_as_it_needs_them(vtk):
    image = sg.gyroid(size=24).to_vtk()
    expected = sg.gyroid(size=24)
    name = expected.keys()[0]
    gc.collect()
    np.empty(24**3).fill(1)  # over memory that is free
    assert np.array_equal(sg.wrap(image)[name], expected[name])


def test_pyvista_takes_it(volume):
    pyvista = pytest.importorskip("pyvista")
    grid = sg.uniform(volume, name="T").to_pyvista()
    assert isinstance(grid, pyvista.ImageData) and np.array_equal(sg.wrap(grid)["T"], volume.reshape(-1))


# ---- xarray

@pytest.fixture
def xr():
    return pytest.importorskip("xarray")


def test_arrays_of_xarray_lie_at_their_coordinates(xr):
    values = np.arange(24.0).reshape(2, 3, 4)
    a = xr.DataArray(values, dims=("time", "lat", "lon"), coords={"lat": [50.0, 45.0, 40.0], "lon": [10.0, 12.0, 14.0, 16.0], "time": [0.0, 6.0]},
                     name="air", attrs={"units": "K"})
    ds = sg.wrap(a)
    assert ds.kind == "rectilinear" and ds.unit("air") == "K" and list(ds.axes[1]) == [50, 45, 40]
    assert np.array_equal(ds["air"], values[0].reshape(-1)) and np.allclose(ds.points[5], [12, 45, 0])
    assert sg.wrap(a, time=5.5)["air"][0] == 12
    even = sg.wrap(a.sel(time=0.0).isel(lat=slice(None, None, -1)))
    assert even.kind == "uniform" and even.spacing[:2] == (2, 5) and even["air"][0] == 8
    with pytest.raises(sg.UsageError, match="no dimension 'tme'"):
        sg.wrap(a, tme=0)


def test_datasets_of_xarray_bring_the_variables_of_one_grid(xr):
    y, x = np.mgrid[0:3, 0:4].astype(float)
    d = xr.Dataset({"T": (("j", "i"), x + y), "S": (("j", "i"), x), "n": 3}, coords={"lon": (("j", "i"), x + 0.1 * y), "lat": (("j", "i"), y)})
    ds = sg.wrap(d)
    assert ds.kind == "curvilinear" and sorted(ds.keys()) == ["S", "T"] and np.allclose(ds.points[5], [1.1, 1, 0])
    with pytest.raises(sg.UsageError, match="no variable of numbers"):
        sg.wrap(xr.Dataset({"w": ("i", ["a", "b"])}))


def test_grids_go_to_xarray_and_back(xr, volume):
    ds = sg.rectilinear([0, 1, 3, 4, 5, 9], [0, 1, 2, 3, 5], [0, 1, 2, 4], volume, name="T", unit="K").with_field("c", np.arange(60.0))
    d = ds.to_xarray()
    assert d["T"].dims == ("z", "y", "x") and d["T"].attrs["units"] == "K" and float(d["T"].sel(x=3, y=2, z=1)) == volume[1, 2, 2]
    assert d["c"].shape == (3, 4, 5) and list(d["x_cell"].values) == [0.5, 2, 3.5, 4.5, 7]
    back = sg.wrap(d["T"])
    assert np.array_equal(back["T"], ds["T"]) and np.allclose(back.points, ds.points)
    with pytest.raises(sg.UsageError, match="no axes"):
        sg.points(np.zeros((1, 3))).to_xarray()


# ---- pandas

def test_frames_are_tables(tmp_path):
    pd = pytest.importorskip("pandas")
    frame = pd.DataFrame({"t": [0.0, 1.0], "n": [3, 4], "site": ["n", None], "kind": pd.Categorical(["a", "b"]),
                          "when": pd.to_datetime(["1970-01-01T00:00:10", "1970-01-02"])})
    table = sg.wrap(frame)
    assert list(table["t"]) == [0, 1] and list(table["site"]) == ["n", ""] and list(table["kind"]) == ["a", "b"]
    assert list(table["when"]) == [10, 86400] and table.unit("when") == "s" and table["n"].dtype.kind == "i"
    back = table.to_pandas()
    assert list(back.columns) == ["t", "n", "site", "kind", "when"] and list(back["n"]) == [3, 4]
    assert "station" in sg.wrap(frame.set_index(pd.Index(["x", "y"], name="station"))).keys()
    points = sg.points(np.eye(3)).with_field("v", np.arange(6.0).reshape(3, 2)).to_pandas()
    assert list(points.columns) == ["x", "y", "z", "v_0", "v_1"] and points["v_1"][2] == 5


# ---- meshio

def test_meshes_of_meshio_come_and_go():
    meshio = pytest.importorskip("meshio")
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1.0]])
    mesh = meshio.Mesh(points, [("tetra", [[0, 1, 2, 3], [1, 2, 3, 4]]), ("triangle", [[0, 1, 2]])], point_data={"p": np.arange(5.0)},
                       cell_data={"c": [[1.0, 2.0], [3.0]]}, cell_sets={"wall": [None, [0]]})
    ds = sg.wrap(mesh)
    assert list(ds.cells[2]) == [10, 10, 5] and list(ds["c"]) == [1, 2, 3] and list(ds["wall"]) == [0, 0, 1] and list(ds["p"]) == [0, 1, 2, 3, 4]
    back = ds.to_meshio()
    assert [b.type for b in back.cells] == ["tetra", "triangle"] and list(back.cell_data["c"][0]) == [1, 2] and np.array_equal(back.points, points)
    with pytest.raises(sg.UsageError, match="no hint"):
        sg.wrap(mesh, time=1)


# ---- nibabel

def test_images_of_nibabel_lie_where_the_file_does(tmp_path):
    nibabel = pytest.importorskip("nibabel")
    c, s = np.cos(0.2), np.sin(0.2)
    affine = np.array([[-2 * c, 3 * s, 0, 10], [2 * s, 3 * c, 0, -20], [0, 0, 4, 30], [0, 0, 0, 1]])
    image = nibabel.Nifti1Image(np.arange(60, dtype=np.float32).reshape(3, 4, 5), affine)
    image.to_filename(tmp_path / "a.nii")
    ds, there = sg.wrap(image), sg.read(tmp_path / "a.nii")
    assert ds.dims == there.dims == (3, 4, 5) and np.allclose(ds.points, there.points, atol=1e-4)
    assert np.array_equal(ds["values"], there[there.keys()[0]])
    several = sg.wrap(nibabel.Nifti1Image(np.zeros((2, 3, 4, 6), np.float32), np.eye(4)))
    assert several["values"].shape == (24, 6)


# ---- OpenVDB

def test_grids_of_openvdb_are_dense():
    vdb = None
    for name in ("openvdb", "pyopenvdb"):
        try:
            vdb = __import__(name)
            break
        except ImportError:
            pass
    if vdb is None:
        pytest.skip("OpenVDB's module is not installed")
    grid = vdb.FloatGrid()
    grid.copyFromArray(np.arange(1, 25, dtype=np.float32).reshape(2, 3, 4), ijk=(5, 6, 7))
    grid.transform = vdb.createLinearTransform(voxelSize=0.5)
    grid.name = "density"
    ds = sg.wrap(grid)
    assert ds.dims == (2, 3, 4) and np.allclose(ds.origin, (2.5, 3, 3.5)) and np.allclose(ds.spacing, 0.5)
    assert ds["density"][1] == 13 and ds["density"].min() == 1


def test_references_are_given_back(vtk, volume):
    before = sys.getrefcount(volume)
    for _ in range(20):
        sg.wrap(sg.uniform(volume, name="T").to_vtk())
    gc.collect()
    assert sys.getrefcount(volume) == before

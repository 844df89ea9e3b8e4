# SPDX-License-Identifier: Apache-2.0
"""Data sets of VTK and PyVista as data, and back: places, cells, fields, units, and memory that neither side loses."""
import gc
import sys

import numpy as np
import pytest
import sightglass as sg

pytest.importorskip("vtkmodules")
from vtkmodules import vtkCommonCore as core  # noqa: E402
from vtkmodules import vtkCommonDataModel as model  # noqa: E402
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy  # noqa: E402

CUBE = np.array([[x, y, z] for z in (0, 2) for y in (0, 2) for x in (0, 2)], float)


def address(a):
    return a.__array_interface__["data"][0]


def array(values, name, unit=""):
    made = numpy_to_vtk(np.asarray(values))
    made.SetName(name)
    if unit:
        made.GetInformation().Set(core.vtkDataArray.UNITS_LABEL(), unit)
    return made


def same(a, b):
    assert a.kind == b.kind and a.n_points == b.n_points and a.n_cells == b.n_cells and np.array_equal(a.points, b.points)
    assert a.keys() == b.keys()
    for name in a:
        assert np.array_equal(a[name], b[name]) and a[name].dtype == b[name].dtype
        assert a.unit(name) == b.unit(name) and a.on(name) == b.on(name)


def fields_everywhere(ds):
    n, m = ds.n_points, ds.n_cells
    return (ds.with_field("T", np.arange(n, dtype=np.float32), unit="K")
            .with_field("v", np.arange(3.0 * n).reshape(n, 3), unit="m/s", on="points").with_field("id", np.arange(m), on="cells")
            .with_field("t", [0.5, 1.5], unit="s", on="whole"))


def test_an_image_lies_along_its_directions_wherever_its_extent_begins():
    image = model.vtkImageData()
    image.SetExtent(2, 4, -1, 2, 3, 3)
    image.SetSpacing(0.5, 2, 3)
    image.SetOrigin(1, 2, 3)
    c, s = np.cos(0.3), np.sin(0.3)
    image.SetDirectionMatrix(c, -s, 0, s, c, 0, 0, 0, 1)
    v = np.arange(12.0)
    image.GetPointData().AddArray(array(v, "T", "K"))
    ds = sg.wrap(image)
    assert ds.kind == "uniform" and ds.dims == (3, 4, 1) and ds.spacing == (0.5, 2, 3) and ds.unit("T") == "K"
    assert np.allclose(ds.points, [image.GetPoint(i) for i in range(12)], atol=1e-14)
    assert np.allclose(ds.direction, [[c, -s, 0], [s, c, 0], [0, 0, 1]])
    assert address(ds["T"]) == address(v)


@pytest.mark.parametrize("kind", ["uniform", "turned", "rectilinear", "curvilinear"])
def test_grids_survive_the_way_there_and_back(kind):
    z, y, x = np.mgrid[0:4, 0:5, 0:6].astype(float)
    ds = fields_everywhere({
        "uniform": lambda: sg.uniform(dims=(6, 5, 4), spacing=(0.5, 1, 2), origin=(1, 2, 3)),
        "turned": lambda: sg.uniform(dims=(6, 5, 4), spacing=(0.5, 1, 2), direction=[[0, -1, 0], [1, 0, 0], [0, 0, 1]]),
        "rectilinear": lambda: sg.rectilinear([0, 1, 3, 4, 5, 9], [3, 2, 1, 0, -5], np.array([0, 1, 2, 4], np.float32)),
        "curvilinear": lambda: sg.curvilinear(np.stack([x + 0.1 * y * z, y, z], -1)),
    }[kind]())
    there = ds.to_vtk()
    assert there.GetNumberOfPoints() == 120 and there.GetNumberOfCells() == 60
    assert np.allclose([there.GetPoint(i) for i in range(120)], ds.points)
    back = sg.wrap(there)
    same(back, ds)
    assert back.dims == ds.dims
    assert all(address(back[name]) == address(ds[name]) for name in ds)


def test_unstructured_meshes_share_points_cells_and_fields(tetra):
    ds = fields_everywhere(tetra)
    grid = ds.to_vtk()
    assert [grid.GetCellType(i) for i in range(2)] == [10, 10] and grid.GetCell(1).GetPointId(3) == 4
    back = sg.wrap(grid)
    same(back, ds)
    for a, b in zip([*back.cells[:2], back.points], [*ds.cells[:2], ds.points]):
        assert np.array_equal(a, b) and address(a) == address(b)
    assert np.array_equal(back.cells[2], ds.cells[2])


def test_trees_keep_the_names_of_their_blocks(tetra, volume):
    ds = sg.collection({"a": sg.uniform(volume, name="T", unit="K"), "b": sg.collection({"c": tetra})})
    blocks = ds.to_vtk()
    assert blocks.GetNumberOfBlocks() == 2 and blocks.GetMetaData(1).Get(blocks.NAME()) == "b/c"
    back = sg.wrap(blocks)
    assert list(back.parts) == ["a", "b/c"] and back.parts["a"].unit("T") == "K" and back.parts["b/c"].n_cells == 2
    outer = model.vtkMultiBlockDataSet()
    outer.SetBlock(0, blocks)
    outer.SetBlock(2, tetra.to_vtk())
    outer.GetMetaData(0).Set(outer.NAME(), "inside")
    assert list(sg.wrap(outer).parts) == ["inside/a", "inside/b/c", "2"]


def test_partitions_are_parts(tetra):
    one, two, all_of_them = model.vtkPartitionedDataSet(), model.vtkPartitionedDataSet(), model.vtkPartitionedDataSetCollection()
    one.SetPartition(0, tetra.to_vtk())
    for i in range(2):
        two.SetPartition(i, tetra.to_vtk())
    all_of_them.SetPartitionedDataSet(0, one)
    all_of_them.SetPartitionedDataSet(1, two)
    all_of_them.GetMetaData(1).Set(model.vtkCompositeDataSet.NAME(), "wing")
    assert list(sg.wrap(two).parts) == ["0", "1"]
    assert list(sg.wrap(all_of_them).parts) == ["0", "wing/0", "wing/1"] and sg.wrap(all_of_them).n_cells == 6


def test_patches_become_cells_and_times_are_told():
    ds = sg.amr([(1.0, [((0, 0), np.ones((4, 4)))]), (0.5, [((2, 2), np.full((4, 4), 3.0))])], name="rho")
    grid = ds.to_vtk()
    assert grid.GetClassName() == "vtkUnstructuredGrid"
    assert grid.GetCellData().GetArray("rho").GetNumberOfTuples() == grid.GetNumberOfCells()
    step = sg.series([0.5, 2], lambda i: sg.uniform(np.full((2, 2, 2), float(i)))).at(2).to_vtk()
    assert step.GetInformation().Get(step.DATA_TIME_STEP()) == 2


def test_tables_have_numbers_words_and_units():
    ds = sg.table({"t": [0.0, 1.0], "site": ["south", "north"], "v": np.arange(6.0).reshape(2, 3)}, units={"t": "s"})
    there = ds.to_vtk()
    assert there.GetNumberOfRows() == 2 and there.GetColumn(1).GetValue(1) == "north"
    back = sg.wrap(there)
    assert back.keys() == ds.keys() and back.unit("t") == "s" and list(back["site"]) == ["south", "north"]
    assert np.array_equal(back["v"], ds["v"])
    assert address(back["t"]) == address(ds["t"])


def test_ghosts_are_carried_as_a_field(tetra):
    grid = tetra.to_vtk()
    grid.AllocateCellGhostArray()
    grid.GetCellGhostArray().SetValue(1, 1)
    ds = sg.wrap(grid)
    assert list(ds["vtkGhostType"]) == [0, 1] and ds["vtkGhostType"].dtype == np.uint8
    assert ds.to_vtk().HasAnyGhostCells()


def test_fields_of_the_same_name_stay_apart(tetra):
    grid = tetra.with_field("a", np.zeros(5), on="points").with_field("a", np.ones(2), on="cells").to_vtk()
    assert grid.GetPointData().GetArray("a").GetNumberOfTuples() == 5 and grid.GetCellData().GetArray("a").GetNumberOfTuples() == 2
    grid.GetPointData().AddArray(numpy_to_vtk(np.arange(5.0)))
    assert sorted(sg.wrap(grid).keys()) == ["a", "a", "array 1"]


def test_arrays_of_other_kinds(tetra, caplog):
    grid = tetra.to_vtk()
    words = core.vtkStringArray()
    words.SetName("words")
    words.InsertNextValue("here")
    grid.GetFieldData().AddArray(words)
    bits = core.vtkBitArray()
    bits.SetName("bits")
    for b in (1, 0, 1, 1, 0):
        bits.InsertNextValue(b)
    grid.GetPointData().AddArray(bits)
    apart = core.vtkSOADataArrayTemplate["float64"]() if hasattr(core, "vtkSOADataArrayTemplate") else None
    if apart is not None:
        apart.SetNumberOfComponents(2)
        apart.SetNumberOfTuples(5)
        apart.SetName("apart")
        for i in range(5):
            apart.SetTuple2(i, i, 10 * i)
        grid.GetPointData().AddArray(apart)
    with caplog.at_level("INFO", "sightglass"):
        ds = sg.wrap(grid)
    assert "'words' is left out" in caplog.text and list(ds["bits"]) == [1, 0, 1, 1, 0]
    if apart is not None:
        assert np.array_equal(ds["apart"], [[i, 10 * i] for i in range(5)]) and "'apart': copied" in caplog.text


def test_what_vtk_cannot_mean_is_refused(tetra):
    with pytest.raises(sg.UsageError, match="1 x 1 x 0 points") as e:
        image = model.vtkImageData()
        image.SetDimensions(1, 1, 0)
        sg.wrap(image)
    assert e.value.right
    with pytest.raises(sg.UsageError, match="vtkHyperTreeGrid is not known"):
        sg.wrap(model.vtkHyperTreeGrid())
    with pytest.raises(sg.UsageError, match="vtkDoubleArray is not known"):
        sg.wrap(core.vtkDoubleArray())
    from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
    with pytest.raises(sg.UsageError, match="GetOutputDataObject"):
        sg.wrap(vtkRTAnalyticSource())
    with pytest.raises(sg.UsageError, match="'time' is no hint"):
        sg.wrap(tetra.to_vtk(), time=1)
    bad = tetra.to_vtk()
    bad.GetPointData().AddArray(array([1.0, 2.0], "short"))
    with pytest.raises(sg.Error, match="'short' has 2"):
        sg.wrap(bad)


def junk():
    """Writes over memory that nobody holds any more."""
    gc.collect()
    for n in (10, 100, 1000, 10000):
        for _ in range(5):
            np.full(n, -7, np.int64)


def big():
    rng = np.random.default_rng(1)
    return sg.unstructured(rng.random((500, 3)), (rng.integers(0, 500, 4000), np.arange(0, 4001, 4), np.full(1000, 10))).with_field(
        "T", rng.random(500), on="points")


def test_vtk_keeps_the_numbers_of_data_that_are_gone():
    wanted = big()
    grid = big().to_vtk()
    junk()
    assert np.array_equal(vtk_to_numpy(grid.GetPoints().GetData()), wanted.points)
    other = grid.NewInstance()
    other.ShallowCopy(grid)
    cells = grid.GetCells()
    del grid
    junk()
    assert np.array_equal(vtk_to_numpy(cells.GetConnectivityArray()), wanted.cells[0])
    del cells
    back = sg.wrap(other)
    del other
    junk()
    same(back, wanted)
    assert all(np.array_equal(a, b) for a, b in zip(back.cells, wanted.cells))


def test_data_keep_the_numbers_of_vtk():
    grid = big().to_vtk()
    own = grid.NewInstance()
    own.DeepCopy(grid)
    del grid
    back = sg.wrap(own)
    del own
    junk()
    same(back, big())


def test_references_are_given_back():
    v = np.arange(12.0)
    image = model.vtkImageData()
    image.SetDimensions(3, 4, 1)
    image.GetPointData().AddArray(array(v, "T"))
    ours = np.arange(12.0)
    sg.wrap(sg.wrap(image).to_vtk())
    gc.collect()
    before = [sys.getrefcount(o) for o in (v, ours, image)], image.GetReferenceCount()
    for _ in range(50):
        sg.wrap(sg.wrap(image).to_vtk())["T"]
        sg.uniform(ours.reshape(3, 4)).to_vtk()
    gc.collect()
    ours[0] = 1  # nobody holds it any more
    assert ([sys.getrefcount(o) for o in (v, ours, image)], image.GetReferenceCount()) == before


def test_pyvista_is_vtk(volume):
    pv = pytest.importorskip("pyvista")
    ds = sg.uniform(volume, name="T", unit="K", spacing=(1, 2, 3))
    mesh = ds.to_pyvista()
    assert isinstance(mesh, pv.DataSet) and np.array_equal(mesh.point_data["T"], volume.reshape(-1)) and mesh.spacing == (1, 2, 3)
    same(sg.wrap(mesh), ds)
    assert sg.wrap(pv.Sphere()).kind == "surface"
    mixed = pv.Plane(i_resolution=1, j_resolution=1)
    mixed.verts, mixed.lines = [1, 0], [2, 1, 2]
    back = sg.wrap(mixed).to_pyvista()
    assert isinstance(back, pv.PolyData) and (back.n_verts, back.n_lines, back.GetNumberOfPolys()) == (1, 1, 1)
    assert np.array_equal(back.faces, mixed.faces) and np.array_equal(back.lines, mixed.lines)
    assert list(sg.wrap(pv.MultiBlock({"a": pv.Sphere()})).parts) == ["a"]


def test_pyvista_missing_is_said(volume):
    try:
        import pyvista  # noqa: F401
    except ImportError:
        with pytest.raises(ImportError, match="to_pyvista: pyvista is not installed"):
            sg.uniform(volume).to_pyvista()

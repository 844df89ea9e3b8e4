# SPDX-License-Identifier: Apache-2.0
"""Images of nibabel as data: places, values and times are those of the file as sg.read has it."""
import gc
import sys

import numpy as np
import pytest
import sightglass as sg

nib = pytest.importorskip("nibabel")

C, S = np.cos(0.2), np.sin(0.2)
OBLIQUE = np.array([[-2 * C, 3 * S, 0, 10], [2 * S, 3 * C, 0, -20], [0, 0, 4, 30], [0, 0, 0, 1]])


def address(a):
    return a.__array_interface__["data"][0]


def image(shape=(3, 4, 5), dtype=np.int16, affine=OBLIQUE, kind=nib.Nifti1Image):
    return kind(np.arange(np.prod(shape)).reshape(shape, order="F").astype(dtype), affine)


def same(path):
    """The file as nibabel has it, after it has been found to be as Sightglass reads it."""
    here, there = sg.wrap(nib.load(path)), sg.read(path)
    assert here.kind == there.kind == "uniform" and here.dims == there.dims
    assert np.allclose(here.points, there.points, atol=1e-5 * np.abs(there.points).max())
    assert np.allclose(here.direction, there.direction, atol=1e-6)
    assert here["values"].shape == there["NIFTI"].shape and np.array_equal(here["values"], there["NIFTI"])
    assert here.times == there.times and here.time == there.time
    return here


@pytest.mark.parametrize("name", ["a.nii", "a.nii.gz"])
@pytest.mark.parametrize("kind", [nib.Nifti1Image, nib.Nifti2Image])
@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.int32, np.float32, np.float64])
def test_files_lie_where_sightglass_reads_them(name, kind, dtype, tmp_path):
    image(dtype=dtype, kind=kind).to_filename(tmp_path / name)
    ds = same(tmp_path / name)
    assert ds["values"].dtype == dtype


def test_patient_space_is_lps():
    a = image()
    ds = sg.wrap(a)
    for voxel in ((0, 0, 0), (2, 1, 0), (1, 3, 4)):
        ras = (OBLIQUE @ (*voxel, 1))[:3]
        n = voxel[0] + 3 * (voxel[1] + 4 * voxel[2])
        assert np.allclose(ds.points[n], ras * (-1, -1, 1)) and ds["values"][n] == a.dataobj[voxel]


def test_forms_of_the_header(tmp_path):
    for code in ("qform", "sform", "neither"):
        a = image(affine=OBLIQUE if code != "neither" else np.diag([2.0, 3, 4, 1]))
        a.set_sform(a.affine, 1 if code == "sform" else 0)
        a.set_qform(a.affine, 1 if code == "qform" else 0)
        a.to_filename(tmp_path / f"{code}.nii")
        same(tmp_path / f"{code}.nii")
    plain = sg.wrap(nib.load(tmp_path / "neither.nii"))
    assert plain.origin == (0, 0, 0) and plain.spacing == (2, 3, 4) and np.array_equal(plain.direction, np.eye(3))


@pytest.mark.parametrize("dtype, wanted", [(np.uint8, np.float32), (np.int16, np.float32), (np.int32, np.float64),
                                           (np.float32, np.float32)])
def test_scaled_values(dtype, wanted, tmp_path):
    a = image(dtype=dtype)
    a.header.set_slope_inter(0.37, -5.5)
    a.header.set_data_dtype(dtype)
    a.to_filename(tmp_path / "a.nii")
    ds = same(tmp_path / "a.nii")
    assert ds["values"].dtype == wanted


def test_bytes_of_the_other_order(tmp_path):
    a = nib.Nifti1Image(np.arange(60).reshape(3, 4, 5).astype(">i2"), OBLIQUE, nib.Nifti1Header(endianness=">"))
    a.to_filename(tmp_path / "a.nii")
    same(tmp_path / "a.nii")


def test_values_are_shared(tmp_path):
    v = np.asfortranarray(np.arange(60.0).reshape(3, 4, 5))
    ds = sg.wrap(nib.Nifti1Image(v, OBLIQUE))
    assert address(ds["values"]) == address(v)
    image(dtype=np.float32).to_filename(tmp_path / "a.nii")
    mapped = nib.load(tmp_path / "a.nii").dataobj.get_unscaled()
    assert isinstance(mapped, np.memmap)
    loaded = sg.wrap(nib.load(tmp_path / "a.nii"))
    assert np.array_equal(loaded["values"], mapped.reshape(-1, order="F"))


@pytest.mark.parametrize("name", ["a.nii", "a.nii.gz"])
def test_the_fourth_axis_is_time(name, tmp_path):
    a = image((3, 4, 5, 4))
    a.header.set_zooms((2, 3, 4, 1.5))
    a.header["toffset"] = 10
    a.to_filename(tmp_path / name)
    ds = same(tmp_path / name)
    assert ds.times == [10, 11.5, 13, 14.5] and ds["values"][0] == 0 and ds.at(13)["values"][0] == 120
    assert sg.wrap(a, time=14)["values"][0] == 180 and sg.wrap(nib.load(tmp_path / name), time=14)["values"][0] == 180
    parts = sg.wrap(a, components=True)
    assert parts["values"].shape == (60, 4) and list(parts["values"][1]) == [1, 61, 121, 181] and parts.times == []


def test_the_fifth_axis_is_components(tmp_path):
    image((3, 4, 5, 1, 6), np.float32).to_filename(tmp_path / "a.nii")
    assert same(tmp_path / "a.nii")["values"].shape == (60, 6)
    image((3, 4, 5, 2, 2), np.float32).to_filename(tmp_path / "b.nii")
    assert same(tmp_path / "b.nii")["values"].shape == (60, 2)


@pytest.mark.parametrize("shape, intent", [((3, 4, 5, 3), 1007), ((3, 4, 5, 1, 3), 1006), ((3, 4, 5, 1, 6), 1005), ((3, 4, 5, 1, 9), 1004),
                                           ((3, 4, 5, 1, 3), 1007)])
def test_vectors_and_tensors_are_turned_as_the_intent_says(shape, intent, tmp_path):
    a = image(shape, np.float32)
    a.header["intent_code"] = intent
    a.to_filename(tmp_path / "a.nii")
    same(tmp_path / "a.nii")


def test_directions_as_fsl_names_them(tmp_path):
    image((3, 4, 5, 3), np.float32).to_filename(tmp_path / "dti_V1.nii.gz")
    here, there = sg.wrap(nib.load(tmp_path / "dti_V1.nii.gz")), sg.read(tmp_path / "dti_V1.nii.gz")
    assert here["values"].shape == (60, 3) and np.allclose(here["values"], there["NIFTI"], rtol=1e-6)


def test_three_volumes_with_b_values_are_time(tmp_path):
    image((3, 4, 5, 3), np.float32).to_filename(tmp_path / "a.nii")
    assert same(tmp_path / "a.nii")["values"].shape == (60, 3)
    (tmp_path / "a.bval").write_text("0 1000 1000\n")
    assert len(same(tmp_path / "a.nii").times) == 3


def test_colours_and_complex_numbers(tmp_path):
    rgb = np.zeros((3, 4, 5), [("R", "u1"), ("G", "u1"), ("B", "u1")])
    rgb["G"] = np.arange(60).reshape(3, 4, 5)
    nib.Nifti1Image(rgb, OBLIQUE).to_filename(tmp_path / "rgb.nii")
    assert same(tmp_path / "rgb.nii")["values"].shape == (60, 3)
    nib.Nifti1Image((np.arange(60) + 1j * np.ones(60)).reshape(3, 4, 5).astype(np.complex64), OBLIQUE).to_filename(tmp_path / "c.nii")
    assert list(same(tmp_path / "c.nii")["values"][0]) == [0, 1]


def test_flat_images_and_other_formats(tmp_path):
    image((3, 4)).to_filename(tmp_path / "flat.nii")
    assert same(tmp_path / "flat.nii").dims == (3, 4, 1)
    mgh = nib.MGHImage(np.arange(60, dtype=np.float32).reshape(3, 4, 5), OBLIQUE)
    assert np.allclose(sg.wrap(mgh).points, sg.wrap(image()).points)
    analyze = nib.AnalyzeImage(np.arange(60, dtype=np.int16).reshape(3, 4, 5), None)
    analyze.header.set_zooms((2, 3, 4))
    analyze.to_filename(tmp_path / "old.img")
    same(tmp_path / "old.img")


@pytest.mark.parametrize("what, text", [
    (lambda: image(affine=[[1.0, 1, 0, 0], [1, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]), "does not span space"),
    (lambda: nib.GiftiImage(), "GiftiImage has no affine map"),
    (lambda: nib.Nifti1Header(), "Nifti1Header has no affine map"),
    (lambda: nib.Nifti1Image(np.zeros((2, 0, 2), np.float32), np.eye(4)), "none of them empty"),
])
def test_what_cannot_be_meant_is_refused(what, text):
    with pytest.raises(sg.UsageError, match=text):
        sg.wrap(what())


def test_hints_are_checked():
    with pytest.raises(sg.UsageError, match="there is one volume"):
        sg.wrap(image(), time=1)
    with pytest.raises(sg.UsageError, match="'tiem' is no hint for a nibabel.Nifti1Image; one of time, components"):
        sg.wrap(image(), tiem=1)


def test_references_are_given_back():
    v = np.asfortranarray(np.zeros((3, 4, 5, 2)))
    a = nib.Nifti1Image(v, OBLIQUE)
    sg.wrap(a).at(1)
    gc.collect()
    before = sys.getrefcount(v), sys.getrefcount(a)
    for _ in range(30):
        sg.wrap(a).at(1)["values"]
    gc.collect()
    assert (sys.getrefcount(v), sys.getrefcount(a)) == before
    v[0] = 1

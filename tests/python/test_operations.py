# SPDX-License-Identifier: Apache-2.0
"""Operations are those of the command line: all of them, with the same parameters and the same results."""
import inspect
import json
import subprocess

import numpy as np
import pytest
import sightglass as sg


@pytest.fixture(scope="module")
def catalog():
    import pathlib

    program = pathlib.Path(sg.__file__).parent.parent.parent / "sightglass"
    return json.loads(subprocess.run([program, "ops", "--json"], capture_output=True, text=True, check=True).stdout)


def test_every_operation_and_source_is_a_function_with_its_parameters(catalog):
    data = sg.gyroid(size=8)
    for entry in catalog["sources"] + catalog["operations"]:
        f = getattr(sg, entry["name"])
        assert entry["name"] in dir(sg)
        if entry["name"] == "unstructured":  # of arrays it makes a mesh
            assert f(data).kind == "unstructured" and entry["sentence"] in data.unstructured.__doc__
            continue
        assert entry["sentence"] in f.__doc__
        names = [p for p in inspect.signature(f).parameters if p not in ("data", "others")]
        assert [n.rstrip("_") if n.endswith("_") else n for n in names] == list(entry["params"].get("properties", {}))
        for name, schema in entry["params"].get("properties", {}).items():
            assert schema.get("description", "") in f.__doc__
        if entry["kind"] != "source":
            assert entry["name"] in dir(data) and callable(getattr(data, entry["name"]))


@pytest.mark.parametrize("operation, params", [
    ("contour", {"values": [0.2, -0.1]}),
    ("clip", {"normal": (1, 1, 0.5)}),
    ("slice", {"axis": "z"}),
    ("threshold", {"min": 0.3}),
    ("gradient", {}),
    ("gaussian_smooth", {"sigma": 2.0}),
    ("resample", {"dims": [9, 9, 9]}),
])
def test_results_are_those_of_the_command_line(operation, params, tmp_path, program):
    here = getattr(sg.gyroid(size=16), operation)(**params)
    words = [f"{k}={','.join(map(str, v)) if isinstance(v, (list, tuple)) else v}" for k, v in params.items()]
    extension = "vti" if here.kind == "uniform" else "vtp" if here.kind == "surface" else "vtu"
    path = tmp_path / f"there.{extension}"
    done = subprocess.run([program, "convert", "-s", "gyroid size=16", "-f", " ".join([operation, *words]), "-o", path], capture_output=True,
                          text=True)
    if done.returncode:
        with pytest.raises(sg.Error):  # then Python refuses it too
            raise sg.Error(done.stderr)
        pytest.fail(done.stderr)
    there = sg.read(path)
    assert there.keys() == here.keys()
    for name in here:
        assert here[name].tobytes() == there[name].tobytes()


def test_parameters_take_python_values(volume):
    ds = sg.uniform(volume)
    wanted = ds.contour(values=[5])["values"]
    for values in ((5,), np.array([5.0]), [np.float32(5)], [np.int64(5)], 5, 5.0, np.array(5)):
        assert np.array_equal(ds.contour(values=values)["values"], wanted)
    assert np.array_equal(ds.contour(values=[5], field=None)["values"], wanted)  # None: not stated
    with pytest.raises(TypeError, match="values"):
        ds.contour(values={})
    with pytest.raises(TypeError, match="values"):
        ds.contour(values=b"5")


def test_mistakes_name_what_where_and_what_would_be_right(volume):
    ds = sg.uniform(volume, name="T")
    with pytest.raises(AttributeError, match="did you mean 'contour'"):
        ds.contuor()
    with pytest.raises(AttributeError, match="did you mean 'gyroid'"):
        sg.gyriod()
    with pytest.raises(KeyError, match="did you mean 'values'") as e:
        ds.contour(value=[1])
    assert "unknown parameter" in e.value.what and isinstance(e.value, ValueError)
    with pytest.raises(KeyError, match="field 'P' not found"):
        ds["P"]
    with pytest.raises(ValueError, match="iterations") as e:
        ds.label_surface(iterations=-1)
    assert e.value.where


def test_further_inputs():
    a, b = sg.gyroid(size=8), sg.tangle(size=8)
    both = a.append(b)
    assert both.n_points == a.n_points + b.n_points
    assert sg.append(a, b).n_points == both.n_points


def test_data_keep_what_the_operation_that_made_them_chose():
    ds = sg.gyroid(size=8)
    (note,) = ds.contour().notes
    assert note.startswith("contour: gyroid = 0")
    assert ds.contour(values=[0.1]).notes == [] and ds.contour().normals().notes == []
    assert sg.uniform(np.zeros((2, 2, 2))).notes == []
    (note_of_nothing,) = ds.contour(values=[99]).notes
    assert "the field ranges from -1.46" in note_of_nothing
    with pytest.warns(sg.SightglassWarning) as heard:
        still = ds.with_field("u", np.full((512, 3), np.nan)).warp()
    assert [str(w.message) for w in heard] == still.notes[-1:] and "warp: 512 points" in still.notes[-1]
    both = sg.collection({"a": ds, "b": ds}).contour()
    assert both.notes == [note] and len(both.parts) == 2


def test_warnings_are_warnings_and_notes_are_logged(caplog):
    import logging

    with caplog.at_level(logging.INFO, "sightglass"):
        sg.gyroid(size=8).plot(size=(64, 48), show="volume")
    assert caplog.records
    nan = sg.uniform(np.full((3, 3, 3), np.nan, np.float32))
    with pytest.warns(sg.SightglassWarning):
        nan.plot(size=(64, 48), show="surface")

# SPDX-License-Identifier: Apache-2.0
"""Whatever the command line can do, Python does, to the same byte: every operation, every source, every way to show."""
import json
import pathlib
import subprocess

import numpy as np
import pytest
import sightglass as sg

PROGRAM = pathlib.Path(sg.__file__).parent.parent.parent / "sightglass"
CATALOG = json.loads(subprocess.run([PROGRAM, "ops", "--json"], capture_output=True, text=True, check=True).stdout)
OPERATIONS = {entry["name"]: entry for entry in CATALOG["operations"]}

# What an operation needs that the files below and its defaults do not give: what it runs on (a file, or a source and its parameters),
# operations before it, and its own parameters.
GYRE = ("double_gyre", {"size": 17})
LINES = [("streamlines", {})]
UNSTEADY = (GYRE, [], {"times": "0:1:3"})
NEEDS = {
    "calc": ("uniform", [], {"expr": "2*s"}), "select": ("uniform", [], {"keep": ["s", "v"]}), "extract": ("uniform", [], {"ids": [0, 3]}),
    "label_surface": ("labels", [], {}), "label_components": ("labels", [], {}), "morphology": ("labels", [], {}),
    "dice": ("labels", [], {"field": "label", "truth": "label"}), "region_grow": ("uniform", [], {"seeds": [0.5, 0.5, 0.5]}),
    "resize": ("uniform", [], {"dims": [4, 5, 6]}), "probe_at": ("uniform", [], {"from": [0, 0, 0], "to": [1, 1, 1]}),
    "profile": ("uniform", LINES, {}), "polylines": ("uniform", LINES, {}), "line_labels": ("uniform", LINES, {"field": "s"}),
    "trails": ("uniform", LINES, {}), "tubes": ("uniform", LINES, {}), "ribbons": ("uniform", LINES, {}),
    "closed_orbits": (GYRE, [], {}), "spot_noise": (GYRE, [], {}), "parallel_vectors": ("uniform", [], {"a": "v", "b": "w"}),
    "pathlines": UNSTEADY, "streaklines": UNSTEADY, "particles": UNSTEADY, "path_surface": UNSTEADY,
    "timelines": (GYRE, [], {"times": "0:1:3", "from": [0.2, 0.2, 0], "to": [1, 0.8, 0]}), "streak_surface": UNSTEADY, "time_surface": UNSTEADY, "tensor_fit": ("diffusion", [], {}),
    "shear_lines": (GYRE, [("ftle", {"times": "0:1:3"})], {}), "traction": ("uniform", [], {"normal": [0, 0, 1]}),
    "degenerate_points": ("uniform", [("slice", {"axis": "z"})], {}), "lic": (GYRE, [], {"resolution": 48}),
    "advect": (GYRE, [], {"resolution": 48}), "tensor_lic": ("surface", [], {"density": 40}), "surface_lic": ("surface", [], {"density": 40}),
    "resample": ("surface", [], {"size": 9}), "ftle": UNSTEADY,
}

def fields_on(mesh):
    x, y, z = mesh.points.T
    tensor = np.stack([1 + x, y, z, y, 2 + x * x, x, z, x, 3 - y], 1)
    fields = {"s": x * x + 2 * y + 0.3 * z, "v": np.stack([1 - y, x, 0.2 + 0 * z], 1), "w": np.stack([y, 1 - x, z * x], 1), "t": tensor}
    ds = mesh.with_fields(fields, on="points")
    return ds.with_field("label", np.arange(ds.n_cells) % 3, on="cells") if ds.n_cells else ds


def diffusion():
    """Signals of one tensor along seven directions, and without any."""
    to = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [0, 1, 1], [1, 0, 1], [1, -1, 0]], float)
    to[1:] /= np.linalg.norm(to[1:], axis=1)[:, None]
    b = np.where(to.any(1), 1000.0, 0.0)
    signals = 100 * np.exp(-b * (to**2 @ (1.7e-3, 4e-4, 3e-4)))
    grid = sg.uniform(np.broadcast_to(signals, (2, 2, 2, 8)).copy(), components=True, name="signal")
    return grid.with_field("bval", b, on="whole").with_field("bvec", to, on="whole")


@pytest.fixture(scope="session")
def files(tmp_path_factory):
    """One of each kind of mesh, with a scalar, two vectors, a tensor, and labels of the cells; a table; labels; diffusion images."""
    folder = tmp_path_factory.mktemp("parity")
    z, y, x = np.mgrid[0:4, 0:5, 0:6] / 3.0
    grid = sg.uniform(dims=(6, 5, 4), spacing=(1 / 3,) * 3)
    made = {
        "uniform.vti": fields_on(grid), "rectilinear.vtr": fields_on(sg.rectilinear(x[0, 0] ** 2, y[0, :, 0], z[:, 0, 0])),
        "curvilinear.vts": fields_on(sg.curvilinear(np.stack([x + 0.1 * y, y, z], -1))), "unstructured.vtu": fields_on(grid.unstructured()),
        "surface.vtp": fields_on(sg.sphere(size=6).contour(values=[0], normals=False)), "points.vtp": fields_on(sg.points(grid.points)),
        "table.csv": sg.table({"a": np.arange(8.0), "b": np.arange(8.0) ** 2}),
        "labels.vti": sg.uniform((x > 0.5).astype(np.uint8) + (y > 0.9), name="label"), "diffusion.vti": diffusion(),
    }
    for name, data in made.items():
        data.save(folder / name)
    return {name.partition(".")[0]: folder / name for name in made}


def words_of(name, params):
    return " ".join([name, *(f"{k}={','.join(map(str, v)) if isinstance(v, list) else v}" for k, v in params.items())])


def bytes_of(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


EXTENSIONS = {"uniform": "vti", "rectilinear": "vtr", "curvilinear": "vts", "unstructured": "vtu", "surface": "vtp", "points": "vtp",
              "table": "csv", "amr": "vtu", "collection": "vtm"}


def compare(data, words, folder):
    """The files that both write are the same."""
    here, there = folder / "here", folder / "there"
    here.mkdir(), there.mkdir()
    name = f"result.{EXTENSIONS[data.kind]}"
    data.save(here / name)
    subprocess.run([PROGRAM, "convert", *words, "-o", there / name, "--quiet"], check=True)
    assert bytes_of(here) and bytes_of(here) == bytes_of(there)


@pytest.mark.parametrize("name", OPERATIONS)
@pytest.mark.filterwarnings("ignore::sightglass.SightglassWarning")
def test_an_operation_gives_what_the_command_line_gives(name, files, tmp_path):
    entry = OPERATIONS[name]
    start, before, stated = NEEDS.get(name, (next(kind for kind in files if kind in entry["takes"][0]), [], {}))
    if isinstance(start, tuple):
        data, words = getattr(sg, start[0])(**start[1]), ["-s", words_of(*start)]
    else:
        data, words = sg.read(files[start]), [files[start]]
    for step, params in before:
        data, words = getattr(data, step)(**params), [*words, "-f", words_of(step, params)]
    others = [files["uniform"]] if entry["inputs"][0] == 2 else []
    result = getattr(data, name)(*map(sg.read, others), **stated)
    compare(result, [*words, "-f", words_of(name, stated) + "".join(f" with={path}" for path in others)], tmp_path)


@pytest.mark.parametrize("name", [entry["name"] for entry in CATALOG["sources"]])
def test_a_source_gives_what_the_command_line_gives(name, files, tmp_path):
    (source,) = (entry for entry in CATALOG["sources"] if entry["name"] == name)
    stated: dict = {small: 9 for small in ("size", "count") if small in source["params"]["properties"]}
    if name == "gradient_images":
        for i in range(3):
            sg.uniform(np.full((2, 2, 2), float(i)), name="signal").save(tmp_path / f"volume_{i}.vti")
        stated = {"path": str(tmp_path / "volume_*.vti")}
    compare(getattr(sg, name)(**stated), ["-s", words_of(name, stated)], tmp_path)


@pytest.mark.filterwarnings("ignore::sightglass.SightglassWarning")
@pytest.mark.parametrize("way", ["auto", *(entry["name"] for entry in CATALOG["show"])])
@pytest.mark.parametrize("kind", ["uniform", "unstructured", "surface", "points"])
def test_a_way_to_show_draws_what_the_command_line_draws(way, kind, files, tmp_path):
    command = [PROGRAM, "render", files[kind], *([] if way == "auto" else ["--show", way]), "--size", "96x72", "--quiet"]
    done = subprocess.run([*command, "-o", tmp_path / "there.png"], capture_output=True, text=True)
    if done.returncode:
        with pytest.raises(sg.Error) as refused:
            sg.read(files[kind]).plot(way, size=(96, 72))
        assert refused.value.what in done.stderr
        return
    picture = sg.read(files[kind]).plot(way, size=(96, 72))
    there = sg.read(tmp_path / "there.png")
    (name,) = there.keys()
    assert np.array_equal(there[name].reshape(72, 96, -1)[::-1], picture.array)

# SPDX-License-Identifier: Apache-2.0
"""The scripts of docs/python/gallery run and make pictures with something in them; the pages of docs/python hold what runs."""
import os
import pathlib
import re
import subprocess
import sys

import numpy as np
import pytest
import sightglass as sg

DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "python"


@pytest.mark.parametrize("script", sorted((DOCS / "gallery").glob("*.py")), ids=lambda p: p.stem)
def test_a_script_of_the_gallery_makes_its_picture(script, tmp_path):
    env = {**os.environ, "PYTHONPATH": str(pathlib.Path(sg.__file__).parent.parent.absolute())}
    done = subprocess.run([sys.executable, "-B", script], cwd=tmp_path, env=env, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    pictures = sorted(tmp_path.glob(script.stem + "*.png"))
    assert pictures
    for path in pictures:
        image = sg.read(path)
        pixels = image[image.keys()[0]]
        assert np.ptp(pixels.astype(int), axis=0).max() > 100 and sg.open(path).steps


def test_the_gallery_names_all_its_scripts():
    page = (DOCS / "gallery.md").read_text()
    assert sorted(re.findall(r"\]\(gallery/(\w+\.py)\)", page)) == sorted(p.name for p in (DOCS / "gallery").glob("*.py"))


def test_the_first_ten_minutes_run(tmp_path, monkeypatch):
    """The blocks of docs/python/README.md one after the other, on a file that stands for the reader's."""
    monkeypatch.chdir(tmp_path)
    sg.tissue_phantom(size=24).save("head.mhd")
    names: dict = {}
    for block in re.findall(r"```python\n(.*?)```", (DOCS / "README.md").read_text(), re.DOTALL):
        if ">>>" in block:
            continue
        exec(block.replace("orbit=360", "orbit=360, frames=3, size=(64, 48)").replace("1920, 1080", "96, 54"), names)  # noqa: S102
    assert (tmp_path / "head.png").exists() and (tmp_path / "turn.webm").exists() and (tmp_path / "0.5.png").exists()


def test_what_is_rewritten_from_pyvista_draws_and_is_shorter(tmp_path, monkeypatch):
    """Pairs of blocks in from_pyvista.md, of which ours run."""
    monkeypatch.chdir(tmp_path)
    page = (DOCS / "from_pyvista.md").read_text()
    topics = re.findall(r"^\*\*(\w+)\*\* \(PyVista (\d+), Sightglass (\d+)\)\n+```python\n(.*?)```\n+```python\n(.*?)```", page, re.MULTILINE | re.DOTALL)
    assert [topic[0] for topic in topics] == ["Volume", "Streamlines", "Clip"]
    z, y, x = np.mgrid[-1:1:32j, -1:1:32j, -1:1:32j]
    for topic, lines_there, lines_here, there, here in topics:
        assert (len(there.splitlines()), len(here.splitlines())) == (int(lines_there), int(lines_here)) and int(lines_here) < int(lines_there)
        mesh = sg.uniform(x * y + z, name="v").unstructured()
        exec(here, {"sg": sg, "np": np, "a": x * x + y * y + z, "u": np.stack([-y, x, 0.3 + 0 * z], -1), "mesh": mesh})  # noqa: S102
        picture = sg.read(f"{topic.lower()}.png")
        assert np.ptp(picture[picture.keys()[0]].astype(int)) > 100


def test_functions_that_the_tables_name_are_there():
    known = {*dir(sg), *dir(sg.gyroid(size=4)), "open", "plot", "render", "save", "movie", "camera", "picture", "add"}
    for page in ("from_pyvista.md", "from_yt_and_xarray.md", "data.md"):
        for line in (DOCS / page).read_text().splitlines():
            cells = line.split("|")
            ours = cells[-2] if len(cells) > 3 else ""
            for name in re.findall(r"\b(?:sg|ds|scene)\.(\w+)\(", ours):
                assert name in known, f"{page}: {name}"

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


def test_functions_that_the_tables_name_are_there():
    known = {*dir(sg), *dir(sg.gyroid(size=4)), "open", "plot", "render", "save", "movie", "camera", "picture", "add"}
    for page in ("from_pyvista.md", "from_yt_and_xarray.md", "data.md"):
        for line in (DOCS / page).read_text().splitlines():
            cells = line.split("|")
            ours = cells[-2] if len(cells) > 3 else ""
            for name in re.findall(r"\b(?:sg|ds|scene)\.(\w+)\(", ours):
                assert name in known, f"{page}: {name}"

# SPDX-License-Identifier: Apache-2.0
"""The notebooks of docs/python/notebooks run from their first cell to their last, and show pictures and tables."""
import base64
import os
import pathlib

import pytest
import sightglass as sg

NOTEBOOKS = sorted((pathlib.Path(__file__).resolve().parents[2] / "docs" / "python" / "notebooks").glob("*.ipynb"))


def executed(path, folder):
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    notebook = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(folder)}}).execute()
    return notebook


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_a_notebook_runs_and_shows_what_it_makes(path, tmp_path, monkeypatch):
    package = str(pathlib.Path(sg.__file__).parent.parent.absolute())
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, [package, os.environ.get("PYTHONPATH")])))
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    notebook = executed(path, tmp_path)
    shown = [output.get("data", {}) for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    pictures = [base64.b64decode(data["image/png"]) for data in shown if "image/png" in data]
    assert pictures and all(png.startswith(b"\x89PNG") for png in pictures)
    assert any("<table" in data.get("text/html", "") for data in shown)


def test_notebooks_are_kept_without_outputs():
    assert len(NOTEBOOKS) >= 2
    nbformat = pytest.importorskip("nbformat")
    for path in NOTEBOOKS:
        notebook = nbformat.read(path, as_version=4)
        nbformat.validate(notebook)
        assert all(not c.outputs and c.execution_count is None for c in notebook.cells if c.cell_type == "code")

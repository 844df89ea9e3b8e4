# SPDX-License-Identifier: Apache-2.0
"""What wrap() takes without another library; each library has a file of its own beside this one."""
import subprocess
import sys

import pytest
import sightglass as sg


def test_data_and_arrays_are_taken_and_others_refused(volume):
    ds = sg.uniform(volume)
    assert sg.wrap(ds) is ds
    assert sg.wrap(volume, name="v")["v"].__array_interface__["data"] == (volume.__array_interface__["data"][0], True)
    with pytest.raises(sg.UsageError, match="builtins.dict are not known"):
        sg.wrap({})


def test_other_libraries_are_not_imported_before_they_are_needed():
    code = "import sys, sightglass; print([m for m in ('vtkmodules', 'xarray', 'pandas', 'meshio', 'nibabel', 'IPython') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-B", "-c", code], capture_output=True, text=True, check=True,
                          env={"PYTHONPATH": str(__import__("pathlib").Path(sg.__file__).parent.parent.absolute())}).stdout.strip() == "[]"

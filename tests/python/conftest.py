# SPDX-License-Identifier: Apache-2.0
import pathlib
import sys

import numpy as np
import pytest

sys.dont_write_bytecode = True

import sightglass as sg  # noqa: E402  after no folder is to be made beside the sources


@pytest.fixture
def volume():
    """x + 2 y + 3 z on 6 x 5 x 4 points, indexed [z, y, x]."""
    z, y, x = np.mgrid[0:4, 0:5, 0:6].astype(np.float32)
    return np.ascontiguousarray(x + 2 * y + 3 * z)


@pytest.fixture
def tetra():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], float)
    return sg.unstructured(points, {"tetra": [[0, 1, 2, 3], [1, 2, 3, 4]]})


@pytest.fixture
def program():
    """The command line of the same build."""
    return pathlib.Path(sg.__file__).parent.parent.parent / "sightglass"

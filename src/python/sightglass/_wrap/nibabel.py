# SPDX-License-Identifier: Apache-2.0
"""nibabel's images, in the patient's frame that scans have here: x to the left, y to the back, z to the head (LPS). NIfTI's is RAS."""
from __future__ import annotations

from typing import Any

import numpy as np

from .. import _meshes
from .._data import Data
from .._errors import usage


def wrapped(x: Any, **hints: Any) -> Data:
    """An image as a grid; further axes as components."""
    if hints:
        raise usage(f"'{next(iter(hints))}' is no hint for images of nibabel", "wrap", "slice it before: image.slicer[..., 0]")
    if not hasattr(x, "affine") or not hasattr(x, "dataobj"):
        raise usage(f"{type(x).__name__} is not known", "wrap", "images with an affine map are")
    values = np.asanyarray(x.dataobj)
    while values.ndim < 3:
        values = values[..., None]
    several = values.ndim > 3 and int(np.prod(values.shape[3:])) > 1
    values = values.reshape(*values.shape[:3], -1) if several else values.reshape(values.shape[:3])
    to_lps = np.diag([-1.0, -1.0, 1.0])
    columns, origin = to_lps @ x.affine[:3, :3], to_lps @ x.affine[:3, 3]
    spacing = np.linalg.norm(columns, axis=0)
    if not (spacing > 0).all() or not np.isfinite(columns).all():
        raise usage("its affine map is singular", "wrap", "one whose columns span space")
    data = _meshes.uniform(values, order="xyz", components=several, spacing=spacing, origin=origin, direction=columns / spacing, name="values")
    return data

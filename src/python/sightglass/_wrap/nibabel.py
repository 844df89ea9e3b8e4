# SPDX-License-Identifier: Apache-2.0
"""Images of nibabel as data, in the frame of the patient that all scans have here: x to the left, y to the back, z to the head (LPS).

nibabel's affines lead to RAS, so x and y change their signs. Values, components and times are those that sg.read gives for the same file.
"""
from __future__ import annotations

import os
from typing import Any

import numpy as np

from .._data import Data
from .._errors import say, usage
from .._meshes import uniform
from .shared import over_time

_vector_intents = range(1003, 1008)
_symmetric, _general, _displacement = 1005, 1004, 1006
_full_matrix = (0, 1, 3, 1, 2, 4, 3, 4, 5)  # of xx xy yy xz yz zz


def wrap(x: Any, /, time: float | None = None, components: bool | None = None) -> Data:
    """An image with an affine map as a uniform grid, its values used where they lie (mapped from the file, if it is not packed or scaled).

    The fourth axis is time: the result is a series, or with ``time`` the step nearest to it. Where the header says that it holds vectors,
    or with ``components=True``, it holds components, as the fifth does; False: never.
    """
    if getattr(x, "affine", None) is None or not hasattr(x, "dataobj"):
        raise usage(f"a nibabel.{type(x).__name__} has no affine map", "wrap", "an image of voxels (NIfTI, MGH, MINC, ...)")
    shape = tuple(x.shape)
    if not 1 <= len(shape) <= 7 or 0 in shape:
        raise usage(f"its voxels are {shape}", "wrap", "one to seven axes, none of them empty")
    steps, blocks = (shape[3] if len(shape) > 3 else 1), int(np.prod(shape[4:], dtype=np.int64))
    if steps > 1 and (components if components is not None else _holds_vectors(x, steps, blocks)):
        steps, blocks = 1, steps * blocks
    times = _times(x, steps)

    def step(i: int) -> Data:
        return _grid(x, i, steps, blocks)

    if time is not None:
        if steps < 2:
            raise usage(f"time={time}, but there is one volume", "wrap", "no time")
        return step(int(np.argmin(np.abs(times - time))))
    return over_time(times, step, "wrap: fourth axis") if steps > 1 else step(0)


def _intent(x: Any) -> int:
    return int(x.header["intent_code"]) if _has(x.header, "intent_code") else 0


def _has(header: Any, key: str) -> bool:
    return hasattr(header, "keys") and key in header.keys()


def _holds_vectors(x: Any, steps: int, blocks: int) -> bool:
    """By the intent; else three volumes of floats without b-values beside the file (FSL's directions)."""
    if blocks > 1 or x.get_data_dtype().kind not in "iuf":
        return False
    if _intent(x) in _vector_intents:
        return True
    return steps == 3 and x.get_data_dtype().kind == "f" and not _has_b_values(_stem(x), steps)


def _has_b_values(stem: str, steps: int) -> bool:
    if not stem:
        return False
    for path in (stem + ".bval", stem + ".bvals", os.path.join(os.path.dirname(stem), "bvals")):
        if os.path.exists(path):
            with open(path, errors="replace") as file:
                return len(file.read(1 << 20).split()) == steps
    return False


def _stem(x: Any) -> str:
    path = x.get_filename() or ""
    path = path[:-3] if path.lower().endswith(".gz") else path
    return os.path.splitext(path)[0]


def _times(x: Any, steps: int) -> np.ndarray:
    """In the file's own unit, as sg.times gives them."""
    zooms = x.header.get_zooms() if hasattr(x.header, "get_zooms") else ()
    each = float(zooms[3]) if len(zooms) > 3 and np.isfinite(zooms[3]) and zooms[3] > 0 else 1.0
    first = float(x.header["toffset"]) if _has(x.header, "toffset") else 0.0
    return (first if np.isfinite(first) else 0.0) + np.arange(steps) * each


def _grid(x: Any, step: int, steps: int, blocks: int) -> Data:
    part = (slice(None),) * 3 + (step,) if steps > 1 else ()
    values = _values(x, part)
    if values.dtype.names:  # colours
        values = np.ascontiguousarray(values.T).view(np.uint8).reshape(*values.shape[::-1], len(values.dtype.names))
        return _placed(x, values, "zyx", True)
    if values.dtype.kind == "c":
        values = np.ascontiguousarray(values.T)
        return _placed(x, values.view(values.real.dtype).reshape(*values.shape, 2), "zyx", True)
    spatial = (tuple(x.shape) + (1, 1))[:3]
    if blocks == 1:
        return _placed(x, values.reshape(spatial, order="F"), "xyz", False)
    say(False, "wrap: copied, components lie apart")
    rows = values.reshape(*spatial, blocks, order="F").transpose(2, 1, 0, 3)
    return _placed(x, _turned(x, np.ascontiguousarray(rows)), "zyx", True)


def _values(x: Any, part: tuple[Any, ...]) -> np.ndarray:
    """As stored, or slope * stored + intercept: in f32 where that holds all digits of what is stored, else in f64."""
    stored = x.dataobj
    if not hasattr(stored, "get_unscaled"):
        return np.asanyarray(stored)[part]
    if (float(stored.slope), float(stored.inter)) != (1.0, 0.0) and stored.dtype.kind in "iuf":
        wide = stored.dtype.itemsize > 4 or (stored.dtype.kind in "iu" and stored.dtype.itemsize == 4)
        return np.asanyarray(stored[part]).astype(np.float64 if wide else np.float32)
    if part == () or not str(x.get_filename()).lower().endswith(("z", "z2")):
        return np.asanyarray(stored.get_unscaled())[part]  # mapped from the file
    return np.asanyarray(stored[part])  # unpacks no more than this step


def _turned(x: Any, values: np.ndarray) -> np.ndarray:
    """Vectors and tensors that are measured along the axes of RAS, in LPS."""
    intent, n = _intent(x), values.shape[-1]
    if intent == _symmetric and n == 6:
        values, n = values[..., _full_matrix], 9
    sign = np.array([-1, -1, 1])
    if intent in (_symmetric, _general) and n == 9:
        return values * np.outer(sign, sign).reshape(-1).astype(_real(values))
    if intent in (_symmetric, _general, _displacement) and n == 3:
        return values * sign.astype(_real(values))
    if intent == 0 and n == 3 and _stem(x).endswith(("_V1", "_V2", "_V3")):  # FSL: along the axes of the voxels, with x to the left
        m = _placing(x)[2].copy()
        if np.linalg.det(m) > 0:
            m[:, 0] = 0 - m[:, 0]
        say(False, "wrap: directions as FSL names them, along the voxels' axes; turned into the patient's")
        return (values.astype(np.float64) @ m.T).astype(_real(values))
    return values


def _real(values: np.ndarray) -> Any:
    return np.float32 if values.dtype.itemsize <= (4 if values.dtype.kind == "f" else 2) else np.float64


def _placing(x: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Spacing, origin and direction. A NIfTI header that gives no orientation means none: no axis is turned then."""
    if _has(x.header, "sform_code") and int(x.header["sform_code"]) <= 0 and int(x.header["qform_code"]) <= 0:
        sizes = [float(abs(h)) if np.isfinite(h) and h != 0 else 1.0 for h in (*x.header.get_zooms()[:3], 1, 1)[:3]]
        return np.array(sizes), np.zeros(3), np.eye(3)
    if _has(x.header, "orient") and not _has(x.header, "sform_code") and np.array_equal(x.affine, x.header.get_best_affine()):
        return np.array([abs(float(h)) or 1.0 for h in (*x.header.get_zooms()[:3], 1, 1)[:3]]), np.zeros(3), _analyze_axes(x)
    flip = np.array([-1.0, -1.0, 1.0])
    columns, origin = flip[:, None] * x.affine[:3, :3], flip * x.affine[:3, 3]
    spacing = np.linalg.norm(columns, axis=0)
    if not np.isfinite(x.affine).all() or not (spacing > 0).all() or abs(np.linalg.det(columns / spacing)) < 1e-9:
        raise usage(f"its affine map {x.affine[:3].tolist()} does not span space", "wrap", "three columns in different directions")
    return spacing, origin + 0.0, columns / spacing + 0.0


def _analyze_axes(x: Any) -> np.ndarray:
    """Analyze has no affine map, and nibabel's is a guess: as the header's byte for the orientation says, rows to the left by default."""
    left, right, back, front, up, down = np.eye(3)[0], -np.eye(3)[0], np.eye(3)[1], -np.eye(3)[1], np.eye(3)[2], -np.eye(3)[2]
    axes = [(left, front, up), (left, up, front), (front, up, left), (left, back, up), (left, down, front), (front, up, right)]
    orient = int.from_bytes(bytes(x.header["orient"].tobytes()[:1]), "little")
    return np.stack(axes[orient if orient < 6 else 0], axis=1) + 0.0


def _placed(x: Any, values: np.ndarray, order: str, components: bool) -> Data:
    spacing, origin, direction = _placing(x)
    return uniform(values, spacing=spacing, origin=origin, direction=direction, order=order, components=components, name="values")

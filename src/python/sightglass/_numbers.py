# SPDX-License-Identifier: Apache-2.0
"""Which numpy arrays can be used as they lie, and copies of those that cannot."""
from __future__ import annotations

import numpy as np

from ._errors import say, usage

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def lent(used: np.ndarray, given: Any) -> Any:
    """Used and given together, where one is a view of the other: both are read-only while data hold them."""
    return (used, given) if used is not given and isinstance(given, np.ndarray) and np.may_share_memory(used, given) else used


def known(array: Any, what: str) -> np.ndarray:
    """As numbers of a type that the library knows: bool as u8, half floats as f32, this machine's byte order."""
    if isinstance(array, np.ma.MaskedArray) and np.ma.is_masked(array):
        say(False, f"{what}: copied, {int(array.mask.sum())} masked values become NaN")
        array = np.ma.filled(array.astype(np.promote_types(array.dtype, np.float32)), np.nan)
    if hasattr(array, "__dlpack__") and not hasattr(array, "__array__") and not hasattr(array, "__array_interface__"):
        array = np.from_dlpack(array)
    a = np.asarray(array)
    kind, size = a.dtype.kind, a.dtype.itemsize
    if kind == "b":
        return a.view(np.uint8)
    if kind not in "iuf":
        raise usage(f"its values are {a.dtype}", what, "whole numbers and floats are known; complex ones as two components")
    wanted = a.dtype
    if kind == "f" and size == 2:
        wanted = np.dtype(np.float32)
    elif kind == "f" and size > 8:
        wanted = np.dtype(np.float64)
    if not wanted.isnative:
        wanted = wanted.newbyteorder("=")
    if wanted != a.dtype:
        say(False, f"{what}: copied, {a.dtype} becomes {wanted}")
        return a.astype(wanted)
    if not a.flags.aligned:
        say(False, f"{what}: copied, its numbers do not lie on whole multiples of their size")
        return a.copy()
    return a


def tuples(array: Any, what: str) -> np.ndarray:
    """One dimension for single numbers, two for tuples, which may lie apart but not inside each other."""
    a = known(array, what)
    if a.ndim == 0 or a.ndim > 2:
        raise usage(f"it has {a.ndim} dimensions", what, "one value, or one row of components, for each point or cell")
    size = a.dtype.itemsize
    components = a.shape[1] if a.ndim == 2 else 1
    inside = a.ndim == 1 or components <= 1 or a.strides[1] == size
    apart = a.shape[0] < 2 or (a.strides[0] >= components * size and a.strides[0] % size == 0)
    if inside and apart:
        return a
    say(False, f"{what}: copied, its numbers lie {a.strides} bytes apart")
    return np.ascontiguousarray(a)


def whole(array: Any, what: str) -> np.ndarray:
    """Point numbers: i32 or i64, one after the other."""
    a = known(array, what)
    if a.dtype.kind == "f":
        raise usage(f"its values are {a.dtype}", what, "point numbers are whole")
    if a.dtype not in (np.int32, np.int64):
        say(False, f"{what}: copied, {a.dtype} becomes int64")
        a = a.astype(np.int64)
    if not a.flags.c_contiguous:
        say(False, f"{what}: copied, its numbers do not lie one after the other")
        a = np.ascontiguousarray(a)
    return a.reshape(-1)


def on_grid(array: Any, order: str, what: str, components: bool = False) -> tuple[tuple[int, int, int], np.ndarray]:
    """The dims (x, y, z) and the values with x fastest of an array of one to three axes, and one more for components.

    ``order``: how the axes are named, "zyx" (the last is x, as image libraries have it) or "xyz" (the first is x). C order suits the first
    and Fortran order the second; others are copied.
    """
    a = known(array, what)
    if order not in ("zyx", "xyz"):
        raise usage(f"order='{order}' is not known", what, "'zyx' (the last axis is x) or 'xyz' (the first one is)")
    axes = a.ndim - (1 if components else 0)
    if not 1 <= axes <= 3:
        raise usage(f"it has {a.ndim} dimensions", what, "one to three axes" + (" and one of components" if components else ""))
    last = (axes,) if components else ()
    if order == "xyz":
        a = a.transpose(*range(axes - 1, -1, -1), *last)
    nx, ny, nz = tuple(reversed(a.shape[:axes])) + (1,) * (3 - axes)
    if not a.flags.c_contiguous:
        say(False, f"{what}: copied, x is not the fastest axis; order='{'xyz' if order == 'zyx' else 'zyx'}' may be meant")
        a = np.ascontiguousarray(a)
    return (nx, ny, nz), a.reshape(-1, a.shape[-1]) if components else a.reshape(-1)

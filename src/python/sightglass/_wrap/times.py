# SPDX-License-Identifier: Apache-2.0
"""Times of the calendar as numbers: seconds since 1970, as other programs count them."""
from __future__ import annotations

from typing import Any

import numpy as np


def seconds(times: Any) -> np.ndarray:
    """Of datetime64; NaN for what is no time. Microseconds survive, as far as doubles tell them apart (until 2106)."""
    a = np.asarray(times)
    days = a.astype("M8[D]")  # apart from the rest: all nanoseconds in one double would lose some
    rest = (a - days).astype("m8[ns]").astype(np.int64) * 1e-9
    return np.where(np.isnat(a), np.nan, days.astype(np.int64) * 86400.0 + rest)


def durations(times: Any) -> np.ndarray:
    """Of timedelta64, in seconds; NaN for what is none."""
    a = np.asarray(times)
    return np.where(np.isnat(a), np.nan, a.astype("m8[ns]").astype(np.int64) * 1e-9)


def numbers_of(values: Any) -> np.ndarray | None:
    """Of datetime64, timedelta64 and cftime's dates in seconds; None for anything else."""
    a = np.asarray(values)
    if a.dtype.kind == "M":
        return seconds(a)
    if a.dtype.kind == "m":
        return durations(a)
    if a.dtype.kind == "O" and a.size and all(hasattr(t, "calendar") and hasattr(t, "timetuple") for t in a.flat):
        return np.array([(t - type(t)(1970, 1, 1)).total_seconds() for t in a.flat]).reshape(a.shape)
    return None

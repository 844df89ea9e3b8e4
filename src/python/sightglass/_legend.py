# SPDX-License-Identifier: Apache-2.0
"""What the legends of a picture say."""
from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Entry(NamedTuple):
    """One label in a legend."""

    value: float
    #: "" where only the number is known.
    name: str
    #: sRGB, 0 to 255.
    color: tuple[int, int, int]


class Legend(NamedTuple):
    """What a legend says of a field."""

    title: str
    unit: str
    #: How values are mapped to colours: "linear", "log" or "symlog".
    scale: str
    #: The values at the two ends of the bar.
    range: tuple[float, float]
    #: (256, 3) bytes, sRGB, evenly along the bar; (0, 3) where there are entries.
    colors: np.ndarray
    #: Of labels and bands of values.
    entries: list[Entry]
    #: (n, 2): of volumes the opacity over values, linear in between.
    opacity: np.ndarray

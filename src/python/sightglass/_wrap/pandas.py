# SPDX-License-Identifier: Apache-2.0
"""pandas' frames are tables."""
from __future__ import annotations

from typing import Any

import numpy as np

from .. import _groups
from .._data import Data
from .._errors import usage


def wrapped(x: Any, **hints: Any) -> Data:
    """Numbers as they are, text and categories as words, times as seconds since 1970; an index that says something is the first column."""
    import pandas as pd

    if hints:
        raise usage(f"'{next(iter(hints))}' is no hint for frames", "wrap", "they need none")
    frame = x.to_frame() if isinstance(x, pd.Series) else x
    if not isinstance(frame, pd.DataFrame):
        raise usage(f"{type(x).__name__} is not known", "wrap", "frames and series of pandas are")
    if not isinstance(frame.index, pd.RangeIndex):
        frame = frame.reset_index()
    columns, units = {}, {}
    for name, values in frame.items():
        if pd.api.types.is_datetime64_any_dtype(values):
            seconds = values.to_numpy("datetime64[ns]").astype(np.int64) / 1e9
            columns[str(name)], units[str(name)] = np.where(values.isna(), np.nan, seconds), "s"
        elif pd.api.types.is_numeric_dtype(values) and not pd.api.types.is_complex_dtype(values):
            plain = values.to_numpy(float, na_value=np.nan) if pd.api.types.is_extension_array_dtype(values) else values.to_numpy()
            columns[str(name)] = plain
        else:
            columns[str(name)] = [None if pd.isna(v) else str(v) for v in values]
    return _groups.table(columns, units)


def to_pandas(data: Data) -> Any:
    """A frame of a table; of other data one row per point: x, y, z and the point fields, the components of a field one by one."""
    import pandas as pd

    columns: dict[str, Any] = {}
    if data.kind != "table":
        columns = {axis: data.points[:, i] for i, axis in enumerate("xyz")}
    for name in data.keys():
        if data.kind != "table" and data.on(name) != "points":
            continue
        values = data[name]
        if values.ndim == 1:
            columns[name] = values
        else:
            columns.update({f"{name}_{i}": values[:, i] for i in range(values.shape[1])})
    return pd.DataFrame(columns)

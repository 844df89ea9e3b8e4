# SPDX-License-Identifier: Apache-2.0
"""Frames of pandas as tables, and data as frames."""
from __future__ import annotations

from typing import Any, Mapping

import numpy as np

from .._data import Data
from .._errors import say, usage
from .._groups import table
from .shared import fields_of, meshes_only, needed, unused
from .times import durations, seconds


def wrap(x: Any, /, units: Mapping[str, str] | None = None, index: bool | None = None) -> Data:
    """A table: columns of numbers, words (strings, categories), times (as seconds since 1970).

    Columns of numbers are used where pandas holds them; it keeps those of one type together, so all of them are read-only meanwhile.
    ``units`` by column; else those in ``frame.attrs["units"]``. ``index``: as columns; default: where it is more than row numbers.
    """
    pandas = needed("pandas", "wrap")
    frame = x.to_frame() if isinstance(x, pandas.Series) else x
    if not isinstance(frame, pandas.DataFrame):
        raise usage(f"a pandas.{type(x).__name__} is no table", "wrap", "a DataFrame or a Series")
    if not frame.shape[1] and not index:
        raise usage("the frame has no columns", "wrap", "one column or more")
    if index or (index is None and not isinstance(frame.index, pandas.RangeIndex)):
        names = [f"level {i}" if n is None else str(n) for i, n in enumerate(frame.index.names)]
        if frame.index.nlevels == 1 and frame.index.name is None:
            names = ["index"]
        taken = {_name(n) for n in frame.columns}
        levels = [(unused(n, lambda u: u in taken), frame.index.get_level_values(i)) for i, n in enumerate(names)]
    else:
        levels = []
    stated = dict(frame.attrs.get("units", {}), **(units or {}))
    columns: dict[str, Any] = {}
    for name, values in [*levels, *((_name(frame.columns[i]), frame.iloc[:, i]) for i in range(frame.shape[1]))]:
        if name in columns:
            raise usage(f"two columns are named '{name}'", "wrap", "a name of its own for each column: frame.columns = [...]")
        columns[name], unit = _column(values, f"wrap '{name}'")
        stated.setdefault(name, unit)
    for name, parts in frame.attrs.get("components", {}).items():
        _join(columns, stated, str(name), [str(p) for p in parts])
    return table(columns, {n: u for n, u in stated.items() if n in columns})


def _name(column: Any) -> str:
    return "/".join(str(level) for level in column if str(level)) if isinstance(column, tuple) else str(column)


def _join(columns: dict[str, Any], units: dict[str, str], name: str, parts: list[str]) -> None:
    """Columns that to_pandas made of one column of rows become one again."""
    if name in columns or not all(p in columns and np.asarray(columns[p]).dtype.kind in "iuf" for p in parts):
        return
    units[name] = units.get(parts[0], "")
    columns[name] = np.column_stack([columns.pop(p) for p in parts])


def _column(values: Any, where: str) -> tuple[Any, str]:
    """Numbers or words as table() takes them, and the unit that follows from their type."""
    kind = values.dtype
    if hasattr(kind, "categories") and not hasattr(kind, "closed"):
        names = [None if c != c else str(c) for c in kind.categories]
        codes = values.cat.codes if hasattr(values, "cat") else values.codes
        return np.array([names[c] if c >= 0 else None for c in codes], object), ""
    if kind.kind == "M":
        return seconds(_plain_times(values)), "s"
    if kind.kind == "m":
        return durations(values.to_numpy()), "s"
    if isinstance(kind, np.dtype) and kind.kind in "iufb":
        return values.to_numpy(), ""
    if kind.kind in "iufb":  # types of pandas that know missing values
        if values.isna().any():
            say(False, f"{where}: copied, missing values become NaN")
            return values.to_numpy(dtype=np.float64, na_value=np.nan), ""
        return values.to_numpy(dtype=kind.numpy_dtype), ""
    return _words(values, where), ""


def _plain_times(values: Any) -> np.ndarray:
    """Of a time zone those of UTC."""
    aware = getattr(values.dtype, "tz", None) is not None
    if aware:
        values = values.dt.tz_convert(None) if hasattr(values, "dt") else values.tz_convert(None)
    return values.to_numpy()


def _words(values: Any, where: str) -> np.ndarray:
    missing = np.asarray(values.isna())
    words = np.array([None if gone else v for v, gone in zip(values.to_numpy(dtype=object), missing)], object)
    for row, v in enumerate(words):
        if v is not None and not isinstance(v, str):
            raise usage(f"row {row} holds a {type(v).__name__}", where,
                        "numbers, words, categories or times; .astype(str) makes words of anything")
    return words


def to_pandas(data: Data, on: str = "points") -> Any:
    """A DataFrame: the columns of a table; of a mesh a row for each point (with x, y and z) or cell.

    Numbers are views where pandas allows it, and read-only then. Rows of numbers become the columns "v_0", "v_1", ... Times of the calendar
    stay seconds since 1970: pandas.to_datetime(frame["t"], unit="s"). ``frame.attrs`` keeps the units ("units") and which columns belong
    together ("components").
    """
    pandas = needed("pandas", "to_pandas")
    columns: dict[str, Any] = {}
    units: dict[str, str] = {}
    together: dict[str, list[str]] = {}
    if data.kind == "table":
        found = [(name, _of_words(data, name) if data._core.words(name) else data[name], data.unit(name)) for name in data.keys()]
    else:
        meshes_only(data, "to_pandas", "one part of it: data.parts[name].to_pandas()")
        if on not in ("points", "cells"):
            raise usage(f"on='{on}' is not known", "to_pandas", "'points' or 'cells'")
        found = [(f.name, f.values, f.unit) for f in fields_of(data) if f.on == on]
        if on == "points":
            found[:0] = [(letter, data.points[:, i], "") for i, letter in enumerate("xyz")]
    for name, values, unit in found:
        name = unused(name, lambda n: n in columns)
        if values.ndim == 2:
            together[name] = [unused(f"{name}_{i}", lambda n: n in columns) for i in range(values.shape[1])]
            for i, part in enumerate(together[name]):
                columns[part], units[part] = values[:, i], unit
        else:
            columns[name], units[name] = values, unit
    frame = pandas.DataFrame({n: pandas.Series(c, copy=False) for n, c in columns.items()}, copy=False)
    if not columns and data.kind != "table":
        frame = pandas.DataFrame(index=range(data.n_cells))
    frame.attrs["units"] = {n: u for n, u in units.items() if u}
    if together:
        frame.attrs["components"] = together
    return frame


def _of_words(table: Data, column: str) -> np.ndarray:
    """None where there is none: its number is -1."""
    return np.array([*table._core.words(column), None], object)[table._core.field(column)[3]]

# SPDX-License-Identifier: Apache-2.0
"""How data look in notebooks: what they are, their fields, and a small picture; tables as tables."""
from __future__ import annotations

import base64
import warnings
from html import escape
from typing import TYPE_CHECKING, Any, Iterable

import numpy as np

if TYPE_CHECKING:
    from ._data import Data

_rows_shown = 10
_thumbnail = (320, 240)
_most_cells = 20_000_000  # a picture of more would keep the reader waiting


def page_of(data: Data) -> str:
    """HTML."""
    head = f"<b>{escape(data._core.summary())}</b>"
    if data.kind == "table":
        return head + _rows_of(data)
    if data.kind == "collection":
        return _beside(head + _table(("part", "kind"), ((name, part._core.summary()) for name, part in data.parts.items())), data)
    cells = []
    for name, on, unit, array in data._core.fields():
        components = array.shape[1] if array.ndim == 2 else 1
        lo, hi = data.range(name) if array.size else (np.nan, np.nan)
        kind = f"{array.dtype}" + (f" x{components}" if components > 1 else "")
        cells.append((name, on, kind, f"{lo:.6g} .. {hi:.6g}", unit))
    return _beside(head + _table(("field", "on", "type", "range", "unit"), cells), data)


def _table(head: Iterable[Any], rows: Iterable[Iterable[Any]]) -> str:
    def line(tag: str, values: Iterable[Any]) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(str(v))}</{tag}>" for v in values) + "</tr>"

    return "<table>" + line("th", head) + "".join(line("td", row) for row in rows) + "</table>"


def _rows_of(table: Data) -> str:
    names = table.keys()
    if not names:
        return ""
    columns = [table[n] for n in names]
    count = len(columns[0])
    heads = [f"{n} [{table.unit(n)}]" if table.unit(n) else n for n in names]

    def cell(v: Any) -> str:
        return f"{v:.6g}" if isinstance(v, (float, np.floating)) else str(v)

    rows = [[cell(c[i]) for c in columns] for i in range(min(count, _rows_shown))]
    more = f"<p>... {count - _rows_shown} more rows</p>" if count > _rows_shown else ""
    return _table(heads, rows) + more


def _beside(text: str, data: Data) -> str:
    """With a small picture; without one where none can be made: that is no reason not to say what the data are."""
    if not 0 < data.n_points <= _most_cells:
        return text
    from ._errors import Error

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            png = data.plot(size=_thumbnail, picture={"triad": False})._repr_png_()
    except Error:
        return text
    image = f'<img src="data:image/png;base64,{base64.b64encode(png).decode()}" width="{_thumbnail[0]}">'
    return f'<div style="display: flex; gap: 1em"><div>{text}</div>{image}</div>'

# SPDX-License-Identifier: Apache-2.0
"""What holds several: collections, tables, levels of patches, series over time."""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from . import _core
from ._data import Data
from ._errors import usage
from ._meshes import _three
from ._numbers import known, lent, tuples

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def collection(parts: Mapping[str, Data] | Sequence[Data]) -> Data:
    """Data side by side, by name: collection({"wing": wing, "flow": flow}); without names they are numbered."""
    named = parts.items() if isinstance(parts, Mapping) else ((str(i), part) for i, part in enumerate(parts))
    return Data(_core.collection([(str(name), part._core) for name, part in named]))


def table(columns: Mapping[str, Any], units: Mapping[str, str] | None = None) -> Data:
    """Columns of equal length by name, of numbers (or rows of them) or words: table({"t": times, "site": ["north", "south", ...]}).

    None and "" among words mean that there is none.
    """
    made = []
    for name, values in columns.items():
        a = np.asarray(values)
        words: list[str] = []
        if a.dtype.kind in "UO" and a.ndim == 1 and all(v is None or isinstance(v, str) for v in a.tolist()):
            words = list(dict.fromkeys(v for v in a.tolist() if v))
            place = {word: i for i, word in enumerate(words)}
            numbers: Any = np.array([place.get(v, -1) for v in a.tolist()], np.int32)
        else:
            numbers = lent(tuples(values, f"table '{name}'"), values)
        made.append((str(name), numbers, (units or {}).get(name, ""), words))
    return Data(_core.table(made))


def amr(levels: Sequence[tuple[Any, Sequence[tuple[Any, Any]]]], *, origin: Any = (0, 0, 0), name: str = "values", unit: str = "",
        order: str = "zyx") -> Data:
    """Patches of cells that refine each other: amr([(1.0, [((0, 0, 0), density)]), (0.5, [((8, 8, 8), finer)])]).

    ``levels``, coarse to fine: the length of their cells (one number, or one for each of x, y and z), and patches. A patch: its first cell
    (along x, y and z, counted at its level from the origin), and an array with the values of its cells, or several by name. ``order`` is
    that of uniform(). Arrays of two axes make a flat grid. Values are copied.
    """
    placed, values = [], {}  # type: ignore[var-annotated]
    flat = None
    for number, (spacing, patches) in enumerate(levels):
        boxes = []
        for first, arrays in patches:
            shape = None
            for field, array in (arrays if isinstance(arrays, Mapping) else {name: arrays}).items():
                a = known(array, f"amr '{field}'")
                if a.ndim not in (2, 3) or (flat is not None and flat != (a.ndim == 2)):
                    raise usage(f"an array of {a.ndim} axes at level {number}", f"amr '{field}'", "all have three axes, or all two")
                flat = a.ndim == 2
                a = a if order == "zyx" else a.T
                if shape is not None and shape != a.shape:
                    raise usage(f"patches of shape {shape} and {a.shape} in one place", f"amr '{field}'", "the same cells for every field")
                shape = a.shape
                values.setdefault(field, []).append(np.ascontiguousarray(a).reshape(-1))
            if shape is None:
                raise usage(f"a patch of level {number} has no values", "amr", "an array, or arrays by name")
            size = (*reversed(shape), 1)[:3]
            lo = [int(i) for i in (*np.asarray(first).reshape(-1), 0)[:3]]
            boxes.append((lo, [i + n - 1 for i, n in zip(lo, size)]))
        lengths = np.full(3, spacing, float) if np.ndim(spacing) == 0 else np.array((*spacing, 0)[:3], float)
        placed.append((tuple(lengths * (1, 1, 0 if flat else 1)), boxes))
    data = _core.amr_grid(placed, _three((*np.asarray(origin).reshape(-1), 0)[:3], "origin"))
    for field, arrays in values.items():
        data = data.with_field(field, "cells", np.concatenate(arrays), unit)
    return Data(data)


def series(times: Sequence[float], load: Callable[[int], Data]) -> Data:
    """Data over time, made when they are needed: series([0, 0.5, 1], lambda i: sg.uniform(np.load(f"T{i}.npy"))).

    ``load`` is given the number of a step, from 0, and gives the same data each time; nothing of them is kept. The result is the first
    step; operations that follow time (pathlines), films, ``at(time)`` and ``times`` see all. What ``load`` raises ends what asked for it.
    """
    def step(number: int) -> _core.Data:
        data = load(number)
        if not isinstance(data, Data):
            raise usage(f"load({number}) gave {type(data).__name__}", "series", "data: sightglass.uniform(array), sightglass.wrap(object), ...")
        return data._core

    return Data(_core.series([float(t) for t in times], step))

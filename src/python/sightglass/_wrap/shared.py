# SPDX-License-Identifier: Apache-2.0
"""What the conversions share: fields one by one, places in lists, libraries that are asked for late."""
from __future__ import annotations

from importlib import import_module
from typing import Any, Callable, Iterable, NamedTuple

import numpy as np

from .._data import Data
from .._errors import say, usage
from .._groups import series


class Field(NamedTuple):
    name: str
    on: str
    values: Any
    unit: str = ""


def fields_of(data: Data) -> list[Field]:
    """Of all places, also where a field of the points and one of the cells share a name."""
    return [Field(name, on, values, unit) for name, on, unit, values in data._core.fields()]


def with_fields(data: Data, fields: Iterable[Field]) -> Data:
    """Tuples of more than one axis (tensors) become rows; a second field of the same name and place gets a number."""
    seen: set[tuple[str, str]] = set()
    for name, on, values, unit in fields:
        a = values if isinstance(values, np.ndarray) else np.asarray(values)
        a = a.reshape(1) if a.ndim == 0 else a.reshape(len(a), -1) if a.ndim > 2 else a
        name = unused(name, lambda n: (n, on) in seen)  # noqa: B023  it is called at once
        seen.add((name, on))
        data = data.with_field(name, a, unit=unit, on=on)
    return data


def unused(name: str, taken: Any) -> str:
    """The name itself, or with the first number that makes it another one."""
    numbered, n = name, 2
    while taken(numbered):
        numbered, n = f"{name} #{n}", n + 1
    return numbered


def needed(module: str, who: str) -> Any:
    """A module of another library. Not an import statement: mypy asks for none of them either."""
    try:
        return import_module(module)
    except ImportError as e:
        library = module.partition(".")[0].replace("vtkmodules", "vtk")
        raise ImportError(f"{who}: {library} is not installed; pip install {library}, or the package of the system", name=module) from e


def spread(begins: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """begins[0], begins[0] + 1, ... (sizes[0] of them), begins[1], ...: the places of lists of different lengths."""
    ends = np.cumsum(sizes)
    total = int(ends[-1]) if len(ends) else 0
    return np.repeat(begins - (ends - sizes), sizes) + np.arange(total, dtype=np.int64)


def begins_of(sizes: np.ndarray) -> np.ndarray:
    """Where lists of these lengths begin, one after the other, and where the last one ends."""
    return np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)


def meshes_only(data: Data, who: str, right: str) -> None:
    """An error for what is no single mesh."""
    if data.kind in ("collection", "table"):
        raise usage(f"it is a {data.kind}", who, right)


def over_time(times: np.ndarray, step: Callable[[int], Data], what: str) -> Data:
    """A series, whatever the order of its times; the first step alone where some are equal or none at all."""
    order = np.argsort(times, kind="stable")
    sorted_times = times[order]
    if not np.isfinite(sorted_times).all() or (np.diff(sorted_times) <= 0).any():
        say(True, f"{what}: the times of its {len(times)} steps are not all different; the first one is taken")
        return step(0)
    return series([float(t) for t in sorted_times], lambda i: step(int(order[i])))

# SPDX-License-Identifier: Apache-2.0
"""DataArray and Dataset of xarray as data."""
from __future__ import annotations

from typing import Any, Sequence

import numpy as np

from .. import _core
from .._data import Data
from .._errors import say, usage
from .shared import Field, over_time, with_fields
from .times import numbers_of
from .xarray_axes import in_order, letters, mesh_of, own_coordinate
from .xarray_out import to_xarray

__all__ = ["to_xarray", "wrap"]

_of_components = ("component", "components")
_on_cells = "_cell"  # to_xarray ends the names of the dimensions of cells so


def wrap(x: Any, /, time: Any = None, components: str | None = None, dims: Sequence[str] | None = None, **chosen: Any) -> Data:
    """A grid whose axes are the dimensions, with the variables as fields; several grids are a collection, several times a series.

    Even, growing coordinates make a uniform grid, others a rectilinear one, longitudes and latitudes of two dimensions a curvilinear one,
    and lists of them points. Which dimension is x, y, z or time follows from attributes and names (CF conventions), for what they leave
    open from the order: the last is x. ``dims``: those of x, y and z instead. ``time``: only the step nearest to it. ``components``: the
    dimension of vectors (default: one named "component"). Further dimensions by name: the entry nearest to a value, wrap(x, member=3).
    Values are used where they lie if x is the last dimension; of dask and of files they are loaded now, of a series when they are needed.
    """
    xarray = _library(x)
    if xarray == "DataArray":
        name = "values" if x.name is None else x.name
        x = x.to_dataset(name=f"{name} values" if name in x.coords else name).assign_attrs(
            {k: v for k, v in x.attrs.items() if k in ("direction", "origin")})
    elif xarray != "Dataset":
        raise usage(f"an xarray.{type(x).__name__} is not known", "wrap", "a DataArray or a Dataset")
    if dims is not None:
        for d in dims:
            _check_dimension(x, d)
    for name, value in chosen.items():
        _check_dimension(x, name)
        x = _nearest(x, name, value)
    clock = next((d for d, letter in letters(x).items() if letter == "t" and d not in (dims or ())), None)
    if clock is None and time is not None:
        names = ", ".join(map(str, x.dims))
        raise usage("it has no dimension of time", "wrap", f"one named time, or with a coordinate of times; it has {names}")
    if clock is not None and time is not None:
        x = _nearest(x, clock, time)
    elif clock is not None and x.sizes[clock] > 1:
        def step(i: int) -> Data:
            return _grids(x.isel({clock: i}), components, dims)

        return over_time(_times(x, clock), step, f"wrap: dimension '{clock}'")
    elif clock is not None:
        x = x.isel({clock: 0})
    return _grids(x, components, dims)


def _times(x: Any, clock: str) -> np.ndarray:
    own = own_coordinate(x, clock)
    at = np.arange(x.sizes[clock]) if own is None else own.values if numbers_of(own.values) is None else numbers_of(own.values)
    return np.asarray(at, float)


def _library(x: Any) -> str:
    return next((b.__name__ for b in type(x).__mro__ if b.__module__.startswith("xarray.") and b.__name__ in ("DataArray", "Dataset")), "")


def _check_dimension(x: Any, name: str) -> None:
    if name not in x.dims:
        raise usage(f"it has no dimension '{name}'", "wrap", "one of " + ", ".join(str(d) for d in x.dims))


def _nearest(x: Any, dim: str, value: Any) -> Any:
    """The entry whose coordinate is nearest; without a coordinate the one of that number."""
    if own_coordinate(x, dim) is None:
        if not -x.sizes[dim] <= value < x.sizes[dim]:
            raise usage(f"there is no entry {value}", f"wrap: dimension '{dim}'", f"0 to {x.sizes[dim] - 1}")
        return x.isel({dim: int(value)})
    try:
        if x.coords[dim].dtype.kind == "M":
            value = np.datetime64(value) if isinstance(value, str) else value
        return x.sel({dim: value}, method=None if x.coords[dim].dtype.kind in "UO" and isinstance(value, str) else "nearest")
    except (KeyError, TypeError, ValueError) as e:
        ends = x.coords[dim].values[[0, -1]]
        raise usage(f"{value!r} is not found", f"wrap: dimension '{dim}'", f"its coordinate runs from {ends[0]} to {ends[1]}") from e


def _grids(x: Any, components: str | None, dims: Sequence[str] | None) -> Data:
    """Variables on the same dimensions are fields of one grid."""
    groups: dict[frozenset[str], dict[str, Any]] = {}
    whole: list[Field] = []
    for name, v in x.data_vars.items():
        if v.attrs.get("on") == "whole":
            whole.append(Field(str(name), "whole", v.values, _unit(v)))
        elif name in _aids(x):
            continue
        elif v.dtype.kind not in "biufMmc" and numbers_of(v.values) is None:
            say(False, f"wrap: '{name}' is left out, its values are {v.dtype}")
        elif not (on := _dims_in_space(x, v, components)):
            say(False, f"wrap: '{name}' is left out, it depends on no dimension of space")
        else:
            groups.setdefault(frozenset(d for d in on if x.sizes.get(d, 2) > 1) or frozenset(on), {})[str(name)] = v
    main = max(groups, key=lambda g: (len(g), len(groups[g])), default=frozenset[str]())
    for key in [k for k in groups if k < main and len(k) == 1]:
        for name in groups.pop(key):
            say(False, f"wrap: '{name}' is left out, it is a profile along an axis of the others")
    if not groups:
        raise usage("the dataset has no variable of numbers with dimensions of space", "wrap", "one at least; it has " +
                    (", ".join(f"{n} ({', '.join(map(str, v.dims))})" for n, v in x.data_vars.items()) or "none at all"))
    made = [(" x ".join(sorted(map(str, key))), _grid(x, variables, components, dims)) for key, variables in groups.items()]
    if len(made) == 1:
        return with_fields(made[0][1], whole)
    return Data(_core.collection([(name, data._core) for name, data in made]))


def _aids(x: Any) -> set[str]:
    """Variables that are there for others: bounds of cells, projections."""
    named: set[str] = set()
    for v in x.variables.values():
        for attribute in ("bounds", "climatology", "grid_mapping"):
            named.update(str({**v.encoding, **v.attrs}.get(attribute, "")).split())
    return named


def _dims_in_space(x: Any, v: Any, components: str | None) -> list[str]:
    """Without that of components; for values of cells the dimensions of the points."""
    last = _dim_of_components(v, components)
    on = [str(d) for d in v.dims if d != last]
    points = [d[:-len(_on_cells)] for d in on if d.endswith(_on_cells)]
    return points if on and v.attrs.get("on") == "cells" and len(points) == len(on) and all(d in x.dims for d in points) else on


def _dim_of_components(v: Any, components: str | None) -> str | None:
    if components is not None:
        return components if components in v.dims else None
    return next((str(d) for d in v.dims if v.ndim > 1 and (d in _of_components or str(d).startswith("component_"))), None)


def _grid(x: Any, variables: dict[str, Any], components: str | None, dims: Sequence[str] | None) -> Data:
    longest = max((_dims_in_space(x, v, components) for v in variables.values()), key=len)
    if dims is not None:
        longest = [d for d in reversed(dims) if d in longest or d in x.dims] + [d for d in longest if d not in dims]
    if len(longest) > 3:
        one = next((d for d in longest if letters(x).get(d, "") == ""), longest[0])
        raise usage(f"it has {len(longest)} axes: {', '.join(longest)}", "wrap", f"three at most; choose an entry: wrap(x, {one}=0), or "
                    f"name the one that holds vectors: components='{longest[-1]}'")
    order = longest if dims is not None else in_order(x, longest)
    return with_fields(mesh_of(x, order), (_field(x, name, v, order, components) for name, v in variables.items()))


def _field(x: Any, name: str, v: Any, order: Sequence[str], components: str | None) -> Field:
    last = _dim_of_components(v, components)
    cells = _dims_in_space(x, v, components) != [d for d in v.dims if d != last]
    ends = _on_cells if cells else ""
    moved = v.transpose(*(d + ends for d in order if d + ends in v.dims), *([last] if last else [])).values
    times = numbers_of(moved)
    if times is not None:
        moved = times
    if not moved.flags.c_contiguous:
        say(False, f"wrap '{name}': copied, its dimensions lie in the order {', '.join(map(str, v.dims))}, not {', '.join(order)}")
        moved = np.ascontiguousarray(moved)
    values = moved.reshape(-1, moved.shape[-1]) if last else moved.reshape(-1)
    return Field(name, "cells" if cells else "points", values, "s" if times is not None else _unit(v))


def _unit(v: Any) -> str:
    unit = next((str(u) for k, u in v.attrs.items() if str(k).lower() in ("units", "unit")), "")
    return "" if unit in ("1", "none") else unit

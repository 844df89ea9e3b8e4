# SPDX-License-Identifier: Apache-2.0
"""What the dimensions of an array of xarray are in space, by the rules that the reader of netCDF follows (CF conventions)."""
from __future__ import annotations

from typing import Any, Sequence

import numpy as np

from .._data import Data
from .._errors import say, usage
from .._meshes import curvilinear, points, rectilinear, uniform
from .times import numbers_of

_east = {"degrees_east", "degree_east", "degree_e", "degrees_e", "degreee", "degreese"}
_north = {"degrees_north", "degree_north", "degree_n", "degrees_n", "degreen", "degreesn"}
_standard = {"longitude": "x", "projection_x_coordinate": "x", "grid_longitude": "x", "latitude": "y", "projection_y_coordinate": "y",
             "grid_latitude": "y", "time": "t", "depth": "z", "height": "z", "altitude": "z", "air_pressure": "z"}
_names = {"x": ("x", "lon", "longitude", "long", "rlon", "nav_lon", "xlong"), "y": ("y", "lat", "latitude", "rlat", "nav_lat", "xlat"),
          "z": ("z", "lev", "level", "depth", "height", "altitude", "plev")}


def letter_of(name: str, coordinate: Any = None) -> str:
    """"x", "y", "z", "t", or "" for none of them: by the attributes of its coordinate, then by its name."""
    says = {k: str(v).lower() for k, v in coordinate.attrs.items()} if coordinate is not None else {}
    units, standard, name = says.get("units", ""), says.get("standard_name", ""), name.lower()
    if says.get("axis", "") in ("x", "y", "z", "t"):
        return says["axis"]
    if " since " in units or (coordinate is not None and (coordinate.dtype.kind == "M" or _is_calendar(coordinate))):
        return "t"
    if units in _east or units in _north:
        return "x" if units in _east else "y"
    if standard in _standard:
        return _standard[standard]
    if says.get("positive"):
        return "z"
    if name == "t" or name.startswith("time") or name.endswith("_time"):
        return "t"
    return next((letter for letter, known in _names.items() if name in known), "z" if name.startswith("depth") else "")


def _is_calendar(coordinate: Any) -> bool:
    return coordinate.dtype.kind == "O" and coordinate.size > 0 and hasattr(coordinate.values.flat[0], "calendar")


def own_coordinate(x: Any, dim: str) -> Any:
    """The coordinate that has the name of a dimension; None without one."""
    return x.coords[dim] if dim in x.coords and x.coords[dim].dims == (dim,) else None


def letters(x: Any) -> dict[str, str]:
    return {str(d): letter_of(str(d), own_coordinate(x, d)) for d in x.dims}


def in_order(x: Any, dims: Sequence[str]) -> list[str]:
    """Dimensions as z, y, x: as their letters say; those without one take what is left, the last first."""
    known = letters(x)
    places: dict[str, str] = {}
    rest = []
    for d in reversed(dims):
        if known[d] in ("x", "y", "z") and known[d] not in places:
            places[known[d]] = d
        else:
            rest.append(d)
    for d in rest:
        places[next(letter for letter in "xyz" if letter not in places)] = d
    return [places[letter] for letter in "zyx" if letter in places]


def axis_of(x: Any, dim: str) -> np.ndarray:
    """The coordinates along a dimension, or 0, 1, 2, ... where it has none that will do."""
    coordinate = own_coordinate(x, dim)
    n = x.sizes[dim]
    if coordinate is None:
        return np.arange(float(n))
    at = numbers_of(coordinate.values)
    if at is None:
        at = coordinate.values
    steps = np.diff(at) if at.dtype.kind in "iuf" else np.zeros(1)
    if n > 1 and not (np.isfinite(steps).all() and ((steps > 0).all() or (steps < 0).all())):
        say(True, f"wrap: coordinate '{dim}' neither grows nor falls; its axis is numbered 0, 1, 2, ...")
        return np.arange(float(n))
    return at if at.dtype.kind in "iuf" else np.arange(float(n))


def _is_even(at: np.ndarray) -> bool:
    if len(at) < 2:
        return True
    h = (float(at[-1]) - float(at[0])) / (len(at) - 1)
    return h > 0 and bool(np.all(np.abs(at - (at[0] + np.arange(len(at)) * h)) <= 1e-4 * h))


def mesh_of(x: Any, dims: Sequence[str]) -> Data:
    """The mesh of these dimensions (z, y, x): a list of places, a curvilinear, a uniform or a rectilinear grid."""
    found = _positions(x, dims)
    if found and len(dims) == 1:
        xyz = np.stack([np.asarray(p, float) for p in _broadcast(x, found, dims)], -1)
        return points(xyz)
    if found:
        return curvilinear(_finite(np.stack([np.asarray(p, float) for p in _broadcast(x, found, dims)], -1)))
    axes = [axis_of(x, d) for d in reversed(dims)] + [np.zeros(1)] * (3 - len(dims))
    turned = _turn(x)
    if all(_is_even(at) for at in axes):
        first = np.array([float(at[0]) for at in axes])
        steps = [(float(at[-1]) - float(at[0])) / (len(at) - 1) if len(at) > 1 else 1.0 for at in axes]
        size = [len(at) for at in axes]
        if turned is None:
            return uniform(dims=size, origin=first, spacing=steps)
        return uniform(dims=size, origin=turned[1] + turned[0] @ first, spacing=steps, direction=turned[0])
    if turned is not None:
        say(True, "wrap: the attribute 'direction' is left aside, it holds for even axes only")
    return rectilinear(*axes)


def _turn(x: Any) -> tuple[np.ndarray, np.ndarray] | None:
    """What to_xarray notes of a turned grid: the directions of its axes, and where its coordinates begin to count."""
    if "direction" not in x.attrs or "origin" not in x.attrs:
        return None
    direction, origin = np.asarray(x.attrs["direction"], float), np.asarray(x.attrs["origin"], float)
    if direction.size != 9 or origin.size != 3:
        raise usage(f"the attributes 'direction' and 'origin' hold {direction.size} and {origin.size} numbers", "wrap",
                    "9 (row by row; the columns are the axes) and 3")
    return direction.reshape(3, 3), origin


def _positions(x: Any, dims: Sequence[str]) -> dict[str, Any] | None:
    """Coordinates x and y (and z) that depend on several dimensions, or that list places along the only one."""
    if all((own := own_coordinate(x, d)) is not None and own.dtype.kind in "iuf" and letter_of(d, own) for d in dims[-2:]):
        return None  # its axes say all
    found: dict[str, Any] = {}
    for name, c in x.coords.items():
        on = set(c.dims)
        if name not in x.dims and c.dtype.kind in "iuf" and on and on <= set(dims) and (len(on) > 1 or len(dims) == 1):
            found.setdefault(letter_of(str(name), c), c)
    return found if "x" in found and "y" in found else None


def _broadcast(x: Any, found: dict[str, Any], dims: Sequence[str]) -> list[np.ndarray]:
    shape = tuple(x.sizes[d] for d in dims)

    def full(c: Any) -> np.ndarray:
        at = c.transpose(*(d for d in dims if d in c.dims)).values
        return np.broadcast_to(at.reshape([x.sizes[d] if d in c.dims else 1 for d in dims]), shape)

    if "z" in found:
        z = full(found["z"])
    elif len(dims) > 2:
        z = np.broadcast_to(axis_of(x, dims[0]).reshape(-1, 1, 1), shape)
    else:
        z = np.zeros(shape)
    return [full(found["x"]), full(found["y"]), z]


def _finite(xyz: np.ndarray) -> np.ndarray:
    """Points without a position lie on the one before."""
    rows = xyz.reshape(-1, 3)
    good = np.isfinite(rows).all(1)
    if not good.all():
        say(True, f"wrap: {int((~good).sum())} points have no position; they lie on the ones before them")
        rows = rows[np.maximum.accumulate(np.where(good, np.arange(len(rows)), int(np.argmax(good))))]
    return rows.reshape(xyz.shape)

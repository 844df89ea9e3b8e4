# SPDX-License-Identifier: Apache-2.0
"""xarray's arrays and datasets: dimensions are axes, coordinates where the points lie."""
from __future__ import annotations

from typing import Any

import numpy as np

from .. import _meshes
from .._data import Data
from .._errors import say, usage
from .._numbers import lent, on_grid

_roles = {"x": ("x", "lon", "longitude", "i", "col", "easting"), "y": ("y", "lat", "latitude", "j", "row", "northing"),
          "z": ("z", "lev", "level", "depth", "height", "altitude", "pressure", "k")}


def _role(dim: str, coordinate: Any) -> str:
    """"x", "y", "z", or "" for a dimension that is none of space."""
    stated = str(coordinate.attrs.get("axis", "")).lower() if coordinate is not None else ""
    if stated in _roles:
        return stated
    kind = coordinate.dtype.kind if coordinate is not None else "f"
    return "" if kind in "MmUOS" else next((r for r, names in _roles.items() if dim.lower() in names), "")


def wrapped(x: Any, **hints: Any) -> Data:
    """A DataArray, or the variables of a Dataset that have its largest variable's dimensions.

    Dimensions named or marked as x, y and z (longitude, latitude, level ...) are those of space; where none is, the last is x. Others are
    chosen by hints (``time=``: the nearest value), or at their first value with a note. Even coordinates make a uniform grid, others a
    rectilinear one, positions of two dimensions (curvilinear longitudes and latitudes) a curvilinear one.
    """
    import xarray as xr

    if isinstance(x, xr.DataArray):
        arrays = {x.name if x.name is not None else "values": x}
    elif isinstance(x, xr.Dataset):
        numeric = {n: v for n, v in x.data_vars.items() if v.dtype.kind in "biuf" and v.ndim > 0}
        if not numeric:
            raise usage("the dataset has no variable of numbers", "wrap", "select one, or a DataArray")
        largest = max(numeric.values(), key=lambda v: v.size)
        arrays = {n: v for n, v in numeric.items() if set(v.dims) == set(largest.dims)}
        for name in x.data_vars:
            if name not in arrays and numeric.get(name) is not None:
                say(False, f"wrap: '{name}' has other dimensions and is left out")
    else:
        raise usage(f"{type(x).__name__} is not known", "wrap", "DataArray and Dataset are")
    chosen: dict[str, Any] = {}
    first = next(iter(arrays.values()))
    roles = {d: _role(str(d), first.coords.get(d)) for d in first.dims}
    if not any(roles.values()):
        for role, dim in zip("xyz", [d for d in reversed(first.dims) if d not in hints]):
            roles[dim] = role
    for hint in hints:
        if hint not in first.dims:
            raise usage(f"there is no dimension '{hint}'", "wrap", "there are " + ", ".join(map(str, first.dims)))
    taken: set[str] = set()
    for dim in first.dims:
        if roles[dim] and roles[dim] not in taken and dim not in hints:
            taken.add(roles[dim])
        else:
            chosen[dim] = _place(first, dim, hints)
    data: Data | None = None
    for name, array in arrays.items():
        flat = array.isel(chosen)
        order = sorted(flat.dims, key=lambda d: "zyx".index(roles[d]))
        flat = flat.transpose(*order)
        if data is None:
            data = _grid(flat, roles)
        values = on_grid(flat.values, "zyx", f"wrap '{name}'")[1]
        data = Data(data._core.with_field(str(name), "points", lent(values, flat.values), str(array.attrs.get("units", ""))))
    assert data is not None
    return data


def _place(array: Any, dim: Any, hints: dict[str, Any]) -> int:
    if dim in hints:
        wanted = hints[dim]
        if dim in array.coords:
            return int(array.get_index(dim).get_indexer([wanted], method="nearest" if array.coords[dim].dtype.kind in "iufMm" else None)[0])
        return int(wanted)
    if array.sizes[dim] > 1:
        value = array.coords[dim].values[0] if dim in array.coords else 0
        say(False, f"wrap: of '{dim}' the first of {array.sizes[dim]} is taken ({value}); {dim}=VALUE chooses another")
    return 0


def _grid(flat: Any, roles: dict[Any, str]) -> Data:
    """The mesh whose points these values are at; flat has its dimensions in the order z, y, x."""
    by_role = {roles[d]: d for d in flat.dims}
    horizontal = {by_role.get("x"), by_role.get("y")} - {None}
    positions = {role: c for role in "xy" for n, c in flat.coords.items() if c.ndim == 2 and set(c.dims) == horizontal
                 and _role(str(n), c) == role}
    axes = []
    for role in "xyz":
        dim = by_role.get(role)
        if dim is None:
            axes.append(np.zeros(1))
        elif dim in flat.coords and flat.coords[dim].dtype.kind in "iuf":
            axes.append(np.asarray(flat.coords[dim].values, float))
        else:
            axes.append(np.arange(flat.sizes[dim], dtype=float))
    nx, ny, nz = (len(a) for a in axes)
    if len(positions) == 2:
        order = [by_role["y"], by_role["x"]]
        x, y = (np.broadcast_to(positions[r].transpose(*order).values, (nz, ny, nx)) for r in "xy")
        z = np.broadcast_to(axes[2][:, None, None], (nz, ny, nx))
        return _meshes.curvilinear(np.stack([x, y, z], axis=-1).astype(float))
    steps = [np.diff(a) for a in axes]
    even = all(len(s) == 0 or (s[0] > 0 and np.allclose(s, s.mean(), rtol=1e-5, atol=0)) for s in steps)
    if even:
        spacing = [float(s.mean()) if len(s) else 1.0 for s in steps]
        return _meshes.uniform(dims=(nx, ny, nz), spacing=spacing, origin=[a[0] for a in axes])
    return _meshes.rectilinear(*axes)


def to_xarray(data: Data) -> Any:
    """A Dataset of a uniform or rectilinear grid, with the dimensions z, y, x and their coordinates; cell fields at the middles of cells."""
    import xarray as xr

    if data.kind not in ("uniform", "rectilinear") or (data.kind == "uniform" and not np.allclose(data.direction, np.eye(3))):
        raise usage(f"a mesh of kind '{data.kind}' has no axes along x, y and z", "to_xarray", "resample() makes a uniform grid of any mesh")
    axes = dict(zip("xyz", data.axes))
    coords = {**axes, **{f"{a}_cell": 0.5 * (c[1:] + c[:-1]) if len(c) > 1 else c for a, c in axes.items()}}
    variables = {}
    for name in data.keys():
        on = data.on(name)
        if on == "whole":
            continue
        dims = ("z", "y", "x") if on == "points" else ("z_cell", "y_cell", "x_cell")
        values = data[name]
        shape = tuple(len(coords[d]) for d in dims)
        more = ("component",) if values.ndim == 2 else ()
        attrs = {"units": data.unit(name)} if data.unit(name) else {}
        variables[name] = ((*dims, *more), values.reshape(*shape, *values.shape[1:]), attrs)
    used = {d for v in variables.values() for d in v[0]} | set("xyz")
    return xr.Dataset(variables, {d: c for d, c in coords.items() if d in used})

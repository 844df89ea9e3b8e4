# SPDX-License-Identifier: Apache-2.0
"""Grids as a Dataset of xarray."""
from __future__ import annotations

from typing import Any

import numpy as np

from .._data import Data
from .._errors import usage
from .shared import fields_of, needed, unused


def to_xarray(data: Data) -> Any:
    """A Dataset of a grid with the dimensions z, y, x, those of cells z_cell, y_cell, x_cell, and "component" of vectors.

    Coordinates are those of the points along the axes, and of the middles of the cells; a curvilinear grid has positions at each point.
    A turned grid has coordinates along its own axes and the attributes ``direction`` (3 x 3, row by row) and ``origin``, on the Dataset and
    each variable: a point lies at origin + direction @ (x, y, z). Units are the attribute ``units``; what belongs to no point has the
    attribute ``on``. Values are views, read-only.
    """
    xarray = needed("xarray", "to_xarray")
    if data.kind not in ("uniform", "rectilinear", "curvilinear"):
        others = {"table": "to_pandas()", "collection": "one part of it: data.parts[name].to_xarray()"}
        right = others.get(data.kind, "resample() makes a grid of it")
        raise usage(f"data of kind '{data.kind}' have no axes", "to_xarray", right)
    shape = data.dims[::-1]
    cell_shape = tuple(max(n - 1, 1) for n in shape)
    dims, cell_dims = ("z", "y", "x"), ("z_cell", "y_cell", "x_cell")
    attributes: dict[str, Any] = {}
    coordinates: dict[str, Any] = {}
    if data.kind == "curvilinear":
        for i, d in enumerate("xyz"):
            coordinates[f"{d}_position"] = (dims, data.points[:, i].reshape(shape), {"axis": d.upper()})
    else:
        axes = list(data.axes)
        if data.kind == "uniform" and not np.array_equal(data.direction, np.eye(3)):
            attributes = {"direction": data.direction.ravel(), "origin": np.array(data.origin)}
            axes = [np.arange(n) * h for n, h in zip(data.dims, data.spacing)]
        for d, at in zip("xyz", axes):
            coordinates[d] = (d, at, {"axis": d.upper()})
            if any(f.on == "cells" for f in fields_of(data)):
                coordinates[f"{d}_cell"] = (f"{d}_cell", (at[1:] + at[:-1]) / 2 if len(at) > 1 else at, {"axis": d.upper()})
    variables: dict[str, Any] = {}
    variable: tuple[tuple[str, ...], np.ndarray]
    for f in fields_of(data):
        rows = f.values.shape[1:]
        if f.on == "whole":
            variable = (f"{f.name}_row",), f.values
        elif f.on == "points":
            variable = dims, f.values.reshape(*shape, *rows)
        else:
            variable = cell_dims, f.values.reshape(*cell_shape, *rows)
        notes = {**({"units": f.unit} if f.unit else {}), **({"on": f.on} if f.on != "points" else {}), **attributes}
        name = unused(f.name, lambda n: n in variables or n in coordinates or n in dims)
        # Vectors of other lengths cannot share a dimension.
        last = ("component",) if rows in ((), (3,)) else (f"component_{rows[0]}",)
        variables[name] = ((*variable[0], *(last if rows else ())), variable[1], notes)
    if data.time is not None:
        attributes["time"] = data.time
    return xarray.Dataset(variables, coordinates, attributes)

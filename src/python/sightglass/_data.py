# SPDX-License-Identifier: Apache-2.0
"""Data: a mesh with its fields, a collection of named parts, or a table."""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from weakref import ref

import numpy as np

from . import _core, _operations
from ._errors import UnknownNameError, usage
from ._methods import Methods
from ._numbers import lent, on_grid, tuples

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Data(Methods):
    """A mesh with its fields, a collection of named parts, or a table of columns. It never changes: what operations return is new and
    shares what stayed the same. Arrays that were handed in are read-only while data hold them."""

    __slots__ = ("_core", "_points", "__weakref__")

    def __init__(self, core: _core.Data):
        self._core = core
        self._points: ref[np.ndarray] | None = None

    # ---- what it is

    @property
    def kind(self) -> str:
        """"uniform", "rectilinear", "curvilinear", "unstructured", "surface", "points", "amr", "collection" or "table"."""
        return self._core.kind

    @property
    def notes(self) -> list[str]:
        """What the operation (or reader) that made it chose and why, and its warnings, one line each; empty for data of arrays."""
        return self._core.notes()

    @property
    def n_points(self) -> int:
        """Of all parts together."""
        return self._core.point_count()

    @property
    def n_cells(self) -> int:
        """Of all parts together."""
        return self._core.cell_count()

    @property
    def bounds(self) -> np.ndarray:
        """Two rows: the smallest and the largest x, y and z."""
        return np.array(self._core.bounds())

    @property
    def dims(self) -> tuple[int, int, int]:
        """Points along x, y and z of a grid."""
        nx, ny, nz = self._core.dims()
        return nx, ny, nz

    @property
    def spacing(self) -> tuple[float, float, float]:
        """Between the points of a uniform grid along its axes."""
        x, y, z = self._core.placing()[0]
        return x, y, z

    @property
    def origin(self) -> tuple[float, float, float]:
        """Where the first point of a uniform grid lies."""
        x, y, z = self._core.placing()[1]
        return x, y, z

    @property
    def direction(self) -> np.ndarray:
        """(3, 3): the columns are the directions of the axes of a uniform grid."""
        return np.array(self._core.placing()[2]).T

    @property
    def axes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The coordinates along x, y and z of a rectilinear or uniform grid (of that along its own axes)."""
        x, y, z = self._core.coordinates()
        return x, y, z

    @property
    def points(self) -> np.ndarray:
        """Positions of all points, (n, 3), read-only: those that the mesh lists, where they are float64; others are computed, once as long
        as somebody holds them."""
        points = self._points() if self._points is not None else None
        if points is None:
            points = self._core.points()
            self._points = ref(points)
        return points

    @property
    def cells(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Point numbers of all cells one after the other, where each begins (one more than there are cells), and VTK's number of its
        type."""
        return self._core.cells()

    @property
    def polyhedra(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of polyhedra: the point numbers of all faces one after the other, where each face begins, and where the faces of each cell begin
        (equal neighbours: a cell of another type). Empty where there are none."""
        ids, begins, of_cells = self._core.faces()
        return (ids, begins, of_cells) if len(ids) else (np.zeros(0, np.int64),) * 3

    @property
    def parts(self) -> dict[str, Data]:
        """Of a collection, by name; itself under "" for anything else. Parts that share a name are numbered."""
        parts: dict[str, Data] = {}
        for name, part in self._core.parts():
            unique, n = name, 2
            while unique in parts:
                unique, n = f"{name} #{n}", n + 1
            parts[unique] = Data(part)
        return parts

    # ---- fields

    def keys(self) -> list[str]:
        """Names of the fields, or of the columns of a table."""
        return [f[0] for f in self._core.fields()]

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys())

    def __contains__(self, name: object) -> bool:
        return name in self.keys()

    def __len__(self) -> int:
        return len(self._core.fields())

    def __getitem__(self, name: str) -> np.ndarray:
        """The numbers of a field where they lie: read-only, one row per point or cell; of a column of words a list of them."""
        if self.kind == "table":
            words = self._core.words(name)
            if words:
                return np.array([words[i] if i >= 0 else "" for i in self._core.field(name)[3]])
        return self._core.field(name)[3]

    def unit(self, field: str) -> str:
        """"K", "m/s"; "" where the data do not say."""
        return self._core.field(field)[2]

    def on(self, field: str) -> str:
        """"points", "cells" or "whole"."""
        return self._core.field(field)[1]

    def range(self, field: str, component: int = -1) -> tuple[float, float]:
        """Of the finite values of all parts; component -1: the only one, or the length of each row."""
        return self._core.range(field, component)

    def with_field(self, name: str, values: Any, unit: str = "", on: str | None = None, order: str | None = None) -> Data:
        """New data with one more field, or another one of that name; everything else is shared.

        ``values``: one value or row per point or cell; with ``order`` ("zyx" or "xyz") an array with the axes of a grid. Used where it
        lies, if its layout permits, and read-only from then on. ``on``: "points" or "cells"; default: whichever its length fits.
        """
        where = f"with_field '{name}'"
        if order is not None:
            components = np.ndim(values) > 3 or (np.ndim(values) > 1 and 1 not in self.dims and np.ndim(values) > 3)
            array = on_grid(values, order, where, components)[1]
        else:
            array = tuples(values, where)
        if on is None:
            n = len(array)
            on = "points" if n == self.n_points else "cells" if n == self.n_cells else None
            if on is None:
                raise usage(f"{n} values", where, f"there are {self.n_points} points and {self.n_cells} cells")
        return Data(self._core.with_field(name, on, lent(array, values), unit))

    def with_fields(self, fields: Mapping[str, Any], on: str | None = None, order: str | None = None) -> Data:
        """Several fields at once: ``{"T": values, "v": (values, "m/s")}``, each as in with_field()."""
        data = self
        for name, given in fields.items():
            values, unit = given if isinstance(given, tuple) and len(given) == 2 and isinstance(given[1], str) else (given, "")
            data = data.with_field(name, values, unit, on, order)
        return data

    # ---- time

    @property
    def time(self) -> float | None:
        """Of what is at hand; None where the data do not say."""
        return self._core.time()

    @property
    def times(self) -> list[float]:
        """Of the series that it comes from, ascending; none where nothing above it has times."""
        return self._core.times()

    def at(self, time: float) -> Data:
        """The same at another time: what it was made of runs again, on the step nearest to it."""
        return Data(self._core.at(float(time)))

    # ---- doing something with it

    def save(self, path: Any, **params: Any) -> None:
        """Writes a file; its extension chooses the format. Nothing is ever half written."""
        self._core.write(str(path), params)

    def plot(self, show: str = "auto", size: tuple[int, int] | float = (1280, 720), camera: dict | None = None,
             picture: dict | None = None, **params: Any) -> Any:
        """The picture that `sightglass render` would make; ``params`` are those of the way to show (see Scene.add).

        ``size``: width and height in pixels; one number is that of points and glyphs.
        """
        from ._scene import Scene

        if isinstance(size, (int, float)):
            params["size"], size = size, (1280, 720)
        return Scene().add(self, show, **params).camera(**(camera or {})).picture(**(picture or {})).render(size)

    def __getattr__(self, name: str) -> Any:
        method = _operations.method(name) if not name.startswith("_") else None
        if method is None:
            near = f"; did you mean '{_operations.nearest(name)}'?" if _operations.nearest(name) else ""
            raise UnknownNameError(f"data have no attribute and Sightglass no operation '{name}'{near}", f"unknown operation '{name}'",
                                   "", near.strip("; "))
        return method.__get__(self)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *_operations.names("operation")]

    # ---- for other libraries (docs/python/conversions.md)

    def to_vtk(self) -> Any:
        """VTK's object for it, over the same numbers, which VTK must not change."""
        from ._wrap.vtk import to_vtk

        return to_vtk(self)

    def to_pyvista(self) -> Any:
        """PyVista's object for it, over the same numbers, which PyVista must not change."""
        from ._wrap.vtk import to_pyvista

        return to_pyvista(self)

    def to_xarray(self) -> Any:
        """A Dataset of a uniform or rectilinear grid."""
        from ._wrap.xarray import to_xarray

        return to_xarray(self)

    def to_pandas(self, on: str = "points") -> Any:
        """A DataFrame: the columns of a table; of a mesh a row for each point (with x, y and z) or cell."""
        from ._wrap.pandas import to_pandas

        return to_pandas(self, on)

    def to_meshio(self) -> Any:
        """A meshio.Mesh."""
        from ._wrap.meshio import to_meshio

        return to_meshio(self)

    # ---- how it looks

    def __repr__(self) -> str:
        return f"<sightglass.Data: {self._core.summary()}>"

    def _repr_html_(self) -> str:
        from ._notebook import page_of

        return page_of(self)

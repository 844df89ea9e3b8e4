# SPDX-License-Identifier: Apache-2.0
"""Data of numpy arrays, which are used where they lie if their layout permits, and read-only from then on."""
from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from . import _core, _operations
from ._data import Data
from ._errors import say, usage
from ._numbers import known, lent, on_grid, tuples, whole

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

#: VTK's numbers of the types of cells, by names.
CELL_TYPES = {
    "vertex": 1, "line": 3, "poly_line": 4, "triangle": 5, "triangle_strip": 6, "polygon": 7, "pixel": 8, "quad": 9, "tetra": 10,
    "tetrahedron": 10, "voxel": 11, "hexahedron": 12, "wedge": 13, "pyramid": 14, "quadratic_edge": 21, "quadratic_triangle": 22,
    "quadratic_quad": 23, "quadratic_tetra": 24, "quadratic_hexahedron": 25, "quadratic_wedge": 26, "quadratic_pyramid": 27,
    "polyhedron": 42, "lagrange_triangle": 69, "lagrange_quad": 70, "lagrange_tetra": 71, "lagrange_hexahedron": 72, "lagrange_wedge": 73,
}
_of_any_length = (4, 6, 7)  # poly_line, triangle_strip, polygon


def _three(numbers: Any, what: str) -> tuple[float, float, float]:
    a = np.asarray(numbers, dtype=float).reshape(-1)
    if len(a) != 3:
        raise usage(f"{len(a)} numbers", what, "one for each of x, y and z")
    return float(a[0]), float(a[1]), float(a[2])


def uniform(values: Any = None, *, dims: Sequence[int] | None = None, spacing: Any = (1, 1, 1), origin: Any = (0, 0, 0),
            direction: Any = None, name: str = "values", unit: str = "", order: str = "zyx", components: bool = False) -> Data:
    """A grid of even steps, with ``values`` at its points: uniform(volume, spacing=(0.5, 0.5, 2)).

    ``values``: an array of one to three axes; with ``components`` the last axis holds those of vectors. ``order``: "zyx" where the last
    axis is x (as tifffile, SimpleITK and h5py give it), "xyz" where the first is (nibabel). ``dims``: instead of values, points along x, y
    and z. ``spacing`` and ``origin``: for x, y and z. ``direction``: (3, 3), whose columns are the directions of the axes in space.
    """
    turned = np.eye(3) if direction is None else np.asarray(direction, float)
    if turned.shape != (3, 3):
        raise usage(f"a direction of shape {turned.shape}", "uniform", "(3, 3), whose columns are the directions of the axes")
    placing = _three(spacing, "spacing"), _three(origin, "origin"), turned.T.tolist()
    if (values is None) == (dims is None):
        raise usage("needs values or dims", "uniform", "an array with the values at its points, or dims=(nx, ny, nz) for a grid without")
    if dims is not None:
        return Data(_core.uniform_grid(tuple(int(n) for n in dims), *placing))
    size, array = on_grid(values, order, f"uniform '{name}'", components)
    grid = _core.uniform_grid(size, *placing)
    return Data(grid.with_field(name, "points", lent(array, values), unit))


def rectilinear(x: Any, y: Any, z: Any = (0.0,), values: Any = None, *, name: str = "values", unit: str = "", order: str = "zyx",
                components: bool = False) -> Data:
    """A grid whose lines lie at the coordinates x, y and z (ascending or descending), with ``values`` at its points (see uniform)."""
    axes = [np.ascontiguousarray(known(a, n), dtype=None if np.asarray(a).dtype in (np.float32, np.float64) else np.float64)
            for a, n in ((x, "x"), (y, "y"), (z, "z"))]
    data = Data(_core.rectilinear_grid(*axes))
    if values is None:
        return data
    array = on_grid(values, order, f"rectilinear '{name}'", components)[1]
    return Data(data._core.with_field(name, "points", lent(array, values), unit))


def curvilinear(points: Any, values: Any = None, *, name: str = "values", unit: str = "", order: str = "zyx", components: bool = False) -> Data:
    """A grid with a position for each point: ``points`` has the axes of the grid and a last one of x, y and z."""
    dims, xyz = on_grid(points, order, "curvilinear points", True)
    data = Data(_core.curvilinear_grid(dims, lent(_positions(xyz), points)))
    if values is None:
        return data
    array = on_grid(values, order, f"curvilinear '{name}'", components)[1]
    return Data(data._core.with_field(name, "points", lent(array, values), unit))


def _lent_positions(points: Any) -> Any:
    return lent(_positions(points), points)


def _positions(points: Any) -> np.ndarray:
    a = tuples(points, "points")
    if a.ndim == 2 and a.shape[1] == 2:
        say(False, "points: copied, z is 0")
        a = np.column_stack([a, np.zeros(len(a), a.dtype)])
    if a.ndim != 2 or a.shape[1] != 3:
        raise usage(f"points of shape {a.shape}", "points", "one row of x, y and z for each")
    if a.dtype not in (np.float32, np.float64):
        say(False, f"points: copied, {a.dtype} becomes float64")
        a = a.astype(np.float64)
    return a


def unstructured(points: Data | Any, cells: Mapping[str | int, Any] | Sequence[Any] | None = None, *, faces: Sequence[Any] | None = None) -> Data:
    """A mesh of cells of any types: unstructured(xyz, {"tetrahedron": (n, 4) point numbers, "hexahedron": (m, 8) ...}).

    The types are those of CELL_TYPES or VTK's numbers; cells come in the order of the mapping. "polygon" and "poly_line" take lists of any
    lengths, "polyhedron" for each cell the list of its faces. ``cells`` may also be the three arrays that Data.cells gives, and ``faces``
    those of Data.polyhedra. Of data alone: the operation of that name.
    """
    if isinstance(points, Data):
        return points.unstructured()
    if cells is not None and not isinstance(cells, Mapping):
        if len(cells) != 3:
            raise usage(f"{len(cells)} lists of cells", "unstructured", "a mapping from types to point numbers, or ids, offsets and types")
        ids, offsets, types = whole(cells[0], "ids"), whole(cells[1], "offsets"), known(cells[2], "types").astype(np.uint8, copy=False)
        of_faces = None if faces is None or len(faces[2]) == 0 else tuple(whole(f, "faces") for f in faces)
        return Data(_core.unstructured_mesh(_lent_positions(points), ids, offsets, types, of_faces))
    if not cells:
        raise usage("no cells", "unstructured", "points(xyz) makes points without cells")
    made = _Lists()
    for name, lists in cells.items():
        number = CELL_TYPES.get(name) if isinstance(name, str) else int(name)
        if number is None:
            raise usage(f"cell type '{name}' is not known", "unstructured", "one of " + ", ".join(CELL_TYPES))
        made.add(number, lists, f"cells '{name}'")
    return Data(_core.unstructured_mesh(_lent_positions(points), *made.arrays()))


class _Lists:
    """Cells of several types, one after the other."""

    def __init__(self) -> None:
        self.ids: list[np.ndarray] = []
        self.sizes: list[np.ndarray] = []
        self.types: list[np.ndarray] = []
        self.faces: list[np.ndarray] = []
        self.face_counts: list[np.ndarray] = []  # of each cell

    def add(self, number: int, lists: Any, what: str) -> None:
        if number == CELL_TYPES["polyhedron"]:
            self.add_polyhedra(lists, what)
            return
        uneven = not isinstance(lists, np.ndarray) and len({len(cell) for cell in lists if np.ndim(cell)}) > 1
        if uneven and number in _of_any_length:
            self.ids.append(np.concatenate([whole(cell, what).astype(np.int64) for cell in lists]))
            self.sizes.append(np.array([len(cell) for cell in lists], np.int64))
        else:
            if uneven:
                raise usage("they have different numbers of points", what, "cells of this type all have the same")
            a = np.asarray(lists)
            if a.ndim != 2:
                raise usage(f"{a.ndim} dimensions", what, "one row of point numbers for each cell")
            self.ids.append(whole(a, what))
            self.sizes.append(np.full(len(a), a.shape[1], np.int64))
        self.finish(number)

    def add_polyhedra(self, cells: Sequence[Sequence[Any]], what: str) -> None:
        self.sizes.append(np.zeros(0, np.int64))
        for cell in cells:
            faces = [whole(face, what).astype(np.int64) for face in cell]
            if not faces:
                raise usage("a polyhedron without faces", what, "the point numbers of each of its faces")
            points = np.unique(np.concatenate(faces))
            self.ids.append(points)
            self.sizes[-1] = np.append(self.sizes[-1], len(points))
            self.faces += faces
        self.finish(CELL_TYPES["polyhedron"], np.array([len(cell) for cell in cells], np.int64))

    def finish(self, number: int, face_counts: np.ndarray | None = None) -> None:
        n = len(self.sizes[-1])
        self.types.append(np.full(n, number, np.uint8))
        self.face_counts.append(np.zeros(n, np.int64) if face_counts is None else face_counts)

    def arrays(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, Any]:
        ids = self.ids[0] if len(self.ids) == 1 else np.concatenate([i.astype(np.int64) for i in self.ids])
        faces = None
        if self.faces:
            sizes = np.array([len(f) for f in self.faces], np.int64)
            faces = np.concatenate(self.faces), _begins(sizes), _begins(np.concatenate(self.face_counts))
        return ids, _begins(np.concatenate(self.sizes)), np.concatenate(self.types), faces


def _begins(sizes: np.ndarray) -> np.ndarray:
    return np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)


def surface(points: Any, faces: Any, offsets: Any = None) -> Data:
    """Triangles (``faces`` of shape (n, 3)), or polygons: point numbers one after the other, with ``offsets`` where each begins."""
    if offsets is not None:
        return Data(_core.polygon_mesh(_lent_positions(points), whole(faces, "faces"), whole(offsets, "offsets")))
    a = np.asarray(faces)
    if a.ndim != 2 or a.shape[1] < 3:
        raise usage(f"faces of shape {a.shape}", "surface", "one row of three or more point numbers for each, or offsets")
    if a.shape[1] == 3:
        return Data(_core.triangle_mesh(_lent_positions(points), whole(a, "faces")))
    begins = np.arange(len(a) + 1, dtype=np.int64) * a.shape[1]
    return Data(_core.polygon_mesh(_lent_positions(points), whole(a, "faces"), begins))


def lines(points: Any, lists: Sequence[Any] | None = None) -> Data:
    """Poly-lines: ``lists`` of point numbers, one for each; default: one line through all points in their order."""
    xyz = _positions(points)
    all_lines = [np.arange(len(xyz))] if lists is None else [np.asarray(x, np.int64) for x in lists]
    ids = np.concatenate(all_lines).astype(np.int64) if all_lines else np.empty(0, np.int64)
    offsets = np.concatenate([[0], np.cumsum([len(x) for x in all_lines])]).astype(np.int64)
    return Data(_core.line_mesh(lent(xyz, points), ids, offsets))


def points(xyz: Any) -> Data:
    """Points without cells: rows of x, y and z."""
    return Data(_core.point_cloud(_lent_positions(xyz)))

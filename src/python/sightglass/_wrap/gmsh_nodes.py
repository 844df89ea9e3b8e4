# SPDX-License-Identifier: Apache-2.0
"""The nodes of cells of higher order: meshio keeps them as Gmsh numbers them, VTK and Sightglass number its Lagrange cells otherwise.

Both orders are written down as places on a lattice (corner 1 of a cell of order n lies at n, 0, 0): where the same place stands in each
says how to reorder. As src/io/gmsh/elements.cpp and src/data/cells/node_lattice.cpp do for files.
"""
from __future__ import annotations

from functools import lru_cache
from itertools import product
from typing import Iterable

Place = tuple[int, ...]

_corners: dict[str, list[Place]] = {
    "line": [(0, 0, 0), (1, 0, 0)], "triangle": [(0, 0, 0), (1, 0, 0), (0, 1, 0)], "quad": [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)],
    "tetra": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
    "hexahedron": [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
    "wedge": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)],
}
_edges: dict[str, list[tuple[int, int]]] = {
    "triangle": [(0, 1), (1, 2), (2, 0)], "quad": [(0, 1), (1, 2), (2, 3), (3, 0)],
    "tetra": [(0, 1), (1, 2), (2, 0), (3, 0), (3, 2), (3, 1)],
    "hexahedron": [(0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)],
    "wedge": [(0, 1), (0, 2), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5)],
}
_faces: dict[str, list[tuple[int, ...]]] = {
    "tetra": [(0, 2, 1), (0, 1, 3), (0, 3, 2), (3, 1, 2)],
    "hexahedron": [(0, 3, 2, 1), (0, 1, 5, 4), (0, 4, 7, 3), (1, 2, 6, 5), (2, 3, 7, 6), (4, 5, 6, 7)],
    "wedge": [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (0, 3, 5, 2), (1, 2, 5, 4)],
}
# VTK's Lagrange cells: edges run along the axes of the lattice, faces of solids are listed by rows.
_vtk_edges: dict[str, list[tuple[int, int]]] = {
    "line": [(0, 1)], "triangle": [(0, 1), (1, 2), (2, 0)], "quad": [(0, 1), (1, 2), (3, 2), (0, 3)],
    "tetra": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
    "hexahedron": [(0, 1), (1, 2), (3, 2), (0, 3), (4, 5), (5, 6), (7, 6), (4, 7), (0, 4), (1, 5), (2, 6), (3, 7)],
    "wedge": [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)],
}
_vtk_faces: dict[str, list[tuple[int, ...]]] = {
    "tetra": [(0, 1, 3), (2, 3, 1), (0, 3, 2), (0, 2, 1)],
    "hexahedron": [(0, 3, 7, 4), (1, 2, 6, 5), (0, 1, 5, 4), (3, 2, 6, 7), (0, 1, 2, 3), (4, 5, 6, 7)],
    "wedge": [(0, 1, 2), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
}


@lru_cache(maxsize=None)
def order_of(shape: str, nodes: int) -> list[int] | None:
    """Node k of VTK's cell is node order[k] of meshio's; None where no order of the shape has so many nodes."""
    for n in range(1, 12):
        gmsh = _gmsh(shape, n)
        if len(gmsh) == nodes:
            place = {p: i for i, p in enumerate(gmsh)}
            return [place[p] for p in _vtk(shape, n)]
        if len(gmsh) > nodes:
            break
    return None


def _between(a: Place, b: Place, n: int) -> list[Place]:
    """Inner nodes of the edge from corner a to corner b, both of order 1."""
    return [tuple(p * n + (q - p) * i for p, q in zip(a, b)) for i in range(1, n)]


def _on_face(face: list[Place], inner: Iterable[Place], n: int) -> list[Place]:
    """Nodes given along the first and the last edge of a face."""
    p0, p1, p2 = face[0], face[1], face[-1]
    return [tuple(a * n + (b - a) * i + (c - a) * j for a, b, c in zip(p0, p1, p2)) for i, j, *_ in inner]


def _shifted(places: Iterable[Place], by: Place) -> list[Place]:
    return [tuple(a + b for a, b in zip(p, by)) for p in places]


def _gmsh_inside(shape: str, n: int) -> list[Place]:
    """Inner nodes are those of a smaller cell of the same shape."""
    if shape == "line":
        return [(i, 0, 0) for i in range(1, n)]
    smaller = {"triangle": n - 3, "tetra": n - 4, "quad": n - 2, "hexahedron": n - 2, "wedge": n - 3}[shape]
    if smaller < 0:
        return []
    if shape == "wedge":
        return [(t[0] + 1, t[1] + 1, l[0] + 1) for t in _gmsh("triangle", n - 3) for l in _gmsh("line", n - 2)]
    return _shifted(_gmsh(shape, smaller), (1, 1, 0) if shape in ("triangle", "quad") else (1, 1, 1))


@lru_cache(maxsize=None)
def _gmsh(shape: str, n: int) -> list[Place]:
    if n == 0:
        return [(0, 0, 0)]
    corners = _corners[shape]
    places = [tuple(c * n for c in corner) for corner in corners]
    if n > 1:
        for a, b in _edges.get(shape, []):
            places += _between(corners[a], corners[b], n)
        for face in _faces.get(shape, []):
            places += _on_face([corners[c] for c in face], _gmsh_inside("triangle" if len(face) == 3 else "quad", n), n)
        places += _gmsh_inside(shape, n)
    return places


def _rows(shape: str, n: int) -> list[Place]:
    """Inner nodes of a face by rows along its first edge, or of a solid by layers of them."""
    inner = range(1, n)
    if shape == "line":
        return []
    if shape == "triangle":
        return [(i, j, 0) for j in inner for i in range(1, n - j)]
    if shape == "quad":
        return [(i, j, 0) for j, i in product(inner, inner)]
    return [(i, j, k) for k, j, i in product(inner, inner, inner) if shape == "hexahedron" or i + j < n]


@lru_cache(maxsize=None)
def _vtk(shape: str, n: int) -> list[Place]:
    if n == 0:
        return [(0, 0, 0)]
    corners = _corners[shape]
    places = [tuple(c * n for c in corner) for corner in corners]
    if n > 1:
        for a, b in _vtk_edges[shape]:
            places += _between(corners[a], corners[b], n)
        for face in _vtk_faces.get(shape, []):
            places += _on_face([corners[c] for c in face], _vtk_face("triangle" if len(face) == 3 else "quad", n, shape == "tetra"), n)
        smaller = {"triangle": n - 3, "tetra": n - 4}.get(shape)
        if smaller is None:
            places += _rows(shape, n)
        elif smaller >= 0:  # simplices list an inner one
            places += _shifted(_vtk(shape, smaller), (1, 1, 0) if shape == "triangle" else (1, 1, 1))
    return places


def _vtk_face(shape: str, n: int, of_tetra: bool) -> list[Place]:
    if not of_tetra:
        return _rows(shape, n)
    return _shifted(_vtk("triangle", n - 3), (1, 1, 0)) if n > 2 else []

# SPDX-License-Identifier: Apache-2.0
"""Objects of other libraries as data. None of these libraries is needed, and none is imported before an object of it comes along."""
from __future__ import annotations

import inspect
from importlib import import_module
from typing import Any, Callable

from .._data import Data
from .._errors import usage

# The package that a class comes from, and the module here that takes its objects. Classes derived elsewhere (PyVista's) count as well.
_takers = {"vtkmodules": "vtk", "xarray": "xarray", "pandas": "pandas", "meshio": "meshio", "nibabel": "nibabel", "openvdb": "openvdb",
           "pyopenvdb": "openvdb"}
_known = ("data sets of VTK and PyVista, DataArray and Dataset of xarray, DataFrame and Series of pandas, Mesh of meshio, images of nibabel, "
          "grids of OpenVDB")


def wrap(x: Any, **hints: Any) -> Data:
    """Data of what another library holds: wrap(pyvista_mesh), wrap(xarray_dataset, time="2013-01-01").

    Known are data sets of VTK and PyVista, xarray, pandas, meshio, nibabel images and OpenVDB grids. Their arrays are used where they lie,
    if their layout permits, and read-only from then on. Fields keep names, units and places (points, cells, the whole). ``hints`` depend on
    the library: ``time``, ``components``, ``dims`` and names of dimensions (xarray), ``time`` and ``components`` (nibabel), ``units`` and
    ``index`` (pandas), ``units`` (meshio), ``box`` (OpenVDB).
    """
    if isinstance(x, Data):
        return x
    for base in type(x).__mro__:
        library = _takers.get(base.__module__.partition(".")[0])
        if library is not None:
            take = import_module(f"{__name__}.{library}").wrap
            _check(take, hints, x)
            return take(x, **hints)
    if hasattr(x, "__array__") or hasattr(x, "__dlpack__"):
        raise usage(f"{_name(x)} says nothing about places in space", "wrap", "uniform(array, spacing=...), points(xyz) or table({...})")
    raise usage(f"objects of type {_name(x)} are not known", "wrap", "known are: " + _known)


def _name(x: Any) -> str:
    module = type(x).__module__
    return type(x).__qualname__ if module == "builtins" else f"{module.partition('.')[0]}.{type(x).__qualname__}"


def _check(take: Callable[..., Data], hints: dict[str, Any], x: Any) -> None:
    known = list(inspect.signature(take).parameters.values())[1:]
    if any(p.kind is p.VAR_KEYWORD for p in known):
        return
    names = [p.name for p in known]
    for hint in hints:
        if hint not in names:
            raise usage(f"hint '{hint}' is not known for a {_name(x)}", "wrap", "one of " + ", ".join(names) if names else "it takes none")

# SPDX-License-Identifier: Apache-2.0
"""Objects of other libraries as data. None of these libraries is needed, and none is imported before an object of it comes along."""
from __future__ import annotations

import inspect
from collections.abc import Callable
from importlib import import_module

from .._data import Data
from .._errors import usage
from .._meshes import uniform

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

# The package that a class comes from, and the module here that takes its objects. Classes derived elsewhere (PyVista's) count as well.
_takers = {"vtkmodules": "vtk", "xarray": "xarray", "pandas": "pandas", "meshio": "meshio", "nibabel": "nibabel", "openvdb": "openvdb",
           "pyopenvdb": "openvdb"}
_known = ("data sets of VTK and PyVista, DataArray and Dataset of xarray, DataFrame and Series of pandas, Mesh of meshio, "
          "images of nibabel, grids of OpenVDB, arrays")


def wrap(x: Any, /, **hints: Any) -> Data:
    """Data of what another library holds: wrap(pyvista_mesh), wrap(xarray_dataset, time="2013-01-01").

    Known are data sets of VTK and PyVista, xarray, pandas, meshio, nibabel images and OpenVDB grids; arrays are taken as uniform() does.
    What they hold is used where it lies, if its layout permits, and read-only from then on. Fields keep names, units and places (points,
    cells, the whole). ``hints`` depend on the library: ``time``, ``components``, ``dims`` and names of dimensions (xarray), ``time`` and
    ``components`` (nibabel), ``units`` and ``index`` (pandas), ``units`` (meshio), ``box`` (OpenVDB).
    """
    if isinstance(x, Data):
        return x
    for base in type(x).__mro__:
        library = _takers.get(base.__module__.partition(".")[0])
        if library is not None:
            module = import_module(f"{__name__}.{library}")
            take = getattr(module, "wrap", None) or module.wrapped
            _check(take, hints, x)
            return take(x, **hints)
    if any(hasattr(x, way) for way in ("__array__", "__array_interface__", "__dlpack__")):
        return uniform(x, **hints)
    raise usage(f"objects of type {_name(x)} are not known", "wrap", "known are: " + _known)


def _name(x: Any) -> str:
    return f"{type(x).__module__.partition('.')[0]}.{type(x).__qualname__}"


def _check(take: Callable[..., Data], hints: dict[str, Any], x: Any) -> None:
    known = list(inspect.signature(take).parameters.values())[1:]
    if any(p.kind is p.VAR_KEYWORD for p in known):
        return
    names = [p.name for p in known]
    for hint in hints:
        if hint not in names:
            raise usage(f"'{hint}' is no hint for a {_name(x)}", "wrap", "one of " + ", ".join(names) if names else "it needs none")

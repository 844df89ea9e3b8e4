# SPDX-License-Identifier: Apache-2.0
"""Trustworthy pictures from simulation and scanner data: numpy in, picture out.

    import sightglass as sg
    ds = sg.read("wing.vtu")
    ds.contour(field="mach", values=[1]).plot().save("shock.png")

Operations are functions and methods: sg.contour(ds, ...), ds.contour(...); sg.help("contour") tells their parameters, help() alone lists
them. What is chosen goes to the logger "sightglass", warnings to `warnings`.
"""
from __future__ import annotations

from . import _core, _operations
from ._data import Data
from ._errors import CancelledError, DataError, Error, InternalError, SightglassWarning, UnknownNameError, UsageError
from ._groups import amr, collection, series, table
from ._meshes import CELL_TYPES, curvilinear, lines, points, rectilinear, surface, uniform, unstructured
from ._pipeline import Pipeline, open, pipeline
from ._progress import set_progress
from ._scene import Picture, Scene
from ._wrap import wrap

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from ._legend import Legend

__version__ = _core.version()
__all__ = ["CELL_TYPES", "CancelledError", "Data", "DataError", "Error", "InternalError", "Legend", "Picture", "Pipeline", "Scene", "SightglassWarning",
           "UnknownNameError", "UsageError", "amr", "collection", "curvilinear", "help", "lines", "pipeline", "points", "read", "rectilinear",
           "scene", "series", "set_memory_limit", "set_progress", "set_threads", "surface", "table", "times", "uniform", "unstructured",
           "wrap"]
# Not open: `from sightglass import *` leaves Python's own alone.

set_threads = _core.set_threads
set_memory_limit = _core.set_memory_limit


def read(path: Any, **params: Any) -> Data:
    """Any file that `sightglass info` reads; of a series ("flow_*.vtu") one step. Parameters: help("read"): fields, time, region, ..."""
    return Data(_core.read(str(path), params))


def times(path: Any) -> list[float]:
    """The times of a series, ascending; none for a file without time."""
    return _core.times(str(path))


def scene() -> Scene:
    """An empty scene: scene().add(ds, "volume", preset="ct_bone").render()."""
    return Scene()


def help(name: str = "") -> None:  # noqa: A001  what Python's own does, for operations
    """Prints what `sightglass ops NAME` prints: an operation, its parameters, units, ranges and choices; without a name all operations."""
    print(_core.help(name), end="")


# What follows is for names that are not written down above: the operations. Type checkers take them from the stub.
def __getattr__(name: str) -> Any:
    if name == "Legend":
        from ._legend import Legend

        return Legend
    f = _operations.function(name) if not name.startswith("_") else None
    if f is None:
        near = _operations.nearest(name) if not name.startswith("_") else ""
        hint = f"did you mean '{near}'?" if near else ""
        raise UnknownNameError(f"sightglass has no operation '{name}'" + (f"; {hint}" if hint else ""), f"unknown operation '{name}'", "", hint)
    return f


def __dir__() -> list[str]:
    return [*__all__, *_operations.names()]

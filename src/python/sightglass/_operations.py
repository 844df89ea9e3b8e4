# SPDX-License-Identifier: Apache-2.0
"""Operations and sources as functions and methods, made of the schema that `sightglass ops --json` prints."""
from __future__ import annotations

import keyword
from collections.abc import Callable, Sequence
from functools import lru_cache

from . import _core

TYPE_CHECKING = False  # the module typing takes as long to import as all of this package
if TYPE_CHECKING:
    import inspect
    from typing import Any

    from ._data import Data


@lru_cache(maxsize=None)
def catalog() -> dict[str, Any]:
    """Sources, operations, ways to show, readers, writers, camera, picture, film, lights, environments and nodes of scenes with JSON Schemas of their parameters."""
    import json  # here and below: what only some programs need does not slow the start of all

    return json.loads(_core.catalog_json())


@lru_cache(maxsize=None)
def _entries() -> dict[str, dict[str, Any]]:
    return {e["name"]: e for kind in ("sources", "operations") for e in catalog()[kind]}


def names(kind: str = "") -> list[str]:
    """Of the operations, of the sources (kind "operation", "source"), or of both."""
    return [n for n, e in _entries().items() if not kind or (e["kind"] == "source") == (kind == "source")]


def nearest(name: str) -> str:
    """The name that is most like it; "" for none."""
    import difflib

    return next(iter(difflib.get_close_matches(name, _entries(), 1)), "")


_types = {"integer": int, "number": float, "string": str, "boolean": bool}


def _annotation(schema: dict[str, Any]) -> Any:
    from typing import Any, Union

    for several in ("anyOf", "oneOf"):
        if several in schema:
            return Union[tuple(_annotation(s) for s in schema[several])]
    kind = schema.get("type")
    if isinstance(kind, list):
        return Union[tuple(_types.get(k, Any) for k in kind)]
    if kind == "array":
        items: Any = _annotation(schema.get("items", {}))
        return Sequence[items]
    return _types.get(str(kind), Any)


def python_name(name: str) -> str:
    """`lambda` is a word of Python: `lambda_`."""
    return name + "_" if keyword.iskeyword(name) else name


def _line(name: str, schema: dict[str, Any]) -> str:
    notes = []
    if "unit" in schema and not schema["unit"].endswith("color"):  # which marks colours for windows
        notes.append(f"in {schema['unit']}")
    if "enum" in schema:
        notes.append(" | ".join(map(str, schema["enum"])))
    for word, text in (("minimum", "at least"), ("exclusiveMinimum", "above"), ("maximum", "at most"), ("exclusiveMaximum", "below")):
        if word in schema:
            notes.append(f"{text} {schema[word]}")
    if "default" in schema:
        notes.append(f"default {schema['default']!r}")
    return f"    {python_name(name)}: {schema.get('description', '')}" + (f" [{', '.join(notes)}]" if notes else "")


def _document(f: Callable, entry: dict[str, Any], first: Sequence["inspect.Parameter"]) -> Callable:
    import inspect
    from typing import Optional

    properties = entry["params"].get("properties", {})
    parameters = list(first)
    for name, schema in properties.items():
        parameters.append(inspect.Parameter(python_name(name), inspect.Parameter.KEYWORD_ONLY, default=schema.get("default"),
                                            annotation=Optional[_annotation(schema)]))
    lines = [entry["sentence"], ""]
    if properties:
        lines += ["Parameters", "----------", *(_line(n, s) for n, s in properties.items())]
    f.__signature__ = inspect.Signature(parameters, return_annotation="Data")  # type: ignore[attr-defined]
    f.__name__ = f.__qualname__ = entry["name"]
    f.__doc__ = "\n".join(lines)
    f.__module__ = "sightglass"
    return f


def _stated(params: dict[str, Any]) -> dict[str, Any]:
    return {n[:-1] if n.endswith("_") and keyword.iskeyword(n[:-1]) else n: v for n, v in params.items()}


@lru_cache(maxsize=None)
def function(name: str) -> Callable | None:
    """sg.contour(data, values=[1]) or sg.gyroid(size=64); None for an unknown name."""
    from ._data import Data

    entry = _entries().get(name)
    if entry is None:
        return None
    if entry["kind"] == "source":
        def source(**params: Any) -> Data:
            return Data(_core.source(name, _stated(params)))

        return _document(source, entry, [])

    def operation(data: Data, *others: Data, **params: Any) -> Data:
        return Data(data._core.run(name, _stated(params), [o._core for o in others]))

    import inspect

    positional = inspect.Parameter("data", inspect.Parameter.POSITIONAL_ONLY, annotation="Data")
    more = inspect.Parameter("others", inspect.Parameter.VAR_POSITIONAL, annotation="Data")
    return _document(operation, entry, [positional] + ([more] if entry["inputs"][1] != 1 else []))


def method(name: str) -> Callable | None:
    """data.contour(values=[1]); None for an unknown name and for sources."""
    entry = _entries().get(name)
    return function(name) if entry is not None and entry["kind"] != "source" else None

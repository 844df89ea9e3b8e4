# SPDX-License-Identifier: Apache-2.0
"""Pipelines that are kept, changed and run again."""
from __future__ import annotations

import os
import warnings

from . import _core
from ._data import Data
from ._errors import SightglassWarning
from ._scene import Picture, wrapped

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any


class Pipeline:
    """Steps that run when their results are needed. Results are kept, so that after a change only what lies below it runs again:

        p = sg.pipeline(sg.read("ct.mhd").gaussian_smooth(sigma=1).contour(values=[300]))
        for value in (300, 500, 1150):
            p.set("contour", values=[value]).render().save(f"{value}.png")
    """

    __slots__ = ("_core",)

    def __init__(self, core: _core.Pipeline):
        self._core = core

    @property
    def steps(self) -> dict[str, dict[str, Any]]:
        """By name, in order: the operation ("read", a source, ...), what is stated, as text, and the steps that it takes."""
        return {name: {"operation": operation, "stated": dict(stated), "from": list(above)}
                for name, operation, stated, above in self._core.steps()}

    def set(self, step: str, **params: Any) -> Pipeline:
        """States parameters of a step anew; None takes one back."""
        self._core.set(step, params)
        return self

    def result(self, step: str = "") -> Data:
        """Of a step; default: the last one."""
        return Data(self._core.result(step))

    def render(self, size: tuple[int, int] | None = None, on_picture: Callable[[Picture], Any] | None = None) -> Picture:
        """What it shows; where it shows nothing, what suits the last results. ``size``: as it states, else 1280x720.

        ``on_picture``: as of :meth:`Scene.render`.
        """
        of = _core.Pipeline(self._core)
        return Picture(self._core.render(*(int(n) for n in size or (0, 0)), wrapped(on_picture, of)), of)

    def explain(self) -> str:
        """The plan as a table: what runs, what is cached, with sizes and times expected."""
        return self._core.explain()

    @property
    def text(self) -> str:
        """As YAML, for `sightglass run`."""
        return self._core.text()

    def save(self, path: Any) -> None:
        """As a file for `sightglass run`."""
        self._core.write(str(path))

    def set_cache_limit(self, bytes: int) -> None:  # noqa: A002
        """How much of the results is kept beyond their use; 512 MB at first."""
        self._core.set_cache_limit(int(bytes))

    def _repr_png_(self) -> bytes:
        return self.render()._repr_png_()

    def __repr__(self) -> str:
        return f"<sightglass.Pipeline: {' > '.join(self.steps)}>"


def pipeline(of: Data | str | os.PathLike) -> Pipeline:
    """Of data: the steps that they came from. Of text or of a file (.yaml): what `sightglass run` does."""
    if isinstance(of, Data):
        return Pipeline(_core.Pipeline(of._core))
    text = os.fspath(of)
    if "\n" in text:
        return Pipeline(_core.Pipeline.parse(text))
    return Pipeline(_core.Pipeline.read(text))


def open(picture: str | os.PathLike) -> Pipeline:  # noqa: A001
    """The pipeline in a picture that Sightglass made: open("a.png").render() makes it again.

    A picture of a stranger is data from outside: its pipeline may read only below the folder of the picture and the working folder, and
    write nothing. Inputs that have changed since are warned of.
    """
    core, changed = _core.Pipeline.open(os.fspath(picture))
    for path in changed:
        warnings.warn(f"'{path}' has changed since the picture was made", SightglassWarning, stacklevel=2)
    return Pipeline(core)

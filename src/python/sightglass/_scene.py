# SPDX-License-Identifier: Apache-2.0
"""What is to be seen, from where, and the picture of it."""
from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from . import _core
from ._data import Data
from ._errors import usage

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from ._legend import Legend
    from ._page import Page


def _at_values(value: Any) -> Any:
    """A mapping from values to opacities or colours in the words of the command line."""
    return ",".join(f"@{float(at)!r}:{what}" for at, what in value.items()) if isinstance(value, Mapping) else value


def wrapped(on_picture: Callable[[Picture], Any] | None, of: _core.Scene | _core.Pipeline) -> Any:
    """The same for pictures of the core."""
    return None if on_picture is None else lambda core: on_picture(Picture(core, of))


class Picture:
    """Pixels, with the pipeline that makes them again and what was chosen. A notebook shows it."""

    __slots__ = ("_core", "_of", "__weakref__")

    def __init__(self, core: _core.Image, of: _core.Scene | _core.Pipeline):
        self._core = core
        self._of = of  # as it was when the picture was drawn

    @property
    def array(self) -> np.ndarray:
        """(height, width, 3 or 4) bytes, sRGB, rows from the top."""
        return self._core.pixels()

    @property
    def depth(self) -> np.ndarray:
        """(height, width): how far what is seen lies along the view, in units of the data; of volumes where half of the light is gone;
        infinity where nothing is."""
        return self._core.depth()

    @property
    def error(self) -> np.ndarray:
        """(height, width): of pictures by paths of light (``integrator``) the standard error of each pixel as displayed, as a share of full
        scale, before denoising; else of no rows."""
        return self._core.error()

    @property
    def ids(self) -> np.ndarray:
        """(height, width): which of what was added to the scene is seen: 1 is the first, 0 nothing, legends or axes."""
        return self._core.ids()

    @property
    def legend(self) -> list[Legend]:
        """What the legends say; empty without legends."""
        from ._legend import Entry, Legend

        return [Legend(title, unit, scale, (low, high), colors, [Entry(*e) for e in entries], np.array(opacity, float).reshape(-1, 2))
                for title, unit, scale, low, high, colors, entries, opacity in self._core.legends()]

    @property
    def size(self) -> tuple[int, int]:
        """Width and height."""
        return self._core.width, self._core.height

    @property
    def notes(self) -> list[str]:
        """What was chosen and why."""
        return self._core.notes()

    @property
    def recipe(self) -> str:
        """The pipeline that makes this picture again (`sightglass run`, `sightglass open`), as YAML."""
        return self._core.recipe()

    def save(self, path: Any) -> None:
        """As .png (with the recipe), .jpg or .webp."""
        self._core.write(str(path))

    def interactive(self, **params: Any) -> Page:
        """The same picture as a page that turns, for notebooks and files; parameters: see sightglass.help("page").

        ``max``: the most bytes it may have, e.g. "2M"; ``times``: its time steps, as of :meth:`Scene.movie`.
        """
        from ._page import Page

        return Page(self._of.page(params, *self.size), self.size)

    def _repr_png_(self) -> bytes:
        return self._core.png()

    def __repr__(self) -> str:
        return f"<sightglass.Picture: {self.size[0]}x{self.size[1]}>"


class Scene:
    """Data and how they are shown. Calls chain: Scene().add(a, "volume").camera(view="front").render()."""

    __slots__ = ("_core",)

    def __init__(self) -> None:
        self._core = _core.Scene()

    def add(self, data: Data, show: str = "auto", **params: Any) -> Scene:
        """``show``: "surface", "volume", "lines", "points", "labels", "glyphs" or "outline", with its parameters; "auto" chooses.

        What changes with the value is a mapping: opacity={180: 0, 450: 0.6}, colors={0: "black", 100: "#ffcc80"}.
        """
        self._core.show(data._core, show, {name: _at_values(value) for name, value in params.items()})
        return self

    def camera(self, **params: Any) -> Scene:
        """view, direction, azimuth, zoom, ...: see sightglass.help("camera"). What is not said follows from the data."""
        self._core.camera(params)
        return self

    def picture(self, **params: Any) -> Scene:
        """title, background, legend, axes, ...: see sightglass.help("picture")."""
        self._core.picture(params)
        return self

    def render(self, size: tuple[int, int] = (1280, 720), on_picture: Callable[[Picture], Any] | None = None) -> Picture:
        """The picture, ``size`` pixels wide and high.

        ``on_picture`` is called with pictures by paths of light (``integrator``) while they grow: one at once, then better ones.
        """
        of = _core.Scene(self._core)
        return Picture(self._core.render(int(size[0]), int(size[1]), wrapped(on_picture, of)), of)

    def interactive(self, size: tuple[int, int] = (1280, 720), **params: Any) -> Page:
        """A page that turns, as :meth:`Picture.interactive`."""
        from ._page import Page

        return Page(self._core.page(params, int(size[0]), int(size[1])), (int(size[0]), int(size[1])))

    def movie(self, path: Any, size: tuple[int, int] = (1280, 720), orbit: float | None = None, frames: int = 120, **params: Any) -> list[float]:
        """A film of what moves: .webm, .gif or numbered pictures ("a_{n}.png"); parameters: see sightglass.help("film"). Returns the times.

        ``orbit``: the camera goes around by so many degrees, in ``frames`` pictures; 360 comes back to where it began, without showing the
        first picture twice.
        """
        if orbit is None:
            return self._core.film(str(path), params, int(size[0]), int(size[1]))
        if "times" in params or frames < 1:
            raise usage("orbit= and times= say both how long it is" if "times" in params else f"frames={frames}", "movie",
                        "one of them, and one frame or more")
        turning = _core.Scene(self._core)
        turning.camera({"azimuth": "{t}"})
        last = orbit * (frames - 1) / frames if abs(orbit) == 360 else orbit
        times = [last * i / max(frames - 1, 1) for i in range(frames)]
        return turning.film(str(path), {**params, "times": times}, int(size[0]), int(size[1]))

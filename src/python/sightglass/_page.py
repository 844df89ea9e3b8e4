# SPDX-License-Identifier: Apache-2.0
"""A picture that turns, as the text of one HTML file."""
from __future__ import annotations

import os
from html import escape
from typing import Any


class Page:
    """A notebook shows it in a frame of its own; :meth:`save` writes the file. It asks no network for anything."""

    __slots__ = ("html", "size")

    def __init__(self, html: str, size: tuple[int, int]):
        self.html = html
        self.size = size

    def save(self, path: Any) -> None:
        """As .html; written beside and renamed, so that there is all of it or nothing."""
        path = os.fspath(path)
        partial = f"{path}.partial-{os.getpid()}"
        try:
            with open(partial, "w", encoding="utf-8", newline="\n") as file:
                file.write(self.html)
            os.replace(partial, path)
        except BaseException:
            if os.path.exists(partial):
                os.remove(partial)
            raise

    def _repr_html_(self) -> str:
        width, height = self.size
        return (f'<iframe srcdoc="{escape(self.html)}" sandbox="allow-scripts allow-downloads" '
                f'style="width: 100%; max-width: {width}px; aspect-ratio: {width} / {height}; border: 0"></iframe>')

    def __repr__(self) -> str:
        return f"<sightglass.Page: {self.size[0]}x{self.size[1]}, {len(self.html) / 2**20:.1f} MiB>"

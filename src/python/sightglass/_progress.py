# SPDX-License-Identifier: Apache-2.0
"""How far long work is: a line of the terminal, or a bar in a notebook; nothing elsewhere."""
from __future__ import annotations

import sys

from . import _core

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_bar: Any = None  # of a notebook


def _in_notebook() -> bool:
    shell = sys.modules.get("IPython")
    return shell is not None and type(shell.get_ipython()).__name__ == "ZMQInteractiveShell"


def set_progress(on: bool | None = None) -> None:
    """Whether work of more than half a second tells how far it is; None: where somebody can see it, in terminals and notebooks."""
    _core.show_progress(bool(on) if on is not None else _in_notebook() or bool(sys.stderr and sys.stderr.isatty()))


def text(fraction: float, doing: str, seconds: float) -> str:
    """"45% rendering, 12 s left"; the rest is told once it can be estimated."""
    left = seconds * (1 - fraction) / fraction if fraction > 0.05 else 0
    return f"{100 * fraction:.0f}% {doing}" + (f", {left:.0f} s left" if left >= 1 else "")


def show(fraction: float, doing: str, seconds: float) -> None:
    """Called by the work."""
    global _bar
    words = text(fraction, doing, seconds)
    if not _in_notebook():
        print(f"\r\x1b[K{words}", end="", file=sys.stderr, flush=True)
        return
    from IPython.display import HTML, display  # type: ignore[import]

    bar = HTML(f'<progress value="{fraction:.3f}" max="1"></progress> {words}')
    if _bar is None:
        _bar = display(bar, display_id=True)
    else:
        _bar.update(bar)


def end() -> None:
    """The work is over, or was stopped."""
    global _bar
    if not _in_notebook():
        print("\r\x1b[K", end="", file=sys.stderr, flush=True)
    elif _bar is not None:
        from IPython.display import HTML

        _bar.update(HTML(""))
        _bar = None


set_progress()

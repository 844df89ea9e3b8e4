# SPDX-License-Identifier: Apache-2.0
"""What goes wrong, and what the library says while it works."""
from __future__ import annotations

import sys
import warnings


class Error(Exception):
    """Whatever goes wrong: ``what`` is the problem, ``where`` the operation and parameter or the file, ``right`` what would be right."""

    def __init__(self, text: str, what: str = "", where: str = "", right: str = ""):
        super().__init__(text)
        self.what, self.where, self.right = what or text, where, right

    def __str__(self) -> str:  # KeyError would print its repr
        return str(self.args[0]) if self.args else ""


class UsageError(Error, ValueError):
    """The caller has to act: an unknown name, a value out of range, an operation that does not fit the data."""


class UnknownNameError(UsageError, KeyError, AttributeError):
    """There is no field, operation or parameter of that name; ``right`` names the nearest."""


class DataError(Error, ValueError):
    """The file or the numbers are damaged, or too large for the limits."""


class InternalError(Error, RuntimeError):
    """A mistake of Sightglass."""


class CancelledError(Error):
    """The work was stopped."""


class SightglassWarning(UserWarning):
    """Something that was mended, left out or looks wrong."""


_kinds = {"usage": UsageError, "data": DataError, "internal": InternalError, "cancelled": CancelledError}


def made(kind: str, text: str, what: str, where: str, right: str) -> Error:
    """The exception for an error of the library."""
    unknown = kind == "usage" and (what.startswith("unknown ") or what.endswith(" not found"))
    return (UnknownNameError if unknown else _kinds[kind])(text, what, where, right)


def usage(what: str, where: str = "", right: str = "") -> UsageError:
    """The exception for a mistake that is found before the library is asked."""
    text = (where + ": " if where else "") + what + ("; " + right if right else "")
    return UsageError(text, what, where, right)


def say(warning: bool, text: str) -> None:
    """Notes go to the logger ``sightglass``, if the program logs at all, warnings to ``warnings``."""
    if warning:
        warnings.warn(text, SightglassWarning, stacklevel=4)
    elif logging := sys.modules.get("logging"):
        logging.getLogger("sightglass").info(text)

# SPDX-License-Identifier: Apache-2.0
"""The methods of data that run operations. They are made when they are asked for (Data.__getattr__); the stub beside this file, which
tools/python_stubs writes from the schema, tells editors and type checkers their parameters."""


class Methods:
    """Nothing at run time."""

    __slots__ = ()

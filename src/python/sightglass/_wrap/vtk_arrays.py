# SPDX-License-Identifier: Apache-2.0
"""Arrays of VTK as numpy arrays and back, where they lie."""
from __future__ import annotations

from typing import Any

import numpy as np

from .._errors import say
from .shared import Field, needed, unused


def numbers(array: Any, what: str) -> np.ndarray:
    """A view that holds the array. Arrays that are computed, or whose components lie apart, are copied."""
    support = needed("vtkmodules.util.numpy_support", "wrap")
    constants = needed("vtkmodules.util.vtkConstants", "wrap")
    if not array.HasStandardMemoryLayout():
        say(False, f"{what}: copied, a {array.GetClassName()} does not hold its numbers one after the other")
        plain = array.CreateDataArray(array.GetDataType())
        plain.DeepCopy(array)
        array = plain
    if array.GetDataType() == constants.VTK_BIT:
        bytes_of_bits = needed("vtkmodules.vtkCommonCore", "wrap").vtkUnsignedCharArray()
        bytes_of_bits.DeepCopy(array)
        array = bytes_of_bits
    return support.vtk_to_numpy(array)


def unit_of(array: Any) -> str:
    """What VTK keeps under the key UNITS_LABEL."""
    key = needed("vtkmodules.vtkCommonCore", "wrap").vtkDataArray.UNITS_LABEL()
    return array.GetInformation().Get(key) or "" if array.HasInformation() and array.GetInformation().Has(key) else ""


def words(array: Any) -> list[str]:
    """Of a vtkStringArray."""
    return [array.GetValue(i) for i in range(array.GetNumberOfValues())]


def is_numbers(array: Any) -> bool:
    return hasattr(array, "GetRange")  # those of vtkDataArray have one, words and variants none


def fields(attributes: Any, on: str) -> list[Field]:
    """The arrays of numbers of points, cells or the whole; others are left out and named."""
    found: list[Field] = []
    names: set[str] = set()
    for i in range(attributes.GetNumberOfArrays()):
        array = attributes.GetAbstractArray(i)
        name = unused(array.GetName() or f"array {i}", lambda n: n in names)
        names.add(name)
        if not is_numbers(array):
            say(False, f"wrap: '{name}' is left out, fields hold numbers and a {array.GetClassName()} does not")
        elif array.GetNumberOfTuples() or on != "whole":
            found.append(Field(name, on, numbers(array, f"wrap '{name}'"), unit_of(array)))
    return found


def array_of(values: np.ndarray, name: str = "", unit: str = "", kind: int | None = None) -> Any:
    """An array of VTK over these numbers; it holds them as long as it lives."""
    support = needed("vtkmodules.util.numpy_support", "to_vtk")
    array = support.create_vtk_array(support.get_vtk_array_type(values.dtype) if kind is None else kind)
    values = np.ascontiguousarray(values)
    array.SetNumberOfComponents(values.shape[1] if values.ndim == 2 else 1)
    array.SetVoidArray(values.reshape(-1), values.size, 1)
    hold(array, values)
    if name:
        array.SetName(name)
    if unit:
        array.GetInformation().Set(needed("vtkmodules.vtkCommonCore", "to_vtk").vtkDataArray.UNITS_LABEL(), unit)
    return array


def hold(array: Any, values: np.ndarray) -> None:
    """Keeps the memory of an array that VTK made over it, until that is deleted, whoever has it then. An attribute (numpy_to_vtk uses one)
    would be let go only when Python drops another object of VTK later on, and the numbers would stay read-only until then."""
    array.AddObserver("UserEvent", _Holder(values))  # which nobody sends


class _Holder:
    __slots__ = ("values",)

    def __init__(self, values: np.ndarray):
        self.values = values

    def __call__(self, *event: Any) -> None:
        """Nothing happens."""

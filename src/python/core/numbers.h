// SPDX-License-Identifier: Apache-2.0
// numpy arrays and those of the library, both ways without a copy.
#pragma once
#include <pybind11/numpy.h>

#include "api/sightglass.h"

namespace sightglass::python {

/// An array as the library takes it, and the one that the user gave, of which it may be a view.
struct Numbers {
  pybind11::array used;
  pybind11::object given;
};

/// Tuples of an array of one or two dimensions, whose numbers within a tuple lie one after the other, used where they lie: the array, the
/// one that was given, and what they are views of are read-only from now on until everything that was made from them is gone. Throws
/// TypeError for numbers that the library does not know (_numbers.py sees to it that none come).
Array array_of(const Numbers& numbers);

/// A read-only view of the numbers, which keeps them there; a copy where they lie apart. One dimension for single numbers, else two.
pybind11::array numpy_of(const Array& array);

}  // namespace sightglass::python

/// A pair (used, given), or one array that is both.
template <>
struct pybind11::detail::type_caster<sightglass::python::Numbers> {
  PYBIND11_TYPE_CASTER(sightglass::python::Numbers, const_name("Numbers"));
  bool load(handle from, bool) {
    if (isinstance<array>(from)) {
      value = {reinterpret_borrow<array>(from), reinterpret_borrow<object>(from)};
      return true;
    }
    if (!isinstance<tuple>(from) || len(from) != 2 || !isinstance<array>(from[int_(0)])) return false;
    value = {array(from[int_(0)]), object(from[int_(1)])};
    return true;
  }
};

// SPDX-License-Identifier: Apache-2.0
// Python objects as the values of parameters.
#pragma once
#include <pybind11/pybind11.h>

#include "api/sightglass.h"

namespace sightglass::python {

/// None, bool, numbers (numpy's too), text, and lists, tuples and arrays of numbers or texts. Throws TypeError naming the parameter.
Value value_of(const std::string& name, pybind11::handle object);
/// Names and values of a dict; None stands for a parameter that is not stated.
Params params_of(const pybind11::dict& stated);

}  // namespace sightglass::python

// SPDX-License-Identifier: Apache-2.0
// The parts of the module _core.
#pragma once
#include <pybind11/pybind11.h>

namespace sightglass::python {

void declare_data(pybind11::module_& m);
void declare_pictures(pybind11::module_& m);

}  // namespace sightglass::python

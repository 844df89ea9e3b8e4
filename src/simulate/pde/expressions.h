// SPDX-License-Identifier: Apache-2.0
// Expressions of x, y, z and time as numbers at the points of a grid (filter/field/calc).
#pragma once
#include <string>

#include "simulate/pde/room.h"

namespace sg::pde {

/// Component `component` of the expression at each point of the grid. Throws Error(usage) for mistakes in it and too few components, and
/// Error(data) where a value is not finite; `who` names the parameter in both.
Values values_of(const std::string& expression, const UniformGrid& grid, double time, const std::string& who, const Context& context,
                 int component = 0);

/// Whether its values change with time.
bool depends_on_time(const std::string& expression);

}  // namespace sg::pde

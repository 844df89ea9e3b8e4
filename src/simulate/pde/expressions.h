// SPDX-License-Identifier: Apache-2.0
// Expressions of x, y, z and time as numbers at the points of a grid (filter/field/calc).
#pragma once
#include <array>
#include <string>

#include "simulate/pde/room.h"

namespace sg::pde {

/// Component `component` of the expression at each point of the grid. Throws Error(usage) for mistakes in it and too few components, and
/// Error(data) where a value is not finite; `who` names the parameter in both.
Values values_of(const std::string& expression, const UniformGrid& grid, double time, const std::string& who, const Context& context,
                 int component = 0);

/// Places along an axis of the box as an expression, from 0 on in units of its longest side; 0.5 along axes without extent.
std::string place_in(const Room& room, size_t axis);
/// exp(-sharpness r^2) about a place, given in shares of the sides.
std::string bump_in(const Room& room, double sharpness, std::array<double, 3> shares);

/// Whether its values change with time.
bool depends_on_time(const std::string& expression);

}  // namespace sg::pde

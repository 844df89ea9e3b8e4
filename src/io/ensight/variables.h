// SPDX-License-Identifier: Apache-2.0
// The values of one variable of an EnSight Gold case, put on the parts of its geometry.
#pragma once
#include "io/ensight/case_file.h"
#include "io/ensight/geometry.h"

namespace sg::ensight {

/// Our component of a listed one: EnSight lists a symmetric tensor as 11 22 33 12 13 23, we as xx yy zz xy yz xz.
int component_of(VariableKind kind, int listed);

/// Reads one file (one step of it) and adds a field of that name, real or imaginary part, to each part that the file has values
/// for. What the file leaves out (undef, partial, missing elements) is NaN. With `look_only` values are skipped and placeholders are added.
/// Throws Error(data).
void read_variable(Stream& s, const Variable& v, const std::string& name, Geometry& geometry, bool look_only);

/// Puts the real and imaginary scalars name_r and name_i together as one field of two components.
void join_complex(const std::string& name, Association association, Geometry& geometry);

}  // namespace sg::ensight

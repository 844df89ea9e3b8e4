// SPDX-License-Identifier: Apache-2.0
// A field file of an OpenFOAM time folder: values in the cells (or on the points) and on the patches.
#pragma once
#include <string>
#include <vector>

#include "data/field.h"
#include "io/openfoam/foam_mesh.h"

namespace sg::openfoam {

struct FoamField {
  Field inner;
  std::vector<Field> patches;  ///< one per patch of the mesh
};

/// Contents of a file according to its header; components 0 = no field that is read (a surface field, a dictionary).
struct FieldClass {
  int components = 0;
  bool on_points = false, only_inner = false;
};
FieldClass field_class(const std::string& class_name);

/// Reads a field. Patches without a value of their own (zeroGradient, empty, ...) have that of the cells behind them. With `look_only`
/// placeholders are returned. Throws Error(data), also for values that depend on an #include or a $macro.
FoamField read_field(const std::string& path, const std::string& name, const FoamMesh& mesh, bool look_only);

/// "m/s", "kg/(m s^2)" from the seven exponents of mass, length, time, temperature, quantity, current, luminosity.
std::string unit_name(std::span<const double> exponents);

/// Whether a patch name in quotes, a regular expression of words, '.', '.*' and (a|b), fits a name.
bool pattern_fits(std::string_view pattern, std::string_view name);

}  // namespace sg::openfoam

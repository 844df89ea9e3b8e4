// SPDX-License-Identifier: Apache-2.0
// Attributes of lines in a flow: fields of the mesh at their points, vorticity, rotation.
#pragma once
#include "filter/flow/trace.h"

namespace sg {

/// The fields that all parts have (by name, association and components), except `without`, at the points of a mesh of lines: point fields
/// interpolated (integers become f32, 64-bit ones f64), cell fields with the value of the cell ("_cell" behind a name that a point field
/// has too). NaN where there is no cell. Parallel.
FieldSet fields_along(const FlowParts& parts, const Dataset& lines, const std::string& without, Context& context);
/// At the points of lines_dataset(lines, ...).
FieldSet fields_along(const FlowParts& parts, const TracedLines& lines, const std::string& without, Context& context);

/// "vorticity" (3 components) when `vorticity`; "angular velocity" and "rotation" when `rotation` (see streamlines.h). `lines` has the
/// point field "time" and the velocity `velocity`.
FieldSet rotation_along(const FlowParts& parts, const Dataset& lines, const std::string& velocity, bool vorticity, bool rotation,
                        Context& context);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Contour lines as whole lines.
#pragma once
#include <string>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct PolylinesParams {
  std::vector<std::string> fields = {};
};
inline void describe(Schema& s, PolylinesParams& p) {
  s("fields", p.fields,
    "Cell fields to keep, which must be constant along each line; default: 'contour value' and 'edge type', if present.");
}

/// Lines and polylines of a mesh joined end to end into as long ones as possible. Where three or more meet, or one of `fields` differs,
/// they end. A closed line has its first point again at the end. A line runs in the direction of its first segment in
/// the input; lines are in the order of their first segments. Points that lines use are kept, in input order, with their
/// fields; new cell fields are 'closed' (u8) and 'length' (f64). Other cell fields and other cells are dropped, with a note.
/// Throws Error(usage) for a mesh without any lines among its cells.
DatasetPtr polylines(const DatasetPtr& in, const PolylinesParams& p, Context& ctx);

struct IsolinesParams {
  FieldName field = {};
  std::string component = {};
  std::vector<double> values = {};
  int count = 10;
};
inline void describe(Schema& s, IsolinesParams& p) {
  s("field", p.field, "Point field; default: the active scalar.").takes(fields::on_points);
  s("component", p.component, "Component of a field with several: 0, 1, ..., x, y, z, or magnitude.");
  s("values", p.values, "Values of the lines; default: evenly spaced within the range.").unit("@field");
  s("count", p.count, "About how many lines, at round values, when no values are given.").range(1, 100000);
}

/// `contour` of a flat grid or surface (of solids: their skin), joined by `polylines`; cell field 'contour value' always. Larger
/// values lie on the left of a line in x-y meshes.
DatasetPtr isolines(const DatasetPtr& in, const IsolinesParams& p, Context& ctx);

/// The values that isolines() chooses where none are stated, over all parts of the data (data/ranks/over_all.h); none without a field.
std::vector<double> choose_line_values(const Dataset& in, const IsolinesParams& p, const Context& ctx);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Cells whose values lie in a range.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct ThresholdParams {
  FieldName field = {};
  int component = -1;
  std::optional<double> min = {}, max = {};
  bool all_points = true;
  bool invert = false;
  std::vector<double> ranges = {};
  std::vector<std::string> names = {};
  std::vector<std::string> fields = {};
  bool mean = false;
};

inline void describe(Schema& s, ThresholdParams& p) {
  s("field", p.field, "Point or cell field to compare; default: the active scalar.");
  s("component", p.component, "Component of the field; -1: the magnitude of a field of several.").at_least(-1);
  s("min", p.min, "Smallest value to keep; default: no limit.").unit("@field");
  s("max", p.max, "Largest value to keep; default: no limit.").unit("@field");
  s("all_points", p.all_points, "With a point field: keep a cell only if all its points are in range, not just one.");
  s("invert", p.invert, "Keep the cells that would be removed instead.");
  s("ranges", p.ranges, "Several ranges instead of min and max: lo,hi,lo,hi,...; values in any of them are kept.").unit("@field");
  s("names", p.names, "Names of labels to keep instead of numbers, as info lists them; upper and lower case are the same.");
  s("fields", p.fields, "Several fields instead of one, of points, cells or both: a cell is kept if it passes for each of them.");
  s("mean", p.mean, "With a point field: compare the mean of a cell's points, as point_to_cell gives it; all_points does not count then.");
}

/// Keeps the cells (of a PointCloud: the points) whose value lies in [min, max], or in one of several ranges, or is a label of one of the
/// `names` (of the field's note "labels of FIELD"), for each of the fields. NaN
/// is in no range; hidden, refined and duplicate cells never stay, inverted or not. A SurfaceMesh stays one, a PointCloud stays one, every
/// other kind becomes an UnstructuredMesh. Only used points are kept; all fields are carried, polyhedra keep their faces. Throws
/// Error(usage) for unknown fields, fields of the whole, an empty range (min > max), ranges that are not pairs,
/// names of a field without names. O(cells), parallel.
DatasetPtr threshold(const DatasetPtr& in, const ThresholdParams& p, Context& ctx);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Cells or points by their numbers.
#pragma once
#include "base/context.h"
#include "base/schema.h"
#include "data/dataset.h"

namespace sg {

struct ExtractParams {
  std::vector<int64_t> ids;
  std::string of = "cell";
  FieldName by = {};
  bool invert = false;
};
inline void describe(Schema& s, ExtractParams& p) {
  s("ids", p.ids, "Numbers of cells or points, counted from 0; or values of the field `by`.");
  s("of", p.of, "What the numbers are of; cells of chosen points are those that use one of them.").choices({"cell", "point"});
  s("by", p.by, "Field of whole numbers that holds the ids (global ids, block or material numbers); default: the places in the file.");
  s("invert", p.invert, "Keeps the others.");
}

/// The chosen cells as a mesh of their own (see extract_cells), in input order, with all fields. With of=point: the cells that use one
/// of the points; of a PointCloud the points. Throws Error(usage) for an empty list, numbers that are not there (without `by`), and
/// for a field `by` of several components or on another place than `of`.
DatasetPtr extract(const DatasetPtr& in, const ExtractParams& p, Context& ctx);

}  // namespace sg

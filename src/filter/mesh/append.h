// SPDX-License-Identifier: Apache-2.0
// Several meshes as one.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct AppendParams {
  bool all = false;
  bool part = true;
};
inline void describe(Schema& s, AppendParams& p) {
  s("all", p.all, "Keep fields that some inputs lack, with NaN (0 for integers) there; otherwise they are dropped.");
  s("part", p.part, "Add a cell field 'part': the number of the input.");
}

/// All datasets of all inputs (collections by their parts) as one mesh: a surface when all are surfaces, a point cloud when all are
/// clouds, else unstructured. Points are not merged (see merge_points). Fields keep their type when all inputs agree, else become
/// f64; those with different numbers of components are dropped, with a note. An input without points (cells) does not affect point (cell)
/// fields. Ghosts are kept.
DatasetPtr append(const std::vector<Data>& inputs, const AppendParams& p, Context& ctx);

}  // namespace sg

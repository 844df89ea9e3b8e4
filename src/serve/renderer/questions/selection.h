// SPDX-License-Identifier: Apache-2.0
// A part of the data by value and place, as a window selects it: "among" of a question (docs/protocol.md).
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/text/json.h"
#include "data/dataset.h"
#include "scene/camera.h"

namespace sg::serve {

/// Where a window has drawn: turns pixels of a view into places of the data.
struct DrawnArea {
  Projection projection;
  double x = 0, y = 0;    ///< pixels of the view in which the projection begins
  Vec3 stretch{1, 1, 1};  ///< of the data in the picture
  Box3 bounds;            ///< of the data in the picture, stretched
};

struct Selection {
  std::string field;  ///< "": of any value
  double lo = 0, hi = 0;
  std::vector<double> box;    ///< x0,x1,y0,y1,z0,z1 or none
  std::vector<double> lasso;  ///< corners x,y,z or none
  std::optional<Vec3> lasso_eye;

  bool all() const { return field.empty() && box.empty() && lasso.empty(); }
};

/// `area`: of the view that the lasso names; null where it has no picture. Throws Error(usage) for ranges and boxes that are empty, wrong
/// counts of numbers, more than 2000 corners, and for what else it does not know.
Selection selection_from(const Json& among, const DrawnArea* area);

/// Steps that select the same cells, one after the other: {"operation", "set"}.
Json steps_of(const Selection& selection);

/// The dataset with cells marked as hidden that are not selected, and how many are. A cell is selected by its centre, and by its own value
/// or the mean of its points' values; a point by its place, and by its own value or where a cell around it has the value. Point clouds have
/// no cells: there are points alone. What the data hides stays hidden.
struct Selected {
  DatasetPtr cells;   ///< cells are marked, points as they were
  DatasetPtr points;  ///< points are marked, cells as well
  size_t cell_count = 0, point_count = 0;
};
/// Throws Error(usage) where the dataset lacks the field.
Selected selected_of(const DatasetPtr& data, const Selection& selection, Context& context);

}  // namespace sg::serve

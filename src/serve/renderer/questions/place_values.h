// SPDX-License-Identifier: Apache-2.0
// Places of questions, and what the data have there.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/context.h"
#include "base/text/json.h"
#include "data/dataset.h"

namespace sg::serve {

/// Three finite numbers; throws Error(usage) that names the word for anything else.
Vec3 place_of(const Json& list, std::string_view word);

struct PointNear {
  size_t point = 0;
  double distance = 0;
};
/// The point of a mesh, which has one at least, that lies nearest.
PointNear nearest_point(const Dataset& d, Vec3 at);

/// The fields at a place as the answer "probe" lists them, by the shape functions of the cell there; on surfaces, which have none about a
/// place, those of the nearest point and of the cell.
std::vector<Json> values_at(const DatasetPtr& d, Vec3 at, std::optional<size_t> cell, Context& context);
/// "1150", "(0.1, 0, 2)".
std::string value_text(const Array& a, size_t i);
/// The number, or the length of several.
double size_at(const Array& a, size_t i);

}  // namespace sg::serve

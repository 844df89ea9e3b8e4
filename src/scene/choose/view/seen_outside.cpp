// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/view/seen_outside.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "data/cells/mesh_dimension.h"
#include "data/field_ops.h"
#include "filter/mesh/surface.h"
#include "scene/choose/telling_field.h"

namespace sg {

namespace {

// Labels of solid cells of which some are on no face outside.
bool hides_labels(const Dataset& d, const Field& field, const Field& outside) {
  constexpr size_t most = 256;
  const auto* mesh = d.as<UnstructuredMesh>();
  std::set<double> seen, solid;
  for (size_t i = 0; i < outside.array.count(); ++i)
    if (seen.insert(outside.array.get(i)).second && seen.size() > most) return false;
  for (size_t i = 0; i < field.array.count(); ++i)
    if (!mesh || cell_type_info(mesh->type(i)).dimension == 3)
      if (solid.insert(field.array.get(i)).second && solid.size() > most) return false;
  return !std::includes(seen.begin(), seen.end(), solid.begin(), solid.end());
}

}  // namespace

bool tells_only_inside(const DatasetPtr& data, const Field& field, Context& context) {
  constexpr size_t largest = 1000000, smallest = 64;
  constexpr double most = 0.7, narrow = 0.05;
  if (data->cell_count() > largest || data->cell_count() < smallest || mesh_dimension(*data) != 3) return false;
  const Range all = data->range(field, -1);
  if (all.empty() || !(all.lo < all.hi)) return false;
  const DatasetPtr outside = surface_of(data, context);
  const Field* shown = outside->fields().find(field.name, field.association);
  if (!shown) return false;
  if (field.association == Association::cell && telling(*data, field) == Telling::divisions) return hides_labels(*data, field, *shown);
  const Array numbers = scalar_of(*shown, -1, ElementType::f64);
  std::vector<double> values;
  for (size_t i = 0; i < numbers.count(); ++i)
    if (const double v = numbers.get(i); std::isfinite(v)) values.push_back(v);
  if (values.empty()) return true;
  // The narrowest span that holds most of them.
  std::sort(values.begin(), values.end());
  const size_t held = std::max<size_t>(1, size_t(std::ceil(most * double(values.size()))));
  double span = HUGE_VAL;
  for (size_t i = 0; i + held <= values.size(); ++i) span = std::min(span, values[i + held - 1] - values[i]);
  return span <= narrow * (all.hi - all.lo);
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/signed_distance.h"

#include <algorithm>

namespace sg {

bool is_signed_distance(const Dataset& data, const Field& field) {
  const auto* g = data.as<UniformGrid>();
  if (!g || field.association != Association::point || field.components() != 1 || !is_float(field.array.type())) return false;
  const std::array<size_t, 3> n = g->dims;
  const Range range = data.range(field, 0);
  if (n[0] < 5 || n[1] < 5 || n[2] < 5 || !(range.lo < 0 && range.hi > 0)) return false;
  const Mat3 to_world = transpose(inverse(g->direction));  // of gradients along the grid's axes
  const auto at = [&](size_t i, size_t j, size_t k) { return field.array.get(i + n[0] * (j + n[1] * k), 0); };
  const auto step = [](size_t points) { return std::max<size_t>(1, (points - 2) / 16); };
  size_t asked = 0, unit = 0;
  Vec3 sum;
  for (size_t k = 1; k + 1 < n[2]; k += step(n[2]))
    for (size_t j = 1; j + 1 < n[1]; j += step(n[1]))
      for (size_t i = 1; i + 1 < n[0]; i += step(n[0])) {
        const double near[] = {at(i, j, k),     at(i - 1, j, k), at(i + 1, j, k), at(i, j - 1, k),
                               at(i, j + 1, k), at(i, j, k - 1), at(i, j, k + 1)};
        if (std::any_of(std::begin(near), std::end(near), [&](double v) { return v == range.lo || v == range.hi; })) continue;
        const Vec3 slope((near[2] - near[1]) / (2 * g->spacing.x), (near[4] - near[3]) / (2 * g->spacing.y),
                         (near[6] - near[5]) / (2 * g->spacing.z));
        const Vec3 gradient = to_world * slope;
        ++asked, unit += std::abs(length(gradient) - 1) < 0.1;
        sum += gradient;
      }
  return asked >= 20 && 10 * unit >= 9 * asked && length(sum) < 0.8 * double(asked);  // a coordinate has one direction
}

}  // namespace sg

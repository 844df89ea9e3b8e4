// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/view/crowded_box.h"

#include <algorithm>
#include <cmath>

#include "data/cells/point_positions.h"
#include "data/field_ops.h"

namespace sg {

namespace {

struct Sample {
  Vec3 at;
  double value;
};

std::vector<Sample> samples_of(std::span<const FieldOf> fields) {
  constexpr size_t most = 200000;
  size_t count = 0;
  for (const FieldOf& f : fields) count += f.data->point_count();
  const size_t step = count / most + 1;
  std::vector<Sample> samples;
  for (const FieldOf& f : fields) {
    const Array positions = point_positions(f.data->mesh()), values = scalar_of(*f.field, -1, ElementType::f64);
    for (size_t i = 0; i < values.count(); i += step)
      if (const double v = values.get(i); std::isfinite(v))
        samples.push_back({{positions.get(i, 0), positions.get(i, 1), positions.get(i, 2)}, v});
  }
  return samples;
}

double quantile(std::vector<double>& v, double share) {
  const auto at = v.begin() + std::ptrdiff_t(share * double(v.size() - 1));
  std::nth_element(v.begin(), at, v.end());
  return *at;
}

bool holds(const Box3& b, Vec3 p) {
  return p.x >= b.lo.x && p.x <= b.hi.x && p.y >= b.lo.y && p.y <= b.hi.y && p.z >= b.lo.z && p.z <= b.hi.z;
}

// Without the least and the most hundredth.
double spread(std::vector<double> v) { return v.empty() ? 0 : quantile(v, 0.99) - quantile(v, 0.01); }

}  // namespace

std::optional<Box3> crowded_box(std::span<const FieldOf> fields) {
  constexpr size_t fewest = 1000;
  constexpr double small = 0.2, margin = 0.25, quiet = 0.1;  // of the whole's length, of the box's, of the range
  for (const FieldOf& f : fields)
    if (f.field->association != Association::point) return {};
  const std::vector<Sample> samples = samples_of(fields);
  if (samples.size() < fewest) return {};
  Box3 whole;
  std::vector<double> values;
  for (const Sample& s : samples) whole.add(s.at), values.push_back(s.value);
  const double range = *std::max_element(values.begin(), values.end()) - *std::min_element(values.begin(), values.end());
  for (const double tail : {0.25, 0.2, 0.15, 0.1, 0.05}) {
    Box3 box = whole;
    int shortened = 0;
    for (int a = 0; a < 3; ++a) {
      std::vector<double> along;
      for (const Sample& s : samples) along.push_back(s.at[a]);
      const double lo = quantile(along, tail), hi = quantile(along, 1 - tail), edge = margin * (hi - lo);
      if (!(hi > lo) || hi - lo + 2 * edge > small * whole.size()[a]) continue;
      box.lo[a] = std::max(lo - edge, whole.lo[a]), box.hi[a] = std::min(hi + edge, whole.hi[a]), ++shortened;
    }
    if (shortened < 2) continue;
    std::vector<double> beyond;
    for (const Sample& s : samples)
      if (!holds(box, s.at)) beyond.push_back(s.value);
    if (spread(beyond) <= quiet * range) return box;
  }
  return {};
}

}  // namespace sg

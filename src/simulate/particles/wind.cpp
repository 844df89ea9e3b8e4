// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/wind.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/error.h"

namespace sg::swarm {

namespace {

template <class T>
T mixed(T a, T b, T share) {
  return a + share * (b - a);
}

void sample_doubles(const StraightGrid& g, const double* values, std::span<const Vec3> x, std::span<Vec3> u) {
  const double last[3] = {double(g.dims[0] - 1), double(g.dims[1] - 1), double(g.dims[2] - 1)};
  const size_t row = 3 * g.dims[0], slice = row * g.dims[1];
  for (size_t k = 0; k < x.size(); ++k) {
    const Vec3 q = (x[k] - g.origin) * g.scale;
    u[k] = {};
    if (!(q.x >= 0 && q.y >= 0 && q.z >= 0 && q.x <= last[0] && q.y <= last[1] && q.z <= last[2])) continue;
    // The last point belongs to the last cell.
    const int64_t i = std::min(int64_t(q.x), int64_t(g.dims[0]) - 2), j = std::min(int64_t(q.y), int64_t(g.dims[1]) - 2),
                  l = std::min(int64_t(q.z), int64_t(g.dims[2]) - 2);
    const double* const p = values + size_t(3 * i) + row * size_t(j) + slice * size_t(l);
    const double r = q.x - double(i), s = q.y - double(j), t = q.z - double(l);
    for (int c = 0; c < 3; ++c) {
      const auto along = [c, r](const double* a) { return mixed(a[c], a[c + 3], r); };
      u[k][c] = mixed(mixed(along(p), along(p + row), s), mixed(along(p + slice), along(p + slice + row), s), t);
    }
  }
}

}  // namespace

Wind::Wind(const DatasetPtr& data, const std::string& field, const std::string& who, Context& context) {
  const Field& f = flow_field_of(*data, field, who);
  const FieldStats& stats = data->stats(f);
  if (const uint64_t bad = stats.nan + stats.infinite)
    fail_data(fmt::format("field '{}' has {} values that are no numbers", f.name, bad), who,
              "cut them off (threshold), or replace them (calc)");
  flow_ = std::make_unique<FlowField>(data, field, context);
  const UniformGrid* g = data->as<UniformGrid>();
  if (!g || g->direction != Mat3() || flow_->components() != 3 || !data->cell_ghost().empty() || !data->point_ghost().empty()) return;
  for (size_t a = 0; a < 3; ++a)
    if (g->dims[a] < 2 || !(g->spacing[int(a)] > 0)) return;
  straight_ = StraightGrid{g->dims, g->origin, {1 / g->spacing.x, 1 / g->spacing.y, 1 / g->spacing.z}};
}

void Wind::sample(std::span<const Vec3> x, std::span<Vec3> u) const {
  if (straight_ && flow_->f32()) return sample_straight(*straight_, flow_->f32(), x, u);
  if (straight_ && flow_->f64()) return sample_doubles(*straight_, flow_->f64(), x, u);
  FlowCursor cursor(*flow_);
  for (size_t k = 0; k < x.size(); ++k)
    if (Vec3 v; cursor(x[k], v)) u[k] = v;
    else u[k] = {};
}

}  // namespace sg::swarm

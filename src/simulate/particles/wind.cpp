// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/wind.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace sg::swarm {

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
  straight_ = true, dims_ = g->dims, origin_ = g->origin;
  scale_ = {1 / g->spacing.x, 1 / g->spacing.y, 1 / g->spacing.z};
}

template <class T>
void Wind::sample_grid(const T* values, std::span<const Vec3> x, std::span<Vec3> u) const {
  const double last[3] = {double(dims_[0] - 1), double(dims_[1] - 1), double(dims_[2] - 1)};
  const size_t row = 3 * dims_[0], slice = row * dims_[1];
  for (size_t k = 0; k < x.size(); ++k) {
    const Vec3 q = (x[k] - origin_) * scale_;
    if (!(q.x >= 0 && q.y >= 0 && q.z >= 0 && q.x <= last[0] && q.y <= last[1] && q.z <= last[2])) {
      u[k] = {};
      continue;
    }
    // The last point belongs to the last cell.
    const int64_t i = std::min(int64_t(q.x), int64_t(dims_[0]) - 2), j = std::min(int64_t(q.y), int64_t(dims_[1]) - 2),
                  l = std::min(int64_t(q.z), int64_t(dims_[2]) - 2);
    const T r = T(q.x - double(i)), s = T(q.y - double(j)), t = T(q.z - double(l));
    const T* const p = values + size_t(3 * i) + row * size_t(j) + slice * size_t(l);
    T sum[3];
    for (size_t c = 0; c < 3; ++c) {
      const auto along = [&](const T* a) { return a[c] + r * (a[c + 3] - a[c]); };
      const T low = along(p), high = along(p + row), low2 = along(p + slice), high2 = along(p + slice + row);
      const T front = low + s * (high - low), back = low2 + s * (high2 - low2);
      sum[c] = front + t * (back - front);
    }
    u[k] = {double(sum[0]), double(sum[1]), double(sum[2])};
  }
}

void Wind::sample(std::span<const Vec3> x, std::span<Vec3> u) const {
  if (straight_ && flow_->f32()) return sample_grid(flow_->f32(), x, u);
  if (straight_ && flow_->f64()) return sample_grid(flow_->f64(), x, u);
  FlowCursor cursor(*flow_);
  for (size_t k = 0; k < x.size(); ++k)
    if (Vec3 v; cursor(x[k], v)) u[k] = v;
    else u[k] = {};
}

}  // namespace sg::swarm

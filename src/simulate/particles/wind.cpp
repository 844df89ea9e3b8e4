// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/wind.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "base/error.h"

namespace sg::swarm {

namespace {

// Four numbers side by side: a tuple of three and one that is not used.
typedef float Four __attribute__((vector_size(16)));

template <class V, class T>
V mixed(V a, V b, T share) {
  return a + share * (b - a);
}

// Between a point's tuple and the next one's.
Four side(const float* p, float share) {
  Four a, b;
  std::memcpy(&a, p, sizeof a), std::memcpy(&b, p + 3, sizeof b);
  return mixed(a, b, share);
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
  straight_ = true, dims_ = g->dims, origin_ = g->origin;
  scale_ = {1 / g->spacing.x, 1 / g->spacing.y, 1 / g->spacing.z};
}

template <class T>
void Wind::sample_grid(const T* values, std::span<const Vec3> x, std::span<Vec3> u) const {
  const double last[3] = {double(dims_[0] - 1), double(dims_[1] - 1), double(dims_[2] - 1)};
  const size_t row = 3 * dims_[0], slice = row * dims_[1];
  // First where some of them read, asking the memory for it, then what is there.
  struct Place {
    const T* p;  // of the cell's first point; null: outside
    T r, s, t;
  };
  constexpr size_t together = 32;
  Place places[together];
  for (size_t first = 0; first < x.size(); first += together) {
    const size_t count = std::min(together, x.size() - first);
    for (size_t k = 0; k < count; ++k) {
      const Vec3 q = (x[first + k] - origin_) * scale_;
      if (!(q.x >= 0 && q.y >= 0 && q.z >= 0 && q.x <= last[0] && q.y <= last[1] && q.z <= last[2])) {
        places[k].p = nullptr;
        continue;
      }
      // The last point belongs to the last cell.
      const int64_t i = std::min(int64_t(q.x), int64_t(dims_[0]) - 2), j = std::min(int64_t(q.y), int64_t(dims_[1]) - 2),
                    l = std::min(int64_t(q.z), int64_t(dims_[2]) - 2);
      const T* const p = values + size_t(3 * i) + row * size_t(j) + slice * size_t(l);
      places[k] = {p, T(q.x - double(i)), T(q.y - double(j)), T(q.z - double(l))};
      __builtin_prefetch(p), __builtin_prefetch(p + row), __builtin_prefetch(p + slice), __builtin_prefetch(p + slice + row);
    }
    for (size_t k = 0; k < count; ++k) {
      const auto [p, r, s, t] = places[k];
      Vec3& to = u[first + k];
      if (!p) {
        to = {};
        continue;
      }
      if constexpr (std::is_same_v<T, float>)
        if (p + slice + row + 7 <= values + slice * dims_[2]) {  // the fourth lane reads one number beyond a pair of points
          const Four front = mixed(side(p, r), side(p + row, r), s), back = mixed(side(p + slice, r), side(p + slice + row, r), s);
          const Four sum = mixed(front, back, t);
          to = {double(sum[0]), double(sum[1]), double(sum[2])};
          continue;
        }
      T sum[3];
      for (size_t c = 0; c < 3; ++c) {
        const auto along = [c, r = r](const T* a) { return mixed(a[c], a[c + 3], r); };
        const T front = mixed(along(p), along(p + row), s), back = mixed(along(p + slice), along(p + slice + row), s);
        sum[c] = mixed(front, back, t);
      }
      to = {double(sum[0]), double(sum[1]), double(sum[2])};
    }
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

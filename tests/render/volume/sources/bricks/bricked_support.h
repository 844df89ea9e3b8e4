// SPDX-License-Identifier: Apache-2.0
// Bricked volumes in memory, and rays through them.
#pragma once
#include <atomic>
#include <cmath>

#include "base/context.h"
#include "data/bricked.h"
#include "render/volume/sources/bricks/bricked_source.h"
#include "support/test.h"

namespace sg::test {

/// Levels by means of 2x2x2; extremes of all blocks. `reads` counts what was asked for.
struct MadeVolume {
  BrickedPtr volume;
  DatasetPtr dataset;
  std::shared_ptr<std::atomic<size_t>> reads = std::make_shared<std::atomic<size_t>>(0);
  std::shared_ptr<std::atomic<size_t>> expected = std::make_shared<std::atomic<size_t>>(0);  ///< samples of which reading was announced
  std::vector<std::array<size_t, 3>> dims;
  std::shared_ptr<std::vector<std::vector<float>>> values = std::make_shared<std::vector<std::vector<float>>>();

  /// Trilinear value of a level at fine coordinates.
  double at(size_t level, Vec3 u) const {
    const auto& n = dims[level];
    double v[3], f[3];
    size_t i[3];
    for (size_t a = 0; a < 3; ++a) {
      const double c = double(volume->levels[level].coarseness[a]);
      v[a] = std::clamp((u[int(a)] - 0.5 * (c - 1)) / c, 0.0, double(n[a] - 1));
      i[a] = size_t(std::min(std::floor(v[a]), std::max(0.0, double(n[a]) - 2)));
      f[a] = v[a] - double(i[a]);
    }
    double sum = 0;
    for (size_t c = 0; c < 8; ++c) {
      const size_t x = std::min(i[0] + (c & 1), n[0] - 1), y = std::min(i[1] + (c >> 1 & 1), n[1] - 1),
                   z = std::min(i[2] + (c >> 2), n[2] - 1);
      sum += (c & 1 ? f[0] : 1 - f[0]) * (c & 2 ? f[1] : 1 - f[1]) * (c & 4 ? f[2] : 1 - f[2]) *
             double((*values)[level][x + n[0] * (y + n[1] * z)]);
    }
    return sum;
  }
};

template <class F>
MadeVolume make_volume(std::array<size_t, 3> dims, size_t levels, F&& f, Mat3 direction = {}, Vec3 origin = {}, Vec3 spacing = {1, 1, 1}) {
  MadeVolume m;
  auto v = std::make_shared<BrickedVolume>();
  v->field = "f", v->direction = direction;
  std::vector<float> fine;
  for (size_t k = 0; k < dims[2]; ++k)
    for (size_t j = 0; j < dims[1]; ++j)
      for (size_t i = 0; i < dims[0]; ++i) fine.push_back(float(f(double(i), double(j), double(k))));
  m.values->push_back(fine), m.dims.push_back(dims);
  v->levels.push_back({dims, origin, spacing, {1, 1, 1}});
  BlockExtremes extremes(dims);
  extremes.add(Array::from_vector(fine), 0, dims[2]);
  v->extremes = extremes.take();
  for (size_t l = 1; l < levels; ++l) {
    const auto from = m.dims.back();
    std::array<size_t, 3> to{};
    for (size_t a = 0; a < 3; ++a) to[a] = (from[a] + 1) / 2;
    std::vector<float> coarse;
    for (size_t k = 0; k < to[2]; ++k)
      for (size_t j = 0; j < to[1]; ++j)
        for (size_t i = 0; i < to[0]; ++i) {
          double sum = 0;
          int n = 0;
          for (size_t c = 0; c < 8; ++c) {
            const size_t x = 2 * i + (c & 1), y = 2 * j + (c >> 1 & 1), z = 2 * k + (c >> 2);
            if (x < from[0] && y < from[1] && z < from[2]) sum += double(m.values->back()[x + from[0] * (y + from[1] * z)]), ++n;
          }
          coarse.push_back(float(sum / n));
        }
    BrickedVolume::Level level = v->levels.back();
    level.dims = to;
    level.origin += direction * (level.spacing * 0.5), level.spacing *= 2;
    for (size_t& c : level.coarseness) c *= 2;
    v->levels.push_back(level);
    m.values->push_back(std::move(coarse)), m.dims.push_back(to);
  }
  v->read = [reads = m.reads, dims = m.dims, values = m.values](size_t level, std::array<size_t, 3> lo, std::array<size_t, 3> n,
                                                                std::byte* out) {
    ++*reads;
    auto* to = reinterpret_cast<float*>(out);
    const auto& d = dims[level];
    for (size_t k = 0; k < n[2]; ++k)
      for (size_t j = 0; j < n[1]; ++j)
        for (size_t i = 0; i < n[0]; ++i) *to++ = (*values)[level][lo[0] + i + d[0] * (lo[1] + j + d[1] * (lo[2] + k))];
  };
  v->expect = [expected = m.expected, dims = m.dims](size_t level, std::array<size_t, 3> lo, std::array<size_t, 3> n) {
    for (size_t a = 0; a < 3; ++a) CHECK((n[a] > 0 && lo[a] + n[a] <= dims[level][a]));
    *expected += n[0] * n[1] * n[2];
  };
  m.volume = v;
  // The dataset is the coarsest level.
  DatasetParts parts;
  UniformGrid g;
  g.dims = m.dims.back(), g.origin = v->levels.back().origin, g.spacing = v->levels.back().spacing, g.direction = direction;
  parts.mesh = g;
  parts.fields.add({"f", Association::point, Array::from_vector(m.values->back()), "", Role::scalars});
  m.dataset = make_dataset(std::move(parts), m.volume);
  return m;
}

inline std::unique_ptr<volume::RaySource> source_of(const MadeVolume& m, const Projection& p, size_t memory = size_t(1) << 28,
                                                    double coarser = 1) {
  VolumeItem item;
  item.data = m.dataset, item.field = "f";
  Context context;
  auto source = volume::bricked_source(item, p, memory, context, coarser);
  REQUIRE(source);
  return source;
}

inline std::vector<volume::Stretch> stretches(volume::RayField& ray, Vec3 origin, Vec3 direction, double from = 0, double to = 1e9) {
  ray.start(origin, direction, from, to);
  std::vector<volume::Stretch> all, some(7);
  while (const size_t n = ray.next(some)) all.insert(all.end(), some.begin(), some.begin() + ptrdiff_t(n));
  return all;
}

}  // namespace sg::test

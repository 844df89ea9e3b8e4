// SPDX-License-Identifier: Apache-2.0
#include "render/volume/effects/light_map.h"
#include "render/shade/exp.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace sg::volume {

namespace {

constexpr float darkest = 12;  // optical depth from which on 16 bits are zero

/// Axes square to the light, the first as near as can be to an axis of the world: light along an axis then meets the faces of the
/// box as it should.
void axes_for(Vec3 along, Vec3 axis[3]) {
  int least = 0;
  for (int a = 1; a < 3; ++a)
    if (std::abs(along[a]) < std::abs(along[least]) - 1e-12) least = a;
  Vec3 e{0, 0, 0};
  e[least] = 1;
  axis[2] = along;
  axis[0] = normalize(e - along * along[least]);
  axis[1] = cross(axis[2], axis[0]);
}

}  // namespace

LightMap::LightMap(const RaySource& source, Extinction extinction, const std::vector<ClipPlane>& clip, Vec3 towards, const Plan& plan,
                   const Context* context) {
  axes_for(-normalize(towards), axis_);
  Vec3 extent;
  for (int a = 0; a < 3; ++a) {
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    for (int c = 0; c < 8; ++c) {
      const Box3& b = source.bounds;
      const double x = dot(axis_[a], Vec3{c & 1 ? b.hi.x : b.lo.x, c & 2 ? b.hi.y : b.lo.y, c & 4 ? b.hi.z : b.lo.z});
      lo = std::min(lo, x), hi = std::max(hi, x);
    }
    // A little inside, so that rays along a face of the box do not miss it.
    const double inset = a < 2 ? 1e-6 * (hi - lo) : 0;
    first_[a] = lo + inset, extent[a] = std::max(hi - lo - 2 * inset, 1e-6 * source.edge);
  }
  spacing_ = plan.spacing > 0 ? plan.spacing : source.edge;
  const auto count = [&] {
    double all = 1;
    for (int a = 0; a < 3; ++a) all *= std::max(2.0, std::ceil(extent[a] / spacing_) + 1);
    return all;
  };
  while (count() > double(std::max<size_t>(plan.most_samples, 8)))
    spacing_ *= std::max(1.02, std::cbrt(count() / double(std::max<size_t>(plan.most_samples, 8))));
  for (int a = 0; a < 3; ++a) {
    n_[a] = size_t(std::max(2.0, std::ceil(extent[a] / spacing_) + 1));
    per_length_[a] = double(n_[a] - 1) / extent[a];
  }
  values_.resize(n_[0] * n_[1] * n_[2]);
  const DepthIntegral integral(extinction);
  parallel_for(
      n_[0] * n_[1], 128,
      [&](size_t begin, size_t end) {
        const auto walker = source.walker();
        std::vector<float> depth(n_[2]);
        for (size_t r = begin; r < end; ++r) {
          const double u = first_.x + double(r % n_[0]) / per_length_.x, v = first_.y + double(r / n_[0]) / per_length_.y;
          DepthRay ray{axis_[0] * u + axis_[1] * v + axis_[2] * first_.z, axis_[2]};
          ray.clip(clip);
          depths_along(ray, *walker, integral, 1 / per_length_.z, darkest, depth);
          uint16_t* row = &values_[r * n_[2]];
          for (size_t k = 0; k < n_[2]; ++k) row[k] = uint16_t(65535 * exp_minus(depth[k]) + 0.5f);
        }
      },
      context);
}

float LightMap::at(Vec3 place) const {
  size_t cell[3];
  float f[3];
  for (int a = 0; a < 3; ++a) {
    const double at = coordinate(a, place);
    if (a < 2 && !(at > -0.5 && at < double(n_[a]) - 0.5)) return 1;  // beside the volume
    const double x = std::clamp(at, 0.0, double(n_[a] - 1));
    cell[a] = std::min(size_t(x), n_[a] - 2), f[a] = float(x - double(cell[a]));
  }
  const auto mix = [](float a, float b, float t) { return a + t * (b - a); };
  const auto along = [&](size_t i, size_t j) {
    const uint16_t* p = &values_[((cell[1] + j) * n_[0] + cell[0] + i) * n_[2] + cell[2]];
    return mix(float(p[0]), float(p[1]), f[2]);
  };
  return (1.0f / 65535) * mix(mix(along(0, 0), along(1, 0), f[0]), mix(along(0, 1), along(1, 1), f[0]), f[1]);
}

}  // namespace sg::volume

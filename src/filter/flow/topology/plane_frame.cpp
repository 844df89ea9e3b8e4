// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/plane_frame.h"

#include "data/point_positions.h"

namespace sg {

std::optional<PlaneFrame> plane_of(const Dataset& data) {
  const Array positions = point_positions(data.mesh());
  const size_t n = positions.count();
  if (n == 0) return std::nullopt;
  const auto* xyz = positions.view<double>().data;
  struct At {
    const double* xyz;
    Vec3 operator[](size_t i) const { return {xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]}; }
  } at{xyz};
  // A long triangle of points spans the plane.
  const Vec3 a = at[0];
  auto farthest = [&](auto&& measure) {
    size_t best = 0;
    double most = -1;
    for (size_t i = 0; i < n; ++i)
      if (const double m = measure(at[i]); m > most) most = m, best = i;
    return at[best];
  };
  const Vec3 b = farthest([&](Vec3 p) { return length(p - a); });
  const Vec3 c = farthest([&](Vec3 p) { return length(cross(p - a, b - a)); });
  Vec3 normal = cross(b - a, c - a);
  const double size = length(b - a);
  if (!(length(normal) > 1e-10 * size * size)) {
    const Vec3 d = b - a;
    normal = std::abs(d.z) > std::hypot(d.x, d.y) ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
    normal = normal - d * (dot(d, normal) / std::max(dot(d, d), 1e-300));
  }
  PlaneFrame f;
  f.origin = a;
  f.normal = normalize(normal);
  int largest = 2;
  for (const int k : {1, 0})
    if (std::abs(f.normal[k]) > std::abs(f.normal[largest]) + 1e-9) largest = k;
  if (f.normal[largest] < 0) f.normal = -f.normal;
  for (int k = 0; k < 3; ++k)
    if (std::abs(std::abs(f.normal[k]) - 1) < 1e-9) {
      f.normal = {};
      f.normal[k] = 1;
    }
  const Vec3 x = std::abs(f.normal.x) < 0.99 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  f.e1 = normalize(x - f.normal * dot(x, f.normal));
  f.e2 = cross(f.normal, f.e1);
  for (size_t i = 0; i < n; ++i)
    if (std::abs(dot(at[i] - a, f.normal)) > 1e-5 * size) return std::nullopt;
  return f;
}

}  // namespace sg

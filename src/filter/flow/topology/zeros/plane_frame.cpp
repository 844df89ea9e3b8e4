// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/zeros/plane_frame.h"

#include <algorithm>

#include "data/cells/point_positions.h"

namespace sg {

std::optional<PlaneFrame> plane_of(const Dataset& data) {
  const Dataset* const one[] = {&data};
  return plane_of(one);
}

std::optional<PlaneFrame> plane_of(std::span<const Dataset* const> parts) {
  std::vector<Array> positions;
  for (const Dataset* d : parts)
    if (d->point_count() > 0) positions.push_back(point_positions(d->mesh()));
  if (positions.empty()) return std::nullopt;
  auto each = [&](auto&& f) {
    for (const Array& p : positions) {
      const double* xyz = p.view<double>().data;
      for (size_t i = 0; i < p.count(); ++i, xyz += 3) f(Vec3(xyz[0], xyz[1], xyz[2]));
    }
  };
  // A long triangle of points spans the plane.
  const double* first = positions[0].view<double>().data;
  const Vec3 a(first[0], first[1], first[2]);
  auto farthest = [&](auto&& measure) {
    Vec3 best;
    double most = -1;
    each([&](Vec3 p) {
      if (const double m = measure(p); m > most) most = m, best = p;
    });
    return best;
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
  double off = 0;
  each([&](Vec3 p) { off = std::max(off, std::abs(dot(p - a, f.normal))); });
  if (off > 1e-5 * size) return std::nullopt;
  return f;
}

}  // namespace sg

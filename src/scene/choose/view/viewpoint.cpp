// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/view/viewpoint.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "filter/mesh/surface_builder.h"

namespace sg {

namespace {

constexpr int side = 128;  // pixels of the depth buffer

struct Corner {
  double x, y, depth;  // pixels; larger depths are nearer
};

// Depths of what is seen along one direction in parallel projection.
class DepthBuffer {
 public:
  DepthBuffer(const Box3& box, Vec3 direction, Vec3 up) : middle_(box.center()), scale_(0.98 * side / box.diagonal()) {
    towards_ = normalize(direction), right_ = normalize(cross(up, towards_)), up_ = cross(towards_, right_);
  }

  Corner corner(Vec3 p) const {
    const Vec3 d = p - middle_;
    return {0.5 * side + scale_ * dot(d, right_), 0.5 * side + scale_ * dot(d, up_), scale_ * dot(d, towards_)};
  }

  void cover(const Corner& a, const Corner& b, const Corner& c) {
    const double area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    if (area == 0) return;
    const auto first = [](double v) { return std::max(0, int(std::ceil(v - 0.5))); };
    const auto last = [](double v) { return std::min(side - 1, int(std::floor(v - 0.5))); };
    for (int y = first(std::min({a.y, b.y, c.y})); y <= last(std::max({a.y, b.y, c.y})); ++y)
      for (int x = first(std::min({a.x, b.x, c.x})); x <= last(std::max({a.x, b.x, c.x})); ++x) {
        const double px = x + 0.5 - a.x, py = y + 0.5 - a.y;
        const double v = (px * (c.y - a.y) - py * (c.x - a.x)) / area, w = (py * (b.x - a.x) - px * (b.y - a.y)) / area;
        if (v < 0 || w < 0 || v + w > 1) continue;
        double& nearest = depths_[size_t(y) * side + size_t(x)];
        nearest = std::max(nearest, a.depth + v * (b.depth - a.depth) + w * (c.depth - a.depth));
      }
  }

  // Whether nothing lies more than a pixel in front of a place.
  bool seen(const Corner& p) const {
    const int x = std::clamp(int(p.x), 0, side - 1), y = std::clamp(int(p.y), 0, side - 1);
    return p.depth >= depths_[size_t(y) * side + size_t(x)] - 1;
  }

  Vec3 towards() const { return towards_; }

 private:
  Vec3 middle_, towards_, right_, up_;
  double scale_;
  std::vector<double> depths_ = std::vector<double>(size_t(side) * side, -HUGE_VAL);
};

using Parts = std::span<const SurfaceMesh* const>;

// Polygons by the places of their corners.
struct Polygons {
  std::vector<Vec3> corners;
  std::vector<size_t> end;  // of each polygon's corners

  // Calls use(first corner, their number) for each.
  template <class Use>
  void each(Use use) const {
    size_t begin = 0;
    for (const size_t e : end) use(corners.data() + begin, e - begin), begin = e;
  }
};

// Every `step`-th polygon of all parts.
Polygons some_polygons(Parts parts, size_t step) {
  Polygons out;
  for (const SurfaceMesh* mesh : parts) {
    const CellsView polygons = cells_view(mesh->polygons);
    const PointReader at(mesh->points);
    for (size_t c = 0; c < polygons.count; c += step) {
      for (size_t k = 0; k < polygons.size(c); ++k) out.corners.push_back(at[size_t(polygons.point(c, k))]);
      out.end.push_back(out.corners.size());
    }
  }
  return out;
}

// How many are seen.
size_t polygons_seen(const Polygons& polygons, const Box3& box, Vec3 direction, Vec3 up) {
  DepthBuffer buffer(box, direction, up);
  polygons.each([&](const Vec3* at, size_t n) {
    for (size_t k = 1; k + 1 < n; ++k) buffer.cover(buffer.corner(at[0]), buffer.corner(at[k]), buffer.corner(at[k + 1]));
  });
  constexpr double least_cosine = 0.2;
  size_t seen = 0;
  polygons.each([&](const Vec3* at, size_t n) {
    if (n < 3) return;
    Vec3 middle;
    for (size_t k = 0; k < n; ++k) middle += at[k] * (1 / double(n));
    const Vec3 normal = cross(at[1] - at[0], at[2] - at[0]);
    const bool edge_on = !(std::abs(dot(normal, buffer.towards())) > least_cosine * length(normal));
    seen += !edge_on && buffer.seen(buffer.corner(middle));  // the far side of a solid lies behind its near one
  });
  return seen;
}

}  // namespace

Vec3 telling_direction(Parts parts, Vec3 direction, Vec3 up) {
  constexpr size_t most_polygons = 200000;
  size_t polygons = 0;
  Box3 box;
  for (const SurfaceMesh* mesh : parts) {
    polygons += mesh->polygons.size();
    const PointReader at(mesh->points);
    for (size_t i = 0; i < mesh->points.count(); ++i) box.add(at[i]);
  }
  if (polygons == 0 || !(box.diagonal() > 0)) return direction;
  const Polygons some = some_polygons(parts, std::max<size_t>(1, polygons / most_polygons));
  const Vec3 axis = normalize(up), along = axis * dot(direction, axis), across = direction - along, aside = cross(axis, across);
  const Vec3 turned[] = {direction, along + aside, along - across, along - aside};
  size_t best = 0, seen[4];
  parallel_for(4, 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) seen[i] = polygons_seen(some, box, turned[i], axis);
  });
  for (size_t i = 0; i < 4; ++i)
    if (double(seen[i]) > 1.1 * double(seen[0]) && seen[i] > seen[best]) best = i;
  return turned[best];
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/view/upright.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sg {

namespace {

double turn(Vec2 a, Vec2 b, Vec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

// Andrew's monotone chain: the corners counterclockwise, no three on a line.
std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(), [](Vec2 a, Vec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  std::vector<Vec2> hull;
  const auto add = [&](Vec2 p, size_t least) {
    while (hull.size() >= least + 2 && !(turn(hull[hull.size() - 2], hull.back(), p) > 0)) hull.pop_back();
    hull.push_back(p);
  };
  for (const Vec2 p : points) add(p, 0);
  const size_t lower = hull.size();
  for (size_t i = points.size(); i-- > 1;) add(points[i - 1], lower - 1);
  if (hull.size() > 1) hull.pop_back();
  return hull;
}

double area(const std::vector<Vec2>& hull) {
  double twice = 0;
  for (size_t i = 1; i + 1 < hull.size(); ++i) twice += turn(hull[0], hull[i], hull[i + 1]);
  return 0.5 * twice;
}

bool contains(const std::vector<Vec2>& hull, Vec2 p) {
  for (size_t i = 0; i < hull.size(); ++i)
    if (turn(hull[i], hull[(i + 1) % hull.size()], p) < 0) return false;
  return hull.size() > 2;
}

template <class Use>
void for_triangles(std::span<const SurfaceMesh* const> parts, Use use) {
  for (const SurfaceMesh* mesh : parts) {
    const CellsView polygons = cells_view(mesh->polygons);
    for (size_t c = 0; c < polygons.count; ++c)
      for (size_t k = 1; k + 1 < polygons.size(c); ++k)
        use(mesh->points.at(size_t(polygons.point(c, 0))), mesh->points.at(size_t(polygons.point(c, k))),
            mesh->points.at(size_t(polygons.point(c, k + 1))));
  }
}

}  // namespace

double stability(std::span<const SurfaceMesh* const> parts, int axis) {
  Box3 box;
  Vec3 moment;
  double surface = 0;
  for_triangles(parts, [&](Vec3 a, Vec3 b, Vec3 c) {
    for (const Vec3 p : {a, b, c}) box.add(p);
    const double size = 0.5 * length(cross(b - a, c - a));
    if (!std::isfinite(size)) return;
    moment += (a + b + c) * (size / 3), surface += size;
  });
  if (!(surface > 0)) return 0;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Vec3 extent = box.size(), centre = moment * (1 / surface);
  const double ground = box.lo[axis] + std::max({extent.x, extent.y, extent.z}) / 50;
  std::vector<Vec2> shadow, contact;
  for_triangles(parts, [&](Vec3 a, Vec3 b, Vec3 c) {
    for (const Vec3 p : {a, b, c}) {
      if (!std::isfinite(p.x + p.y + p.z)) continue;
      shadow.push_back({p[u], p[v]});
      if (p[axis] <= ground) contact.push_back({p[u], p[v]});
    }
  });
  const double whole = area(convex_hull(std::move(shadow)));
  const std::vector<Vec2> base = convex_hull(std::move(contact));
  return whole > 0 && contains(base, {centre[u], centre[v]}) ? area(base) / whole : 0;
}

}  // namespace sg

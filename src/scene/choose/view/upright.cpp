// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/view/upright.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "filter/surface/polygons.h"

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

// Without those that lie within the polygon of the points farthest in eight directions (Akl, Toussaint 1978): few others are on the hull,
// and sorting millions takes long.
std::vector<Vec2> without_inner(std::vector<Vec2> points) {
  constexpr Vec2 directions[] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};  // counterclockwise
  if (points.size() < 100) return points;
  std::array<Vec2, 8> farthest;
  std::array<double, 8> most;
  farthest.fill(points[0]), most.fill(-HUGE_VAL);
  for (const Vec2 p : points)
    for (size_t d = 0; d < 8; ++d)
      if (const double way = p.x * directions[d].x + p.y * directions[d].y; way > most[d]) most[d] = way, farthest[d] = p;
  std::vector<Vec2> corners;
  for (const Vec2 p : farthest)
    if (corners.empty() || p.x != corners.back().x || p.y != corners.back().y) corners.push_back(p);
  if (corners.size() > 1 && corners[0].x == corners.back().x && corners[0].y == corners.back().y) corners.pop_back();
  if (corners.size() < 3) return points;
  std::erase_if(points, [&](Vec2 p) {
    for (size_t i = 0; i < corners.size(); ++i)
      if (!(turn(corners[i], corners[(i + 1) % corners.size()], p) > 0)) return false;
    return true;
  });
  return points;
}

}  // namespace

double stability(std::span<const SurfaceMesh* const> parts, int axis) {
  std::vector<Vec3> corners;  // of all polygons, each once
  Box3 box;
  Vec3 moment;
  double surface = 0;
  for (const SurfaceMesh* mesh : parts) {
    const std::vector<Vec3> at = surface::positions(mesh->points);
    const CellsView polygons = cells_view(mesh->polygons);
    std::vector<uint8_t> used(at.size());
    for (size_t c = 0; c < polygons.count; ++c) {
      const size_t count = polygons.size(c);
      if (count < 3) continue;
      const size_t first = size_t(polygons.point(c, 0));
      size_t before = size_t(polygons.point(c, 1));
      used[first] = used[before] = 1;
      for (size_t k = 2; k < count; ++k) {
        const size_t next = size_t(polygons.point(c, k));
        const Vec3 &p = at[first], &q = at[before], &r = at[next];
        used[next] = 1, before = next;
        const double size = 0.5 * length(cross(q - p, r - p));
        if (!std::isfinite(size)) continue;
        moment += (p + q + r) * (size / 3), surface += size;
      }
    }
    for (size_t i = 0; i < at.size(); ++i) {
      if (!used[i]) continue;
      box.add(at[i]);
      if (std::isfinite(at[i].x + at[i].y + at[i].z)) corners.push_back(at[i]);
    }
  }
  if (!(surface > 0)) return 0;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Vec3 extent = box.size(), centre = moment * (1 / surface);
  const double ground = box.lo[axis] + std::max({extent.x, extent.y, extent.z}) / 50;
  std::vector<Vec2> shadow, contact;
  for (const Vec3& p : corners) {
    shadow.push_back({p[u], p[v]});
    if (p[axis] <= ground) contact.push_back({p[u], p[v]});
  }
  const double whole = area(convex_hull(without_inner(std::move(shadow))));
  const std::vector<Vec2> base = convex_hull(without_inner(std::move(contact)));
  return whole > 0 && contains(base, {centre[u], centre[v]}) ? area(base) / whole : 0;
}

}  // namespace sg

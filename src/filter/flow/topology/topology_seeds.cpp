// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>

#include "data/memory/memory_budget.h"
#include "filter/flow/topology/topology.h"

namespace sg {

namespace {

// Half-way to the nearest other point that one's pattern may reach, and no further than a part of the mesh.
std::vector<double> reaches(const std::vector<CriticalPoint>& points, double part, double most) {
  std::vector<size_t> order(points.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return std::pair(points[a].at.x, a) < std::pair(points[b].at.x, b); });
  std::vector<double> out(points.size(), most);
  for (size_t i = 0; i < order.size(); ++i)
    for (size_t j = i + 1; j < order.size(); ++j) {
      const Vec3 a = points[order[i]].at, b = points[order[j]].at;
      const double d = part * length(a - b);
      if (part * (b.x - a.x) > most) break;
      out[order[i]] = std::min(out[order[i]], d), out[order[j]] = std::min(out[order[j]], d);
    }
  return out;
}

// Even points of the unit sphere along a spiral (Vogel's angle).
Vec3 sphere_point(int64_t i, int64_t n) {
  const double z = 1 - (2 * double(i) + 1) / double(n), r = std::sqrt(1 - z * z), angle = double(i) * M_PI * (3 - std::sqrt(5.0));
  return {r * std::cos(angle), r * std::sin(angle), z};
}

void plane_pattern(const CriticalPoint& c, Vec3 normal, double r, int64_t n, std::vector<Vec3>& out) {
  const Vec3 u = normalize(c.flow.vector[0]), w = cross(normal, u);
  switch (c.flow.type) {
    case CriticalType::saddle:
      // Between each two directions of the saddle, outwards.
      for (int quarter = 0; quarter < 4; ++quarter) {
        const Vec3 a = quarter & 1 ? -c.flow.vector[0] : c.flow.vector[0], b = quarter & 2 ? -c.flow.vector[1] : c.flow.vector[1];
        const Vec3 d = normalize(a + b);
        const int64_t each = std::max<int64_t>(1, n / 4);
        for (int64_t k = 1; k <= each; ++k) out.push_back(c.at + r * double(k) / double(each) * d);
      }
      break;
    case CriticalType::attracting_focus:
    case CriticalType::repelling_focus:
    case CriticalType::centre:
      for (int64_t k = 1; k <= n; ++k) out.push_back(c.at + r * double(k) / double(n) * u);
      break;
    default:
      for (int64_t k = 0; k < n; ++k) {
        const double angle = 2 * M_PI * (double(k) + 0.5) / double(n);
        out.push_back(c.at + r * (std::cos(angle) * u + std::sin(angle) * w));
      }
  }
}

void solid_pattern(const CriticalPoint& c, double r, int64_t n, std::vector<Vec3>& out) {
  if (!is_saddle(c.flow.type)) {
    for (int64_t k = 0; k < n; ++k) out.push_back(c.at + r * sphere_point(k, n));
    return;
  }
  // Two rings about the single direction, on its both sides, between it and the plane of the others.
  int in = 0;
  for (const double re : c.flow.re) in += re < 0;
  Vec3 single;
  for (size_t k = 0; k < 3; ++k)
    if ((c.flow.re[k] < 0) == (in == 1)) single = normalize(c.flow.vector[k]);
  const Vec3 u = normalize(cross(single, std::abs(single.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0))), w = cross(single, u);
  const int64_t each = std::max<int64_t>(1, n / 2);
  for (const double side : {0.5, -0.5})
    for (int64_t k = 0; k < each; ++k) {
      const double angle = 2 * M_PI * double(k) / double(each);
      out.push_back(c.at + r * (side * single + 0.8 * (std::cos(angle) * u + std::sin(angle) * w)));
    }
}

}  // namespace

void describe(Schema& s, TopologySeedsParams& p) {
  s("field", p.field, "Velocity field; default: the active vectors.").takes(fields::vectors);
  describe(s, p.critical);
  s("count", p.count, "Number of seeds around each critical point.").range(1, 1e6);
  s("radius", p.radius, "Extent of the patterns, as a fraction of the distance to the nearest other critical point.").positive();
}

DatasetPtr topology_seeds(const Data& in, const TopologySeedsParams& p, Context& context) {
  const FlowParts flow(in, p.field.name, "topology_seeds", context);
  const CriticalPoints critical = find_critical_points(flow, p.critical, context);
  constexpr double bytes_a_seed = 100;  // its place, its numbers, and lists that grow
  need_memory(double(p.count) * double(critical.points.size() + 1) * bytes_a_seed,
              fmt::format("{} seeds around each of {} critical points", p.count, critical.points.size()), "topology_seeds",
              "use fewer: count");
  const std::vector<double> reach = reaches(critical.points, p.radius, 0.1 * flow.bounds().diagonal());
  std::vector<double> xyz;
  std::vector<int32_t> number, type;
  PartsCursor cursor(flow);
  std::vector<Vec3> seeds;
  for (size_t i = 0; i < critical.points.size(); ++i) {
    const CriticalPoint& c = critical.points[i];
    seeds.clear();
    if (critical.dimension == 2) plane_pattern(c, critical.normal[i], reach[i], p.count, seeds);
    else solid_pattern(c, reach[i], p.count, seeds);
    Vec3 v;
    cursor(c.at, v);
    for (const Vec3 x : seeds) {
      if (!cursor(x, v)) continue;
      xyz.insert(xyz.end(), {x.x, x.y, x.z});
      number.push_back(int32_t(i)), type.push_back(int32_t(c.flow.type));
    }
  }
  if (critical.points.empty())
    context.warn("topology_seeds: the flow has no critical point, so there are no seeds; use seeds on a grid instead");
  else context.info(fmt::format("topology_seeds: {} seeds; {}", number.size(), summary(critical)));
  DatasetParts parts;
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::move(xyz), 3);
  parts.mesh = std::move(cloud);
  parts.fields.add({"critical point", Association::point, Array::from_vector(std::move(number)), "", Role::labels});
  parts.fields.add({"type", Association::point, Array::from_vector(std::move(type)), "", Role::labels});
  return make_dataset(std::move(parts));
}

}  // namespace sg

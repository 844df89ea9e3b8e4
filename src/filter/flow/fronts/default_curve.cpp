// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/fronts/default_curve.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "filter/flow/seeds/random_places.h"

namespace sg {

namespace {

// A point with strong flow, and how far the flow travels from there.
class Middle {
 public:
  Middle(const FlowParts& parts, std::string_view who, Context& context)
      : flow_(parts), box_(parts.bounds()), least_(0.02 * parts.largest_speed()) {
    const double much = parts.mean_speed();
    if (!(much > 0)) fail_usage(fmt::format("field '{}' is zero or NaN everywhere: there is no flow", parts.name()), std::string(who));
    at = box_.center();
    if (speed(at) < 0.5 * much) {
      std::vector<DatasetPtr> meshes;
      for (const FlowField& f : parts.fields()) meshes.push_back(f.dataset());
      const std::vector<Vec3> places = random_places(
          meshes, 40, 1, [&](Vec3 x) { return speed(x) >= much; }, context);
      double longest = -1, nearest = HUGE_VAL;
      const Vec3 center = at;
      for (const Vec3& x : places) {
        const double l = way(x), d = length(x - center);
        if (l > longest || (l == longest && d < nearest)) longest = l, nearest = d, at = x;
      }
    }
    Vec3 v;
    if (!flow_(at, v) || !(length(v) > 0)) fail_usage("there is no flow in the middle of the mesh", std::string(who), "say where to begin");
    along = normalize(v);
  }

  bool flat(int axis) const { return !(box_.size()[axis] > 1e-6 * box_.diagonal()); }
  double step() const { return box_.diagonal() / 400; }
  // How far there is flow on this side, up to an eighth of the diagonal.
  double reach(Vec3 side) {
    int k = 0;
    while (k < 50 && speed(at + side * (step() * (k + 1))) > least_) ++k;
    return step() * k;
  }

  Vec3 at, along;

 private:
  double speed(Vec3 x) {
    Vec3 v;
    return flow_(x, v) ? length(v) : 0.0;
  }
  // How far the flow travels from there before it nearly stops, up to the diagonal.
  double way(Vec3 x) {
    constexpr int steps = 200;
    const double h = box_.diagonal() / steps;
    int k = 0;
    for (Vec3 v, w; k < steps && flow_(x, v) && length(v) > least_ && flow_(x + normalize(v) * (h / 2), w) && length(w) > least_; ++k)
      x += normalize(w) * h;
    return h * k;
  }
  PartsCursor flow_;
  Box3 box_;
  double least_;
};

}  // namespace

SeedCurveParams across_the_flow(const FlowParts& parts, std::string_view who, Context& context) {
  Middle m(parts, who, context);
  int axis = -1;
  for (const int a : {2, 1, 0})
    if (!m.flat(a) && (axis < 0 || std::abs(m.along[a]) < std::abs(m.along[axis]) - 0.05)) axis = a;
  Vec3 side;
  side[std::max(axis, 0)] = 1;
  side = normalize(side - m.along * dot(m.along, side));
  SeedCurveParams p;
  p.from = m.at - side * m.reach(-side), p.to = m.at + side * m.reach(side);
  if (!(length(*p.to - *p.from) > 0)) p.from = m.at - side * m.step(), p.to = m.at + side * m.step();
  context.info(
      fmt::format("{}: seeds: a line across the flow, from={:.4g},{:.4g},{:.4g} to={:.4g},{:.4g},{:.4g}; points=, or center= and radius=, "
                  "choose others",
                  who, p.from->x, p.from->y, p.from->z, p.to->x, p.to->y, p.to->z));
  return p;
}

std::pair<Vec3, Vec3> rectangle_sides(Vec3 normal) {
  const Vec3 u = normalize(cross(std::abs(normal.y) < 0.9 ? Vec3(0, 1, 0) : Vec3(0, 0, 1), normal));
  return {u, cross(normal, u)};
}

SeedRectangle rectangle_across_the_flow(const FlowParts& parts, std::string_view who, Context& context) {
  Middle m(parts, who, context);
  SeedRectangle r{m.at, m.along, {}};
  for (int a = 0; a < 3; ++a)
    if (m.flat(a)) r.normal = Vec3(), r.normal[a] = 1;
  const auto [u, w] = rectangle_sides(r.normal);
  for (const auto& [side, size] : {std::pair<Vec3, double&>(u, r.size[0]), std::pair<Vec3, double&>(w, r.size[1])}) {
    const double less = std::max(m.reach(-side), m.step()), more = std::max(m.reach(side), m.step());
    r.center += side * (0.5 * (more - less)), size = less + more;
  }
  context.info(fmt::format("{}: begins with a rectangle, center={:.4g},{:.4g},{:.4g} normal={:.4g},{:.4g},{:.4g} size={:.4g},{:.4g}", who,
                           r.center.x, r.center.y, r.center.z, r.normal.x, r.normal.y, r.normal.z, r.size[0], r.size[1]));
  return r;
}

FlowParts flow_at(const Series& series, std::optional<double> start, const std::string& field, std::string_view who, Context& context) {
  if (series.times.empty()) fail_usage("the series has no time step", std::string(who));
  size_t nearest = 0;
  for (size_t k = 1; start && k < series.times.size(); ++k)
    if (std::abs(series.times[k] - *start) < std::abs(series.times[nearest] - *start)) nearest = k;
  return {series.load(nearest), field, who, context};
}

}  // namespace sg

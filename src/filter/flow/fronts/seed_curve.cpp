// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/fronts/seed_curve.h"

#include <fmt/core.h>

#include <algorithm>
#include <numbers>

#include "filter/flow/lines/line_frames.h"

namespace sg {

namespace {
using std::numbers::pi;
}

void describe(Schema& s, SeedCurveParams& p) {
  s("from", p.from, "First end of a straight seed curve.").unit("length");
  s("to", p.to, "Its other end.").unit("length");
  s("center", p.center, "Centre of a seed circle.").unit("length");
  s("normal", p.normal, "Axis of the circle; default: z.");
  s("radius", p.radius, "Radius of the circle.").unit("length").positive();
  s("points", p.points, "Points of a seed curve: x,y,z,x,y,z,...").unit("length");
}

Vec3 SeedCurve::operator()(double s) const {
  if (round) return center + u * std::cos(2 * pi * s) + v * std::sin(2 * pi * s);
  const double l = std::clamp(s, 0.0, 1.0) * whole();
  const size_t k = size_t(
      std::clamp<ptrdiff_t>(std::upper_bound(length.begin(), length.end(), l) - length.begin() - 1, 0, ptrdiff_t(length.size()) - 2));
  const double part = length[k + 1] - length[k];
  return lerp(at[k], at[(k + 1) % at.size()], part > 0 ? (l - length[k]) / part : 0.0);
}

SeedCurve seed_curve(const SeedCurveParams& p, const DatasetPtr& lines, std::string_view who) {
  const bool straight = p.from || p.to, circle = p.center || p.radius || p.normal, listed = !p.points.empty();
  if (int(straight) + int(circle) + int(listed) + int(lines != nullptr) != 1)
    fail_usage("needs one seed curve", std::string(who),
               "give from= and to=, or center= and radius=, or points=, or lines as a second input");
  SeedCurve c;
  if (straight) {
    if (!p.from || !p.to) fail_usage("a line needs two ends", std::string(who), "from=x,y,z to=x,y,z");
    c.at = {*p.from, *p.to};
  } else if (circle) {
    if (!p.center || !p.radius) fail_usage("a circle needs a centre and a radius", std::string(who), "center=x,y,z radius=r");
    const Vec3 n = normalize(p.normal.value_or(Vec3(0, 0, 1)));
    if (!(length(n) > 0)) fail_usage("0,0,0 is not a valid direction", "normal");
    const Vec3 side = normalize(cross(n, std::abs(n.x) < 0.9 ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
    c.center = *p.center, c.u = side * *p.radius, c.v = cross(n, side) * *p.radius;
    c.closed = c.round = true;
    for (int k = 0; k < 64; ++k) c.at.push_back(c(k / 64.0));
  } else if (listed) {
    if (p.points.size() % 3 != 0 || p.points.size() < 6)
      fail_usage(fmt::format("{} numbers do not make a line", p.points.size()), "points",
                 "give three numbers per point, and at least two points");
    for (size_t i = 0; i < p.points.size(); i += 3) c.at.emplace_back(p.points[i], p.points[i + 1], p.points[i + 2]);
    if (c.at.size() > 3 && c.at.front() == c.at.back()) c.closed = true, c.at.pop_back();
  } else {
    if (!lines->as<SurfaceMesh>() || lines->as<SurfaceMesh>()->lines.size() == 0)
      fail_usage("the second input has no lines", std::string(who), "make lines with isolines, feature_edges or streamlines");
    double most = -1;
    for (const LinePath& path : line_paths(*lines)) {
      std::vector<Vec3> at;
      double sum = 0;
      for (const uint32_t id : path.points) {
        at.push_back(lines->as<SurfaceMesh>()->points.at(id));
        if (at.size() > 1) sum += length(at.back() - at[at.size() - 2]);
      }
      if (sum > most) most = sum, c.at = std::move(at), c.closed = path.closed;
    }
  }
  c.length = {0};
  for (size_t k = 1; k < c.at.size() + size_t(c.closed); ++k)
    c.length.push_back(c.length.back() + length(c.at[k % c.at.size()] - c.at[k - 1]));
  if (!(c.whole() > 0) || !std::isfinite(c.whole())) fail_usage("the seed curve has no length", std::string(who));
  return c;
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "filter/surface/curvature.h"

#include <fmt/core.h>

#include <algorithm>
#include <numbers>

#include "base/error.h"
#include "data/fields/axis_notes.h"
#include "data/fields/known_looks.h"
#include "filter/surface/polygons.h"

namespace sg {

namespace {

using namespace surface;

using std::numbers::pi;

struct PointSums {
  Vec3 laplacian;  // sum over edges of (cot + cot) * (x_i - x_j)
  Vec3 normal;     // sum of vector areas
  double angles = 0, area = 0;
};

// What the triangles around a point add up to; triangles of no area add nothing.
std::vector<PointSums> sums_of(const CellsView& triangles, const std::vector<Vec3>& at) {
  std::vector<PointSums> s(at.size());
  for (size_t t = 0; t < triangles.count; ++t) {
    const size_t id[3] = {size_t(triangles.point(t, 0)), size_t(triangles.point(t, 1)), size_t(triangles.point(t, 2))};
    const Vec3 n = cross(at[id[1]] - at[id[0]], at[id[2]] - at[id[0]]);
    const double twice = length(n);
    if (!(twice > 0)) continue;
    double cot[3], angle[3], side2[3];  // side2[k]: the side opposite corner k, squared
    int blunt = -1;
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 u = at[id[(k + 1) % 3]] - at[id[k]], v = at[id[(k + 2) % 3]] - at[id[k]];
      cot[k] = dot(u, v) / twice;
      angle[k] = std::atan2(twice, dot(u, v));
      const Vec3 w = v - u;
      side2[k] = dot(w, w);
      if (dot(u, v) < 0) blunt = int(k);
    }
    for (size_t k = 0; k < 3; ++k) {
      const size_t a = (k + 1) % 3, b = (k + 2) % 3;
      PointSums& p = s[id[k]];
      p.angles += angle[k];
      p.normal += n;
      p.laplacian += (at[id[k]] - at[id[b]]) * cot[a] + (at[id[k]] - at[id[a]]) * cot[b];
      if (blunt < 0) p.area += (side2[a] * cot[a] + side2[b] * cot[b]) / 8;  // Voronoi region within the triangle
      else p.area += twice / (size_t(blunt) == k ? 4 : 8);
    }
  }
  return s;
}

enum Place : uint8_t { inside, border, beyond };  // beyond: no surface there

std::vector<uint8_t> places(const Edges& edges, const std::vector<PointSums>& sums) {
  std::vector<uint8_t> r(sums.size(), inside);
  for (size_t e = 0; e < edges.size(); ++e) {
    const size_t n = edges.of(e).size();
    for (uint32_t p : {edges.lo[e], edges.hi[e]}) r[p] = n > 2 ? uint8_t(beyond) : n == 1 ? std::max<uint8_t>(r[p], border) : r[p];
  }
  for (size_t p = 0; p < r.size(); ++p)
    if (!(sums[p].area > 0)) r[p] = beyond;
  return r;
}

// The mean over a point and a sixth of each of its neighbours inside, by their areas.
void average_inside(std::vector<double>& values, const Edges& edges, const std::vector<uint8_t>& place,
                    const std::vector<PointSums>& sums) {
  std::vector<double> sum(values.size(), 0), weight(values.size(), 0);
  for (size_t e = 0; e < edges.size(); ++e)
    for (const auto& [p, q] : {std::pair(edges.lo[e], edges.hi[e]), std::pair(edges.hi[e], edges.lo[e])})
      if (place[p] == inside && place[q] == inside) sum[p] += sums[q].area * values[q], weight[p] += sums[q].area;
  for (size_t p = 0; p < values.size(); ++p)
    if (weight[p] > 0) {  // a point of small area carries little information
      const double w = weight[p] / 6 + sums[p].area;
      values[p] = (sums[p].area * values[p] + sum[p] / 6) / w;
    }
}

// Points on the border take the mean of their neighbours inside.
void fill_border(std::vector<double>& values, const Edges& edges, const std::vector<uint8_t>& place) {
  std::vector<double> sum(values.size(), 0);
  std::vector<uint32_t> count(values.size(), 0);
  for (size_t e = 0; e < edges.size(); ++e)
    for (const auto& [p, q] : {std::pair(edges.lo[e], edges.hi[e]), std::pair(edges.hi[e], edges.lo[e])})
      if (place[p] == border && place[q] == inside) sum[p] += values[q], ++count[p];
  for (size_t p = 0; p < values.size(); ++p)
    if (place[p] != inside) values[p] = place[p] == border && count[p] ? sum[p] / count[p] : std::nan("");
}

}  // namespace

DatasetPtr curvature(const DatasetPtr& in, const CurvatureParams& p, Context& ctx) {
  if (!p.gaussian && !p.mean && !p.principal && !p.angle_defect)
    fail_usage("no measure is requested", "curvature", "keep gaussian or mean true");
  const DatasetPtr s = triangle_surface(in, "curvature", ctx);
  DatasetParts out = s->parts();
  SurfaceMesh mesh = *s->as<SurfaceMesh>();
  const std::vector<Vec3> at = positions(mesh.points);
  const Edges edges = edges_of_polygons(cells_view(mesh.polygons), at.size());
  const Orientation o = orientation(cells_view(mesh.polygons), edges, at, false);
  if (o.one_sided)
    ctx.warn(fmt::format("curvature: {} pieces are one-sided, so the sign of the mean curvature is not consistent", o.one_sided));
  mesh = oriented(mesh, o);
  ctx.check();
  const std::vector<PointSums> sums = sums_of(cells_view(mesh.polygons), at);
  const std::vector<uint8_t> place = places(edges, sums);
  const size_t n = at.size();
  std::vector<double> gaussian(n), mean(n), defect(n);
  for (size_t i = 0; i < n; ++i) {
    const PointSums& q = sums[i];
    defect[i] = q.angles == 0 ? 0 : (place[i] == border ? pi : 2 * pi) - q.angles;
    if (place[i] != inside) continue;
    gaussian[i] = defect[i] / q.area;
    const double h = length(q.laplacian) / (4 * q.area);
    mean[i] = dot(q.laplacian, q.normal) < 0 ? -h : h;
  }
  for (int k = 0; k < p.average; ++k)
    for (auto* v : {&gaussian, &mean}) average_inside(*v, edges, place, sums);
  fill_border(gaussian, edges, place);
  fill_border(mean, edges, place);
  if (const auto none = std::count(place.begin(), place.end(), uint8_t(beyond)))
    ctx.info(fmt::format("curvature: {} of {} points have none (NaN): more than two triangles meet in an edge there, or they have no area",
                         none, n));
  const std::string of_axes = length_unit(*in);
  const auto per_length = [&](const char* power) { return of_axes.empty() ? "" : "1/" + of_axes + power; };
  auto add = [&](const char* name, std::vector<double> v, const std::string& unit) {
    out.fields.add({name, Association::point, Array::from_vector(std::move(v)), unit, Role::none, known_look(name)});
  };
  if (p.principal) {
    std::vector<double> largest(n), smallest(n);
    for (size_t i = 0; i < n; ++i) {
      const double apart = std::sqrt(std::max(mean[i] * mean[i] - gaussian[i], 0.0));  // umbilic up to rounding: 0
      largest[i] = mean[i] + apart, smallest[i] = mean[i] - apart;
    }
    add("largest curvature", std::move(largest), per_length(""));
    add("smallest curvature", std::move(smallest), per_length(""));
  }
  if (p.gaussian) add("Gaussian curvature", std::move(gaussian), per_length("^2"));
  if (p.mean) add("mean curvature", std::move(mean), per_length(""));
  if (p.angle_defect) add("angle defect", std::move(defect), "rad");
  mark_result(out.fields, "mean curvature", Association::point);
  out.mesh = std::move(mesh);
  return make_dataset(std::move(out));
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/fronts/surface_run.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "data/fields/known_looks.h"
#include "filter/flow/fronts/default_curve.h"
#include "filter/flow/line_mesh.h"

namespace sg {

namespace {

// Seeds evenly along a curve, and their parameters.
std::vector<double> even_parameters(const SeedCurve& curve, double spacing) {
  const double wanted = std::max(std::ceil(curve.whole() / spacing - 1e-9), curve.closed ? 3.0 : 1.0);
  if (!(wanted <= 1e6)) fail_usage(fmt::format("{:.3g} seeds are too many", wanted), "surfaces", "use a larger spacing or a shorter curve");
  const auto n = size_t(wanted);
  std::vector<double> out;
  for (size_t i = 0; i < n + size_t(!curve.closed); ++i) out.push_back(double(i) / double(n));
  return out;
}

DatasetPtr seed_lines(const std::vector<Data>& others, const char* who) {
  return others.empty() ? nullptr : single_dataset(others[0], who);
}

}  // namespace

UnsteadyParams run_params(const UnsteadySurfaceParams& p, const std::vector<Vec3>& seeds) {
  UnsteadyParams u;
  u.field = p.field, u.times = p.times, u.start = p.start, u.time = p.time, u.interpolation = p.interpolation;
  u.integration = p.integration, u.geographic = p.geographic;
  for (const Vec3& x : seeds) u.seeds.points.insert(u.seeds.points.end(), {x.x, x.y, x.z});
  return u;
}

double first_diagonal(const Series& series) {
  if (series.times.empty()) fail_usage("the series has no time step", "surfaces");
  Box3 box;
  for_each_dataset(series.load(0), [&](const std::string&, const DatasetPtr& d) { box.add(d->bounds()); });
  return box.diagonal();
}

DatasetPtr surface_dataset(Collected c, const Field& velocity, double start, double end, bool releases) {
  const size_t n = c.x.size();
  Box3 box;
  for (const Vec3& x : c.x) box.add(x);
  SurfaceMesh mesh;
  mesh.points.origin = box.empty() ? Vec3() : box.center();
  float *xyz = nullptr, *v = nullptr, *speed = nullptr, *s = nullptr, *st = nullptr, *age = nullptr;
  mesh.points.xyz = Array::make<float>(n, 3, &xyz);
  FieldSet fields;
  fields.add({own_value("speed", velocity.name), Association::point, Array::make<float>(n, 1, &speed), velocity.unit, Role::scalars,
              known_look("speed")});
  fields.add({velocity.name, Association::point, Array::make<float>(n, 3, &v), velocity.unit, Role::vectors});
  fields.add({own_value("seed parameter", velocity.name), Association::point, Array::make<float>(n, 1, &s), "", Role::none});
  fields.add({own_value("age", velocity.name), Association::point, Array::make<float>(n, 1, &age), "", Role::none});
  fields.add({own_value("texture coordinates", velocity.name), Association::point, Array::make<float>(n, 2, &st), "", Role::tcoords});
  for (size_t i = 0; i < n; ++i) {
    for (int a = 0; a < 3; ++a) xyz[3 * i + size_t(a)] = float(c.x[i][a] - mesh.points.origin[a]), v[3 * i + size_t(a)] = float(c.v[i][a]);
    speed[i] = float(length(c.v[i])), s[i] = float(c.s[i]), age[i] = float(c.time[i] - c.born[i]);
    st[2 * i] = s[i], st[2 * i + 1] = end > start ? float((c.time[i] - c.born[i]) / (end - start)) : 0;
  }
  fields.add({own_value("time", velocity.name), Association::point, Array::from_vector(std::move(c.time)), "", Role::none});
  if (releases)
    fields.add({own_value("release time", velocity.name), Association::point, Array::from_vector(std::move(c.born)), "", Role::none});
  mesh.polygons.fixed = 3;
  mesh.polygons.connectivity = Array::from_vector(std::move(c.triangles));
  DatasetParts parts{std::move(mesh), std::move(fields), {}, {}, {}, end};
  return make_dataset(std::move(parts));
}

CurveRun::CurveRun(const Series& series, const std::vector<Data>& others, const UnsteadySurfaceParams& p, const SeedCurveParams& c,
                   const char* who, Context& context)
    : curve(seed_curve(
          others.empty() && c.nothing() ? across_the_flow(flow_at(series, p.start, p.field.name, who, context), who, context) : c,
          seed_lines(others, who), who)),
      spacing(p.spacing.value_or(std::min(first_diagonal(series) / 100, c.nothing() ? curve.whole() / 12 : HUGE_VAL))),
      parameters(even_parameters(curve, spacing)),
      run(series, {}, run_params(p, places()), who, false, context) {}

std::vector<Vec3> CurveRun::places() const {
  std::vector<Vec3> at;
  for (const double s : parameters) at.push_back(curve(s));
  return at;
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <numeric>

#include "filter/mesh/mesh_meshes.h"
#include "filter/scalar/contour/contour.h"
#include "filter/surface/curvature.h"
#include "support/test.h"
#include "surface_shapes.h"

using namespace sg;
using namespace sg::test::shapes;

namespace {

std::vector<double> values(const Dataset& d, const char* name) {
  const Field& f = d.fields().require(name, Association::point);
  std::vector<double> r;
  for (size_t i = 0; i < f.array.count(); ++i) r.push_back(f.array.get(i));
  return r;
}

double sum(const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); }

}  // namespace

TEST_CASE("curvature: of a sphere converges to 1/r^2 and 1/r; of a torus with its closed form") {
  Context ctx;
  double h[4], k[4], m[4], tk[4], tm[4];
  for (int l = 0; l < 4; ++l) {
    h[l] = std::pow(0.5, l);
    const DatasetPtr d = curvature(sphere(l + 2, 2).dataset(), {}, ctx);
    k[l] = m[l] = tk[l] = tm[l] = 0;
    double n = 0;
    for (double x : values(*d, "Gaussian curvature")) k[l] += std::pow(x - 0.25, 2), n += 1;
    for (double x : values(*d, "mean curvature")) m[l] += std::pow(x - 0.5, 2);
    k[l] = std::sqrt(k[l] / n), m[l] = std::sqrt(m[l] / n);
    const int c = 12 << l;
    const DatasetPtr t = curvature(torus(2 * c, c, 1, 0.4).dataset(), {}, ctx);
    const auto tg = values(*t, "Gaussian curvature"), th = values(*t, "mean curvature");
    for (size_t i = 0; i < tg.size(); ++i) {
      const double v = 2 * pi * double(i % size_t(c)) / c, R = 1, r = 0.4, w = R + r * std::cos(v);
      tk[l] = std::max(tk[l], std::abs(tg[i] - std::cos(v) / (r * w)));
      tm[l] = std::max(tm[l], std::abs(th[i] - (R + 2 * r * std::cos(v)) / (2 * r * w)));
    }
  }
  MESSAGE("sphere K " << k[3] << " H " << m[3] << "; torus K " << tk[3] << " H " << tm[3] << " orders " << test::observed_order(h, k, 4)
                      << " " << test::observed_order(h, m, 4) << " " << test::observed_order(h, tk, 4) << " "
                      << test::observed_order(h, tm, 4));
  CHECK(test::observed_order(h, k, 4) > 0.9);
  CHECK(test::observed_order(h, m, 4) > 0.9);
  CHECK(test::observed_order(h, tk, 4) > 1.8);
  CHECK(test::observed_order(h, tm, 4) > 1.8);
}

TEST_CASE("curvature: Gauss-Bonnet: the angle defects add up to 2 pi times the Euler number") {
  Context ctx;
  const CurvatureParams p{.angle_defect = true};
  CHECK(sum(values(*curvature(sphere(4).dataset(), p, ctx), "angle defect")) == doctest::Approx(4 * pi).epsilon(1e-12));
  CHECK(std::abs(sum(values(*curvature(torus(40, 20, 1, 0.4).dataset(), p, ctx), "angle defect"))) < 1e-10);
  CHECK(sum(values(*curvature(box().dataset(), p, ctx), "angle defect")) == doctest::Approx(4 * pi).epsilon(1e-13));
  CHECK(std::abs(sum(values(*curvature(cylinder(20, 1, false).dataset(), p, ctx), "angle defect"))) < 1e-11);  // an open tube: 0
  CHECK(sum(values(*curvature(test::meshes::uniform_box(5, 4, 0), p, ctx), "angle defect")) == doctest::Approx(2 * pi).epsilon(1e-12));
}

TEST_CASE("curvature: cylinders are flat one way; inside out turns the sign; borders take their neighbours' values") {
  Context ctx;
  Builder tube;
  const int n = 48, rows = 5;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < n; ++i) tube.point({2 * std::cos(2 * pi * i / n), 2 * std::sin(2 * pi * i / n), 0.2 * j});
  for (int64_t j = 0; j + 1 < rows; ++j)
    for (int64_t i = 0; i < n; ++i) tube.polygon({j * n + i, j * n + (i + 1) % n, (j + 1) * n + (i + 1) % n, (j + 1) * n + i});
  const DatasetPtr d = curvature(tube.dataset(), {.principal = true}, ctx);
  for (double x : values(*d, "Gaussian curvature")) CHECK(std::abs(x) < 1e-10);
  for (double x : values(*d, "mean curvature")) CHECK(x == doctest::Approx(0.25).epsilon(0.01));
  for (double x : values(*d, "largest curvature")) CHECK(x == doctest::Approx(0.5).epsilon(0.01));
  Builder in = sphere(3);
  for (size_t t = 0; t < in.ids.size(); t += 3) std::swap(in.ids[t], in.ids[t + 1]);
  for (double x : values(*curvature(in.dataset(), {}, ctx), "mean curvature")) CHECK(x == doctest::Approx(-1).epsilon(0.05));
}

TEST_CASE("curvature: bad input: no choice, clouds, triangles of no area, fins") {
  Context ctx;
  CHECK(test::error_of([&] { curvature(sphere(1).dataset(), {.gaussian = false, .mean = false}, ctx); }).find("no measure is requested") !=
        std::string::npos);
  Builder fin = box();
  const int64_t p = fin.point({-1, 0, 0}), q = fin.point({-1, 1, 0});
  fin.polygon({0, 2, q, p});
  const auto k = values(*curvature(fin.dataset(), {}, ctx), "Gaussian curvature");
  CHECK(std::isnan(k[0]));
  CHECK(std::isfinite(k[7]));
  Builder flat;
  for (int i = 0; i < 3; ++i) flat.point({double(i), 0, 0});
  flat.polygon({0, 1, 2});
  for (double x : values(*curvature(flat.dataset(), {}, ctx), "mean curvature")) CHECK(std::isnan(x));
}

TEST_CASE("curvature: averaging calms the thin triangles of a contour") {
  Context ctx;
  UniformGrid g;
  g.dims = {33, 33, 33};
  g.origin = {-1.3, -1.3, -1.3};
  g.spacing = {2.6 / 32, 2.6 / 32, 2.6 / 32};
  std::vector<double> f;
  for (int k = 0; k < 33; ++k)
    for (int j = 0; j < 33; ++j)
      for (int i = 0; i < 33; ++i) f.push_back(length(g.origin + g.spacing * Vec3(i, j, k)));
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(f), "", Role::scalars});
  const DatasetPtr s = contour(make_dataset(g, fields), {.field = {}, .values = {1}, .component = {}}, ctx);
  auto worst = [&](int times) {
    double w = 0;
    for (double x : values(*curvature(s, {.average = times}, ctx), "mean curvature")) w = std::max(w, std::abs(std::abs(x) - 1));
    return w;
  };
  CHECK(worst(6) < 0.25);
  CHECK(worst(6) < 0.5 * worst(0));
}

TEST_CASE("curvature: its unit is that of the axes, and points that have none are told") {
  std::string told;
  Context ctx;
  ctx.on_log = [&](LogLevel, std::string_view text) { told += std::string(text) + "\n"; };
  DatasetParts parts = sphere(2).dataset()->parts();
  CHECK(curvature(make_dataset(DatasetParts(parts)), {}, ctx)->fields().require("mean curvature").unit.empty());
  parts.notes.emplace_back("length unit", "um");
  const DatasetPtr d = curvature(make_dataset(std::move(parts)), {}, ctx);
  CHECK(d->fields().require("mean curvature").unit == "1/um");
  CHECK(d->fields().require("Gaussian curvature").unit == "1/um^2");
  CHECK(told.empty());
  // Three triangles that meet in one edge.
  SurfaceMesh m;
  m.points.xyz = Array::from_vector<float>({0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, -1, -1, 0}, 3);
  m.polygons = {Array::from_vector<int32_t>({0, 1, 2, 0, 1, 3, 0, 1, 4}), {}, 3};
  curvature(make_dataset(m), {}, ctx);
  CHECK(told.find("2 of 5 points have none (NaN)") != std::string::npos);
}

// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/mesh/heat_on_mesh.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "filter/every_mesh.h"
#include "simulate/pde/mesh/meshes.h"
#include "support/test.h"

using namespace sg;
using namespace sg::pde;

namespace {

using std::numbers::pi;

template <class F>
double error_on(const DatasetPtr& d, F&& f) {
  const Simplices s = simplices_of(d, "test", Context());
  const Array& a = d->fields().require("temperature", Association::point).array;
  double worst = 0;
  for (size_t i = 0; i < a.count(); ++i) worst = std::max(worst, std::abs(a.get(i) - f(s.at[i])));
  return worst;
}

// The root of the mean square, which irregular cells do not disturb.
template <class F>
double mean_error_on(const DatasetPtr& d, F&& f) {
  const Simplices s = simplices_of(d, "test", Context());
  const Array& a = d->fields().require("temperature", Association::point).array;
  double sum = 0;
  for (size_t i = 0; i < a.count(); ++i) sum += std::pow(a.get(i) - f(s.at[i]), 2);
  return std::sqrt(sum / double(a.count()));
}

HeatOnMeshParams steady(const std::string& value, const std::string& source = "0") {
  HeatOnMeshParams p;
  p.steady = true, p.held = "border", p.value = value, p.source = source, p.diffusivity = "1", p.tolerance = 1e-12;
  return p;
}

DatasetPtr with_field(const DatasetPtr& in, const std::string& name, Association on, std::vector<double> values) {
  DatasetParts parts = in->parts();
  parts.fields.add({name, on, Array::from_vector(std::move(values)), "", Role::scalars});
  return make_dataset(std::move(parts));
}

}  // namespace

TEST_CASE("heat_on_mesh: steady linear temperatures are exact on tetrahedra at random, hexahedra, quads and triangles") {
  Context context;
  const auto linear = [](Vec3 p) { return 3 * p.x - 2 * p.y + p.z - 1; };
  for (const DatasetPtr& mesh : {test::as_simplices(test::shaken_grid(6, 0.35)), test::shaken_grid(5, 0.25),
                                 test::shaken_grid(9, 0.3, true), test::as_simplices(test::shaken_grid(9, 0.3, true))})
    CHECK(error_on(heat_on_mesh(mesh, steady("3*x-2*y+z-1"), context), linear) < 1e-9);
  // A wall between two sides that are held, insulated across.
  HeatOnMeshParams wall = steady("2*x+1");
  wall.held = "x==0||x==1";
  CHECK(error_on(heat_on_mesh(test::shaken_grid(5, 0.25), wall, context), [](Vec3 p) { return 2 * p.x + 1; }) < 1e-9);
}

TEST_CASE("heat_on_mesh: steady linear temperatures are exact on every kind of mesh, curved ones made linear") {
  Context context;
  for (const test::MeshKind& kind : test::every_mesh()) {
    CAPTURE(kind.name);
    const DatasetPtr mesh = kind.make(4, 2);
    if (mesh->as<AmrGrid>()) {
      CHECK(test::contains(test::error_of([&] { heat_on_mesh(mesh, steady("x"), context); }), "resample it first"));
      continue;
    }
    const DatasetPtr d = heat_on_mesh(mesh, steady("3*x-2*y+z-1"), context);
    CHECK(d->point_count() >= 9);
    CHECK(error_on(d, [](Vec3 p) { return 3 * p.x - 2 * p.y + p.z - 1; }) < 1e-8);
  }
}

TEST_CASE("heat_on_mesh: along a line, a steady source makes a parabola, exact at the points") {
  Context context;
  SurfaceMesh m;
  std::vector<double> xyz;
  std::vector<int32_t> ids;
  for (int i = 0; i <= 10; ++i) xyz.insert(xyz.end(), {i / 10.0, 2 * i / 10.0, 0}), ids.push_back(i);
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.lines.connectivity = Array::from_vector(std::move(ids));
  m.lines.offsets = Array::from_vector(std::vector<int32_t>{0, 11});
  CHECK(error_on(heat_on_mesh(make_dataset(m), steady("0", "2"), context), [](Vec3 p) { return 5 * p.x * (1 - p.x); }) < 1e-9);
}

TEST_CASE("heat_on_mesh: a made-up solution is met with order 2 on shaken tetrahedra and triangles") {
  Context context;
  for (const bool flat : {true, false}) {
    double h[4], error[4];
    for (int i = 0; i < 4; ++i) {
      const size_t n = size_t(flat ? 8 : 4) << i;
      h[i] = 1.0 / double(n);
      const std::string u = flat ? "sin(pi*x)*exp(y)" : "sin(pi*x)*exp(y)*cos(z)";
      const DatasetPtr d = heat_on_mesh(test::shaken_grid(n, 0.15, flat), steady(u, flat ? "(pi^2-1)*" + u : "pi^2*" + u), context);
      error[i] = mean_error_on(d, [&](Vec3 p) { return std::sin(pi * p.x) * std::exp(p.y) * (flat ? 1 : std::cos(p.z)); });
    }
    CHECK(test::observed_order(h, error, 4) == doctest::Approx(2).epsilon(0.1));
  }
}

TEST_CASE("heat_on_mesh: harmonics of the sphere fade by exp(-l(l+1) t)") {
  Context context;
  double h[4], error[4];
  for (int i = 0; i < 4; ++i) {
    HeatOnMeshParams p;
    p.initial = "x*y", p.diffusivity = "1", p.scheme = MeshHeatScheme::crank_nicolson, p.frame = p.time = 0.1, p.step = 0.1 / (4 << i);
    p.tolerance = 1e-11, h[i] = 1.0 / (1 << i);
    error[i] = error_on(heat_on_mesh(test::sphere_mesh(i + 2), p, context), [](Vec3 q) { return std::exp(-0.6) * q.x * q.y; });
  }
  CHECK(test::observed_order(h, error, 4) == doctest::Approx(2).epsilon(0.15));
}

TEST_CASE("heat_on_mesh: backward Euler has order 1 in time, Crank-Nicolson 2, with sources and held values that change") {
  Context context;
  for (const MeshHeatScheme scheme : {MeshHeatScheme::backward_euler, MeshHeatScheme::crank_nicolson}) {
    double dt[4], error[4];
    for (int i = 0; i < 4; ++i) {
      HeatOnMeshParams p;  // u = exp(-t) + sin(t) x: linear in space
      p.initial = "1", p.held = "border", p.value = "exp(-time)+sin(time)*x", p.source = "-exp(-time)+cos(time)*x";
      p.diffusivity = "0.01", p.scheme = scheme, p.time = p.frame = 1, p.step = dt[i] = 0.2 / (1 << i), p.tolerance = 1e-12;
      error[i] =
          error_on(heat_on_mesh(test::shaken_grid(8, 0.2, true), p, context), [](Vec3 q) { return std::exp(-1) + std::sin(1) * q.x; });
    }
    CHECK(test::observed_order(dt, error, 4) == doctest::Approx(scheme == MeshHeatScheme::crank_nicolson ? 2 : 1).epsilon(0.15));
  }
}

TEST_CASE("heat_on_mesh: nothing is lost where nothing is held, and there are no new extremes on acute triangles") {
  const Context context;
  HeatOnMeshParams p;
  p.initial = "if(z>0.5,1,0)", p.diffusivity = "1", p.frame = 0.02, p.tolerance = 1e-12;
  MeshHeat run(test::sphere_mesh(4), p, context);
  const auto total = [&] {
    double s = 0;
    for (size_t i = 0; i < run.values().size(); ++i) s += run.stiffness().mass[i] * run.values()[i];
    return s;
  };
  const double before = total();
  for (int i = 0; i < 10; ++i) run.advance(context);
  CHECK(total() == doctest::Approx(before).epsilon(1e-10));
  for (const double v : run.values()) CHECK((v >= -1e-10 && v <= 1 + 1e-10));
}

TEST_CASE("heat_on_mesh: labels of points and of cells choose where values are held; diffusivities may differ by cell") {
  Context context;
  const DatasetPtr plain = test::shaken_grid(8, 0, true);
  const Simplices s = simplices_of(plain, "test", Context());
  std::vector<double> label, material;
  for (const Vec3& p : s.at) label.push_back(p.x == 0 ? 3 : p.x == 1 ? 7 : 0);
  for (size_t c = 0; c < 64; ++c) material.push_back(c % 8 < 4 ? 1 : 2);
  const DatasetPtr mesh = with_field(with_field(plain, "label", Association::point, label), "material", Association::cell, material);
  HeatOnMeshParams p = steady("if(label==3,0,9)");
  p.held = "label==3||label==7", p.diffusivity = "if(material==1,1,2)";
  // Flow is the same on both sides: slopes 12 and 6.
  CHECK(error_on(heat_on_mesh(mesh, p, context), [](Vec3 q) { return q.x < 0.5 ? 12 * q.x : 6 + 6 * (q.x - 0.5); }) < 1e-9);
  p.held = "material==2", p.value = "5", p.initial = "1";
  const DatasetPtr d = heat_on_mesh(mesh, p, context);
  CHECK(error_on(d, [](Vec3) { return 5.0; }) < 1e-9);
  CHECK(d->fields().find("label"));
  CHECK_FALSE(d->fields().find("border"));
}

TEST_CASE("heat_on_mesh: what nothing holds comes to rest at its mean; sources that balance nothing are told") {
  Context context;
  const DatasetPtr mesh = test::shaken_grid(6, 0.2, true);
  HeatOnMeshParams p;
  p.steady = true, p.initial = "x", p.diffusivity = "1", p.tolerance = 1e-12;
  CHECK(error_on(heat_on_mesh(test::shaken_grid(6, 0, true), p, context), [](Vec3) { return 0.5; }) < 0.02);
  p.source = "1";
  CHECK(test::contains(test::error_of([&] { heat_on_mesh(mesh, p, context); }), "no steady state"));
  double h[4], error[4];
  for (int i = 0; i < 4; ++i) {
    p.source = "pi^2*cos(pi*x)", p.initial = "0";
    h[i] = 1.0 / (4 << i);
    error[i] = error_on(heat_on_mesh(test::shaken_grid(size_t(4) << i, 0, true), p, context), [](Vec3 q) { return std::cos(pi * q.x); });
  }
  CHECK(test::observed_order(h, error, 4) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("heat_on_mesh: the same in any order of times, on any number of threads; time follows frames") {
  const DatasetPtr mesh = test::shaken_grid(10, 0.2), other = test::shaken_grid(10, 0.2, false, 2);
  const auto bytes = [&](const DatasetPtr& in, double time, int threads) {
    set_thread_count(threads);
    Context context;
    HeatOnMeshParams p;
    p.initial = "if(x<0.3,1,0)", p.held = "x==1", p.time = time;
    const DatasetPtr d = heat_on_mesh(in, p, context);
    set_thread_count(0);
    CHECK(d->time().value() == doctest::Approx(time));
    std::vector<double> v(d->point_count());
    for (size_t i = 0; i < v.size(); ++i) v[i] = d->fields().require("temperature").array.get(i);
    return v;
  };
  const auto late = bytes(mesh, 0.2, 1), early = bytes(mesh, 0.08, 3);
  CHECK(bytes(mesh, 0.2, 4) == late);
  CHECK(bytes(other, 0.2, 1) != late);
  CHECK(bytes(mesh, 0.08, 1) == early);
}

TEST_CASE("heat_on_mesh: bad input is told; one cell is right") {
  Context context;
  const DatasetPtr mesh = test::shaken_grid(3, 0.1);
  const auto error = [&](auto change, DatasetPtr on = nullptr) {
    HeatOnMeshParams p;
    p.initial = "x";
    change(p);
    return test::error_of([&] { heat_on_mesh(on ? on : mesh, p, context); });
  };
  CHECK(test::contains(error([](HeatOnMeshParams& p) { p.initial = "sqrt(-1-x)"; }), "heat_on_mesh initial"));
  CHECK(test::contains(error([](HeatOnMeshParams& p) { p.initial = "tmperature"; }), "heat_on_mesh initial"));
  CHECK(test::contains(error([](HeatOnMeshParams& p) { p.initial = ""; }), "nothing is warm"));
  CHECK(test::contains(error([](HeatOnMeshParams& p) { p.held = "x>5"; }), "no point is held"));
  CHECK(test::contains(error([](HeatOnMeshParams& p) { p.value = "5"; }), "held=border"));
  CHECK(test::contains(error([](HeatOnMeshParams& p) { p.held = "border", p.value = "1/(x-x)"; }), "heat_on_mesh value"));
  CHECK(test::contains(error([](HeatOnMeshParams& p) { p.source = "log(-1-x)"; }), "heat_on_mesh source"));
  CHECK(test::contains(error([](HeatOnMeshParams& p) { p.diffusivity = "-1"; }), "0 or more"));
  CHECK(test::contains(error([](HeatOnMeshParams& p) { p.diffusivity = "1/(x-x)"; }), "0 or more"));
  CHECK(test::contains(error([](HeatOnMeshParams& p) { p.step = 0; }), "heat_on_mesh step"));
  CHECK(test::contains(error([](HeatOnMeshParams& p) { p.step = -1; }), "heat_on_mesh step"));
  CHECK(test::contains(error([](HeatOnMeshParams& p) { p.step = HUGE_VAL; }), "heat_on_mesh step"));
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0}, 3);
  CHECK(test::contains(error([](HeatOnMeshParams&) {}, make_dataset(cloud)), "no lines, faces or solids"));
  // A NaN in a field of the mesh, and one where nothing is held.
  const size_t n = mesh->point_count();
  std::vector<double> bad(n, 1);
  bad[0] = NAN;
  const DatasetPtr spoiled = with_field(mesh, "T", Association::point, bad);
  CHECK(test::contains(error([](HeatOnMeshParams& p) { p.initial = "T"; }, spoiled), "not a number at 0, 0, 0"));
  HeatOnMeshParams p;
  p.initial = "0", p.held = "x==1", p.value = "T", p.steady = true;
  CHECK(error_on(heat_on_mesh(spoiled, p, context), [](Vec3) { return 1.0; }) < 1e-6);
  // One hexahedron whose corners are all held, and one of which none is.
  HeatOnMeshParams one;
  one.initial = "x", one.time = 100, one.frame = 100;
  CHECK(error_on(heat_on_mesh(test::shaken_grid(1, 0), one, context), [](Vec3) { return 0.5; }) < 0.2);
  one.held = "border";
  CHECK(error_on(heat_on_mesh(test::shaken_grid(1, 0), one, context), [](Vec3 q) { return q.x; }) < 1e-12);
}

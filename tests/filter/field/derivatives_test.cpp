// SPDX-License-Identifier: Apache-2.0
#include "filter/field/derivatives/derivatives.h"

#include <algorithm>
#include <cstring>

#include "base/parallel.h"
#include "data/cells/cell_reader.h"
#include "data/cells/point_positions.h"
#include "filter/field/derivatives/quadratic_fit.h"
#include "filter/mesh/to_unstructured.h"
#include "support/test.h"

using namespace sg;

namespace {

// Kuhn tetrahedra of a cube [-1,1]^3 with n cells a side, its points smoothly displaced.
UnstructuredMesh tets(size_t n) {
  const size_t m = n + 1;
  std::vector<double> xyz;
  for (size_t k = 0; k < m; ++k)
    for (size_t j = 0; j < m; ++j)
      for (size_t i = 0; i < m; ++i) {
        const double x = -1 + 2 * double(i) / double(n), y = -1 + 2 * double(j) / double(n), z = -1 + 2 * double(k) / double(n);
        const double w = 0.08 * (1 - x * x) * (1 - y * y) * (1 - z * z);
        xyz.insert(xyz.end(), {x + w * std::sin(5 * y + 3 * z), y + w * std::sin(5 * z + 3 * x), z + w * std::sin(5 * x + 3 * y)});
      }
  constexpr int kuhn[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  std::vector<int64_t> ids;
  for (size_t k = 0; k < n; ++k)
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i)
        for (const auto& tet : kuhn)
          for (const int c : tet) ids.push_back(int64_t(i + size_t(c & 1) + m * (j + size_t(c >> 1 & 1) + m * (k + size_t(c >> 2)))));
  UnstructuredMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.cells.connectivity = Array::from_vector(std::move(ids));
  mesh.cells.fixed = 4;
  mesh.single_type = CellType::tetra;
  return mesh;
}

UniformGrid cube(size_t n) {
  UniformGrid g;
  g.dims = {n, n, n};
  g.origin = {-1, -1, -1};
  g.spacing = Vec3{1, 1, 1} * (2.0 / double(n - 1));
  return g;
}

Array centers(const DatasetPtr& d) {
  CellReader r(d);
  std::vector<double> c;
  for (size_t i = 0; i < r.count(); ++i) {
    r.open(i);
    Vec3 s{0, 0, 0};
    for (const Vec3& p : r.at()) s = s + p;
    for (int a = 0; a < 3; ++a) c.push_back(s[a] / double(r.at().size()));
  }
  return Array::from_vector(c, 3);
}

// The mesh with field f on points or cells; f gives `components` numbers.
template <class F>
DatasetPtr with(Mesh mesh, Association on, int components, F&& f) {
  const DatasetPtr bare = make_dataset(mesh);
  const Array at = on == Association::point ? point_positions(mesh) : centers(bare);
  std::vector<double> v;
  for (size_t i = 0; i < at.count(); ++i) {
    double out[9];
    f(Vec3{at.get(i, 0), at.get(i, 1), at.get(i, 2)}, out);
    v.insert(v.end(), out, out + components);
  }
  FieldSet fields;
  fields.add({"f", on, Array::from_vector(v, components), "m", components == 3 ? Role::vectors : Role::scalars});
  return make_dataset(std::move(mesh), std::move(fields));
}

// Largest error of a field against g, over places with |x|,|y|,|z| < inner.
template <class G>
double error(const DatasetPtr& d, const std::string& name, double inner, G&& g) {
  const Field& f = d->fields().require(name);
  const Array at = f.association == Association::point ? point_positions(d->mesh()) : centers(d);
  double worst = 0;
  for (size_t i = 0; i < at.count(); ++i) {
    const Vec3 p{at.get(i, 0), at.get(i, 1), at.get(i, 2)};
    if (std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}) > inner) continue;
    double right[9];
    g(p, right);
    for (int c = 0; c < f.components(); ++c) {
      const double e = std::fabs(f.array.get(i, c) - right[c]);
      worst = e >= 0 ? std::max(worst, e) : HUGE_VAL;
    }
  }
  return worst;
}

void quadratic(Vec3 p, double* v) { v[0] = 1 + p.x - 2 * p.y + p.x * p.x - 0.5 * p.y * p.y + 2 * p.x * p.z + p.y * p.z; }
void quadratic_gradient(Vec3 p, double* v) { v[0] = 1 + 2 * p.x + 2 * p.z, v[1] = -2 - p.y + p.z, v[2] = 2 * p.x + p.y; }
void quadratic_hessian(Vec3, double* v) {
  const double h[9] = {2, 0, 2, 0, -1, 1, 2, 1, 0};
  std::copy_n(h, 9, v);
}
void wave_value(Vec3 p, double* v) { v[0] = std::sin(2 * p.x) * std::cos(p.y) + p.z * p.z * p.x; }
void wave_slope(Vec3 p, double* v) {
  v[0] = 2 * std::cos(2 * p.x) * std::cos(p.y) + p.z * p.z, v[1] = -std::sin(2 * p.x) * std::sin(p.y), v[2] = 2 * p.z * p.x;
}
// ABC flow with A = B = C = 1 and period 2: curl u = pi u, div u = 0.
void abc(Vec3 p, double* v) {
  const double k = 3.14159265358979323846;
  v[0] = std::sin(k * p.z) + std::cos(k * p.y), v[1] = std::sin(k * p.x) + std::cos(k * p.z), v[2] = std::sin(k * p.y) + std::cos(k * p.x);
}

double order(std::vector<double> h, std::vector<double> e) { return test::observed_order(h.data(), e.data(), int(h.size())); }

}  // namespace

TEST_CASE("gradient: exact for quadratic fields on tetrahedra, points and cells, and so are Hessians") {
  for (const Association on : {Association::point, Association::cell}) {
    Context ctx;
    const DatasetPtr d = with(tets(4), on, 1, quadratic);
    CHECK(error(gradient(d, {}, ctx), "gradient(f)", 2, quadratic_gradient) < 1e-9);
    CHECK(error(hessian(d, {}, ctx), "hessian(f)", 2, quadratic_hessian) < 1e-7);
  }
}

TEST_CASE("gradient: second order on tetrahedra up to the border, points and cells") {
  for (const Association on : {Association::point, Association::cell}) {
    std::vector<double> h, e;
    for (const size_t n : {4, 6, 9, 13}) {
      Context ctx;
      h.push_back(1.0 / double(n));
      e.push_back(error(gradient(with(tets(n), on, 1, wave_value), {}, ctx), "gradient(f)", 2, wave_slope));
    }
    CHECK(order(h, e) > 1.8);
  }
}

TEST_CASE("gradient: cell fields of grids are second order, uniform, rectilinear and curvilinear") {
  std::vector<double> h, e, c;
  for (const size_t n : {13, 17, 23, 31}) {
    Context ctx;
    const UniformGrid u = cube(n);
    h.push_back(1.0 / double(n - 1));
    e.push_back(error(gradient(with(u, Association::cell, 1, wave_value), {}, ctx), "gradient(f)", 2, wave_slope));
    CurvilinearGrid g;
    g.dims = u.dims;
    g.points.xyz = tets(n - 1).points.xyz;
    c.push_back(error(gradient(with(g, Association::cell, 1, wave_value), {}, ctx), "gradient(f)", 2, wave_slope));
  }
  CHECK(order(h, e) > 1.8);
  CHECK(order(h, c) > 1.8);
  Context ctx;
  const std::vector<double> axis{-1, -0.5, 0.5, 1};
  const Array a = Array::from_vector(axis);
  const auto linear = [](Vec3 p, double* v) { v[0] = 3 * p.x - p.y + 2 * p.z; };
  const auto slope = [](Vec3, double* v) { v[0] = 3, v[1] = -1, v[2] = 2; };
  CHECK(error(gradient(with(RectilinearGrid{a, a, a, {0, 0, 0}}, Association::cell, 1, linear), {}, ctx), "gradient(f)", 2, slope) < 1e-12);
}

TEST_CASE("divergence and curl of the ABC flow: 0 and pi u, second order on grids and tetrahedra") {
  const auto zero = [](Vec3, double* v) { v[0] = 0; };
  const auto pi_u = [](Vec3 p, double* v) {
    abc(p, v);
    for (int a = 0; a < 3; ++a) v[a] *= 3.14159265358979323846;
  };
  for (const bool grid : {true, false}) {
    std::vector<double> h, divergences, curls;
    for (const size_t n : {8, 12, 16, 20}) {
      Context ctx;
      const Mesh mesh = grid ? Mesh(cube(n + 1)) : Mesh(tets(n));
      const DatasetPtr d = with(mesh, Association::point, 3, abc);
      h.push_back(1.0 / double(n));
      divergences.push_back(error(divergence(d, {}, ctx), "divergence(f)", 0.8, zero));
      curls.push_back(error(curl(d, {}, ctx), "curl(f)", 0.8, pi_u));
    }
    CHECK(order(h, curls) > 1.8);
    if (grid) CHECK(divergences.back() < 1e-12);  // each component does not depend on its own coordinate
    else CHECK(order(h, divergences) > 1.7);
  }
}

TEST_CASE("hessian: second order inside a grid, symmetric, with the unit of a second derivative") {
  const auto second = [](Vec3 p, double* v) {
    const double xx = -4 * std::sin(2 * p.x) * std::cos(p.y), xy = -2 * std::cos(2 * p.x) * std::sin(p.y),
                 yy = -std::sin(2 * p.x) * std::cos(p.y);
    const double h[9] = {xx, xy, 2 * p.z, xy, yy, 0, 2 * p.z, 0, 2 * p.x};
    std::copy_n(h, 9, v);
  };
  std::vector<double> h, e;
  for (const size_t n : {11, 15, 21, 31}) {
    Context ctx;
    const DatasetPtr d = hessian(with(cube(n), Association::point, 1, wave_value), {}, ctx);
    h.push_back(2.0 / double(n - 1));
    e.push_back(error(d, "hessian(f)", 0.6, second));
    CHECK(d->fields().require("hessian(f)").unit == "m/length^2");
    CHECK(d->fields().size() == 2);
  }
  CHECK(order(h, e) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("quadratic fit: too few neighbours keep linear functions exact and say so; a surface gets its tangential part") {
  QuadraticFit fit;
  const std::vector<Vec3> star = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}};
  fit.place(star, 3, {});
  Vec3 g;
  double h[6];
  fit.solve(std::vector<double>{2, -3, 4, -2}, g, h);
  CHECK(fit.linear());
  CHECK_FALSE(fit.quadratic());
  CHECK(fit.determined() == 0);
  CHECK(length(g - Vec3{2, -3, 4}) < 1e-14);
  for (const double second : h) CHECK(std::abs(second) < 1e-14);
  std::vector<Vec3> ring;
  std::vector<double> df;
  for (int i = 0; i < 12; ++i) {
    ring.push_back({std::cos(i * 0.5), std::sin(i * 0.5), 0});
    if (i % 2) ring.back() = ring.back() * 2;
    df.push_back(3 * ring.back().x - ring.back().y + 2 * ring.back().x * ring.back().y);
  }
  fit.place(ring, 2, {0, 0, 1});
  CHECK(fit.quadratic());
  fit.solve(df, g, h);
  CHECK(length(g - Vec3{3, -1, 0}) < 1e-12);
  CHECK(h[1] == doctest::Approx(2).epsilon(1e-12));
}

TEST_CASE("derivatives: wrong fields are refused, threads do not change a byte") {
  Context ctx;
  const DatasetPtr d = with(tets(3), Association::point, 1, wave_value);
  CHECK(test::error_of([&] { curl(d, {}, ctx); }).find("no field of 3 components") != std::string::npos);
  CHECK(test::error_of([&] { divergence(d, {{"f"}, ""}, ctx); }).find("has 1 components, not 3") != std::string::npos);
  DatasetParts whole = d->parts();
  whole.fields.add({"of all", Association::whole, Array::from_vector(std::vector<double>{1, 2, 3}), "", Role::none});
  CHECK(test::error_of([&] {
          hessian(make_dataset(whole), {{"of all"}, ""}, ctx);
        }).find("on neither points nor cells") != std::string::npos);
  std::vector<Array> r;
  for (const int threads : {1, 8}) {
    set_thread_count(threads);
    r.push_back(hessian(with(tets(9), Association::point, 1, wave_value), {}, ctx)->fields().require("hessian(f)").array);
  }
  set_thread_count(0);
  CHECK(std::memcmp(r[0].raw(), r[1].raw(), r[0].bytes()) == 0);
}

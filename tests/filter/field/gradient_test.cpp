// SPDX-License-Identifier: Apache-2.0
#include "filter/field/derivatives/gradient.h"

#include "base/parallel.h"
#include "filter/cell_meshes.h"

using namespace sg;
using namespace sg::test;

namespace {

const Vec3 slope(1.5, -2, 0.25);
double linear(Vec3 p) { return dot(slope, p) + 4; }
double wave(Vec3 p) { return std::sin(2 * p.x) * std::cos(p.y) + p.z * p.z * p.x; }
Vec3 wave_gradient(Vec3 p) {
  return {2 * std::cos(2 * p.x) * std::cos(p.y) + p.z * p.z, -std::sin(2 * p.x) * std::sin(p.y), 2 * p.z * p.x};
}

DatasetPtr run(const DatasetPtr& d, const std::string& field = "", const std::string& as = "") {
  Context c;
  GradientParams p;
  p.field.name = field;
  p.as = as;
  return gradient(d, p, c);
}

Vec3 at(const Field& f, size_t i) { return {f.array.get(i, 0), f.array.get(i, 1), f.array.get(i, 2)}; }

// Largest difference from the slope, less its part along `normal`.
double worst(const DatasetPtr& d, Vec3 want) {
  const auto r = run(d);
  const Field& g = r->fields().require("gradient(f)", Association::point);
  REQUIRE(g.components() == 3);
  double e = 0;
  for (size_t i = 0; i < g.array.count(); ++i) {
    const double off = length(at(g, i) - want);
    e = std::isfinite(off) ? std::max(e, off) : HUGE_VAL;
  }
  return e;
}

DatasetPtr curvilinear(std::array<size_t, 3> n, double (*f)(Vec3)) {
  const Mesh box = uniform(n, {-1, -1, -1}, {1, 1, 1});
  const Lattice lattice(box);
  std::vector<double> xyz;
  for (size_t k = 0; k < n[2]; ++k)
    for (size_t j = 0; j < n[1]; ++j)
      for (size_t i = 0; i < n[0]; ++i) {
        const Vec3 q = lattice.view().position(i, j, k), p = q + 0.15 * Vec3(std::sin(2 * q.y), std::sin(2 * q.z), std::sin(2 * q.x));
        xyz.insert(xyz.end(), {p.x, p.y, p.z});
      }
  CurvilinearGrid g;
  g.dims = n;
  g.points.xyz = Array::from_vector(std::move(xyz), 3);
  FieldSet fields;
  fields.add(point_field<double>(g, n, f));
  return make_dataset(g, fields);
}

DatasetPtr rectilinear(std::array<size_t, 3> n, double (*f)(Vec3)) {
  Array axis[3];
  for (int a = 0; a < 3; ++a) {
    std::vector<double> x;
    for (size_t i = 0; i < n[size_t(a)]; ++i) {
      const double t = n[size_t(a)] > 1 ? -1 + 2 * double(i) / double(n[size_t(a)] - 1) : 0.3;
      x.push_back((a == 1 ? -1 : 1) * (t + 0.3 * (1 - t * t)));
    }
    axis[a] = Array::from_vector(std::move(x));
  }
  RectilinearGrid g{axis[0], axis[1], axis[2]};
  FieldSet fields;
  fields.add(point_field<double>(g, n, f));
  return make_dataset(g, fields);
}

DatasetPtr turned(std::array<size_t, 3> n, double (*f)(Vec3)) {
  UniformGrid g = uniform(n, {-1, -1, -1}, {1, 1, 1});
  g.direction = Mat3{{{0.6, -0.8, 0}, {0.8, 0.6, 0.1}, {0, 0, 1}}};
  FieldSet fields;
  fields.add(point_field<double>(g, n, f));
  return make_dataset(g, fields);
}

}  // namespace

TEST_CASE("gradient: a linear field is exact on every mesh kind") {
  CHECK(worst(cube(5, 1, linear), slope) < 1e-12);
  CHECK(worst(turned({5, 4, 6}, linear), slope) < 1e-12);
  CHECK(worst(rectilinear({5, 6, 4}, linear), slope) < 1e-12);
  CHECK(worst(rectilinear({2, 2, 3}, linear), slope) < 1e-12);
  CHECK(worst(curvilinear({5, 6, 7}, linear), slope) < 1e-12);
  for (const auto& kind : solid_kinds()) {
    CAPTURE(kind);
    CHECK(worst(solid_mesh(kind, 3, 1, linear, 0.07), slope) < 1e-9);
  }
}

TEST_CASE("gradient: axes with one point give 0, curved sheets the gradient along them") {
  for (int a = 0; a < 3; ++a) {
    std::array<size_t, 3> n{6, 6, 6};
    n[size_t(a)] = 1;
    Vec3 want = slope;
    want[a] = 0;
    const Mesh g = uniform(n, {-1, -1, -1}, {1, 1, 1});
    FieldSet fields;
    fields.add(point_field<double>(g, n, linear));
    CHECK(worst(make_dataset(g, fields), want) < 1e-12);
    CHECK(worst(rectilinear(n, linear), want) < 1e-12);
  }
  // A plane of triangles across (0,0,1)+(0,1,1): only the part of the slope in the plane.
  SurfaceMesh s;
  std::vector<double> xyz, v;
  std::vector<int32_t> ids;
  const Vec3 u(1, 0, 0), w = normalize(Vec3(0, 1, 1)), normal = cross(u, w);
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 5; ++i) {
      const Vec3 p = u * double(i) + w * double(j);
      xyz.insert(xyz.end(), {p.x, p.y, p.z});
      v.push_back(linear(p));
      if (i < 4 && j < 4) {
        const int a = i + 5 * j;
        ids.insert(ids.end(), {a, a + 1, a + 6, a, a + 6, a + 5});
      }
    }
  s.points.xyz = Array::from_vector(xyz, 3);
  s.polygons.connectivity = Array::from_vector(ids);
  s.polygons.fixed = 3;
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(v), "", Role::scalars});
  CHECK(worst(make_dataset(s, fields), slope - normal * dot(slope, normal)) < 1e-9);
}

TEST_CASE("gradient: second order on uniform, rectilinear and curvilinear grids, borders included") {
  for (auto make : {turned, rectilinear, curvilinear}) {
    double h[4], e[4];
    const size_t n[] = {9, 17, 33, 65};
    for (int k = 0; k < 4; ++k) {
      const auto r = run(make({n[k], n[k], n[k]}, wave));
      const Field& g = r->fields().require("gradient(f)");
      const Lattice lattice(r->mesh());
      h[k] = 1.0 / double(n[k] - 1);
      e[k] = 0;
      size_t p = 0;
      for (size_t z = 0; z < n[k]; ++z)
        for (size_t y = 0; y < n[k]; ++y)
          for (size_t x = 0; x < n[k]; ++x, ++p) e[k] = std::max(e[k], length(at(g, p) - wave_gradient(lattice.view().position(x, y, z))));
    }
    CHECK(observed_order(h, e, 4) == doctest::Approx(2).epsilon(0.1));
  }
}

TEST_CASE("gradient: converges on tetrahedra") {
  double h[3], e[3];
  const int n[] = {5, 10, 20};
  for (int k = 0; k < 3; ++k) {
    const auto r = run(solid_mesh("tetra", n[k], 1, wave));
    const auto& points = r->as<UnstructuredMesh>()->points;
    const Field& g = r->fields().require("gradient(f)");
    h[k] = 1.0 / n[k];
    double sum = 0;
    for (size_t p = 0; p < points.count(); ++p) sum += length(at(g, p) - wave_gradient(points.at(p)));
    e[k] = sum / double(points.count());
  }
  CHECK(observed_order(h, e, 3) > 0.9);
}

TEST_CASE("gradient: of a vector has nine components, row by row") {
  const size_t n = 5;
  const Mesh g = uniform({n, n, n}, {0, 0, 0}, {1, 2, 3});
  const Lattice lattice(g);
  std::vector<float> v;
  for (size_t k = 0; k < n; ++k)
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i) {
        const Vec3 p = lattice.view().position(i, j, k);
        v.insert(v.end(), {float(p.x + 2 * p.y + 3 * p.z), float(4 * p.x + 5 * p.y + 6 * p.z), float(7 * p.x + 8 * p.y + 9 * p.z)});
      }
  FieldSet fields;
  fields.add({"u", Association::point, Array::from_vector(v, 3), "m/s", Role::vectors});
  const auto r = run(make_dataset(g, fields), "u", "J");
  const Field& j = r->fields().require("J", Association::point);
  CHECK(j.components() == 9);
  CHECK(j.array.type() == ElementType::f32);
  CHECK(j.unit == "m/s/length");
  for (size_t p = 0; p < j.array.count(); ++p)
    for (int c = 0; c < 9; ++c) CHECK(j.array.get(p, c) == doctest::Approx(c + 1).epsilon(1e-4));
  CHECK(r->fields().find("u") != nullptr);
}

TEST_CASE("gradient: beside NaN it is one-sided, at NaN it is NaN") {
  std::vector<double> v(6 * 6 * 6);
  for (size_t p = 0; p < v.size(); ++p) v[p] = 2.0 * double(p % 6);
  v[3 + 6 * (3 + 6 * 3)] = NAN;
  const auto r = run(grid_of<double>({6, 6, 6}, v));
  const Field& g = r->fields().require("gradient(f)");
  for (size_t p = 0; p < v.size(); ++p) {
    if (std::isnan(v[p])) CHECK(std::isnan(g.array.get(p)));
    else CHECK(length(at(g, p) - Vec3(2, 0, 0)) < 1e-12);
  }
}

TEST_CASE("gradient: AMR grids patch by patch, integers, 1 and 8 threads") {
  AmrGrid amr;
  amr.levels.resize(2);
  amr.levels[0].patches.push_back({{0, 0, 0}, {3, 3, 3}, 0, 0});
  amr.levels[1].spacing = {0.5, 0.5, 0.5};
  amr.levels[1].patches.push_back({{2, 2, 2}, {5, 5, 5}, 64, 125});
  std::vector<double> v;
  for (const auto& level : amr.levels)
    for (int k = 0; k < 5; ++k)
      for (int j = 0; j < 5; ++j)
        for (int i = 0; i < 5; ++i) {
          const auto& lo = level.patches[0].lo;
          v.push_back(linear(level.spacing * Vec3(double(lo[0] + i), double(lo[1] + j), double(lo[2] + k))));
        }
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(v), "", Role::scalars});
  CHECK(worst(make_dataset(amr, fields), slope) < 1e-12);
  const auto d = cube<uint8_t>(20, 1, [](Vec3 p) { return 100 + 50 * std::sin(3 * p.x + p.y); });
  set_thread_count(1);
  const auto one = run(d);
  set_thread_count(8);
  const auto eight = run(d);
  set_thread_count(0);
  CHECK(same_bytes(one->fields().require("gradient(f)").array, eight->fields().require("gradient(f)").array));
  const Field& g = one->fields().require("gradient(f)");
  CHECK(g.array.type() == ElementType::f32);
  CHECK(g.array.get(20 * 20 * 10 + 20 * 10 + 10, 0) == doctest::Approx(150 * std::cos(0.2)).epsilon(0.15));
}

TEST_CASE("gradient: refuses what it cannot do and says what would be right") {
  CHECK(error_of([] { run(cube(3, 1, linear), "g"); }).find("field 'g'") != std::string::npos);
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0}, 3);
  CHECK(error_of([&] { run(make_dataset(cloud)); }).find("not connected") != std::string::npos);
  FieldSet fields;
  fields.add({"w", Association::whole, Array::from_vector(std::vector<float>(1)), "", Role::none});
  const auto whole = make_dataset(uniform({2, 2, 2}, {0, 0, 0}, {1, 1, 1}), fields);
  CHECK(error_of([&] { run(whole, "w"); }).find("on neither points nor cells") != std::string::npos);
  CHECK(error_of([&] { run(whole); }).find("no field of one or three components") != std::string::npos);
}

TEST_CASE("gradient: fast rows of an even grid agree with the general path, also beside missing values") {
  // The same grid as a rectilinear one takes the general path.
  UniformGrid u;
  u.dims = {37, 11, 9};
  u.origin = {-1, 2, 3};
  u.spacing = {0.25, 0.5, 0.125};
  std::vector<double> axis[3];
  for (int a = 0; a < 3; ++a)
    for (size_t i = 0; i < u.dims[size_t(a)]; ++i) axis[a].push_back(u.origin[a] + u.spacing[a] * double(i));
  const RectilinearGrid r{Array::from_vector(axis[0]), Array::from_vector(axis[1]), Array::from_vector(axis[2]), {0, 0, 0}};
  for (const bool holes : {false, true})
    for (const bool wide : {false, true}) {
      std::vector<double> v;
      for (size_t i = 0; i < 37 * 11 * 9; ++i) v.push_back(holes && i % 97 == 5 ? NAN : std::sin(double(i) * 0.013) * 4);
      FieldSet f;
      const Array values = Array::from_vector(v);
      f.add({"f", Association::point, wide ? values : values.converted(ElementType::f32), "", Role::scalars});
      Context ctx;
      const Array a = gradient(make_dataset(u, f), {}, ctx)->fields().require("gradient(f)").array;
      const Array b = gradient(make_dataset(r, f), {}, ctx)->fields().require("gradient(f)").array;
      double worst = 0;
      size_t missing = 0;
      for (size_t i = 0; i < a.count(); ++i)
        for (int c = 0; c < 3; ++c) {
          const double x = a.get(i, c), y = b.get(i, c);
          CHECK(std::isnan(x) == std::isnan(y));
          if (std::isnan(x)) ++missing;
          else worst = std::max(worst, std::fabs(x - y));
        }
      CHECK(worst < (wide ? 1e-11 : 2e-4));  // differences of values about 4 over steps of 1/8, in the type's last places
      CHECK((missing > 0) == holes);
    }
}

// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/lines/tubes.h"

#include <cstring>
#include <numbers>

#include "base/parallel.h"
#include "filter/flow/lines/line_frames.h"
#include "filter/surface/mass_properties.h"
#include "support/test.h"

using namespace sg;

namespace {

using std::numbers::pi;

// One poly-line with a point field "size" from 0 to 1 along it and a cell field.
DatasetPtr line_of(const std::vector<Vec3>& at, bool closed = false) {
  std::vector<double> xyz, size;
  std::vector<int32_t> ids;
  for (size_t i = 0; i < at.size(); ++i) {
    xyz.insert(xyz.end(), {at[i].x, at[i].y, at[i].z});
    size.push_back(double(i) / double(at.size() - 1)), ids.push_back(int32_t(i));
  }
  if (closed) ids.push_back(0);
  SurfaceMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.lines.offsets = Array::from_vector(std::vector<int32_t>{0, int32_t(ids.size())});
  mesh.lines.connectivity = Array::from_vector(std::move(ids));
  FieldSet fields;
  fields.add({"size", Association::point, Array::from_vector(std::move(size)), "", Role::none});
  fields.add({"line", Association::cell, Array::from_vector(std::vector<int32_t>{7}), "", Role::none});
  return make_dataset(Mesh(std::move(mesh)), std::move(fields));
}

std::vector<Vec3> circle(int n, double r) {
  std::vector<Vec3> at;
  for (int i = 0; i < n; ++i) at.push_back({r * std::cos(2 * pi * i / n), r * std::sin(2 * pi * i / n), 0});
  return at;
}

double volume(const DatasetPtr& d) {
  Context context;
  const TablePtr t = mass_properties(d, {}, context);
  for (const Field& c : t->columns)
    if (c.name == "volume") return c.array.get(0);
  FAIL("no volume");
  return 0;
}

}  // namespace

TEST_CASE("tubes: a straight one is a prism, closed, with the fields of its line") {
  Context context;
  TubesParams p;
  p.radius = 0.2, p.sides = 9;
  const DatasetPtr tube = tubes(line_of({{0, 0, 0}, {1, 1, 0}, {3, 3, 0}}), p, context);
  const double area = 9.0 / 2 * std::sin(2 * pi / 9) * 0.04;
  CHECK(volume(tube) == doctest::Approx(area * 3 * std::sqrt(2.0)).epsilon(1e-5));
  CHECK(tube->cell_count() == 2 * 9 + 2);
  const Field& size = tube->fields().require("size");
  CHECK(size.array.get(0) == 0);
  CHECK(size.array.get(26) == 1);
  CHECK(tube->fields().require("line").array.get(4) == 7);
  const Field& normals = tube->fields().require("Normals");
  for (size_t i = 0; i < 27; ++i) {
    const Vec3 n(normals.array.get(i, 0), normals.array.get(i, 1), normals.array.get(i, 2));
    CHECK(std::abs(dot(n, Vec3(1, 1, 0))) < 1e-6);
    CHECK(length(n) == doctest::Approx(1));
  }
}

TEST_CASE("tubes: a closed line gives a torus, and a field widens a tube from its radius to ratio times that") {
  Context context;
  TubesParams p;
  p.radius = 0.1, p.sides = 24;
  const DatasetPtr torus = tubes(line_of(circle(96, 1), true), p, context);
  CHECK(torus->cell_count() == 24 * 96);
  CHECK(volume(torus) == doctest::Approx(2 * pi * pi * 0.01).epsilon(0.015));
  p.radius_field = {"size"}, p.ratio = 3;
  const DatasetPtr cone = tubes(line_of({{0, 0, 0}, {0, 0, 1}}), p, context);
  CHECK(cone->bounds().hi.x == doctest::Approx(0.3).epsilon(1e-5));
}

TEST_CASE("line frames: on a helix they turn no more than the line's torsion makes them, and they close on a closed line") {
  // The normal of a rotation-minimising frame turns against the helix's own normal by torsion times length.
  const double a = 1, c = 0.4, speed = std::sqrt(a * a + c * c), torsion = c / (speed * speed);
  std::vector<Vec3> at;
  const int n = 400;
  for (int i = 0; i <= n; ++i) {
    const double t = 4 * pi * i / n;
    at.push_back({a * std::cos(t), a * std::sin(t), c * t});
  }
  std::vector<LineFrame> f;
  make_frames(at, false, {-1, 0, 0}, f);
  const int i = n / 2 + n / 8;  // away from the ends, whose tangents are one-sided
  const int j = n / 8;
  const auto against = [&](int k) {
    const double t = 4 * pi * k / n;
    const Vec3 own(-std::cos(t), -std::sin(t), 0);
    return std::atan2(dot(cross(own, f[size_t(k)].normal), f[size_t(k)].tangent), dot(own, f[size_t(k)].normal));
  };
  const double turn = against(i) - against(j), expected = -torsion * speed * 4 * pi * (i - j) / n;
  CHECK(std::abs(std::remainder(turn - expected, 2 * pi)) < 2e-3);
  make_frames(circle(50, 1), true, {0, 0.3, 1}, f);
  for (size_t k = 1; k < f.size(); ++k) CHECK(dot(f[k].normal, f[k - 1].normal) > 0.9);
  CHECK(dot(f.front().normal, f.back().normal) > 0.9);
}

TEST_CASE("ribbons: they are as wide as asked, and turn with the angle of their rotation") {
  Context context;
  std::vector<Vec3> at;
  for (int i = 0; i <= 20; ++i) at.push_back({0, 0, 0.1 * i});
  RibbonsParams p;
  p.width = 0.4, p.rotation = {"size"}, p.normal = Vec3(1, 0, 0);
  const DatasetPtr band = ribbons(line_of(at), p, context);
  const SurfaceMesh& mesh = *band->as<SurfaceMesh>();
  CHECK(band->cell_count() == 20);
  for (int i = 0; i <= 20; ++i) {
    const Vec3 side = mesh.points.at(size_t(2 * i) + 1) - mesh.points.at(size_t(2 * i));
    CHECK(length(side) == doctest::Approx(0.4).epsilon(1e-5));
    // It faces x at the start, and turns about z by one radian in all.
    const double angle = i / 20.0;
    CHECK(std::abs(dot(side, Vec3(std::cos(angle), std::sin(angle), 0))) < 1e-6);
  }
}

TEST_CASE("tubes: lines without length and meshes without lines, and the same bytes for any number of threads") {
  Context context;
  CHECK(tubes(line_of({{1, 1, 1}, {1, 1, 1}}), {.radius = 1}, context)->cell_count() == 0);
  UniformGrid g;
  g.dims = {3, 3, 3};
  CHECK(test::error_of([&] { tubes(make_dataset(Mesh(g)), {}, context); }).find("streamlines") != std::string::npos);
  const DatasetPtr in = line_of(circle(500, 1));
  set_thread_count(1);
  const DatasetPtr one = tubes(in, {}, context);
  set_thread_count(8);
  const DatasetPtr many = tubes(in, {}, context);
  set_thread_count(0);
  const Array &a = one->as<SurfaceMesh>()->points.xyz, &b = many->as<SurfaceMesh>()->points.xyz;
  CHECK(std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
}

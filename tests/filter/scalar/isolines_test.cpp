// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>
#include <set>

#include "base/parallel.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/scalar/contour/contour_support.h"
#include "filter/scalar/isolines.h"
#include "filter/scalar/line_labels.h"
#include "filter/surface/feature_edges.h"
#include "filter/surface/surface_shapes.h"

using namespace sg;

namespace {

double cell(const Dataset& d, const char* name, size_t i) { return d.fields().require(name, Association::cell).array.get(i); }
double point(const Dataset& d, const char* name, size_t i) { return d.fields().require(name, Association::point).array.get(i); }

}  // namespace

TEST_CASE("isolines: circles are closed lines, their length and area converge with order 2, larger values on the left") {
  Context ctx;
  double h[4], long_by[4], area_by[4];
  for (int l = 0; l < 4; ++l) {
    const size_t n = (size_t(16) << l) + 1;
    const DatasetPtr d = isolines(test::square_grid(n, [](Vec3 p) { return -length(p); }), {.values = {-1}}, ctx);
    REQUIRE(d->cell_count() == 1);
    CHECK(cell(*d, "closed", 0) == 1);
    CHECK(cell(*d, "contour value", 0) == -1);
    const auto& m = *d->as<SurfaceMesh>();
    const CellsView v = cells_view(m.lines);
    CHECK(v.point(0, 0) == v.point(0, v.size(0) - 1));
    double area = 0;
    for (size_t k = 0; k + 1 < v.size(0); ++k)
      area += cross(m.points.at(size_t(v.point(0, k))), m.points.at(size_t(v.point(0, k + 1)))).z / 2;
    CHECK(area > 0);  // the middle is higher and lies on the left
    h[l] = 1.0 / double(n), long_by[l] = std::abs(cell(*d, "length", 0) - 2 * test::shapes::pi),
    area_by[l] = std::abs(area - test::shapes::pi);
  }
  CHECK(test::observed_order(h, long_by, 4) == doctest::Approx(2).epsilon(0.1));
  CHECK(test::observed_order(h, area_by, 4) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("isolines: a field of the input's that is called contour value breaks no line") {
  Context ctx;
  DatasetParts parts = test::square_grid(21, [](Vec3 p) { return -length(p); })->parts();
  std::vector<float> other(20 * 20);
  for (size_t i = 0; i < other.size(); ++i) other[i] = float(i);
  parts.fields.add({"contour value", Association::cell, Array::from_vector(std::move(other)), "", Role::none});
  const DatasetPtr d = isolines(make_dataset(std::move(parts)), {.values = {-1}}, ctx);
  REQUIRE(d->cell_count() == 1);
  CHECK(cell(*d, "contour value", 0) == -1);
}

TEST_CASE("contour: as many round values as are asked for") {
  Context ctx;
  const DatasetPtr d = contour(test::square_grid(41, [](Vec3 p) { return 10 * p.x; }), {.field = {}, .count = 4, .component = {}}, ctx);
  const Range r = d->range(d->fields().require("contour value", Association::cell), 0);
  CHECK(r.lo == -10);  // of -15 to 15: -10, -5, 0, 5, 10
  CHECK(r.hi == 10);
  std::set<double> values;
  for (size_t i = 0; i < d->cell_count(); ++i) values.insert(cell(*d, "contour value", i));
  CHECK(values == std::set<double>{-10, -5, 0, 5, 10});
}

TEST_CASE("isolines: open lines end at the border; each value has its own; every segment is used once") {
  Context ctx;
  const DatasetPtr d = isolines(test::square_grid(20, [](Vec3 p) { return p.x; }), {.count = 5}, ctx);
  CHECK(d->cell_count() == 5);
  for (size_t i = 0; i < 5; ++i) {
    CHECK(cell(*d, "closed", i) == 0);
    CHECK(cell(*d, "length", i) == doctest::Approx(3).epsilon(1e-6));
    CHECK(cell(*d, "contour value", i) == doctest::Approx(-1 + 0.5 * double(i)));
  }
  const DatasetPtr wild = test::square_grid(60, [](Vec3 p) { return std::sin(7 * p.x + 1) * std::cos(9 * p.y) + 0.3 * p.x; });
  const DatasetPtr segments = contour(wild, {.field = {}, .values = {0.1, 0.5}, .component = {}}, ctx);
  const DatasetPtr lines = isolines(wild, {.values = {0.1, 0.5}}, ctx);
  const CellsView v = cells_view(lines->as<SurfaceMesh>()->lines);
  size_t n = 0;
  for (size_t i = 0; i < v.count; ++i) n += v.size(i) - 1;
  CHECK(n == segments->cell_count());
  CHECK(v.count < 80);
  for (size_t i = 0; i < v.count; ++i)
    if (cell(*lines, "closed", i) == 0)
      for (size_t k : {size_t(0), v.size(i) - 1}) {
        const Vec3 p = lines->as<SurfaceMesh>()->points.at(size_t(v.point(i, k)));
        CHECK(std::max(std::abs(p.x), std::abs(p.y)) == doctest::Approx(1.5));
      }
}

TEST_CASE("isolines: every mesh kind: the skin of solids, surfaces, unstructured faces, AMR") {
  Context ctx;
  using namespace test::meshes;
  for (const DatasetPtr& d : {uniform_box(4, 4, 4), solid_box(CellType::tetra, 3), solid_box(CellType::polyhedron, 2)}) {
    const DatasetPtr l = isolines(d, {.field = {"f"}, .values = {2}}, ctx);  // a plane through the box: one closed polygon
    REQUIRE(l->cell_count() == 1);
    CHECK(cell(*l, "closed", 0) == 1);
    CHECK(cell(*l, "length", 0) ==
          doctest::Approx(cell(*isolines(uniform_box(1, 1, 1), {.field = {"f"}, .values = {2}}, ctx), "length", 0)).epsilon(1e-6));
  }
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0}, 3);
  CHECK(test::error_of([&] { isolines(make_dataset(Mesh(cloud)), {}, ctx); }).find("no faces") != std::string::npos);
  CHECK(test::error_of([&] { isolines(uniform_box(2, 2, 0), {.field = {"c"}}, ctx); }).find("cells") != std::string::npos);
  CHECK(isolines(test::square_grid(4, [](Vec3 p) { return p.x; }), {.values = {9}}, ctx)->cell_count() == 0);
  CHECK(isolines(test::square_grid(4, [](Vec3) { return 1.0; }), {}, ctx)->cell_count() == 0);
}

TEST_CASE("polylines: edges of a box end at its corners; those of an open cylinder are two rings; fields keep lines apart") {
  Context ctx;
  CHECK(polylines(feature_edges(test::shapes::box().dataset(), {}, ctx), {}, ctx)->cell_count() == 12);
  const DatasetPtr edges = feature_edges(test::shapes::cylinder(20, 1, false).dataset(), {}, ctx);
  const DatasetPtr rings = polylines(edges, {}, ctx);
  CHECK(rings->cell_count() == 2);
  CHECK(cell(*rings, "closed", 1) == 1);
  DatasetParts parts = edges->parts();
  std::vector<int32_t> half;
  for (size_t i = 0; i < 40; ++i)
    half.push_back(edges->as<SurfaceMesh>()->points.at(size_t(cells_view(edges->as<SurfaceMesh>()->lines).point(i, 0))).x > 0);
  parts.fields.add({"half", Association::cell, Array::from_vector(half), "", Role::none});
  CHECK(polylines(make_dataset(parts), {.fields = {"half"}}, ctx)->cell_count() >= 4);
  CHECK(test::error_of([&] { polylines(test::shapes::box().dataset(), {}, ctx); }).find("no lines") != std::string::npos);
  CHECK(test::error_of([&] { polylines(edges, {.fields = {"angel"}}, ctx); }).find("angle") != std::string::npos);
  UniformGrid line;
  line.dims = {5, 1, 1};
  CHECK(polylines(make_dataset(Mesh(line)), {}, ctx)->cell_count() == 1);
  // The direction of the first segment stays, others are turned.
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0}, 3);
  m.lines = {Array::from_vector(std::vector<int32_t>{1, 2, 1, 0, 3, 2}), {}, 2};
  const DatasetPtr one = polylines(make_dataset(Mesh(m)), {}, ctx);
  REQUIRE(one->cell_count() == 1);
  for (int64_t k = 0; k < 4; ++k) CHECK(cells_view(one->as<SurfaceMesh>()->lines).point(0, size_t(k)) == k);
}

TEST_CASE("line_labels: spaced along lines, upright, in the straight parts") {
  Context ctx;
  const DatasetPtr lines = isolines(test::square_grid(40, [](Vec3 p) { return p.x - p.y; }), {.values = {0, 0.5}}, ctx);
  const DatasetPtr d = line_labels(lines, {.spacing = 1.1, .width = 0.2}, ctx);
  REQUIRE(d->point_count() >= 4);
  for (size_t i = 0; i < d->point_count(); ++i) {
    const Vec3 p = d->as<PointCloud>()->points.at(i);
    CHECK(point(*d, "angle", i) == doctest::Approx(45).epsilon(1e-5));
    CHECK(point(*d, "value", i) == doctest::Approx(p.x - p.y).epsilon(1e-5));
    for (size_t k = 0; k < i; ++k) CHECK(length(p - d->as<PointCloud>()->points.at(k)) > 0.2);
  }
  // A rounded corner is avoided.
  SurfaceMesh m;
  std::vector<double> xyz;
  for (int i = 0; i <= 20; ++i) xyz.insert(xyz.end(), {i < 10 ? 0.0 : double(i - 10) / 10, i < 10 ? 1 - i / 10.0 : 0.0, 0.0});
  std::vector<int32_t> ids(21);
  std::iota(ids.begin(), ids.end(), 0);
  m.points.xyz = Array::from_vector(xyz, 3);
  m.lines = {Array::from_vector(ids), {}, 21};
  DatasetParts parts;
  parts.mesh = m;
  parts.fields.add({"v", Association::point, Array::from_vector(std::vector<double>(21, 3)), "m", Role::scalars});
  const DatasetPtr corner = line_labels(make_dataset(parts), {.spacing = 10, .width = 0.3}, ctx);
  REQUIRE(corner->point_count() == 1);
  const Vec3 p = corner->as<PointCloud>()->points.at(0);
  CHECK(std::max(p.x, p.y) > 0.149);
  CHECK(point(*corner, "value", 0) == 3);
  // Read from the front, a line along z stands on its head at most at 90 degrees.
  const DatasetPtr front = line_labels(make_dataset(parts), {.spacing = 10, .width = 0.3, .normal = {0, 0, -1}}, ctx);
  CHECK(std::abs(point(*front, "angle", 0)) <= 90);
  CHECK(line_labels(lines, {.width = 100}, ctx)->point_count() == 0);
  CHECK(test::error_of([&] { line_labels(lines, {.normal = {0, 0, 0}}, ctx); }).find("no length") != std::string::npos);
  CHECK(test::error_of([&] { line_labels(test::shapes::box().dataset(), {}, ctx); }).find("field") != std::string::npos);
}

TEST_CASE("isolines: that fields of cells are not on lines is no news; joining lines that have some says so") {
  Context ctx;
  std::string log;
  ctx.on_log = [&](LogLevel, std::string_view text) { log += text; };
  DatasetParts parts = test::square_grid(9, [](Vec3 p) { return p.x; })->parts();
  parts.fields.add({"of cells", Association::cell, Array::from_vector(std::vector<float>(64, 1.0f)), "", Role::none});
  const DatasetPtr lines = isolines(make_dataset(std::move(parts)), {.values = {0.1, 0.5}}, ctx);
  CHECK(log.find("left out") == std::string::npos);
  CHECK(lines->fields().find("contour value", Association::cell));
  polylines(lines, {.fields = {"contour value"}}, ctx);
  CHECK(log.find("left out") != std::string::npos);  // 'length' and 'closed' of the pieces
}

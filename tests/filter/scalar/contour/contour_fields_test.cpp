// SPDX-License-Identifier: Apache-2.0
// Contours: what is carried, left out and refused.
#include <tuple>

#include "filter/cell_meshes.h"
#include "filter/scalar/contour/known_surfaces.h"

using namespace sg;
using namespace sg::test;

namespace {

DatasetPtr carrying(const DatasetPtr& d, std::vector<Field> more, Array cell_ghost = {}, Array point_ghost = {}) {
  DatasetParts p = d->parts();
  for (Field& f : more) p.fields.add(std::move(f));
  p.cell_ghost = std::move(cell_ghost);
  p.point_ghost = std::move(point_ghost);
  p.time = 2.5;
  return make_dataset(std::move(p));
}

}  // namespace

TEST_CASE("contour: carries point fields along edges, cell fields from cells, and fields of the whole") {
  const size_t n = 12, cells = 11 * 11 * 11;
  const auto base = cube(n, 1.5, sphere);
  const Mesh& g = base->mesh();
  std::vector<int32_t> ids(cells);
  std::iota(ids.begin(), ids.end(), 0);
  const auto d = carrying(base, {point_field<float>(
                                     g, {n, n, n}, [](Vec3 p) { return 2 * p.x - p.y + 3; }, "linear"),
                                 {"cell id", Association::cell, Array::from_vector(ids), "", Role::none},
                                 {"title", Association::whole, Array::from_vector(std::vector<double>{7}), "m", Role::none}});
  const auto c = contour_at(d, 0);
  const Surface s(c);
  CHECK(c->time() == 2.5);
  const Field& linear = c->fields().require("linear", Association::point);
  CHECK(linear.array.type() == ElementType::f32);
  for (size_t i = 0; i < s.points.size(); ++i)
    CHECK(linear.array.get(i) == doctest::Approx(2 * s.points[i].x - s.points[i].y + 3).epsilon(1e-5));
  const Field& value = c->fields().require("f", Association::point);
  for (size_t i = 0; i < s.points.size(); ++i) CHECK(std::abs(value.array.get(i)) < 1e-7);
  const Field& id = c->fields().require("cell id", Association::cell);
  REQUIRE(id.array.count() == s.triangles.size());
  for (size_t t = 0; t < s.triangles.size(); ++t) {
    const Vec3 m = (s.points[size_t(s.triangles[t][0])] + s.points[size_t(s.triangles[t][1])] + s.points[size_t(s.triangles[t][2])]) / 3.0;
    const int cell = int(id.array.get(t));
    const int at[3] = {cell % 11, cell / 11 % 11, cell / 121};
    for (int a = 0; a < 3; ++a) {
      const double lo = -1.5 + 3.0 / 11 * at[a];
      CHECK((m[a] > lo - 1e-6 && m[a] < lo + 3.0 / 11 + 1e-6));
    }
  }
  CHECK(c->fields().require("title", Association::whole).array.get(0) == 7);
  CHECK(!c->fields().find("contour value"));
}

TEST_CASE("contour: several values give one mesh with the value on the cells") {
  ContourParams p;
  p.values = {0.2, -0.3};
  const auto d = cube(20, 1.5, sphere);
  const auto both = contoured(d, p);
  const auto first = contour_at(d, 0.2), second = contour_at(d, -0.3);
  CHECK(both->point_count() == first->point_count() + second->point_count());
  REQUIRE(both->cell_count() == first->cell_count() + second->cell_count());
  const Field& value = both->fields().require("contour value", Association::cell);
  const Surface s(both);
  CHECK(s.components() == 2);
  CHECK(s.faults() == 0);
  for (size_t t = 0; t < s.triangles.size(); ++t) {
    CHECK(value.array.get(t) == (t < first->cell_count() ? 0.2 : -0.3));
    for (int v : s.triangles[t]) CHECK(length(s.points[size_t(v)]) == doctest::Approx(1 + value.array.get(t)).epsilon(0.02));
  }
  CHECK(both->fields().require("Normals").array.count() == both->point_count());
  CHECK(both->fields().require("f").array.count() == both->point_count());
}

TEST_CASE("contour: without values it takes the middle of the range, without normals it makes none") {
  ContourParams p;
  p.normals = false;
  const auto d = cube(16, 1, [](Vec3 v) { return v.z * 3 + 5; });
  const auto c = contoured(d, p);
  CHECK(!c->fields().find("Normals"));
  for (Vec3 v : Surface(c).points) CHECK(std::abs(v.z) < 1e-7);
}

TEST_CASE("contour: cells that touch NaN are left out with a clean border") {
  const size_t n = 16;
  std::vector<size_t> missing;
  const auto whole = cube<float>(n, 1.5, sphere);
  auto holes = [&](Vec3 p) { return p.x > 0.2 && p.y > 0.1 ? NAN : sphere(p); };
  const auto d = cube<float>(n, 1.5, holes);
  const auto c = contour_at(d, 0);
  const Surface s(c), full(contour_at(whole, 0));
  CHECK(s.triangles.size() > 100);
  CHECK(s.triangles.size() < full.triangles.size());
  CHECK(s.every_point_used());
  // Every triangle is one of the full surface.
  std::set<std::array<std::array<double, 3>, 3>> all;
  auto key = [](const Surface& q, size_t t) {
    std::array<std::array<double, 3>, 3> r;
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 p = q.points[size_t(q.triangles[t][k])];
      r[k] = {p.x, p.y, p.z};
    }
    return r;
  };
  for (size_t t = 0; t < full.triangles.size(); ++t) all.insert(key(full, t));
  for (size_t t = 0; t < s.triangles.size(); ++t) CHECK(all.count(key(s, t)) == 1);
  for (const auto& [edge, count] : s.edges()) CHECK(count == 1);
  const Field& normal = c->fields().require("Normals");
  for (size_t i = 0; i < s.points.size(); ++i) {
    const Vec3 g(normal.array.get(i, 0), normal.array.get(i, 1), normal.array.get(i, 2));
    CHECK(length(g) == doctest::Approx(1));
    CHECK(dot(g, normalize(s.points[i])) < -0.9);
  }
}

TEST_CASE("contour: ghost and blanked cells and hidden points are left out") {
  const size_t n = 14;
  const auto d = cube(n, 1.5, sphere);
  std::vector<uint8_t> cells(13 * 13 * 13), points(n * n * n);
  for (size_t c = 0; c < cells.size(); ++c)
    cells[c] = c % 13 < 6 ? uint8_t(c % 3 == 0 ? ghost_duplicate : c % 3 == 1 ? ghost_hidden_cell : ghost_refined_cell) : 0;
  for (size_t p = 0; p < points.size(); ++p) points[p] = p % n < 6 ? ghost_hidden_point : 0;
  const Surface by_cells(contour_at(carrying(d, {}, Array::from_vector(cells)), 0)),
      by_points(contour_at(carrying(d, {}, {}, Array::from_vector(points)), 0));
  const double x = -1.5 + 3.0 / 13 * 6;
  CHECK(by_cells.points.size() > 100);
  for (Vec3 p : by_cells.points) CHECK(p.x > x - 1e-6);
  CHECK(by_cells.every_point_used());
  CHECK(by_points.points.size() == by_cells.points.size());
  CHECK(by_points.triangles == by_cells.triangles);
  // The same on hexahedra.
  const auto hexes = solid_mesh("hexahedron", 13, 1.5, sphere);
  const Surface u(contour_at(carrying(hexes, {}, Array::from_vector(cells)), 0));
  CHECK(u.points.size() == by_cells.points.size());
  CHECK(u.triangles.size() == by_cells.triangles.size());
}

TEST_CASE("contour: lines on a 2D grid stop at NaN and ghost cells") {
  std::vector<float> v(10 * 10);
  for (size_t j = 0; j < 10; ++j)
    for (size_t i = 0; i < 10; ++i) v[i + 10 * j] = i == 4 && j == 4 ? NAN : float(j) - 4.5f;
  const auto d = grid_of<float>({10, 10, 1}, v);
  const Surface s(contour_at(d, 0));
  CHECK(s.lines.size() == 7);  // nine, without the two beside the NaN
  CHECK(s.every_point_used());
  std::vector<uint8_t> ghost(81);
  ghost[9 * 4 + 8] = ghost_hidden_cell;
  const Surface less(contour_at(carrying(d, {}, Array::from_vector(ghost)), 0));
  CHECK(less.lines.size() == 6);
  CHECK(less.every_point_used());
}

TEST_CASE("contour: nothing to see gives an empty mesh with its fields and a note") {
  for (const auto& [d, value, note] : {std::tuple{cube(6, 1, sphere), 9.0, "the field ranges from"},
                                       {cube(6, 1, [](Vec3) { return 3.0; }), 3.5, "ranges from 3 to 3"},
                                       {cube(6, 1, [](Vec3) { return double(NAN); }), 0.0, "has no values"},
                                       {solid_mesh("tetra", 3, 1, sphere), 9.0, "the field ranges from"}}) {
    std::string log;
    ContourParams p;
    p.values = {value};
    const auto c = contoured(d, p, &log);
    CHECK(c->point_count() == 0);
    CHECK(c->cell_count() == 0);
    CHECK(c->fields().find("f", Association::point));
    CHECK(c->fields().find("Normals", Association::point));
    CHECK(log.find(note) != std::string::npos);
  }
  // A constant field has no surface at its own value either: no cell has an outside corner.
  CHECK(contour_at(cube(6, 1, [](Vec3) { return 3.0; }), 3)->cell_count() == 0);
  ContourParams none;
  CHECK(contoured(cube(5, 1, [](Vec3) { return double(NAN); }), none)->cell_count() == 0);
}

TEST_CASE("contour: one cell, infinite samples and far away grids") {
  const Surface one(contour_at(grid_of<float>({2, 2, 2}, {1, 0, 0, 0, 0, 0, 0, 0}), 0.25));
  REQUIRE(one.points.size() == 3);
  CHECK(one.points[0] == Vec3(0.75, 0, 0));
  CHECK(dot(one.area_vector(0), Vec3(1, 1, 1)) > 0);  // away from the larger value
  const auto inf = contour_at(grid_of<float>({2, 2, 2}, {HUGE_VALF, 0, 0, 0, 0, 0, 0, -HUGE_VALF}), 0.25);
  for (Vec3 p : Surface(inf).points) CHECK(std::isfinite(p.x + p.y + p.z));
  const size_t n = 20;
  const Mesh far = uniform({n, n, n}, {1e7, -2e7, 3e7}, {1e7 + 2, -2e7 + 2, 3e7 + 2});
  FieldSet fields;
  const Vec3 center(1e7 + 1, -2e7 + 1, 3e7 + 1);
  fields.add(point_field<double>(far, {n, n, n}, [&](Vec3 p) { return length(p - center) - 0.7; }));
  const auto c = contour_at(make_dataset(far, fields), 0);
  double worst = 0;
  for (Vec3 p : Surface(c).points) worst = std::max(worst, std::abs(length(p - center) - 0.7));
  CHECK(worst < 0.01);
  CHECK(c->as<SurfaceMesh>()->points.xyz.type() == ElementType::f32);
}

TEST_CASE("contour: of a component or the magnitude of a vector") {
  const size_t n = 14;
  const Mesh g = uniform({n, n, n}, {-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5});
  const Lattice lattice(g);
  std::vector<float> v;
  for (size_t k = 0; k < n; ++k)
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i) {
        const Vec3 p = lattice.view().position(i, j, k);
        v.insert(v.end(), {float(p.x), float(p.y), float(p.z)});
      }
  FieldSet fields;
  fields.add({"velocity", Association::point, Array::from_vector(v, 3), "", Role::vectors});
  const auto d = make_dataset(g, fields);
  ContourParams p;
  p.values = {1};
  const std::string message = error_of([&] { contoured(d, p); });
  CHECK(message.find("magnitude") != std::string::npos);
  CHECK(message.find("component=0") != std::string::npos);
  p.component = "magnitude";
  const Surface s(contoured(d, p));
  CHECK(s.euler() == 2);
  p.component = "z";
  for (Vec3 q : Surface(contoured(d, p)).points) CHECK(q.z == doctest::Approx(1));
  p.component = "3";
  CHECK(error_of([&] { contoured(d, p); }).find("no component '3'") != std::string::npos);
  p.component = "q";
  CHECK(error_of([&] { contoured(d, p); }).find("no component 'q'") != std::string::npos);
}

TEST_CASE("contour: refuses what it cannot do and says what would be right") {
  const auto d = cube(5, 1, sphere);
  ContourParams p;
  p.field.name = "ff";
  CHECK(error_of([&] { contoured(d, p); }).find("did you mean 'f'") != std::string::npos);
  const auto cells = carrying(d, {{"c", Association::cell, Array::from_vector(std::vector<float>(64)), "", Role::none}});
  p.field.name = "c";
  CHECK(error_of([&] { contoured(cells, p); }).find("is a cell field") != std::string::npos);
  p.field.name = "f";
  p.values = {NAN};
  CHECK(error_of([&] { contoured(d, p); }).find("finite") != std::string::npos);
  p = {};
  CHECK(error_of([&] { contoured(grid_of<float>({5, 1, 1}, {1, 2, 3, 4, 5}), p); }).find("1 axis") != std::string::npos);
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0}, 3);
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::vector<float>{0, 1}), "", Role::none});
  CHECK(error_of([&] { contoured(make_dataset(cloud, fields), p); }).find("'points'") != std::string::npos);
  CHECK(error_of([&] {
          contoured(make_dataset(uniform({3, 3, 3}, {0, 0, 0}, {1, 1, 1})), p);
        }).find("no point field") != std::string::npos);
  UnstructuredMesh line;
  line.points = cloud.points;
  line.cells.connectivity = Array::from_vector(std::vector<int32_t>{0, 1});
  line.cells.fixed = 2;
  line.single_type = CellType::line;
  CHECK(error_of([&] { contoured(make_dataset(line, fields), p); }).find("faces or solids") != std::string::npos);
  UnstructuredMesh curved;
  curved.points.xyz = Array::from_vector(std::vector<float>(30), 3);
  curved.cells.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
  curved.cells.fixed = 10;
  curved.single_type = CellType::quadratic_tetra;
  FieldSet ten;
  ten.add({"f", Association::point, Array::from_vector(std::vector<float>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}), "", Role::none});
  CHECK(contoured(make_dataset(curved, ten), p)->bounds().diagonal() == 0);  // all ten points lie in one place
  AmrGrid amr;
  amr.levels.resize(1);
  amr.levels[0].patches.push_back({{0, 0, 0}, {1, 1, 1}, 0, 0});
  FieldSet points27;
  points27.add({"f", Association::point, Array::from_vector(std::vector<float>(27)), "", Role::none});
  CHECK(contoured(make_dataset(amr, points27), p)->cell_count() == 0);
  Context cancelled;
  cancelled.cancel();
  CHECK_THROWS_AS(contour(d, {}, cancelled), Error);
}

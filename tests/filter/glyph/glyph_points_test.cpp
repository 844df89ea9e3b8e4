// SPDX-License-Identifier: Apache-2.0
// Places for glyphs, along lines too, and trails.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/parallel.h"
#include "base/random.h"
#include "filter/glyph/points.h"
#include "filter/glyph/trails.h"
#include "support/test.h"

using namespace sg;
using sg::test::error_of;

namespace {

DatasetPtr box_grid(size_t nx, size_t ny, size_t nz) {
  UniformGrid g;
  g.dims = {nx, ny, nz};
  g.spacing = {1.0 / double(std::max<size_t>(nx, 2) - 1), 1.0 / double(std::max<size_t>(ny, 2) - 1),
               1.0 / double(std::max<size_t>(nz, 2) - 1)};
  std::vector<float> x;
  for (size_t i = 0; i < nx * ny * nz; ++i) x.push_back(float(i % nx) / float(nx - 1));
  std::vector<int32_t> cell;
  for (size_t i = 0; i < std::max<size_t>(nx - 1, 1) * std::max<size_t>(ny - 1, 1) * std::max<size_t>(nz - 1, 1); ++i)
    cell.push_back(int32_t(i));
  FieldSet f;
  f.add({"x", Association::point, Array::from_vector(std::move(x)), "m", Role::scalars});
  f.add({"cell", Association::cell, Array::from_vector(std::move(cell)), "", Role::none});
  return make_dataset(Mesh(g), std::move(f));
}

DatasetPtr scattered(size_t n) {
  std::vector<float> xyz, size;
  for (uint64_t i = 0; i < n; ++i) {
    for (uint64_t c = 0; c < 3; ++c) xyz.push_back(float(random_unit(5, 3 * i + c)));
    size.push_back(float(0.02 + 0.1 * random_unit(6, i)));
  }
  FieldSet f;
  f.add({"size", Association::point, Array::from_vector(std::move(size)), "", Role::scalars});
  return make_dataset(Mesh(PointCloud{{Array::from_vector(std::move(xyz), 3), {}}}), std::move(f));
}

Vec3 place(const DatasetPtr& d, size_t i) { return d->as<PointCloud>()->points.at(i); }

DatasetPtr run(const DatasetPtr& d, GlyphPointsParams p) {
  Context context;
  return glyph_points(d, p, context);
}

// Two straight lines: 10 and 3 long, 0.2 apart, with a time along them.
DatasetPtr two_lines() {
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0, 4, 0, 0, 10, 0, 0, 0, 0.2, 0, 3, 0.2, 0}, 3);
  m.lines = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 3, 4}), Array::from_vector(std::vector<int32_t>{0, 3, 5}), 0};
  FieldSet f;
  f.add({"time", Association::point, Array::from_vector(std::vector<double>{0, 4, 10, 2, 5}), "s", Role::scalars});
  f.add({"line", Association::cell, Array::from_vector(std::vector<int32_t>{7, 8}), "", Role::none});
  return make_dataset(Mesh(std::move(m)), std::move(f));
}

}  // namespace

TEST_CASE("glyph_points: even places fill a box with about the asked number, values interpolated") {
  for (const auto& dims : {std::array<size_t, 3>{12, 12, 12}, {40, 30, 1}}) {
    const DatasetPtr p = run(box_grid(dims[0], dims[1], dims[2]), {.mode = GlyphPlaces::even, .count = 900});
    CHECK(p->point_count() > 700);
    CHECK(p->point_count() < 1150);
    const Array& x = p->fields().require("x", Association::point).array;
    for (size_t i = 0; i < p->point_count(); ++i) REQUIRE(x.get(i) == doctest::Approx(place(p, i).x).epsilon(1e-5));
    CHECK(p->fields().find("valid") == nullptr);
    CHECK(p->fields().find("cell", Association::point) != nullptr);
  }
  // Scattered points: one a box, so places are some of the points.
  const DatasetPtr s = run(scattered(5000), {.mode = GlyphPlaces::even, .count = 300});
  CHECK(s->point_count() > 280);
  CHECK(s->point_count() < 320);
}

TEST_CASE("glyph_points: all, every and cells give the points and middles that they say") {
  const DatasetPtr g = box_grid(5, 4, 3);
  CHECK(run(g, {.mode = GlyphPlaces::all})->point_count() == 60);
  const DatasetPtr every = run(g, {.mode = GlyphPlaces::every, .every = 7});
  CHECK(every->point_count() == 9);
  CHECK(every->fields().require("x").array.get(1) == doctest::Approx(0.5));  // point 7 is the third of its row
  const DatasetPtr cells = run(g, {.mode = GlyphPlaces::cells});
  CHECK(cells->point_count() == 24);
  CHECK(place(cells, 0).x == doctest::Approx(0.125));
  CHECK(cells->fields().require("cell", Association::point).array.get(23) == 23);
  CHECK(cells->fields().require("x", Association::point).array.get(0) == doctest::Approx(0.125));
  DatasetParts hidden = g->parts();
  std::vector<uint8_t> ghost(60);
  ghost[0] = ghost[59] = ghost_hidden_point;
  hidden.point_ghost = Array::from_vector(ghost);
  CHECK(run(make_dataset(hidden), {.mode = GlyphPlaces::all})->point_count() == 58);
}

TEST_CASE("glyph_points: infinite points do not move the others") {
  const float inf = HUGE_VALF;
  const auto cloud = make_dataset(Mesh(PointCloud{{Array::from_vector<float>({1, 2, 3, inf, 2, 3, -inf, 2, 3}, 3), {}}}), FieldSet());
  GlyphPointsParams p;
  p.mode = GlyphPlaces::all;
  const DatasetPtr d = run(cloud, p);
  REQUIRE(d->point_count() >= 1);
  CHECK(place(d, 0) == Vec3(1, 2, 3));
}

TEST_CASE("glyph_points: random places are uniform by area and the same for a seed and any number of threads") {
  // Two triangles of areas 1 and 3.
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 2, 0, 0, 0, 1, 0, 5, 0, 1, 7, 0, 1, 5, 3, 1}, 3);
  m.polygons = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 3, 4, 5}), {}, 3};
  const DatasetPtr d = make_dataset(Mesh(std::move(m)));
  set_thread_count(1);
  const DatasetPtr one = run(d, {.mode = GlyphPlaces::random, .count = 8000});
  set_thread_count(8);
  const DatasetPtr eight = run(d, {.mode = GlyphPlaces::random, .count = 8000});
  set_thread_count(0);
  size_t first = 0;
  for (size_t i = 0; i < 8000; ++i) first += place(one, i).x < 4;
  CHECK(std::abs(double(first) - 2000) < 4 * std::sqrt(8000 * 0.25 * 0.75));
  const Array &a = one->as<PointCloud>()->points.xyz, &b = eight->as<PointCloud>()->points.xyz;
  CHECK(std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
  const DatasetPtr other = run(d, {.mode = GlyphPlaces::random, .count = 8000, .seed = 2});
  CHECK(std::memcmp(a.raw(), other->as<PointCloud>()->points.xyz.raw(), a.bytes()) != 0);
  const DatasetPtr solid = run(box_grid(6, 6, 6), {.mode = GlyphPlaces::random, .count = 500});
  CHECK(solid->point_count() == 500);
  size_t left = 0;
  for (size_t i = 0; i < 500; ++i) left += place(solid, i).x < 0.5;
  CHECK(std::abs(double(left) - 250) < 4 * std::sqrt(125.0));
  CHECK(run(scattered(100), {.mode = GlyphPlaces::random, .count = 30})->point_count() == 30);
}

TEST_CASE("glyph_points: places apart never overlap, in space or as seen, and leave no room for another") {
  const DatasetPtr all = scattered(3000);
  for (const bool seen : {false, true}) {
    GlyphPointsParams p{.mode = GlyphPlaces::apart, .diameter = {"size"}};
    if (seen) p.view = Vec3{0, 0, -2};
    const DatasetPtr kept = run(all, p);
    const Array& size = kept->fields().require("size").array;
    auto distance = [&](Vec3 a, Vec3 b) {
      Vec3 d = a - b;
      if (seen) d.z = 0;
      return length(d);
    };
    for (size_t i = 0; i < kept->point_count(); ++i)
      for (size_t j = 0; j < i; ++j) REQUIRE(distance(place(kept, i), place(kept, j)) >= 0.5 * (size.get(i) + size.get(j)) - 1e-6);
    const Array& every = all->fields().require("size").array;
    for (size_t i = 0; i < all->point_count(); i += 7) {
      bool blocked = false;
      for (size_t j = 0; j < kept->point_count() && !blocked; ++j)
        blocked = distance(place(all, i), place(kept, j)) < 0.5 * (every.get(i) + size.get(j)) + 1e-6;
      REQUIRE(blocked);
    }
    CHECK(kept->point_count() > (seen ? 50u : 100u));
  }
}

TEST_CASE("glyph_points: along lines at even spacing, with tangents, and not beside a place on another line") {
  const DatasetPtr p = run(two_lines(), {.mode = GlyphPlaces::lines, .spacing = 2, .separation = 0});
  REQUIRE(p->point_count() == 6 + 2);
  for (size_t i = 0; i < 6; ++i) CHECK(place(p, i).x == doctest::Approx(2.0 * double(i)));
  CHECK(place(p, 6).x == doctest::Approx(0.5));
  CHECK(p->fields().require("time").array.get(1) == doctest::Approx(2));
  CHECK(p->fields().require("line", Association::point).array.get(7) == 8);
  CHECK(p->fields().require("tangent").array.get(3, 0) == 1);
  CHECK(run(two_lines(), {.mode = GlyphPlaces::lines, .spacing = 2})->point_count() == 6);  // the other line is too near
  CHECK(error_of([] { run(box_grid(3, 3, 1), {.mode = GlyphPlaces::lines}); }).find("has no lines") != std::string::npos);
  CHECK(error_of([] { run(two_lines(), {.mode = GlyphPlaces::lines, .spacing = 1e-200}); }).find("use a larger spacing") !=
        std::string::npos);
}

TEST_CASE("trails: the stretch before a time, cut exactly, with ages and heads") {
  Context context;
  const DatasetPtr t = trails(two_lines(), {.time = 5, .length = 2}, context);
  const SurfaceMesh& m = *t->as<SurfaceMesh>();
  CHECK(m.lines.size() == 2);
  CHECK(m.vertices.size() == 2);
  const CellsView lines = cells_view(m.lines);
  CHECK(lines.size(0) == 3);  // 3, 4 and 5 seconds
  CHECK(m.points.at(size_t(lines.point(0, 0))).x == doctest::Approx(3));
  CHECK(m.points.at(size_t(lines.point(0, 2))).x == doctest::Approx(5));
  CHECK(m.points.at(size_t(lines.point(1, 0))).x == doctest::Approx(1));
  const Array& age = t->fields().require("age").array;
  CHECK(age.get(size_t(lines.point(0, 0))) == doctest::Approx(1));
  CHECK(age.get(size_t(lines.point(0, 1))) == doctest::Approx(0.5));
  CHECK(age.get(size_t(lines.point(0, 2))) == 0);
  CHECK(t->fields().require("line", Association::cell).array.get(2) == 7);
  const Field& faded = t->fields().require("trail");
  CHECK(faded.role == Role::colors);
  CHECK(faded.array.get(size_t(lines.point(0, 1)), 3) == 128);
  CHECK(faded.array.get(size_t(lines.point(0, 2)), 3) == 255);
  CHECK(error_of([&] { trails(two_lines(), {.color = {1}}, context); }).find("not make a colour") != std::string::npos);
  CHECK(trails(two_lines(), {.time = 20, .length = 1}, context)->cell_count() == 0);
  CHECK(trails(two_lines(), {}, context)->as<SurfaceMesh>()->lines.size() == 1);  // the last second: 9 to 10
  CHECK(error_of([&] { trails(two_lines(), {.field = {"tim"}}, context); }).find("'tim'") != std::string::npos);
  CHECK(error_of([&] { trails(scattered(5), {}, context); }).find("has no lines") != std::string::npos);
}

TEST_CASE("trails: without a time, lines of all lengths are shown at the latest time at which half of them run") {
  SurfaceMesh m;
  std::vector<double> xyz, time;
  std::vector<int32_t> ids, offsets{0};
  for (int l = 0; l < 10; ++l) {  // until 2, 4, ... 20, one that lasts 1000
    const double last = l == 9 ? 1000 : 2 * (l + 1);
    for (int k = 0; k <= 10; ++k)
      xyz.insert(xyz.end(), {k * last / 10, double(l), 0}), time.push_back(k * last / 10), ids.push_back(int32_t(ids.size()));
    offsets.push_back(int32_t(ids.size()));
  }
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.lines = {Array::from_vector(std::move(ids)), Array::from_vector(std::move(offsets)), 0};
  FieldSet f;
  f.add({"time", Association::point, Array::from_vector(std::move(time)), "s", Role::none});
  Context context;
  const DatasetPtr t = trails(make_dataset(Mesh(std::move(m)), std::move(f)), {}, context);
  CHECK(t->as<SurfaceMesh>()->vertices.size() == 5);  // those that last 12 and more, and the one that ends there
  CHECK(t->range(t->fields().require("time")).hi == doctest::Approx(12));
  CHECK(t->range(t->fields().require("time")).lo == doctest::Approx(12 - 0.1 * 12));  // of the line in the middle
}

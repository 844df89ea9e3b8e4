// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <random>

#include "data/cells/triangulate_loops.h"
#include "filter/mesh/append.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/surface/cap.h"
#include "filter/surface/mass_properties.h"
#include "filter/surface/normals.h"
#include "support/test.h"
#include "surface_shapes.h"

using namespace sg;
using namespace sg::test::shapes;

namespace {

// Upper half of a sphere, open below.
Builder half_ball(int n, double r, bool inside_out = false) {
  Builder b;
  const int rows = n / 4;
  const int64_t pole = b.point({0, 0, r});
  for (int j = 1; j <= rows; ++j)
    for (int i = 0; i < n; ++i) {
      const double u = 2 * pi * i / n, v = 0.5 * pi * j / rows;
      b.point({r * std::sin(v) * std::cos(u), r * std::sin(v) * std::sin(u), j == rows ? 0 : r * std::cos(v)});
    }
  auto id = [&](int j, int i) { return int64_t(1 + (j - 1) * n + i % n); };
  for (int i = 0; i < n; ++i) {
    std::vector<int64_t> t{pole, id(1, i), id(1, i + 1)};
    if (inside_out) std::swap(t[1], t[2]);
    b.polygon(t);
    for (int j = 1; j < rows; ++j) {
      std::vector<int64_t> q{id(j, i), id(j + 1, i), id(j + 1, i + 1), id(j, i + 1)};
      if (inside_out) std::swap(q[1], q[3]);
      b.polygon(q);
    }
  }
  return b;
}

struct Flat {
  std::vector<Vec2> at;
  std::vector<std::vector<uint32_t>> loops;
  void loop(const std::vector<Vec2>& p) {
    loops.emplace_back();
    for (Vec2 q : p) loops.back().push_back(uint32_t(at.size())), at.push_back(q);
  }
  void star(std::mt19937& random, Vec2 c, double r0, double r1, int n, bool back) {
    std::uniform_real_distribution<double> d(r0, r1);
    std::vector<Vec2> p;
    for (int i = 0; i < n; ++i) {
      const double u = (back ? -2 : 2) * pi * i / n, r = d(random);
      p.push_back({c.x + r * std::cos(u), c.y + r * std::sin(u)});
    }
    loop(p);
  }
  double area(const std::vector<uint32_t>& l) const {
    double s = 0;
    for (size_t k = 0; k < l.size(); ++k) s += at[l[k]].x * at[l[(k + 1) % l.size()]].y - at[l[k]].y * at[l[(k + 1) % l.size()]].x;
    return s / 2;
  }
  // Triangles, their area, and the area of those that run the wrong way.
  std::array<double, 3> run() const {
    std::vector<uint32_t> t;
    triangulate_loops(at, loops, t);
    double sum = 0, wrong = 0;
    for (size_t i = 0; i < t.size(); i += 3) {
      const double a = area({t[i], t[i + 1], t[i + 2]});
      sum += a, wrong += std::min(a, 0.0);
    }
    return {double(t.size() / 3), sum, wrong};
  }
};

}  // namespace

TEST_CASE("triangulate_loops: random stars with holes in holes: right area, right count, nothing overlaps") {
  std::mt19937 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    Flat f;
    const int n = 5 + trial % 60;
    f.star(random, {0, 0}, 6, 10, n, trial % 2);
    double expected = std::abs(f.area(f.loops[0]));
    size_t points = size_t(n), holes = 0;
    if (trial % 3 > 0) {  // several holes
      const double r = std::cos(pi / n) * 6;
      for (int h = 0; h < 5; ++h) {
        const double u = 2 * pi * h / 5;
        f.star(random, {0.55 * r * std::cos(u), 0.55 * r * std::sin(u)}, 0.05 * r, 0.25 * r, 3 + trial % 17, trial % 5 < 2);
        expected -= std::abs(f.area(f.loops.back()));
        points += f.loops.back().size(), ++holes;
      }
    }
    if (trial % 3 == 2) {  // an island in the middle hole
      f.star(random, {0, 0}, 0.5, 0.9, 12, false);
      f.loops.pop_back();
    }
    const auto [count, area, wrong] = f.run();
    CHECK(count == double(points + 2 * holes - 2));
    CHECK(std::abs(area) == doctest::Approx(expected).epsilon(1e-9));
    if (trial % 2 == 0) CHECK(wrong > -1e-6);
    else CHECK(std::abs(area - wrong) < 1e-6);  // the way of the outer loop
  }
}

TEST_CASE("triangulate_loops: nested squares by even-odd, points along sides, touching and degenerate loops") {
  Flat f;
  auto square = [](double r, Vec2 c = {0, 0}) {
    return std::vector<Vec2>{{c.x - r, c.y - r}, {c.x + r, c.y - r}, {c.x + r, c.y + r}, {c.x - r, c.y + r}};
  };
  for (double r : {4.0, 3.0, 2.0, 1.0}) f.loop(square(r));
  f.loop(square(1, {9, 0}));
  CHECK(f.run()[1] == doctest::Approx(64 - 36 + 16 - 4 + 4).epsilon(1e-9));
  Flat dots;
  std::vector<Vec2> p;
  for (int s = 0; s < 4; ++s)
    for (int i = 0; i < 10; ++i) {
      const double t = i / 10.0;
      p.push_back(s == 0 ? Vec2{t, 0} : s == 1 ? Vec2{1, t} : s == 2 ? Vec2{1 - t, 1} : Vec2{0, 1 - t});
    }
  dots.loop(p);
  const auto [count, area, wrong] = dots.run();
  CHECK(count == 38);
  CHECK(area == doctest::Approx(1).epsilon(1e-9));
  CHECK(wrong == 0);
  Flat touching;
  touching.loop(square(2));
  touching.loop({{2, 0}, {1, 1}, {0, 0}, {1, -1}});  // a hole that touches the side
  CHECK(touching.run()[1] == doctest::Approx(14).epsilon(1e-8));
  Flat corner;
  corner.loop(square(2));
  corner.loop({{2, 2}, {1, 0}, {0, 1}});  // and one that touches a corner
  CHECK(corner.run()[1] == doctest::Approx(16 - 1.5).epsilon(1e-8));
  Flat line;
  line.loop({{0, 0}, {1, 0}, {2, 0}, {1, 0}});
  CHECK(line.run()[1] == doctest::Approx(0));
  Flat few;
  few.loop({{0, 0}, {1, 0}});
  CHECK(few.run()[0] == 0);
}

TEST_CASE("cap: half a ball becomes closed and has its volume, order 2") {
  Context ctx;
  double h[3], error[3];
  for (int l = 0; l < 3; ++l) {
    const int n = 16 << l;
    const DatasetPtr c = cap(half_ball(n, 1).dataset(), {}, ctx);
    const TablePtr t = mass_properties(c, {}, ctx);
    CHECK(number(*t, "closed") == 1);
    h[l] = 1.0 / n, error[l] = std::abs(number(*t, "volume") - 2 * pi / 3);
    CHECK(number(*t, "z") == doctest::Approx(3.0 / 8).epsilon(0.05));
    CHECK(c->point_count() == half_ball(n, 1).xyz.size() / 3);
    const Field& mark = c->fields().require("cap", Association::cell);
    double caps = 0;
    for (size_t i = 0; i < mark.array.count(); ++i) caps += mark.array.get(i);
    CHECK(caps == n - 2);
  }
  CHECK(test::observed_order(h, error, 3) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("cap: half a shell gets a ring, tubes get two lids, normals stay sharp") {
  Context ctx;
  const DatasetPtr shell = append({Data(half_ball(32, 1).dataset()), Data(half_ball(32, 0.5, true).dataset())}, {}, ctx);
  const TablePtr t = mass_properties(cap(shell, {}, ctx), {}, ctx);
  CHECK(number(*t, "closed") == 1);
  const double whole = number(*mass_properties(cap(half_ball(32, 1).dataset(), {}, ctx), {}, ctx), "volume");
  CHECK(number(*t, "volume") == doctest::Approx(whole * 7 / 8).epsilon(1e-12));
  const DatasetPtr tube = cap(cylinder(20, 2, false).dataset(), {}, ctx);
  CHECK(number(*mass_properties(tube, {}, ctx), "volume") == doctest::Approx(20 * std::sin(2 * pi / 20)).epsilon(1e-13));
  const DatasetPtr smooth = normals(cylinder(20, 2, false).dataset(), {.feature_angle = 60}, ctx);
  const DatasetPtr sharp = cap(smooth, {}, ctx);
  CHECK(sharp->point_count() == 80);
  const Field& n = sharp->fields().require("Normals", Association::point);
  for (size_t i = 0; i < 80; ++i) CHECK(std::abs(n.array.get(i, 2)) == doctest::Approx(i < 40 ? 0 : 1));
  CHECK(number(*mass_properties(sharp, {}, ctx), "closed") == 1);
  CHECK(cap(cylinder(20, 2, false).dataset(), {.only_cap = true}, ctx)->cell_count() == 36);
  CHECK(cap(cylinder(20, 2, false).dataset(), {.max_perimeter = 3}, ctx)->cell_count() == 20);
}

TEST_CASE("cap: split points, turned polygons, bent loops, nothing to close, solids and bad input") {
  Context ctx;
  std::string said;
  ctx.on_log = [&](LogLevel, std::string_view text) { said += text; };
  Builder apart;  // four sides and a floor of a box, each with its own points, one turned round
  const Builder b = box();
  for (size_t c = 0; c < 5; ++c) {
    std::vector<int64_t> q;
    for (size_t k = 0; k < 4; ++k) {
      const auto p = size_t(b.ids[4 * c + k]);
      q.push_back(apart.point({b.xyz[3 * p], b.xyz[3 * p + 1], b.xyz[3 * p + 2]}));
    }
    if (c == 2) std::swap(q[1], q[3]);
    apart.polygon(q);
  }
  CHECK(number(*mass_properties(cap(apart.dataset(), {}, ctx), {}, ctx), "volume") == doctest::Approx(1).epsilon(1e-13));
  Builder saddle = cylinder(40, 1, false);
  for (size_t i = 0; i < saddle.xyz.size(); i += 3)
    if (saddle.xyz[i + 2] > 0.5) saddle.xyz[i + 2] += 0.2 * saddle.xyz[i] * saddle.xyz[i];
  CHECK(number(*mass_properties(cap(saddle.dataset(), {}, ctx), {}, ctx), "closed") == 1);
  CHECK(said.find("not planar") != std::string::npos);
  CHECK(cap(box().dataset(), {}, ctx)->cell_count() == 6);
  CHECK(said.find("no hole") != std::string::npos);
  CHECK(number(*mass_properties(cap(test::meshes::solid_box(CellType::tetra, 2), {}, ctx), {}, ctx), "volume") == doctest::Approx(1));
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0}, 3);
  CHECK(test::error_of([&] { cap(make_dataset(Mesh(cloud)), {}, ctx); }).find("no faces") != std::string::npos);
}

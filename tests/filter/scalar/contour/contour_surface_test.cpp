// SPDX-License-Identifier: Apache-2.0
// Isosurfaces of functions with known answers (correctness.md, I1 to I8, I11, I12).
#include "base/parallel.h"
#include "base/random.h"
#include "filter/scalar/contour/cells/cell_cases.h"
#include "filter/scalar/contour/contour_support.h"
#include "filter/scalar/contour/known_surfaces.h"

using namespace sg;
using namespace sg::test;

namespace {

// Sum over the points of 2 pi minus the angles of the triangles there.
double angle_defects(const Surface& s) {
  double sum = 2 * M_PI * double(s.points.size());
  for (const auto& t : s.triangles)
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 a = s.points[size_t(t[(k + 1) % 3])] - s.points[size_t(t[k])],
                 b = s.points[size_t(t[(k + 2) % 3])] - s.points[size_t(t[k])];
      sum -= std::atan2(length(cross(a, b)), dot(a, b));
    }
  return sum;
}

const size_t sizes[] = {17, 33, 65, 129};

}  // namespace

TEST_CASE("contour: sphere area, volume, vertices and normals converge with their orders") {
  double h[4], area[4], volume[4], vertex[4], facet[4], normal[4];
  for (int i = 0; i < 4; ++i) {
    const auto d = contour_at(cube(sizes[i], 1.3, sphere), 0);
    const Surface s(d);
    h[i] = 2.6 / double(sizes[i] - 1);
    area[i] = std::abs(s.area() - 4 * M_PI);
    volume[i] = std::abs(-s.volume() - 4 * M_PI / 3);  // normals face the smaller values: inwards here
    CHECK(s.euler() == 2);
    CHECK(s.components() == 1);
    CHECK(s.faults() == 0);
    if (i < 2) CHECK(angle_defects(s) == doctest::Approx(4 * M_PI).epsilon(1e-9));
    vertex[i] = facet[i] = normal[i] = 0;
    for (Vec3 p : s.points) vertex[i] = std::max(vertex[i], std::abs(length(p) - 1));
    for (size_t t = 0; t < s.triangles.size(); ++t) {
      const Vec3 n = s.area_vector(t);
      if (length(n) < 1e-7 * h[i] * h[i]) continue;  // where samples lie on the sphere
      const Vec3 c = s.points[size_t(s.triangles[t][0])] + s.points[size_t(s.triangles[t][1])] + s.points[size_t(s.triangles[t][2])];
      facet[i] = std::max(facet[i], length(cross(normalize(n), normalize(c))));
      CHECK_MESSAGE(dot(n, c) < 0, "winding");
    }
    const Field& n = d->fields().require("Normals", Association::point);
    for (size_t v = 0; v < s.points.size(); ++v) {
      const Vec3 g(n.array.get(v, 0), n.array.get(v, 1), n.array.get(v, 2));
      normal[i] = std::max(normal[i], length(g + normalize(s.points[v])));
    }
  }
  CHECK(observed_order(h, area, 4) == doctest::Approx(2).epsilon(0.1));
  CHECK(observed_order(h, volume, 4) == doctest::Approx(2).epsilon(0.1));
  CHECK(observed_order(h, vertex, 4) == doctest::Approx(2).epsilon(0.1));
  CHECK(observed_order(h, facet, 4) == doctest::Approx(1).epsilon(0.2));
  CHECK(observed_order(h, normal, 4) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("contour: torus area and volume converge with order 2, Euler number 0") {
  double h[3], area[3], volume[3];
  const double R = 1, r = 0.4;
  for (int i = 0; i < 3; ++i) {
    const Surface s(contour_at(cube(sizes[i + 1], 1.6, torus), 0));
    h[i] = 3.2 / double(sizes[i + 1] - 1);
    area[i] = std::abs(s.area() - 4 * M_PI * M_PI * R * r);
    volume[i] = std::abs(-s.volume() - 2 * M_PI * M_PI * R * r * r);
    CHECK(s.euler() == 0);
    CHECK(s.faults() == 0);
  }
  CHECK(observed_order(h, area, 3) == doctest::Approx(2).epsilon(0.1));
  CHECK(observed_order(h, volume, 3) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("contour: one point per cut edge, triangles = 2 (points - Euler number)") {
  struct Row {
    double (*f)(Vec3);
    size_t n;
    double r;
    size_t points, triangles;
  };
  for (const Row& row : {Row{sphere, 17, 1.3, 726, 1448}, Row{sphere, 33, 1.3, 2886, 5768}, Row{torus, 33, 1.6, 2216, 4432},
                         Row{tangle, 41, 3, 6624, 13264}}) {
    const auto d = contour_at(cube(row.n, row.r, row.f), 0);
    CHECK(d->point_count() == row.points);
    CHECK(d->cell_count() == row.triangles);
  }
}

TEST_CASE("contour: tanglecube is one piece of genus 5") {
  for (size_t n : {41, 65}) {
    const Surface s(contour_at(cube(n, 3, tangle), 0));
    CHECK(s.euler() == -8);
    CHECK(s.components() == 1);
    CHECK(s.faults() == 0);
  }
}

TEST_CASE("contour: an ambiguous face joins or separates by the asymptotic decider") {
  // Two cells would agree on the face; one cell with the face at z = 0 and everything outside above it shows the pieces.
  auto pieces = [](double a, double b, double c, double d) {
    return Surface(contour_at(grid_of<double>({2, 2, 2}, {a, b, c, d, -1, -1, -1, -1}), 0)).components();
  };
  CHECK(pieces(3, -1, -1, 3) == 1);
  CHECK(pieces(1, -3, -3, 1) == 2);
  CHECK(pieces(-1, 3, 3, -1) == 1);
  CHECK(pieces(-3, 1, 1, -3) == 2);
}

TEST_CASE("contour: a decider that is exactly 0 gives no face twice") {
  const auto d = grid_of<double>({2, 2, 3}, {13, -1, -1, -7, -1, 1, 7, -7, 15, -9, -3, -1});
  const Surface s(contour_at(d, 0));
  CHECK(!s.triangles.empty());
  CHECK(s.faults(d->bounds()) == 0);
}

TEST_CASE("contour: random closed grids are watertight, manifold and oriented") {
  for (uint64_t seed = 0; seed < 12; ++seed) {
    const std::array<size_t, 3> n{5 + seed % 3 * 31, 7, 6 + seed % 2};
    std::vector<double> v;
    uint64_t at = 0;
    size_t cut = 0;
    for (size_t k = 0; k < n[2]; ++k)
      for (size_t j = 0; j < n[1]; ++j)
        for (size_t i = 0; i < n[0]; ++i) {
          const bool border = i == 0 || j == 0 || k == 0 || i + 1 == n[0] || j + 1 == n[1] || k + 1 == n[2];
          // Small whole numbers make ties and zero deciders.
          const double r = seed % 2 ? std::floor(7 * random_unit(seed, at++)) - 3 : random_unit(seed, at++) - 0.5;
          v.push_back(border ? -1 : r);
        }
    for (size_t k = 0; k < n[2]; ++k)
      for (size_t j = 0; j < n[1]; ++j)
        for (size_t i = 0; i < n[0]; ++i) {
          auto in = [&](size_t a, size_t b, size_t c) { return v[a + n[0] * (b + n[1] * c)] >= 0; };
          if (i + 1 < n[0]) cut += in(i, j, k) != in(i + 1, j, k);
          if (j + 1 < n[1]) cut += in(i, j, k) != in(i, j + 1, k);
          if (k + 1 < n[2]) cut += in(i, j, k) != in(i, j, k + 1);
        }
    for (const ContourTopology topology : {ContourTopology::fixed, ContourTopology::trilinear}) {
      Context context;
      ContourParams params;
      params.values = {0};
      params.topology = topology;
      const Surface s(contour(grid_of(n, v), params, context));
      if (topology == ContourTopology::fixed) CHECK(s.points.size() == cut);
      else CHECK(s.points.size() > cut);
      CHECK(s.faults() == 0);
      CHECK(s.every_point_used());
      CHECK(long(s.triangles.size()) == 2 * (long(s.points.size()) - s.euler()));
      // Every point has one fan of triangles: as many different neighbours as triangles.
      std::map<int, std::pair<int, std::set<int>>> fans;
      for (const auto& t : s.triangles)
        for (size_t k = 0; k < 3; ++k) {
          auto& [count, next] = fans[t[k]];
          ++count;
          next.insert(t[(k + 1) % 3]);
          next.insert(t[(k + 2) % 3]);
        }
      for (const auto& [p, fan] : fans) CHECK(size_t(fan.first) == fan.second.size());
    }
  }
}

TEST_CASE("contour: case tables close all loops, never run a diagonal along a face, and turn inside out with the signs") {
  const CaseTable* tables[] = {&lattice_cases(),
                               cell_cases(CellType::tetra),
                               cell_cases(CellType::pyramid),
                               cell_cases(CellType::wedge),
                               cell_cases(CellType::hexahedron),
                               cell_cases(CellType::pentagonal_prism),
                               cell_cases(CellType::hexagonal_prism)};
  for (const CaseTable* t : tables) {
    REQUIRE(t);
    CHECK(t->bad_diagonals() == 0);
    const uint32_t all = (1u << t->shape().corners) - 1;
    CHECK(t->triangles(0, 0).empty());
    CHECK(t->triangles(all, 0).empty());
    for (uint32_t p = 1; p < all; ++p) {
      size_t cut = 0, in_loops = 0;
      for (const auto& e : t->shape().edges) cut += (p >> e[0] & 1) != (p >> e[1] & 1);
      for (const auto& loop : t->loops(p, 0)) {
        CHECK(loop.size() >= 3);
        in_loops += loop.size();
      }
      CHECK(cut == in_loops);
    }
  }
  // A lone corner 0 that is inside: the triangle faces away from it.
  const auto t = lattice_cases().triangles(1, 0);
  REQUIRE(t.size() == 3);
  Vec3 at[3];
  for (size_t k = 0; k < 3; ++k) {
    const auto& e = lattice_cases().shape().edges[t[k]];
    for (int c = 0; c < 3; ++c)
      at[k][c] = 0.5 * double(lattice_cases().shape().place[e[0]][size_t(c)] + lattice_cases().shape().place[e[1]][size_t(c)]);
  }
  CHECK(dot(cross(at[1] - at[0], at[2] - at[0]), Vec3(1, 1, 1)) > 0);
}

TEST_CASE("contour: 1 and 8 threads give the same bytes, and so do element types of the same values") {
  auto bumps = [](Vec3 p) { return std::floor(100 + 60 * std::sin(3 * p.x) * std::cos(4 * p.y) + 30 * p.z); };
  const auto d = cube<float>(70, 1, bumps);
  set_thread_count(1);
  const auto one = contour_at(d, 104.5);
  set_thread_count(8);
  const auto eight = contour_at(d, 104.5);
  set_thread_count(0);
  CHECK(one->cell_count() > 1000);
  CHECK(same_surface(one, eight));
  CHECK(same_bytes(one->fields().require("Normals").array, eight->fields().require("Normals").array));
  CHECK(same_bytes(one->fields().require("f").array, eight->fields().require("f").array));
  for (const auto& other : {cube<uint8_t>(70, 1, bumps), cube<uint16_t>(70, 1, bumps), cube<int16_t>(70, 1, bumps),
                            cube<double>(70, 1, bumps), cube<int32_t>(70, 1, bumps), cube<uint64_t>(70, 1, bumps)}) {
    const auto s = contour_at(other, 104.5);
    CHECK(same_surface(one, s));
    CHECK(same_bytes(one->fields().require("Normals").array, s->fields().require("Normals").array));
  }
}

// SPDX-License-Identifier: Apache-2.0
// Contours of AMR grids: closed at level jumps, planes for linear fields (correctness.md I12, I13).
#include "filter/scalar/contour/contour_support.h"
#include "filter/scalar/contour/known_surfaces.h"

using namespace sg;
using namespace sg::test;

namespace {

struct Box {
  std::array<long long, 3> lo, hi;
};

// A grid over [-1,1]^3 whose coarsest level has n cells an axis; every further level has boxes in its own cells.
template <class F>
DatasetPtr amr(int n, int ratio, const std::vector<std::vector<Box>>& finer, F&& f, bool at_points = false, int dimension = 3) {
  AmrGrid g;
  g.dimension = dimension;
  g.origin = {-1, -1, dimension == 3 ? -1.0 : 0.0};
  std::vector<double> cells, points;
  std::vector<uint8_t> ghost;
  double h = 2.0 / n;
  size_t cell_offset = 0, point_offset = 0;
  for (size_t l = 0; l <= finer.size(); ++l) {
    AmrGrid::Level level;
    level.spacing = {h, h, h};
    level.ratio = l == 0 ? std::array{1, 1, 1} : std::array{ratio, ratio, dimension == 3 ? ratio : 1};
    std::vector<Box> boxes{{{0, 0, 0}, {n - 1, n - 1, dimension == 3 ? n - 1 : 0}}};
    if (l > 0) boxes = finer[l - 1];
    for (const Box& b : boxes) {
      AmrGrid::Patch p;
      p.lo = b.lo, p.hi = b.hi;
      p.cell_offset = cell_offset, p.point_offset = point_offset;
      const auto c = p.cells();
      for (size_t k = 0; k < c[2]; ++k)
        for (size_t j = 0; j < c[1]; ++j)
          for (size_t i = 0; i < c[0]; ++i) {
            const std::array<long long, 3> at{p.lo[0] + (long long)i, p.lo[1] + (long long)j, p.lo[2] + (long long)k};
            Vec3 x;
            for (int a = 0; a < 3; ++a) x[a] = g.origin[a] + h * (double(at[size_t(a)]) + 0.5);
            if (dimension == 2) x.z = 0;
            cells.push_back(f(x));
            bool covered = false;
            if (l < finer.size())
              for (const Box& q : finer[l]) {
                bool in = true;
                for (size_t a = 0; a < 3; ++a) {
                  const long long r = a == 2 && dimension == 2 ? 1 : ratio;
                  in = in && at[a] * r >= q.lo[a] && at[a] * r <= q.hi[a];
                }
                covered = covered || in;
              }
            ghost.push_back(covered ? uint8_t(ghost_refined_cell) : 0);
          }
      for (size_t k = 0; k < c[2] + 1; ++k)
        for (size_t j = 0; j < c[1] + 1; ++j)
          for (size_t i = 0; i < c[0] + 1; ++i) {
            Vec3 x = g.origin + Vec3(double(p.lo[0]) + double(i), double(p.lo[1]) + double(j), double(p.lo[2]) + double(k)) * h;
            if (dimension == 2) x.z = 0;
            points.push_back(f(x));
          }
      cell_offset += c[0] * c[1] * c[2];
      point_offset += (c[0] + 1) * (c[1] + 1) * (dimension == 3 ? c[2] + 1 : 1);
      level.patches.push_back(p);
    }
    g.levels.push_back(level);
    h /= ratio;
  }
  DatasetParts parts;
  points.resize(point_count(Mesh(g)));
  parts.mesh = g;
  if (at_points) parts.fields.add({"f", Association::point, Array::from_vector(std::move(points)), "", Role::scalars});
  else parts.fields.add({"f", Association::cell, Array::from_vector(std::move(cells)), "", Role::scalars});
  parts.cell_ghost = Array::from_vector(std::move(ghost));
  return make_dataset(std::move(parts));
}

// Nested boxes off the middle, ratio r: jumps inside, at edges and at corners, and two levels at one face.
std::vector<std::vector<Box>> nested(int r) {
  const int a = 2 * r, b = 6 * r - 1;
  return {{{{a, a, a}, {b, b, b}}, {{0, 0, 6 * r}, {2 * r - 1, 4 * r - 1, 8 * r - 1}}},
          {{{a * r, a * r, a * r}, {4 * r * r - 1, 4 * r * r - 1, 5 * r * r - 1}}}};
}

}  // namespace

TEST_CASE("contour: on AMR grids a linear field gives a plane, exact and without cracks, at jumps of any ratio") {
  // The area of the plane in the box, from the one lattice contour that is tested elsewhere.
  const double area = Surface(contour_at(cube(9, 1, oblique_plane), 0)).area();
  for (int ratio : {2, 3, 4})
    for (bool at_points : {false, true}) {
      CAPTURE(ratio);
      CAPTURE(at_points);
      const auto d = amr(8, ratio, nested(ratio), oblique_plane, at_points);
      const auto c = contour_at(d, 0);
      const Surface s(c);
      CHECK(s.faults(d->bounds()) == 0);
      CHECK(s.every_point_used());
      CHECK(s.area() == doctest::Approx(area).epsilon(1e-6));
      double off = 0, turned = 0;
      for (Vec3 p : s.points) off = std::max(off, std::abs(oblique_plane(p)));
      CHECK(off < 1e-6);
      const Field& n = c->fields().require("Normals", Association::point);
      for (size_t i = 0; i < n.array.count(); ++i)
        turned = std::max(turned, length(Vec3(n.array.get(i, 0), n.array.get(i, 1), n.array.get(i, 2)) + plane_normal));
      CHECK(turned < 1e-5);
    }
}

TEST_CASE("contour: a sphere through three AMR levels is closed, and its error falls with order 2") {
  auto sphere = [](Vec3 p) { return length(p) - 0.7; };
  double h[3], area[3], normal[3];
  for (int i = 0; i < 3; ++i) {
    const int m = std::array{2, 3, 4}[size_t(i)];
    std::vector<std::vector<Box>> boxes = nested(2);
    for (auto& level : boxes)
      for (Box& b : level)
        for (size_t a = 0; a < 3; ++a) b.lo[a] *= m, b.hi[a] = (b.hi[a] + 1) * m - 1;
    const auto c = contour_at(amr(8 * m, 2, boxes, sphere), 0);
    const Surface s(c);
    CHECK(s.faults() == 0);
    CHECK(s.euler() == 2);
    CHECK(s.components() == 1);
    CHECK(s.volume() < 0);
    h[i] = 1.0 / m;
    area[i] = std::abs(s.area() - 4 * M_PI * 0.49);
    normal[i] = 0;
    const Field& f = c->fields().require("Normals", Association::point);
    for (size_t v = 0; v < s.points.size(); ++v)
      normal[i] = std::max(normal[i], length(Vec3(f.array.get(v, 0), f.array.get(v, 1), f.array.get(v, 2)) + normalize(s.points[v])));
  }
  CHECK(observed_order(h, area, 3) > 1.5);    // nears 2 from below: the coarsest cells are a third of the radius
  CHECK(observed_order(h, normal, 3) > 0.8);  // of first order at the jumps
}

TEST_CASE("contour: random values on AMR grids leave no holes; a flat AMR grid gives closed lines") {
  uint64_t seed = 1;
  auto noise = [&](Vec3 p) {
    const double far = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    seed = seed * 6364136223846793005ull + 1442695040888963407ull;
    return far > 0.7 ? -1.0 : double(seed >> 40) / double(1 << 24) - 0.45;
  };
  for (int ratio : {2, 3}) {
    const Surface s(contour_at(amr(8, ratio, nested(ratio), noise), 0));
    CHECK(s.triangles.size() > 1000);
    CHECK(s.faults() == 0);
  }
  auto circle = [](Vec3 p) { return p.x * p.x + p.y * p.y - 0.49; };
  const Surface lines(contour_at(amr(32, 2, {{{{16, 16, 0}, {47, 63, 0}}}}, circle, false, 2), 0));
  std::map<int, int> ends;
  double around = 0;
  for (const auto& l : lines.lines) {
    ++ends[l[0]], --ends[l[1]];
    around += length(lines.points[size_t(l[1])] - lines.points[size_t(l[0])]);
  }
  for (const auto& [p, n] : ends) CHECK(n == 0);
  CHECK(lines.lines.size() == lines.points.size());
  CHECK(around == doctest::Approx(2 * M_PI * 0.7).epsilon(0.01));
}

TEST_CASE("contour: cells without a value and no value in range leave clean results on AMR grids") {
  auto hole = [](Vec3 p) { return length(p - Vec3(0.3, 0.2, 0.1)) < 0.3 ? std::nan("") : oblique_plane(p); };
  const auto c = contour_at(amr(8, 2, nested(2), hole), 0);
  for (Vec3 p : Surface(c).points) CHECK(std::isfinite(p.x));
  CHECK(Surface(c).triangles.size() > 100);
  const auto none = contour_at(amr(8, 2, nested(2), oblique_plane), 99);
  CHECK(none->cell_count() == 0);
  CHECK(none->fields().find("f", Association::point));
}

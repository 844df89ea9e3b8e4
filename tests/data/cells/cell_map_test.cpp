// SPDX-License-Identifier: Apache-2.0
#include "data/cells/shape/cell_map.h"

#include <algorithm>

#include "cell_cases.h"
#include "support/test.h"

using namespace sg;
using test::CellCase;

namespace {

// The reference nodes, turned, stretched and shaken by `shake` of the distance between nodes. Two-dimensional ones are bent too.
std::vector<Vec3> distorted(const CellShape& s, uint64_t seed, double shake) {
  const auto o = s.orders();
  const double step = 1.0 / std::max({o[0], o[1], o[2]});
  std::vector<Vec3> at;
  for (size_t k = 0; k < s.nodes(); ++k) {
    Vec3 p = s.node(k);
    const Vec3 r = test::random_vector(seed, k) * (2 * shake * step);
    for (int a = 0; a < s.dimension(); ++a) p[a] += r[a];
    if (s.dimension() < 3) p.z += 0.1 * p.x * p.x;
    if (s.dimension() < 2) p.y += 0.2 * p.x * p.x;
    at.push_back({5 + 2 * p.x - 0.3 * p.y, 1 + 0.4 * p.x + 1.5 * p.y + 0.2 * p.z, -3 + 0.1 * p.x - 0.5 * p.y + 1.2 * p.z});
  }
  return at;
}

// Whether the map keeps its orientation all over the element: what "valid" means for a distorted cell.
bool valid(const CellMap& m, const CellShape& s) {
  for (Vec3 p : s.quadrature(6).at)
    if (determinant(m.jacobian(p)) <= 0.05) return false;
  for (size_t k = 0; k < s.nodes(); ++k)
    if (determinant(m.jacobian(lerp(s.node(k), s.center(), 1e-9))) <= 0.02) return false;
  return true;
}

}  // namespace

TEST_CASE("cell map: the inverse undoes the forward map on distorted solids of every type and order") {
  std::vector<CellCase> cases = test::fixed_cases();
  for (const CellCase& c : test::order_cases(1, 10)) cases.push_back(c);
  for (const CellCase& c : cases) {
    const CellShape& s = c.shape();
    if (s.dimension() != 3) continue;
    CAPTURE(c.name());
    int tried = 0;
    const int cells = c.nodes > 300 ? 1 : 6, places = c.nodes > 300 ? 3 : 10;
    for (uint64_t cell = 0; tried < cells && cell < 40; ++cell) {
      // Equidistant nodes amplify: what leaves a cubic valid folds a cell of order 10.
      const auto o = s.orders();
      const int order = std::max({o[0], o[1], o[2]});
      const double shake = order < 2 ? 0.2 : 0.3 / std::pow(1.6, order);
      CellMap m(test::one_cell(c.type, distorted(s, 10 + cell, shake), c.orders));
      m.open(0);
      if (!valid(m, s)) continue;
      ++tried;
      for (int i = 0; i < places; ++i) {
        const Vec3 p = test::random_place(s, 1000 * cell + uint64_t(i));
        CellPlace place;
        REQUIRE(m.locate(m.position(p), place));
        CHECK(length(place.rst - p) < 1e-8);
        CHECK(place.outside <= 1e-9);
        CHECK(place.distance2 == 0);
      }
    }
    CHECK(tried >= std::min(cells, 2));
  }
}

TEST_CASE("cell map: the inverse finds places on bent curves and surfaces of every type and order") {
  std::vector<CellCase> cases = test::fixed_cases();
  for (const CellCase& c : test::order_cases(1, 10)) cases.push_back(c);
  for (const CellCase& c : cases) {
    const CellShape& s = c.shape();
    if (s.dimension() == 3) continue;
    CAPTURE(c.name());
    CellMap m(test::one_cell(c.type, distorted(s, 3, 0.02), c.orders));
    m.open(0);
    for (uint64_t i = 0; i < 10; ++i) {
      const Vec3 p = test::random_place(s, i), x = m.position(p);
      CellPlace place;
      CHECK(m.locate(x, place, 1e-8));
      CHECK(length(place.rst - p) < 1e-6);
      CHECK(length(place.nearest - x) < 1e-8);
      // Off the surface along its normal: found again, at that distance, and not inside.
      const Mat3 j = m.jacobian(p);
      Vec3 normal = s.dimension() == 2 ? cross(j.column(0), j.column(1)) : cross(j.column(0), Vec3(0.3, 1, 0.2));
      if (s.dimension() == 0) normal = {1, 0, 0};
      CHECK_FALSE(m.locate(x + normalize(normal) * 0.01, place, 1e-8));
      CHECK(place.distance2 == doctest::Approx(1e-4).epsilon(1e-4));
      CHECK(place.outside > 0);
    }
  }
}

TEST_CASE("cell map: in strongly distorted hexahedra, where Newton from the centre may leave or end outside, no place is lost") {
  // Valid ones among many random ones; Newton alone loses about one place of two thousand here.
  const CellShape& s = *CellShape::find(CellType::hexahedron, 8);
  int cells = 0;
  size_t lost = 0, wrong = 0;
  for (uint64_t seed = 0; seed < 300000 && cells < 300; ++seed) {
    std::vector<Vec3> at;
    for (size_t k = 0; k < 8; ++k) at.push_back(s.node(k) + test::random_vector(seed, k) * 1.4);
    std::vector<double> n(8);
    std::vector<Vec3> dn(8);
    bool ok = true;
    auto positive = [&](Vec3 p) {
      s.derivatives(p, dn.data());
      Vec3 c[3];
      for (size_t k = 0; k < 8; ++k)
        for (int a = 0; a < 3; ++a) c[a] += at[k] * dn[k][a];
      return dot(c[0], cross(c[1], c[2])) > 0.001;
    };
    for (size_t k = 0; k < 8 && ok; ++k) ok = positive(s.node(k));
    for (size_t i = 0; i < s.quadrature(12).at.size() && ok; ++i) ok = positive(s.quadrature(12).at[i]);
    if (!ok) continue;
    ++cells;
    CellMap m(test::one_cell(CellType::hexahedron, at));
    m.open(0);
    for (uint64_t i = 0; i < 200; ++i) {
      const Vec3 p = test::random_place(s, 777 * seed + i), x = m.position(p);
      CellPlace place;
      if (!m.locate(x, place)) ++lost;
      else if (!(length(m.position(place.rst) - x) < 1e-9)) ++wrong;
    }
  }
  CHECK(cells == 300);
  CHECK(lost == 0);
  CHECK(wrong == 0);
}

TEST_CASE("cell map: a parabola that bulges beyond its nodes is found there, and its box holds it") {
  // The middle node sits at a quarter: the arc rises above it.
  CellMap m(test::one_cell(CellType::quadratic_triangle, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, -0.3, 0}, {0.7, 0.5, 0}, {0, 0.5, 0}}));
  m.open(0);
  for (int i = 0; i <= 20; ++i)
    for (Vec3 p : {Vec3(i / 20.0, 0, 0), Vec3(1 - i / 20.0, i / 20.0, 0)}) {
      const Vec3 x = m.position(p);
      const Box3 box = m.reader().box();
      for (int a = 0; a < 2; ++a) CHECK((box.lo[a] <= x[a] && x[a] <= box.hi[a]));
      CellPlace place;
      CHECK(m.locate(x, place, 1e-8));
    }
  std::vector<Vec3> at;
  const CellShape& s = *CellShape::find(CellType::quadratic_hexahedron, 20);
  for (size_t k = 0; k < 20; ++k) {
    const Vec3 p = s.node(k);
    at.push_back({p.x, p.y, p.z + 0.9 * (p.x - 0.35) * (p.x - 0.35)});
  }
  CellMap bent(test::one_cell(CellType::quadratic_hexahedron, at));
  bent.open(0);
  for (uint64_t i = 0; i < 200; ++i) {
    const Vec3 p = test::random_place(s, i), x{p.x, p.y, p.z + 0.9 * (p.x - 0.35) * (p.x - 0.35)};
    CellPlace place;
    REQUIRE(bent.locate(x, place));
    CHECK(length(place.rst - p) < 1e-9);
    CHECK_FALSE(bent.locate(x - Vec3(0, 0, p.z + 1e-6), place));
  }
}

TEST_CASE("cell map: places outside are outside, with a way back to the cell") {
  using enum CellType;
  for (CellType type : {tetra, voxel, hexahedron, wedge, pyramid, quadratic_tetra, quadratic_hexahedron}) {
    const CellShape& s = *CellShape::find(type, size_t(cell_type_info(type).points));
    CAPTURE(cell_type_info(type).name);
    std::vector<Vec3> at;
    for (size_t k = 0; k < s.nodes(); ++k) at.push_back(s.node(k) * 2.0);
    CellMap m(test::one_cell(type, at));
    m.open(0);
    for (uint64_t i = 0; i < 300; ++i) {
      const Vec3 x = test::random_vector(5, i) * 6.0 + Vec3(1, 1, 1);
      CellPlace place;
      const double outside = s.outside(x / 2.0);
      CHECK(m.locate(x, place) == (outside <= 1e-9));
      if (outside <= 0) continue;
      CHECK(place.outside > 0);
      CHECK(place.distance2 > 0);
      // The nearest point: no random place of the cell is nearer, and it belongs to the cell.
      m.nearest(x, place);
      CHECK(length(x - place.nearest) == doctest::Approx(std::sqrt(place.distance2)).epsilon(1e-9));
      CHECK(s.outside(place.nearest / 2.0) < 1e-7);
      for (uint64_t j = 0; j < 30; ++j) CHECK(length(x - place.nearest) <= length(x - m.position(test::random_place(s, j))) + 1e-9);
    }
  }
}

TEST_CASE("cell map: a tilted voxel grid and pixels are located by arithmetic") {
  UniformGrid g;
  g.dims = {4, 4, 4};
  g.spacing = {0.5, 2, 1};
  g.origin = {1e7, -1e7, 3};
  const double c = std::cos(0.3), n = std::sin(0.3);
  g.direction = Mat3{{{c, -n, 0}, {n, c, 0}, {0, 0, 1}}};
  CellMap m(make_dataset(g));
  for (size_t cell : {0u, 13u, 26u}) {
    m.open(cell);
    for (uint64_t i = 0; i < 20; ++i) {
      const Vec3 p = test::random_place(*CellShape::find(CellType::voxel, 8), i);
      CellPlace place;
      CHECK(m.locate(m.position(p), place));
      CHECK(length(place.rst - p) < 1e-7);  // 1e7 leaves 2e-9 of a unit
      CHECK_FALSE(m.locate(m.position(p + Vec3(0, 1.001, 0)), place));
    }
  }
}

TEST_CASE("cell map: points on a face are inside both of its cells, also far from zero where they cannot lie on it exactly") {
  using enum CellType;
  const double far = 1e9;
  CellMap left(test::one_cell(tetra, {{far, far, far}, {far + 1, far, far}, {far, far + 1.1, far}, {far, far, far + 1.2}}));
  CellMap right(test::one_cell(tetra, {{far + 1, far, far}, {far, far + 1.1, far}, {far, far, far + 1.2}, {far + 1, far + 1, far + 1}}));
  left.open(0), right.open(0);
  CellPlace place;
  for (uint64_t i = 0; i < 200; ++i) {
    const double a = random_unit(1, i), b = (1 - a) * random_unit(2, i);
    const auto at = right.reader().at();
    const Vec3 x = at[0] * a + at[1] * b + at[2] * (1 - a - b);
    CHECK(left.locate(x, place));
    CHECK(right.locate(x, place));
  }
}

TEST_CASE("cell map: cells without a volume, NaN positions and pyramids of high order say so") {
  using enum CellType;
  CellPlace place;
  CellMap flat(test::one_cell(tetra, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
  flat.open(0);
  CHECK_FALSE(flat.locate({0.5, 0.5, 0}, place));
  CHECK(flat.measure() == 0);
  const double nan = std::nan("");
  for (CellType type : {tetra, hexahedron, wedge, pyramid, triangle, quad, line, voxel, quadratic_tetra}) {
    const CellShape& s = *CellShape::find(type, size_t(cell_type_info(type).points));
    std::vector<Vec3> at;
    for (size_t k = 0; k < s.nodes(); ++k) at.push_back(s.node(k));
    CellMap good(test::one_cell(type, at));
    good.open(0);
    CHECK_FALSE(good.locate({nan, 0.2, 0.2}, place));
    at[1].y = nan;
    CellMap bad(test::one_cell(type, at));
    bad.open(0);
    CHECK_FALSE(bad.locate({0.2, 0.2, 0.2}, place));
  }
  CellMap tall(test::one_cell(lagrange_pyramid, std::vector<Vec3>(30)));
  CHECK(test::error_of([&] { tall.open(0); }).find("pyramids have") != std::string::npos);
  CellMap odd(test::one_cell(lagrange_hexahedron, std::vector<Vec3>(28)));
  CHECK(test::error_of([&] { odd.open(0); }).find("does not fit any order") != std::string::npos);
}

// SPDX-License-Identifier: Apache-2.0
// Cells that no mesh should have, but files do.
#include "cell_cases.h"
#include "data/cells/shape/cell_map.h"
#include "support/test.h"

using namespace sg;

namespace {

// Every question, twice; the answers may be NaN, but they come, and "inside" means that the cell's image is there.
void ask(CellMap& m, uint64_t seed) {
  const size_t n = m.reader().ids().size();
  std::vector<double> w(n), f(n, 1.0);
  std::vector<Vec3> g(n);
  for (Vec3 x : {test::random_vector(seed, 1), Vec3(0, 0, 0), Vec3(1e30, 0, 0), Vec3(std::nan(""), 0, 0)}) {
    CellPlace place;
    const bool in = m.locate(x, place);
    CHECK_FALSE((in && std::isnan(x.x)));
    if (in) {
      m.weights(place, w);
      m.gradient_weights(place, g);
      m.gradient(place, f);
    }
    m.nearest(x, place);
  }
  m.measure();
  m.integration_weights(w);
  m.center();
  m.reader().box();
}

}  // namespace

TEST_CASE("cell map: garbage cells of every type neither crash nor hang") {
  std::vector<test::CellCase> cases = test::fixed_cases();
  for (const auto& c : test::order_cases(1, 3)) cases.push_back(c);
  for (CellType t : {CellType::polygon, CellType::triangle_strip, CellType::poly_line, CellType::poly_vertex, CellType::quadratic_polygon})
    for (size_t n : {0, 1, 2, 3, 4, 6}) cases.push_back({t, n});
  cases.push_back({CellType::pentagonal_prism, 10}), cases.push_back({CellType::hexagonal_prism, 12}),
      cases.push_back({CellType::empty, 0});
  const double nan = std::nan("");
  for (const auto& c : cases) {
    CAPTURE(c.name());
    for (int kind = 0; kind < 5; ++kind) {
      std::vector<Vec3> at;
      for (size_t k = 0; k < c.nodes; ++k) {
        const Vec3 r = test::random_vector(uint64_t(kind), k);
        at.push_back(kind == 0   ? Vec3(0, 0, 0)                   // all in one point
                     : kind == 1 ? Vec3(r.x, 0, 0)                 // on a line
                     : kind == 2 ? r                               // folded
                     : kind == 3 ? (k == 1 ? Vec3(nan, 0, 0) : r)  // a missing position
                                 : r * 1e200);                     // squares overflow
      }
      CellMap m(test::one_cell(c.type, at, c.orders));
      m.open(0);
      ask(m, uint64_t(kind));
    }
  }
}

TEST_CASE("cell map: every point of a linear solid is found, however it is folded over itself") {
  using enum CellType;
  for (CellType type : {tetra, pyramid, wedge, hexahedron}) {
    const size_t nodes = size_t(cell_type_info(type).points);
    const CellShape& shape = *CellShape::find(type, nodes, {});
    size_t lost = 0;
    for (uint64_t cell = 0; cell < 400; ++cell) {
      std::vector<Vec3> at;
      for (size_t k = 0; k < nodes; ++k) at.push_back(shape.node(k) + test::random_vector(cell, k) * (cell % 2 ? 1.5 : 4.0));
      CellMap m(test::one_cell(type, at));
      m.open(0);
      for (uint64_t p = 0; p < 20; ++p) {
        const Vec3 x = m.position(test::random_place(shape, 1000 * cell + p));
        CellPlace place;
        if (!m.locate(x, place)) ++lost;
        else CHECK(length(m.position(place.rst) - x) < 1e-6);
      }
    }
    CAPTURE(int(type));
    CHECK(lost == 0);
  }
}

TEST_CASE("cell map: polyhedra without faces, with faces of two points, or open ones neither crash nor hang") {
  for (int kind = 0; kind < 4; ++kind) {
    UnstructuredMesh m;
    m.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, 3);
    m.cells = {Array::from_vector(std::vector<int64_t>{0, 1, 2, 3}), Array::from_vector(std::vector<int64_t>{0, 4}), 0};
    m.single_type = CellType::polyhedron;
    std::vector<int64_t> faces{0, 1, 0, 1, 2, 3, 3, 3, 3}, offsets{0, 2, 2, 3, 6, 9};
    if (kind == 1) faces = {0, 1, 2}, offsets = {0, 3};
    if (kind == 2) faces = {0, 1, 2, 0, 1, 2, 0, 2, 1, 0, 1, 2}, offsets = {0, 3, 6, 9, 12};
    m.faces = {Array::from_vector(faces), Array::from_vector(offsets), 0};
    m.polyhedron_faces = Array::from_vector(std::vector<int64_t>{0, kind == 3 ? 0 : int64_t(offsets.size()) - 1});
    CellMap map(make_dataset(m));
    map.open(0);
    ask(map, 3);
    CHECK(std::abs(map.measure()) < 1);
  }
}

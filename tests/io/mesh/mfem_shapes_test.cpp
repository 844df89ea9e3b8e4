// SPDX-License-Identifier: Apache-2.0
// Curved elements of every shape, order and collection: the file is written here, by MFEM's numbering as its documentation and its
// lists of nodes tell it (written down once more, independently of the reader), with the nodes on a known map; the cells must be
// that map everywhere, across faces that two elements see from different corners too.
#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "data/cells/shape/cell_map.h"
#include "io/io_files.h"
#include "io/mesh/mfem_lists.h"
#include "io/mfem/element.h"
#include "support/property.h"
#include "support/test.h"

using namespace sg;
using namespace sg::mfem;
using namespace sg::test::mfem_lists;
using sg::test::Random;

namespace {

// Points along [0, 1]: closed at equal distances (a) or Gauss and Lobatto's (b).
std::vector<double> axis(bool lobatto, int p) { return basis_points(lobatto ? Basis::gauss_lobatto : Basis::closed_uniform, p); }

// Places inside a face or a cell, in the order in which MFEM lists them: rows, the first axis fastest.
Places inside(Geometry g, const std::vector<double>& x, bool around) {
  const int p = int(x.size()) - 1;
  const bool tri = g == Geometry::triangle || g == Geometry::prism, tet = g == Geometry::tetrahedron;
  const bool flat = g == Geometry::triangle || g == Geometry::square, thin = g == Geometry::segment;
  Places out;
  for (int k = 1; k < (flat || thin ? 2 : p); ++k)
    for (int j = 1; j < (thin ? 2 : p); ++j)
      for (int i = 1; i < p; ++i) {
        const int rest = p - i - j - (tet ? k : 0);
        if ((tri || tet) && rest < 1) continue;
        Vec3 at(x[size_t(i)], thin ? 0 : x[size_t(j)], flat || thin ? 0 : x[size_t(k)]);
        if (tri) at = Vec3(at.x / (at.x + at.y + x[size_t(rest)]), at.y / (at.x + at.y + x[size_t(rest)]), at.z);
        if (tet) at = at * (1 / (at.x + at.y + at.z + x[size_t(rest)]));
        out.push_back(at);
      }
  if (around)  // the collection "Cubic": 8 nodes that go around two layers as the corners of a cube do
    for (const size_t layer : {size_t(0), size_t(4)}) std::swap(out[layer + 2], out[layer + 3]);
  return out;
}

// A mesh whose elements are affine images of their reference elements, bent by `bend`.
struct MfemMesh {
  int dimension;
  Places vertices;
  std::vector<Element> elements;

  Vec3 place(const Element& e, Vec3 r) const { return placed(vertices, e, r); }

  template <class Bend>
  std::string text(const std::string& collection, bool lobatto, int p, Bend bend) const {
    std::string s = fmt::format("MFEM mesh v1.0\ndimension\n{}\nelements\n{}\n", dimension, elements.size());
    for (const Element& e : elements) {
      s += fmt::format("1 {}", int(e.shape));
      for (const int64_t v : e.corners) s += fmt::format(" {}", v);
      s += '\n';
    }
    s += fmt::format("boundary\n0\nvertices\n{}\nnodes\nFiniteElementSpace\nFiniteElementCollection: {}\nVDim: 3\nOrdering: 1\n\n",
                     vertices.size(), collection);
    auto add = [&](Vec3 at) {
      const Vec3 b = bend(at);
      s += fmt::format("{:.17g} {:.17g} {:.17g}\n", b.x, b.y, b.z);
    };
    const std::vector<double> x = axis(lobatto, p);
    for (const Vec3& v : vertices) add(v);
    if (dimension > 1) {
      std::set<std::pair<int64_t, int64_t>> seen;  // edges in the order in which elements name them, from their smaller vertex
      for (const Element& e : elements)
        for (const auto& edge : edges_of(e.shape)) {
          const auto [a, b] = std::minmax(e.corners[size_t(edge[0])], e.corners[size_t(edge[1])]);
          if (!seen.insert({a, b}).second) continue;
          for (int i = 1; i < p; ++i) add(vertices[size_t(a)] + (vertices[size_t(b)] - vertices[size_t(a)]) * x[size_t(i)]);
        }
    }
    std::set<std::set<int64_t>> seen;  // faces likewise, as the first element sees them
    for (const Element& e : elements)
      for (const auto& face : faces_of(e.shape)) {
        std::set<int64_t> ids;
        for (const int c : face) ids.insert(e.corners[size_t(c)]);
        if (!seen.insert(ids).second) continue;
        const Vec3 o = vertices[size_t(e.corners[size_t(face[0])])], a = vertices[size_t(e.corners[size_t(face[1])])] - o,
                   b = vertices[size_t(e.corners[size_t(face.back())])] - o;
        for (const Vec3& r : inside(face.size() == 3 ? Geometry::triangle : Geometry::square, x, false)) add(o + a * r.x + b * r.y);
      }
    for (const Element& e : elements)
      for (const Vec3& r : inside(e.shape, x, collection == "Cubic" && e.shape == Geometry::cube)) add(place(e, r));
    return s;
  }
};

// Of total degree d, invertible on the small meshes here.
Vec3 bent(Vec3 p, int d) {
  if (d == 1) return {p.x + 0.2 * p.y - 0.1 * p.z, p.y + 0.1 * p.z, p.z + 0.15 * p.x};
  if (d == 2) return {p.x + 0.12 * p.y * p.y, p.y - 0.1 * p.z * p.x, p.z + 0.08 * p.x * p.x};
  const double q = d == 3 ? 1 : p.x;
  return {p.x + 0.06 * p.y * p.y * p.z * q, p.y - 0.05 * p.z * p.z * p.z + 0.04 * p.x * p.y, p.z + 0.05 * p.x * p.x * p.y * q};
}

double check(const MfemMesh& mesh, const std::string& collection, bool lobatto, int p, int d) {
  const DatasetPtr data = test::read_text("shape.mesh", mesh.text(collection, lobatto, p, [d](Vec3 x) { return bent(x, d); }));
  REQUIRE(data->cell_count() == mesh.elements.size());
  CellMap map(data);
  double worst = 0;
  Random random(uint64_t(100 * p + d));
  for (size_t e = 0; e < mesh.elements.size(); ++e) {
    map.open(e);
    for (int k = 0; k < 12; ++k) {
      Vec3 r(random.unit(), random.unit(), random.unit());
      const Geometry g = mesh.elements[e].shape;
      if (g == Geometry::segment) r.y = r.z = 0;
      if (g == Geometry::triangle || g == Geometry::square) r.z = 0;
      if (g == Geometry::triangle || g == Geometry::prism) r.y *= 1 - r.x;
      if (g == Geometry::tetrahedron) r.y *= 1 - r.x, r.z *= 1 - r.x - r.y;
      worst = std::max(worst, length(map.position(r) - bent(mesh.place(mesh.elements[e], r), d)));
    }
  }
  return worst;
}

// The element alone, its vertices numbered in random order, so that its edges run either way.
MfemMesh alone(Geometry g, Random& random) {
  MfemMesh m;
  const Places ref = corners_of(g);
  m.dimension = g == Geometry::segment ? 1 : g == Geometry::triangle || g == Geometry::square ? 2 : 3;
  std::vector<int64_t> number(ref.size());
  std::iota(number.begin(), number.end(), 0);
  for (size_t i = number.size(); i > 1; --i) std::swap(number[i - 1], number[size_t(random.whole(0, int(i) - 1))]);
  m.vertices.resize(ref.size());
  for (size_t c = 0; c < ref.size(); ++c) m.vertices[size_t(number[c])] = ref[c];
  m.elements.push_back({g, number});
  return m;
}

}  // namespace

TEST_CASE("mfem: curved elements of every shape, order and collection are the map that their nodes lie on") {
  Random random(5);
  for (const Geometry g : {Geometry::segment, Geometry::triangle, Geometry::square, Geometry::tetrahedron, Geometry::cube, Geometry::prism})
    for (int p = 1; p <= 5; ++p) {
      CAPTURE(int(g));
      CAPTURE(p);
      const int held = std::min(p, 4);
      for (int tries = 0; tries < 3; ++tries) {
        const MfemMesh m = alone(g, random);
        CHECK(check(m, fmt::format("H1_3D_P{}", p), true, p, held) < 1e-12);
        CHECK(check(m, fmt::format("H1@U_3D_P{}", p), false, p, held) < 1e-12);
        if (p <= 3) CHECK(check(m, p == 1 ? "Linear" : p == 2 ? "Quadratic" : "Cubic", false, p, held) < 1e-12);
      }
    }
}

TEST_CASE("mfem: neighbours are the same map across faces that each lists from another corner") {
  // Two cubes, the second turned in all 24 ways; two prisms and a cube; tetrahedra in all even orders.
  const std::vector<std::array<int, 3>> axes{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (size_t a = 0; a < axes.size(); ++a)
    for (int flips = 0; flips < 8; ++flips) {
      const bool odd = (a > 2) != bool((flips ^ flips >> 1 ^ flips >> 2) & 1);
      if (odd) continue;  // mirrored
      MfemMesh m;
      m.dimension = 3;
      for (int k = 0; k < 2; ++k)
        for (int j = 0; j < 2; ++j)
          for (int i = 0; i < 3; ++i) m.vertices.push_back(Vec3(2 - i, j, k) * 0.5);
      auto id = [](int i, int j, int k) { return int64_t(2 - i + 3 * (j + 2 * k)); };
      Element one{Geometry::cube, {}}, two{Geometry::cube, {}};
      for (const Vec3& c : corners_of(Geometry::cube)) {
        const int at[3] = {int(c.x), int(c.y), int(c.z)};
        int to[3];
        for (size_t k = 0; k < 3; ++k) to[axes[a][k]] = (flips >> k & 1) ? 1 - at[k] : at[k];
        one.corners.push_back(id(at[0], at[1], at[2]));
        two.corners.push_back(id(1 + to[0], to[1], to[2]));
      }
      m.elements = {one, two};
      for (int p = 2; p <= 4; ++p) CHECK(check(m, fmt::format("H1_3D_P{}", p), true, p, p) < 1e-12);
      CHECK(check(m, "Cubic", false, 3, 3) < 1e-12);
    }
  std::array<int64_t, 4> order{1, 2, 3, 4};
  do {
    MfemMesh m;
    m.dimension = 3;
    m.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
    m.elements = {{Geometry::tetrahedron, {0, 1, 2, 3}}, {Geometry::tetrahedron, {order.begin(), order.end()}}};
    for (const int p : {3, 4, 5}) CHECK(check(m, fmt::format("H1_3D_P{}", p), true, p, std::min(p, 4)) < 1e-12);
    CHECK(check(m, "Cubic", false, 3, 3) < 1e-12);
  } while (std::next_permutation(order.begin(), order.end()));
}

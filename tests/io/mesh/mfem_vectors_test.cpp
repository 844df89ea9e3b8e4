// SPDX-License-Identifier: Apache-2.0
// Fields in H(curl) and H(div): degrees of freedom are computed here from a polynomial field in space, edge by edge, face by face and
// inside, as MFEM's documentation tells their places, directions and order; what is read must be that field.
#include <fmt/core.h>

#include <algorithm>
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

using Field3 = std::function<Vec3(Vec3)>;

struct Dof {
  Vec3 at, direction;  // in the reference element
};

constexpr double third = 1.0 / 3, g0 = 0.21132486540518713, g1 = 0.78867513459481287;  // Gauss' two points on [0, 1]

// Inside the element, of RT_P1 (rt) and ND_P2, and of RT_P0 and ND_P1, which have none.
std::vector<Dof> inside_dofs(Geometry g, bool rt, int degree) {
  if (degree == 1) return {};
  switch (g) {
    case Geometry::triangle:
      if (rt) return {{{third, third, 0}, {0, -1, 0}}, {{third, third, 0}, {-1, 0, 0}}};
      return {{{third, third, 0}, {1, 0, 0}}, {{third, third, 0}, {0, 1, 0}}};
    case Geometry::square:
      if (rt) return {{{.5, g0, 0}, {1, 0, 0}}, {{.5, g1, 0}, {-1, 0, 0}}, {{g0, .5, 0}, {0, -1, 0}}, {{g1, .5, 0}, {0, 1, 0}}};
      return {{{g0, .5, 0}, {1, 0, 0}}, {{g1, .5, 0}, {1, 0, 0}}, {{.5, g0, 0}, {0, 1, 0}}, {{.5, g1, 0}, {0, 1, 0}}};
    case Geometry::tetrahedron:
      if (!rt) return {};
      return {{{.25, .25, .25}, {-1, 0, 0}}, {{.25, .25, .25}, {0, -1, 0}}, {{.25, .25, .25}, {0, 0, -1}}};
    case Geometry::cube: {
      std::vector<Dof> all;
      for (int a = 0; a < 3; ++a)
        for (int k = 0; k < 4; ++k) {
          if (!rt && k > 1) break;
          const double fast = k % 2 ? g1 : g0, slow = k / 2 ? g1 : g0;
          Dof d{{.5, .5, .5}, {}};
          d.direction[a] = 1;
          if (rt) d.at[a == 0 ? 1 : 0] = fast, d.at[a == 2 ? 1 : 2] = slow;
          else d.at[a] = fast;
          all.push_back(d);
        }
      return all;
    }
    default: {  // prism
      std::vector<Dof> all;
      if (rt) {
        for (const double z : {g0, g1}) all.push_back({{third, third, z}, {0, -1, 0}}), all.push_back({{third, third, z}, {-1, 0, 0}});
        const double a = g0 / (2 * g0 + g1), b = g1 / (2 * g0 + g1);
        for (const Vec3& at : {Vec3(a, a, .5), Vec3(b, a, .5), Vec3(a, b, .5)}) all.push_back({at, {0, 0, 1}});
      } else {
        all = {{{third, third, .5}, {1, 0, 0}}, {{third, third, .5}, {0, 1, 0}}};
      }
      return all;
    }
  }
}

// Of a face of three or four corners, in its frame: place and tangent. RT: once per place.
std::vector<Dof> face_dofs(bool triangle, bool rt, int degree) {
  const double a = g0 / (2 * g0 + g1), b = g1 / (2 * g0 + g1);
  if (rt && degree == 1) return {{triangle ? Vec3(third, third, 0) : Vec3(.5, .5, 0), {}}};
  if (rt && triangle) return {{{a, a, 0}, {}}, {{b, a, 0}, {}}, {{a, b, 0}, {}}};
  if (rt) return {{{g0, g0, 0}, {}}, {{g1, g0, 0}, {}}, {{g0, g1, 0}, {}}, {{g1, g1, 0}, {}}};
  if (degree == 1) return {};
  if (triangle) return {{{third, third, 0}, {1, 0, 0}}, {{third, third, 0}, {0, 1, 0}}};
  return {{{g0, .5, 0}, {1, 0, 0}}, {{g1, .5, 0}, {1, 0, 0}}, {{.5, g0, 0}, {0, 1, 0}}, {{.5, g1, 0}, {0, 1, 0}}};
}

struct VectorMesh {
  int dimension;
  Places vertices;
  std::vector<Element> elements;

  std::string text(bool rt, int degree, const Field3& u) const {
    std::string s = fmt::format("solution\nMFEM mesh v1.0\ndimension\n{}\nelements\n{}\n", dimension, elements.size());
    for (const Element& e : elements) {
      s += fmt::format("1 {}", int(e.shape));
      for (const int64_t v : e.corners) s += fmt::format(" {}", v);
      s += '\n';
    }
    s += fmt::format("boundary\n0\nvertices\n{}\n{}\n", vertices.size(), dimension);
    for (const Vec3& v : vertices) s += dimension == 2 ? fmt::format("{} {}\n", v.x, v.y) : fmt::format("{} {} {}\n", v.x, v.y, v.z);
    s += fmt::format("FiniteElementSpace\nFiniteElementCollection: {}_{}D_P{}\nVDim: 1\nOrdering: 0\n\n", rt ? "RT" : "ND", dimension,
                     rt ? degree - 1 : degree);
    for (const double v : values(rt, degree, u)) s += fmt::format("{:.17g}\n", v);
    return s;
  }

  std::vector<double> values(bool rt, int degree, const Field3& u) const {
    std::vector<double> out;
    const std::vector<double> along = degree == 1 ? std::vector<double>{.5} : std::vector<double>{g0, g1};
    std::set<std::pair<int64_t, int64_t>> edges;
    for (const Element& e : elements)
      for (const auto& edge : edges_of(e.shape)) {
        if (rt && dimension == 3) continue;
        const auto [a, b] = std::minmax(e.corners[size_t(edge[0])], e.corners[size_t(edge[1])]);
        if (!edges.insert({a, b}).second) continue;
        const Vec3 o = vertices[size_t(a)], t = vertices[size_t(b)] - o;
        for (const double x : along) out.push_back(dot(u(o + t * x), rt ? Vec3(t.y, -t.x, 0) : t));
      }
    std::set<std::set<int64_t>> faces;
    for (const Element& e : elements)
      for (const auto& face : faces_of(e.shape)) {
        std::set<int64_t> ids;
        for (const int c : face) ids.insert(e.corners[size_t(c)]);
        if (!faces.insert(ids).second) continue;
        const Vec3 o = vertices[size_t(e.corners[size_t(face[0])])], x = vertices[size_t(e.corners[size_t(face[1])])] - o,
                   y = vertices[size_t(e.corners[size_t(face.back())])] - o;
        for (const Dof& d : face_dofs(face.size() == 3, rt, degree)) {
          const Vec3 v = u(o + x * d.at.x + y * d.at.y);
          out.push_back(dot(v, rt ? cross(x, y) : x * d.direction.x + y * d.direction.y));
        }
      }
    for (const Element& e : elements) {
      const Vec3 o = placed(vertices, e, {0, 0, 0}), x = placed(vertices, e, {1, 0, 0}) - o, y = placed(vertices, e, {0, 1, 0}) - o,
                 z = dimension == 3 ? placed(vertices, e, {0, 0, 1}) - o : Vec3(0, 0, 1);
      for (const Dof& d : inside_dofs(e.shape, rt, degree)) {
        const Vec3 v = u(o + x * d.at.x + y * d.at.y + z * d.at.z);
        // The reference field: J^T u, or det J J^-1 u.
        const Vec3 reference =
            rt ? Vec3(dot(v, cross(y, z)), dot(v, cross(z, x)), dot(v, cross(x, y))) : Vec3(dot(v, x), dot(v, y), dot(v, z));
        out.push_back(dot(reference, d.direction));
      }
    }
    return out;
  }

  // The largest difference between what is read and u.
  double worst(bool rt, int degree, const Field3& u) const {
    const DatasetPtr data = test::read_text("vectors.saved", text(rt, degree, u));
    REQUIRE(data->cell_count() == elements.size());
    const Field& f = data->fields().require("solution");
    REQUIRE(f.components() == 3);
    CHECK(f.role == Role::vectors);
    const auto* mesh = data->as<UnstructuredMesh>();
    double worst = 0;
    for (size_t p = 0; p < data->point_count(); ++p) {
      const Vec3 is(f.array.get(p, 0), f.array.get(p, 1), f.array.get(p, 2));
      worst = std::max(worst, length(is - u(mesh->points.at(p))));
    }
    return worst;
  }
};

Field3 linear(Random& random, int dimension) {
  Vec3 c[4];
  for (Vec3& v : c) v = Vec3(random.in(-1, 1), random.in(-1, 1), dimension == 3 ? random.in(-1, 1) : 0);
  return [=](Vec3 x) { return c[0] + c[1] * x.x + c[2] * x.y + c[3] * x.z; };
}
Field3 constant(Random& random, int dimension) {
  const Vec3 c(random.in(-1, 1), random.in(-1, 1), dimension == 3 ? random.in(-1, 1) : 0);
  return [=](Vec3) { return c; };
}

void renumber(VectorMesh& m, Random& random) {
  std::vector<int64_t> number(m.vertices.size());
  std::iota(number.begin(), number.end(), 0);
  for (size_t i = number.size(); i > 1; --i) std::swap(number[i - 1], number[size_t(random.whole(0, int(i) - 1))]);
  Places moved(m.vertices.size());
  for (size_t v = 0; v < number.size(); ++v) moved[size_t(number[v])] = m.vertices[v];
  m.vertices = moved;
  for (Element& e : m.elements)
    for (int64_t& v : e.corners) v = number[size_t(v)];
}

void check(VectorMesh m, Random& random) {
  renumber(m, random);
  for (Vec3& v : m.vertices) v = Vec3(v.x + 0.3 * v.y - 0.2 * v.z, 0.8 * v.y + 0.1 * v.x, 1.2 * v.z + (m.dimension == 3 ? 0.2 * v.x : 0));
  for (const bool rt : {true, false}) {
    CAPTURE(rt);
    CHECK(m.worst(rt, 1, constant(random, m.dimension)) < 1e-12);
    CHECK(m.worst(rt, 2, linear(random, m.dimension)) < 1e-12);
    // Fields of the lowest order that are not constant: x - a, and a turn about a.
    const Vec3 a(0.2, 0.7, m.dimension == 3 ? 0.4 : 0), w(0, 0, 1);
    CHECK(m.worst(rt, 1, [&](Vec3 x) { return rt ? x - a : cross(w, x - a); }) < 1e-12);
  }
}

}  // namespace

TEST_CASE("mfem: fields in H(div) and H(curl) on flat meshes are what their degrees of freedom were taken from") {
  Random random(11);
  for (int tries = 0; tries < 6; ++tries) {
    check({2, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{Geometry::triangle, {0, 1, 2}}, {Geometry::triangle, {3, 2, 1}}}}, random);
    VectorMesh squares{2, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}, {3, 0, 0}}, {}};
    std::vector<int64_t> second{1, 2, 5, 4};
    std::rotate(second.begin(), second.begin() + tries % 4, second.end());
    squares.elements = {{Geometry::square, {0, 1, 4, 3}}, {Geometry::square, second}, {Geometry::triangle, {6, 5, 2}}};
    check(squares, random);
  }
}

TEST_CASE("mfem: fields in H(div) and H(curl) agree across faces that each element lists from another corner") {
  Random random(12);
  std::vector<int64_t> order{1, 2, 3, 4};
  do {
    check({3,
           {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}},
           {{Geometry::tetrahedron, {0, 1, 2, 3}}, {Geometry::tetrahedron, {order.begin(), order.end()}}}},
          random);
  } while (std::next_permutation(order.begin(), order.end()));
  for (int turn = 0; turn < 4; ++turn) {  // a prism between two cubes
    VectorMesh m{3, {}, {}};
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 3; ++i) m.vertices.emplace_back(i, j, k);
    m.vertices.emplace_back(3, 0, 0), m.vertices.emplace_back(3, 0, 1);
    std::vector<int64_t> low{1, 2, 5, 4}, high{7, 8, 11, 10};
    std::rotate(low.begin(), low.begin() + turn, low.end()), std::rotate(high.begin(), high.begin() + turn, high.end());
    low.insert(low.end(), high.begin(), high.end());
    m.elements = {{Geometry::cube, {0, 1, 4, 3, 6, 7, 10, 9}}, {Geometry::cube, low}, {Geometry::prism, {2, 12, 5, 8, 13, 11}}};
    check(m, random);
  }
}

TEST_CASE("mfem: on bent squares the lowest orders hold what Piola's maps of constant fields are") {
  Random random(13);
  for (const bool rt : {true, false})
    for (int tries = 0; tries < 4; ++tries) {
      VectorMesh m{2, {{0, 0, 0}, {1, 0.1, 0}, {2, 0, 0}, {0.1, 1, 0}, {1.2, 0.8, 0}, {2.1, 1.1, 0}}, {}};
      m.elements = {{Geometry::square, {0, 1, 4, 3}}, {Geometry::square, {1, 2, 5, 4}}};
      renumber(m, random);
      CHECK(m.worst(rt, 1, constant(random, 2)) < 1e-12);
    }
}

TEST_CASE("mfem: vector-valued spaces of every order have as many degrees of freedom as the literature says") {
  const auto count = [](const char* mesh, const std::string& collection, size_t n) {
    const auto text = [&](size_t values) {
      std::string s =
          fmt::format("solution\n{}FiniteElementSpace\nFiniteElementCollection: {}\nVDim: 1\nOrdering: 0\n\n", mesh, collection);
      for (size_t i = 0; i < values; ++i) s += "0\n";
      return s;
    };
    CHECK(test::read_text("count.saved", text(n))->fields().require("solution").components() == 3);
    CHECK(test::error_of([&] { test::read_text("count.saved", text(n - 1)); }) != "");
  };
  const char* tet = "MFEM mesh v1.0\ndimension\n3\nelements\n1\n1 4 0 1 2 3\nboundary\n0\nvertices\n4\n3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  const char* cube =
      "MFEM mesh v1.0\ndimension\n3\nelements\n1\n1 5 0 1 2 3 4 5 6 7\nboundary\n0\nvertices\n8\n3\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 "
      "1\n1 1 1\n0 1 1\n";
  for (size_t p = 1; p <= 6; ++p) {  // Nedelec 1980; RT_P(p - 1)
    count(tet, fmt::format("ND_3D_P{}", p), p * (p + 2) * (p + 3) / 2);
    count(tet, fmt::format("RT_3D_P{}", p - 1), p * (p + 1) * (p + 3) / 2);
    if (p > 4) continue;
    count(cube, fmt::format("ND_3D_P{}", p), 3 * p * (p + 1) * (p + 1));
    count(cube, fmt::format("RT_3D_P{}", p - 1), 3 * p * p * (p + 1));
  }
}

TEST_CASE("mfem: vector-valued spaces on what has none of them are refused") {
  const std::string line = "solution\nMFEM mesh v1.0\ndimension\n1\nelements\n1\n1 1 0 1\nboundary\n0\nvertices\n2\n1\n0\n1\n";
  const auto error = [&](const std::string& collection) {
    return test::error_of([&] {
      test::read_text("line.saved",
                      line + "FiniteElementSpace\nFiniteElementCollection: " + collection + "\nVDim: 1\nOrdering: 0\n\n1\n1\n");
    });
  };
  CHECK(error("ND_1D_P1").find("segments") != std::string::npos);
  CHECK(error("ND_1D_P0").find("not supported") != std::string::npos);
}

// SPDX-License-Identifier: Apache-2.0
#include "data/cells/shape/cell_shape.h"

#include <algorithm>

#include "cell_cases.h"
#include "support/test.h"

using namespace sg;
using test::CellCase;

namespace {

bool lagrange_like(CellType type) { return !is_bezier(type); }

// Rounding of interpolation grows with the order: Lebesgue constants of equidistant nodes.
double loss(const CellShape& s) {
  const auto o = s.orders();
  return std::pow(2.0, std::max({o[0], o[1], o[2]}) - 1);
}

double power(Vec3 p, int a, int b, int c) { return std::pow(p.x, a) * std::pow(p.y, b) * std::pow(p.z, c); }

double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

// Closed integrals of r^a s^b t^c over the reference elements.
double closed_integral(CellType base, int a, int b, int c) {
  auto simplex = [](std::initializer_list<int> e) {
    int sum = int(e.size());
    double top = 1;
    for (int i : e) sum += i, top *= factorial(i);
    return top / factorial(sum);
  };
  switch (base) {
    case CellType::line: return 1.0 / (a + 1);
    case CellType::triangle: return simplex({a, b});
    case CellType::tetra: return simplex({a, b, c});
    case CellType::wedge: return simplex({a, b}) / (c + 1);
    case CellType::pixel:
    case CellType::quad: return 1.0 / ((a + 1) * (b + 1));
    default: return 1.0 / ((a + 1) * (b + 1) * (c + 1));
  }
}

}  // namespace

TEST_CASE("cell shape: every type with a map has one, the others and unfitting counts have none") {
  for (const CellCase& c : test::all_cases()) {
    CAPTURE(c.name());
    const CellShape* s = CellShape::find(c.type, c.nodes, c.orders);
    REQUIRE(s);
    CHECK(s->type() == c.type);
    CHECK(s->nodes() == c.nodes);
    CHECK(s->dimension() == cell_type_info(c.type).dimension);
    CHECK(s == CellShape::find(c.type, c.nodes, c.orders));
    for (size_t k = 0; k < c.nodes; ++k) CHECK(s->outside(s->node(k)) <= 1e-15);
    CHECK(s->outside(s->center()) <= 0);
  }
  using enum CellType;
  for (CellType t :
       {empty, polygon, polyhedron, triangle_strip, poly_line, poly_vertex, quadratic_polygon, pentagonal_prism, hexagonal_prism})
    for (size_t n : {0, 1, 4, 10, 12}) CHECK(CellShape::find(t, n) == nullptr);
  CHECK(CellShape::find(tetra, 5) == nullptr);
  CHECK(CellShape::find(lagrange_hexahedron, 28) == nullptr);
  CHECK(CellShape::find(lagrange_hexahedron, 12 * 12 * 12) == nullptr);  // order 11
  CHECK(CellShape::find(lagrange_pyramid, 30) == nullptr);
  CHECK(CellShape::find(bezier_pyramid, 14) == nullptr);
  CHECK(CellShape::find(lagrange_quad, 12, {2, 2, 0}) == nullptr);
  CHECK(CellShape::find(lagrange_wedge, 18, {2, 1, 2}) == nullptr);
}

TEST_CASE("cell shape: Lagrange-like functions are 1 at their node and 0 at the others") {
  for (const CellCase& c : test::all_cases()) {
    if (!lagrange_like(c.type)) continue;
    CAPTURE(c.name());
    const CellShape& s = c.shape();
    std::vector<double> n(c.nodes);
    double worst = 0;
    const size_t stride = c.nodes > 200 ? 7 : 1;
    for (size_t j = 0; j < c.nodes; j += stride) {
      s.values(s.node(j), n.data());
      for (size_t k = 0; k < c.nodes; ++k) worst = std::max(worst, std::abs(n[k] - (j == k)));
    }
    CHECK(worst < 1e-13 * loss(s));
  }
}

TEST_CASE("cell shape: functions sum to 1, their derivatives to 0, and functions() agrees with both") {
  for (const CellCase& c : test::all_cases()) {
    CAPTURE(c.name());
    const CellShape& s = c.shape();
    std::vector<double> n(c.nodes), n2(c.nodes);
    std::vector<Vec3> dn(c.nodes), dn2(c.nodes);
    for (uint64_t i = 0; i < 4; ++i) {
      // Outside the element too: the identity holds everywhere.
      const Vec3 p = test::random_place(s, i) * (i == 3 ? 1.1 : 1.0);
      s.values(p, n.data());
      s.derivatives(p, dn.data());
      double sum = 0;
      Vec3 slope;
      for (size_t k = 0; k < c.nodes; ++k) sum += n[k], slope += dn[k];
      CHECK(std::abs(sum - 1) < 1e-12 * loss(s));
      CHECK(length(slope) < 1e-10 * loss(s));
      for (int a = s.dimension(); a < 3; ++a) CHECK(slope[a] == 0);
      s.functions(p, n2.data(), dn2.data());
      CHECK(n == n2);
      CHECK(dn == dn2);
    }
  }
}

TEST_CASE("cell shape: polynomials of the cell's degree are reproduced, and one degree more is not") {
  for (const CellCase& c : test::all_cases()) {
    const CellShape& s = c.shape();
    if (s.dimension() == 0) continue;
    CAPTURE(c.name());
    // (1 + p.x)^degree with a random direction has every monomial of that degree. A Bezier cell holds it in its coefficients:
    // reproduced when the values at enough places fit the functions; there the Bernstein coefficients of x^d are known (blossom).
    const Vec3 direction = Vec3(0.7, 0.4, 0.3);
    auto f = [&](Vec3 p, int d) { return std::pow(0.5 + dot(direction, p), d); };
    std::vector<double> n(c.nodes);
    double worst = 0, beyond = 0;
    for (uint64_t i = 0; i < 5; ++i) {
      const Vec3 p = test::random_place(s, 100 + i);
      s.values(p, n.data());
      double sum = 0, above = 0;
      for (size_t k = 0; k < c.nodes; ++k) {
        const int d = lagrange_like(c.type) ? s.degree() : 1;  // control points of Bezier cells reproduce linear functions
        sum += n[k] * f(s.node(k), d), above += n[k] * f(s.node(k), s.degree() + 1);
      }
      worst = std::max(worst, std::abs(sum - f(p, lagrange_like(c.type) ? s.degree() : 1)));
      beyond = std::max(beyond, std::abs(above - f(p, s.degree() + 1)));
    }
    CHECK(worst < 2e-13 * loss(s) * std::pow(2, s.degree()));
    if (s.degree() <= 4 && c.orders[0] == 0) CHECK(beyond > 1e-6);
  }
}

TEST_CASE("cell shape: Bernstein functions are the powers of the barycentric coordinates, times binomials") {
  // Along an axis x^d = sum_i C(i,d)/C(n,d) B_i: every power up to the order is reproduced.
  auto choose = [](int n, int k) { return k > n ? 0.0 : factorial(n) / factorial(k) / factorial(n - k); };
  using enum CellType;
  for (CellType type : {bezier_curve, bezier_triangle, bezier_quad, bezier_tetra, bezier_hexahedron, bezier_wedge})
    for (int order = 1; order <= 10; ++order) {
      const CellShape& s = *CellShape::find(type, lattice_nodes(type, {order, order, order}));
      CAPTURE(cell_type_info(type).name);
      CAPTURE(order);
      std::vector<double> n(s.nodes());
      const Vec3 p = test::random_place(s, uint64_t(order));
      s.values(p, n.data());
      for (int d = 0; d <= order; ++d)
        for (int a = 0; a < s.dimension(); ++a) {
          double sum = 0;
          for (size_t k = 0; k < s.nodes(); ++k) sum += n[k] * choose(int(std::lround(s.node(k)[a] * order)), d) / choose(order, d);
          CHECK(sum == doctest::Approx(std::pow(p[a], d)).epsilon(1e-11));
        }
      for (double v : n) CHECK(v >= -1e-14);  // on the rim 1-r-s-t may round below 0
    }
}

TEST_CASE("cell shape: derivatives agree with differences") {
  for (const CellCase& c : test::all_cases()) {
    const CellShape& s = c.shape();
    CAPTURE(c.name());
    std::vector<double> up(c.nodes), down(c.nodes);
    std::vector<Vec3> dn(c.nodes);
    // A place well inside, so that pyramids keep away from the apex.
    const Vec3 p = lerp(test::random_place(s, 7), s.center(), 0.3);
    s.derivatives(p, dn.data());
    const double h = 1e-5;
    for (int a = 0; a < s.dimension(); ++a) {
      Vec3 q = p, r = p;
      q[a] += h, r[a] -= h;
      s.values(q, up.data()), s.values(r, down.data());
      double worst = 0, size = 1;
      for (size_t k = 0; k < c.nodes; ++k) {
        worst = std::max(worst, std::abs((up[k] - down[k]) / (2 * h) - dn[k][a]));
        size = std::max(size, std::abs(dn[k][a]));
      }
      CHECK(worst < 2e-8 * size * loss(s));
    }
  }
}

TEST_CASE("cell shape: functions of a face's nodes are those of the face's own type, the others vanish there") {
  // So that two cells that share a face, of any two types, agree on it.
  std::vector<CellCase> cases = test::fixed_cases();
  for (const CellCase& c : test::order_cases(1, 5)) cases.push_back(c);
  for (const CellCase& c : cases) {
    const CellShape& s = c.shape();
    if (s.dimension() != 3 || c.orders[0] > 0) continue;
    CAPTURE(c.name());
    const CellFaces& faces = cell_faces(c.type, c.nodes);
    CHECK(faces.size() >= 4);
    std::vector<double> n(c.nodes);
    for (size_t f = 0; f < faces.size(); ++f) {
      const auto nodes = faces.face(f);
      const CellShape* flat = CellShape::find(faces.type[f], nodes.size());
      REQUIRE(flat);
      std::vector<double> m(nodes.size());
      const Vec3 uv = test::random_place(*flat, f);
      flat->values(uv, m.data());
      Vec3 p;
      for (size_t k = 0; k < nodes.size(); ++k) p += s.node(nodes[k]) * m[k];
      s.values(p, n.data());
      double worst = 0;
      for (size_t k = 0; k < nodes.size(); ++k) worst = std::max(worst, std::abs(n[nodes[k]] - m[k])), n[nodes[k]] = 0;
      for (double v : n) worst = std::max(worst, std::abs(v));
      CHECK(worst < 1e-12 * loss(s));
    }
  }
}

TEST_CASE("cell shape: quadrature integrates monomials of its degree exactly") {
  using enum CellType;
  for (CellType type : {line, triangle, quad, pixel, tetra, hexahedron, voxel, wedge}) {
    const CellShape& s = *CellShape::find(type, size_t(cell_type_info(type).points));
    CAPTURE(cell_type_info(type).name);
    for (int degree = 0; degree <= 20; ++degree) {
      const auto& q = s.quadrature(degree);
      double worst = 0;
      for (int a = 0; a <= degree; ++a)
        for (int b = 0; a + b <= degree; ++b)
          for (int c = 0; a + b + c <= degree; ++c) {
            if ((s.dimension() < 2 && b > 0) || (s.dimension() < 3 && c > 0)) continue;
            double sum = 0;
            for (size_t i = 0; i < q.at.size(); ++i) sum += q.weight[i] * power(q.at[i], a, b, c);
            const double exact = closed_integral(type, a, b, c);
            worst = std::max(worst, std::abs(sum / exact - 1));
          }
      CHECK(worst < 2e-13);
      for (Vec3 p : q.at) CHECK(s.outside(p) < 0);
    }
  }
}

TEST_CASE("cell shape: quadrature of the pyramid, centred monomials in closed form") {
  // x = r - 1/2: the section at t has half-width (1-t)/2, so the integral is 0 for odd powers and a beta function otherwise.
  const CellShape& s = *CellShape::find(CellType::pyramid, 5);
  for (int degree = 0; degree <= 12; ++degree) {
    const auto& q = s.quadrature(degree);
    for (int a = 0; a <= degree; ++a)
      for (int b = 0; a + b <= degree; ++b) {
        const int c = degree - a - b, m = a + b + 2;
        double sum = 0;
        for (size_t i = 0; i < q.at.size(); ++i) sum += q.weight[i] * power(q.at[i] - Vec3(0.5, 0.5, 0), a, b, c);
        const double flat = a % 2 || b % 2 ? 0 : 4 * std::pow(0.5, m) / ((a + 1) * (b + 1));
        const double exact = flat * factorial(m) * factorial(c) / factorial(m + c + 1);
        CHECK(sum == doctest::Approx(exact).epsilon(1e-12));
      }
  }
  double volume = 0;
  for (double w : s.quadrature(2).weight) volume += w;
  CHECK(volume == doctest::Approx(s.reference_measure()).epsilon(1e-14));
}

TEST_CASE("cell shape: clamping is the nearest place, and leaves places inside alone") {
  using enum CellType;
  for (CellType type : {vertex, line, triangle, quad, pixel, tetra, hexahedron, wedge, pyramid}) {
    const CellShape& s = *CellShape::find(type, size_t(cell_type_info(type).points));
    CAPTURE(cell_type_info(type).name);
    for (uint64_t i = 0; i < 200; ++i) {
      Vec3 p;
      for (int a = 0; a < s.dimension(); ++a) p[a] = 3 * random_unit(i, uint64_t(a)) - 1;
      const Vec3 q = s.clamped(p);
      CHECK(s.outside(q) <= 1e-15);
      if (s.outside(p) <= 0) CHECK(length(p - q) < 1e-15);
      if (type == pyramid) continue;
      // No random place inside is nearer.
      for (uint64_t j = 0; j < 20; ++j) {
        const Vec3 other = test::random_place(s, 1000 + j);
        CHECK(length(p - q) <= length(p - other) + 1e-14);
      }
    }
  }
}

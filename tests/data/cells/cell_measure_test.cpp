// SPDX-License-Identifier: Apache-2.0
// Lengths, areas, volumes, integrals and gradients of cells.
#include <algorithm>

#include "cell_cases.h"
#include "data/cells/shape/cell_map.h"
#include "support/test.h"

using namespace sg;
using test::CellCase;

namespace {

// A matrix with determinant 2 * 1.5 * 1.2 + shear that no axis escapes.
Vec3 affine(Vec3 p) { return {1 + 2 * p.x + 0.3 * p.y - 0.1 * p.z, -2 + 1.5 * p.y + 0.2 * p.z, 4 + 0.1 * p.x + 1.2 * p.z}; }
const double affine_determinant = 2 * (1.5 * 1.2) - 0.3 * (0 * 1.2 - 0.2 * 0.1) + -0.1 * (0 - 1.5 * 0.1);

std::vector<Vec3> moved(const CellShape& s, Vec3 (*f)(Vec3)) {
  std::vector<Vec3> at;
  for (size_t k = 0; k < s.nodes(); ++k) at.push_back(f(s.node(k)));
  return at;
}

std::vector<Vec3> shaken(const CellShape& s, uint64_t seed) {
  const auto o = s.orders();
  const int order = std::max({o[0], o[1], o[2]});
  std::vector<Vec3> at;
  for (size_t k = 0; k < s.nodes(); ++k) at.push_back(affine(s.node(k) + test::random_vector(seed, k) * (0.6 / std::pow(1.6, order))));
  return at;
}

// 1/3 of the flux of x through the curved faces, by the faces' own 2D functions.
double flux_volume(const CellCase& c, const std::vector<Vec3>& at) {
  const CellFaces& faces = cell_faces(c.type, c.nodes);
  double sum = 0;
  for (size_t f = 0; f < faces.size(); ++f) {
    const auto nodes = faces.face(f);
    const CellShape& s = *CellShape::find(faces.type[f], nodes.size());
    const auto& q = s.quadrature(3 * std::max(s.orders()[0], 1) + 2);
    std::vector<double> n(nodes.size());
    std::vector<Vec3> dn(nodes.size());
    for (size_t i = 0; i < q.at.size(); ++i) {
      s.functions(q.at[i], n.data(), dn.data());
      Vec3 x, u, v;
      for (size_t k = 0; k < nodes.size(); ++k) x += at[nodes[k]] * n[k], u += at[nodes[k]] * dn[k].x, v += at[nodes[k]] * dn[k].y;
      sum += q.weight[i] * dot(x, cross(u, v)) / 3;
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("cell measure: a stretched reference element has the determinant times its measure, a mirrored solid a negative one") {
  std::vector<CellCase> cases = test::fixed_cases();
  for (const CellCase& c : test::order_cases(1, 10)) cases.push_back(c);
  for (const CellCase& c : cases) {
    CAPTURE(c.name());
    const CellShape& s = c.shape();
    if (s.dimension() == 0) continue;
    CellMap m(test::one_cell(c.type, moved(s, affine), c.orders));
    m.open(0);
    const Vec3 u{2, 0, 0.1}, v{0.3, 1.5, 0};
    const double stretch = s.dimension() == 3 ? affine_determinant : s.dimension() == 2 ? length(cross(u, v)) : length(u);
    CHECK(m.measure() == doctest::Approx(stretch * s.reference_measure()).epsilon(1e-10));
    if (s.dimension() < 3) continue;
    CellMap mirrored(test::one_cell(c.type, moved(s, [](Vec3 p) { return affine({p.x, p.y, -p.z}); }), c.orders));
    mirrored.open(0);
    CHECK(mirrored.measure() == doctest::Approx(-affine_determinant * s.reference_measure()).epsilon(1e-10));
  }
}

TEST_CASE("cell measure: the volume of every distorted solid is the flux through its faces, so they point outward") {
  std::vector<CellCase> cases = test::fixed_cases();
  for (const CellCase& c : test::order_cases(1, 6)) cases.push_back(c);
  for (const CellCase& c : cases) {
    const CellShape& s = c.shape();
    if (s.dimension() != 3 || c.orders[0] > 0) continue;
    CAPTURE(c.name());
    const std::vector<Vec3> at = shaken(s, 3);
    CellMap m(test::one_cell(c.type, at));
    m.open(0);
    CHECK(m.measure() > 0);
    CHECK(m.measure() == doctest::Approx(flux_volume(c, at)).epsilon(1e-9));
  }
}

TEST_CASE("cell measure: wedges in VTK's and the mirrored order have volumes of opposite sign") {
  const std::vector<Vec3> at{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 2}, {1, 0, 2}, {0, 1, 2}};
  CellMap m(test::one_cell(CellType::wedge, at));
  m.open(0);
  CHECK(m.measure() == doctest::Approx(1).epsilon(1e-14));
  CellMap other(test::one_cell(CellType::wedge, {at[0], at[2], at[1], at[3], at[5], at[4]}));
  other.open(0);
  CHECK(other.measure() == doctest::Approx(-1).epsilon(1e-14));
  CellPlace place;
  CHECK(other.locate({0.2, 0.3, 1}, place));
  CHECK_FALSE(other.locate({0.6, 0.6, 1}, place));
}

TEST_CASE("cell measure: the integral weights sum to the measure and integrate linear fields exactly") {
  std::vector<CellCase> cases = test::fixed_cases();
  for (const CellCase& c : test::order_cases(1, 6)) cases.push_back(c);
  for (const CellCase& c : cases) {
    const CellShape& s = c.shape();
    if (s.dimension() == 0) continue;
    CAPTURE(c.name());
    for (bool mirrored : {false, true}) {
      std::vector<Vec3> at = moved(s, affine);
      if (mirrored)
        for (Vec3& p : at) p.z = -p.z;
      CellMap m(test::one_cell(c.type, at, c.orders));
      m.open(0);
      std::vector<double> w(c.nodes);
      m.integration_weights(w);
      double sum = 0;
      Vec3 moment;
      for (size_t k = 0; k < c.nodes; ++k) sum += w[k], moment += at[k] * w[k];
      CHECK(sum == doctest::Approx(std::abs(m.measure())).epsilon(1e-10));
      // The centre of mass of an affine image: pyramids, simplices and boxes have it at the shape's centre.
      CHECK(length(moment / sum - m.position(s.center())) < 1e-9);
    }
  }
}

TEST_CASE("cell measure: gradients of a linear field are exact on distorted cells, and their weights sum to zero") {
  std::vector<CellCase> cases = test::fixed_cases();
  for (const CellCase& c : test::order_cases(1, 8)) cases.push_back(c);
  const Vec3 slope{0.7, -1.1, 0.4};
  for (const CellCase& c : cases) {
    const CellShape& s = c.shape();
    if (s.dimension() == 0) continue;
    CAPTURE(c.name());
    const std::vector<Vec3> at = shaken(s, 8);
    CellMap m(test::one_cell(c.type, at, c.orders));
    m.open(0);
    std::vector<double> f;
    for (Vec3 p : at) f.push_back(3 + dot(slope, p));
    CellPlace place;
    place.rst = lerp(test::random_place(s, 4), s.center(), 0.2);
    const Mat3 j = m.jacobian(place.rst);
    Vec3 want = slope;
    if (s.dimension() == 2) {
      const Vec3 normal = normalize(cross(j.column(0), j.column(1)));
      want = slope - normal * dot(normal, slope);
    } else if (s.dimension() == 1) {
      const Vec3 t = normalize(j.column(0));
      want = t * dot(t, slope);
    }
    CHECK(length(m.gradient(place, f) - want) < 1e-8);
    std::vector<Vec3> g(c.nodes);
    m.gradient_weights(place, g);
    Vec3 sum;
    for (Vec3 v : g) sum += v;
    CHECK(length(sum) < 1e-8);
  }
}

TEST_CASE("cell measure: a disc of quadratic triangles has the area of its parabolic arcs, with order 4") {
  const double known[] = {3.1045695, 3.1391476, 3.1414377};
  double h[3], error[3];
  for (int level = 0; level < 3; ++level) {
    const int m = 4 << level;
    double area = 0;
    auto at = [&](double turn) { return Vec3(std::cos(2 * M_PI * turn / m), std::sin(2 * M_PI * turn / m), 0); };
    for (int i = 0; i < m; ++i) {
      const Vec3 a = at(i), b = at(i + 1);
      CellMap map(test::one_cell(CellType::quadratic_triangle, {{0, 0, 0}, a, b, a * 0.5, at(i + 0.5), b * 0.5}));
      map.open(0);
      area += map.measure();
    }
    CHECK(area == doctest::Approx(known[level]).epsilon(2e-8));
    h[level] = 1.0 / m, error[level] = M_PI - area;
  }
  CHECK(test::observed_order(h, error, 3) == doctest::Approx(4).epsilon(0.02));
}

TEST_CASE("cell measure: a rational Bezier quarter circle is exact, and so are ring and shell") {
  const double w = std::sqrt(0.5);
  // VTK's order: ends first, the middle last.
  CellMap arc(test::one_cell(CellType::bezier_curve, {{1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {}, {1, 1, w}));
  arc.open(0);
  for (int i = 0; i <= 50; ++i) CHECK(length(arc.position({i / 50.0, 0, 0})) == doctest::Approx(1).epsilon(1e-14));
  CHECK(arc.measure() == doctest::Approx(M_PI / 2).epsilon(1e-11));
  // A quarter ring of radii 1 and 3, order 2 around and 1 across: (3-1)^2... area pi/4 (9 - 1).
  std::vector<Vec3> at(6);
  std::vector<double> weights(6);
  const Vec3 ring[3] = {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 3; ++i) {
      const uint32_t node = lattice_node(CellType::bezier_quad, {1, 2, 0}, j, i);
      at[node] = ring[i] * (j ? 3.0 : 1.0), weights[node] = i == 1 ? w : 1;
    }
  CellMap quarter(test::one_cell(CellType::bezier_quad, at, {1, 2, 0}, weights));
  quarter.open(0);
  CHECK(quarter.measure() == doctest::Approx(2 * M_PI).epsilon(1e-11));
  std::vector<double> n(6);
  CellPlace place;
  for (int i = 0; i < 20; ++i) {
    const double turn = M_PI / 2 * random_unit(1, uint64_t(i)), radius = 1 + 2 * random_unit(2, uint64_t(i));
    const Vec3 x{radius * std::cos(turn), radius * std::sin(turn), 0};
    REQUIRE(quarter.locate(x, place, 1e-9));
    CHECK(place.rst.x == doctest::Approx((radius - 1) / 2).epsilon(1e-7));
    quarter.weights(place, n);
    double sum = 0;
    Vec3 p;
    for (size_t k = 0; k < 6; ++k) sum += n[k], p += at[k] * n[k];
    CHECK(sum == doctest::Approx(1).epsilon(1e-14));
    CHECK(length(p - x) < 1e-8);
  }
  // The same ring, 2 high: volume 4 pi, and the radius is found from the place.
  std::vector<Vec3> solid(12);
  std::vector<double> solid_weights(12);
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 3; ++i) {
        const uint32_t node = lattice_node(CellType::bezier_hexahedron, {1, 2, 1}, j, i, k);
        solid[node] = ring[i] * (j ? 3.0 : 1.0) + Vec3(0, 0, 2.0 * k), solid_weights[node] = i == 1 ? w : 1;
      }
  CellMap shell(test::one_cell(CellType::bezier_hexahedron, solid, {1, 2, 1}, solid_weights));
  shell.open(0);
  CHECK(shell.measure() == doctest::Approx(4 * M_PI).epsilon(1e-10));
  CHECK(shell.locate({std::sqrt(2.0), std::sqrt(2.0), 0.5}, place));
  CHECK(place.rst.x == doctest::Approx(0.5).epsilon(1e-9));
  CHECK_FALSE(shell.locate({0.7, 0.7, 0.5}, place));
  CHECK(place.outside == doctest::Approx((1 - 0.7 * std::sqrt(2.0)) / 2).epsilon(1e-6));
}

TEST_CASE("cell measure: rational weights of any order keep the partition of unity and their derivatives the differences") {
  for (const CellCase& c : test::order_cases(1, 10)) {
    if (!is_bezier(c.type) || c.nodes > 400) continue;
    CAPTURE(c.name());
    const CellShape& s = c.shape();
    std::vector<Vec3> at = moved(s, affine);
    std::vector<double> w, n(c.nodes);
    for (size_t k = 0; k < c.nodes; ++k) w.push_back(0.5 + random_unit(9, k));
    CellMap m(test::one_cell(c.type, at, c.orders, w));
    m.open(0);
    CellPlace place;
    place.rst = lerp(test::random_place(s, 3), s.center(), 0.3);
    m.weights(place, n);
    double sum = 0;
    for (double v : n) {
      sum += v;
      CHECK(v >= -1e-15);
    }
    CHECK(sum == doctest::Approx(1).epsilon(1e-13));
    const Mat3 j = m.jacobian(place.rst);
    for (int a = 0; a < s.dimension(); ++a) {
      Vec3 step;
      step[a] = 1e-5;
      const Vec3 slope = (m.position(place.rst + step) - m.position(place.rst - step)) / 2e-5;
      CHECK(length(slope - j.column(a)) < 1e-7);
    }
  }
}

// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/mesh/finite_elements.h"

#include <cmath>
#include <numeric>
#include <vector>

#include "base/parallel.h"
#include "simulate/pde/mesh/meshes.h"
#include "support/test.h"

using namespace sg;
using namespace sg::pde;

namespace {

double total_size(const Simplices& s) {
  std::array<Vec3, 4> g;
  double sum = 0;
  for (size_t t = 0; t < s.size(); ++t) sum += simplex_gradients(s, t, g);
  return sum;
}

Stiffness unit_stiffness(const Simplices& s) { return stiffness_of(s, std::vector<double>(s.size(), 1), Context()); }

double quotient(const Stiffness& k, const std::vector<double>& u) {
  std::vector<double> out(u.size());
  apply(k, 0, 1, u, out, Context());
  double above = 0, below = 0;
  for (size_t i = 0; i < u.size(); ++i) above += u[i] * out[i], below += k.mass[i] * u[i] * u[i];
  return above / below;
}

}  // namespace

TEST_CASE("simplices: they fill the box, meet in whole facets, and their border is that of the box") {
  for (const bool flat : {false, true}) {
    const Simplices s = simplices_of(test::shaken_grid(5, 0.2, flat), "test", Context());
    CHECK(s.size() == (flat ? 50 : 750));
    CHECK(total_size(s) == doctest::Approx(1).epsilon(1e-12));
    const auto border = border_points(s);
    for (size_t i = 0; i < s.at.size(); ++i) {
      const Vec3 p = s.at[i];
      const bool outside = p.x == 0 || p.x == 1 || p.y == 0 || p.y == 1 || (!flat && (p.z == 0 || p.z == 1));
      CHECK((border[i] != 0) == outside);
    }
  }
  const auto closed = border_points(simplices_of(test::sphere_mesh(2), "test", Context()));
  CHECK(std::accumulate(closed.begin(), closed.end(), 0) == 0);
}

TEST_CASE("finite elements: on triangles the weights are half the sums of cotangents, masses a third of the areas about a point") {
  // Two triangles over the edge 0-1, of angles 60 and 90 degrees opposite of it.
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0, 2, 0, 0, 1, std::sqrt(3.0), 0, 1, 0, 1}, 3);
  m.cells.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2, 1, 0, 3});
  m.cells.fixed = 3, m.single_type = CellType::triangle;
  const Stiffness k = unit_stiffness(simplices_of(make_dataset(m), "test", Context()));
  const auto weight = [&](size_t i, uint32_t j) {
    for (size_t e = k.begin[i]; e < k.begin[i + 1]; ++e)
      if (k.column[e] == j) return k.value[e];
    return 0.0;
  };
  CHECK(weight(0, 1) == doctest::Approx(-(1 / std::sqrt(3.0) + 0) / 2));
  CHECK(weight(1, 0) == doctest::Approx(weight(0, 1)));
  CHECK(weight(0, 3) == doctest::Approx(-0.5));  // opposite of it 45 degrees
  CHECK(weight(2, 3) == 0);
  CHECK(k.mass[0] == doctest::Approx((std::sqrt(3.0) + 1) / 3));
  CHECK(k.mass[3] == doctest::Approx(1.0 / 3));
}

TEST_CASE("finite elements: constants have no flow, and linear functions none inside of tetrahedra at random") {
  const Simplices s = simplices_of(test::shaken_grid(6, 0.35), "test", Context());
  const Stiffness k = unit_stiffness(s);
  const auto border = border_points(s);
  std::vector<double> one(s.at.size(), 1), linear(s.at.size()), out(s.at.size());
  for (size_t i = 0; i < linear.size(); ++i) linear[i] = 3 * s.at[i].x - 2 * s.at[i].y + s.at[i].z - 1;
  apply(k, 0, 1, one, out, Context());
  for (const double v : out) CHECK(std::abs(v) < 1e-12);
  apply(k, 0, 1, linear, out, Context());
  for (size_t i = 0; i < out.size(); ++i) CHECK((border[i] || std::abs(out[i]) < 1e-11));
  CHECK(quotient(k, linear) > 0);
}

TEST_CASE("finite elements: the cotangent Laplacian of the sphere has the eigenvalues l(l+1) of its harmonics, with order 2") {
  struct Harmonic {
    int l;
    double (*f)(Vec3);
  };
  const Harmonic harmonics[] = {{1, [](Vec3 p) { return p.z; }},
                                {2, [](Vec3 p) { return p.x * p.y; }},
                                {2, [](Vec3 p) { return 3 * p.z * p.z - 1; }},
                                {3, [](Vec3 p) { return p.x * p.y * p.z; }},
                                {4, [](Vec3 p) { return 35 * std::pow(p.z, 4) - 30 * p.z * p.z + 3; }}};
  for (const Harmonic& y : harmonics) {
    double h[4], error[4];
    for (int i = 0; i < 4; ++i) {
      const Simplices s = simplices_of(test::sphere_mesh(i + 2), "test", Context());
      std::vector<double> u(s.at.size());
      for (size_t p = 0; p < u.size(); ++p) u[p] = y.f(s.at[p]);
      h[i] = 1.0 / (1 << i), error[i] = std::abs(quotient(unit_stiffness(s), u) - y.l * (y.l + 1));
    }
    CAPTURE(y.l);
    if (y.l == 1) {  // the energy of the embedding is twice the area: exact
      for (const double e : error) CHECK(e < 1e-12);
      continue;
    }
    CHECK(error[3] < 0.03 * y.l * y.l);
    CHECK(test::observed_order(h, error, 4) == doctest::Approx(2).epsilon(0.1));
  }
}

TEST_CASE("finite elements: the same bytes on one thread and on several") {
  const auto bytes = [](int threads) {
    set_thread_count(threads);
    const Simplices s = simplices_of(test::shaken_grid(20, 0.3), "test", Context());
    const Stiffness k = unit_stiffness(s);
    std::vector<double> x(s.at.size());
    const std::vector<double> b = k.mass;
    solve(k, 0, 1, b, border_points(s), 1e-10, 1000, x, Context());
    set_thread_count(0);
    return x;
  };
  CHECK(bytes(1) == bytes(4));
}

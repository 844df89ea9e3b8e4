// SPDX-License-Identifier: Apache-2.0
// Shape functions of MFEM's elements at the nodes of ours. A nodal basis is found from its nodes: with V the matrix of some basis of
// the same polynomials (products of Legendre polynomials, well conditioned up to order 10) at the nodes, N(x) = V^-T phi(x).
#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "io/mfem/element.h"
#include "io/mfem/polynomials.h"
#include "io/text/mesh_text.h"

namespace sg::mfem {

namespace {

std::vector<double> gauss_legendre(int n) {
  std::vector<double> x(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) {
    double t = -std::cos(M_PI * (i + 0.75) / (n + 0.5));
    for (int k = 0; k < 50; ++k) {
      const auto [p, d] = legendre(n, t);
      t -= p / d;
      if (std::fabs(p / d) < 1e-16) break;
    }
    x[size_t(i)] = n % 2 && i == n / 2 ? 0.5 : (1 + t) / 2;
  }
  return x;
}

/// -1, the zeros of P'_p, 1.
std::vector<double> gauss_lobatto(int p) {
  std::vector<double> x(size_t(p) + 1);
  x[0] = 0, x[size_t(p)] = 1;
  for (int i = 1; i < p; ++i) {
    double t = -std::cos(M_PI * i / p);
    for (int k = 0; k < 50; ++k) {
      const auto [value, d] = legendre(p, t);
      const double second = (2 * t * d - p * (p + 1) * value) / (1 - t * t);  // Legendre's equation
      t -= d / second;
      if (std::fabs(d / second) < 1e-16) break;
    }
    x[size_t(i)] = 2 * i == p ? 0.5 : (1 + t) / 2;
  }
  return x;
}

double power(double x, int n) {
  double r = 1;
  while (n-- > 0) r *= x;
  return r;
}

/// Whether the element uses simplex coordinates along (0, 1), (0, 1, 2), or none.
int simplex_axes(Geometry g) { return g == Geometry::triangle || g == Geometry::prism ? 2 : g == Geometry::tetrahedron ? 3 : 1; }

/// Position of the node at a lattice place: 1D points along tensor axes, their normalised products (Warburton's blend) on simplices.
std::array<double, 3> position(Geometry g, const std::vector<double>& points, std::array<int, 3> place) {
  const int p = int(points.size()) - 1, axes = simplex_axes(g);
  std::array<double, 3> x{};
  if (p == 0) {
    const double center = axes > 1 ? 1.0 / (axes + 1) : 0.5;
    return {center, center, g == Geometry::prism ? 0.5 : center};
  }
  for (size_t a = 0; a < 3; ++a) x[a] = points[size_t(place[a])];
  if (axes > 1) {
    int rest = p;
    double sum = 0;
    for (int a = 0; a < axes; ++a) rest -= place[size_t(a)], sum += x[size_t(a)];
    sum += points[size_t(rest)];
    for (int a = 0; a < axes; ++a) x[size_t(a)] /= sum;
  }
  return x;
}

/// Places of the nodes as MFEM lists them for discontinuous elements: x fastest.
std::vector<std::array<int, 3>> rows(Geometry g, int p) {
  std::vector<std::array<int, 3>> places;
  const int dimension = info(g).dimension;
  const bool tet = g == Geometry::tetrahedron, tri = g == Geometry::triangle || g == Geometry::prism;
  for (int k = 0; k <= (dimension > 2 ? p : 0); ++k)
    for (int j = 0; j <= (dimension > 1 ? p - (tet ? k : 0) : 0); ++j)
      for (int i = 0; i <= p - (tet ? j + k : tri ? j : 0); ++i) places.push_back({i, j, k});
  return places;
}

/// All products of Legendre polynomials that span the element's polynomials, at x; in the order of rows().
void modal(Geometry g, int p, const std::array<double, 3>& x, double* out) {
  double l[3][11];
  for (size_t a = 0; a < 3; ++a)
    for (int n = 0; n <= p; ++n) l[a][n] = legendre(n, 2 * x[a] - 1).first;
  const int dimension = info(g).dimension;
  for (const auto& m : rows(g, p)) *out++ = l[0][m[0]] * (dimension > 1 ? l[1][m[1]] : 1) * (dimension > 2 ? l[2][m[2]] : 1);
}

/// Bernstein polynomial at a lattice place.
double bernstein(Geometry g, int p, std::array<int, 3> place, const std::array<double, 3>& x) {
  const int axes = simplex_axes(g), dimension = info(g).dimension;
  double value = 1;
  if (axes > 1) {
    int rest = p;
    double last = 1;
    for (int a = 0; a < axes; ++a) {
      const int n = place[size_t(a)];
      value *= binomial(rest, n) * power(x[size_t(a)], n);
      rest -= n, last -= x[size_t(a)];
    }
    value *= power(last, rest);
  }
  for (int a = axes > 1 ? axes : 0; a < dimension; ++a) {
    const int n = place[size_t(a)];
    value *= binomial(p, n) * power(x[size_t(a)], n) * power(1 - x[size_t(a)], p - n);
  }
  return value;
}

/// Where a sample is a node its row is exact: rounding would move points that the file gives.
double cleaned(double w) { return std::fabs(w) < 1e-13 ? 0 : std::fabs(w - 1) < 1e-13 ? 1 : w; }

/// Lagrange polynomials of the points at i/q: (q + 1) x (p + 1).
std::vector<double> axis_matrix(const std::vector<double>& points, int q) {
  std::vector<double> m;
  for (int i = 0; i <= q; ++i)
    for (size_t d = 0; d < points.size(); ++d) {
      double w = 1;
      for (size_t e = 0; e < points.size(); ++e)
        if (e != d) w *= (double(i) / q - points[e]) / (points[d] - points[e]);
      m.push_back(cleaned(w));
    }
  return m;
}

/// Numbers of the places of a triangle or tetrahedron in rows().
struct SimplexNodes {
  SimplexNodes() = default;
  SimplexNodes(Geometry g, int p) : places(rows(g, p)), solid(g == Geometry::tetrahedron) {
    number.assign(1331, 0);
    for (size_t n = 0; n < places.size(); ++n) number[key(places[n])] = n;
  }
  size_t key(std::array<int, 3> a) const { return size_t(a[0] + 11 * (a[1] + 11 * (solid ? a[2] : 0))); }
  size_t at(std::array<int, 3> a) const { return number[key(a)]; }
  std::vector<std::array<int, 3>> places;
  std::vector<size_t> number;
  bool solid = false;
};

/// Nodal functions of a triangle or tetrahedron at the lattice of order q, both in the order of rows().
std::vector<double> simplex_matrix(Geometry g, const std::vector<double>& points, int q) {
  const int p = int(points.size()) - 1;
  const auto nodes = rows(g, p), samples = rows(g, q);
  const size_t n = nodes.size(), columns = samples.size();
  std::vector<double> v(n * n), b(n * columns), phi(n), m(n * columns);
  for (size_t d = 0; d < n; ++d) {  // V^T N = phi, solved for all samples at once
    modal(g, p, position(g, points, nodes[d]), phi.data());
    for (size_t k = 0; k < n; ++k) v[k * n + d] = phi[k];
  }
  for (size_t s = 0; s < columns; ++s) {
    std::array<double, 3> x{};
    for (size_t a = 0; a < 3; ++a) x[a] = double(samples[s][a]) / q;
    modal(g, p, x, phi.data());
    for (size_t k = 0; k < n; ++k) b[k * columns + s] = phi[k];
  }
  solve(v, b, n, columns);
  for (size_t s = 0; s < columns; ++s)
    for (size_t d = 0; d < n; ++d) m[s * n + d] = cleaned(b[d * columns + s]);
  return m;
}

}  // namespace

double binomial(int n, int k) {
  double r = 1;
  for (int i = 1; i <= k; ++i) r = r * double(n - k + i) / i;
  return r;
}

std::vector<double> basis_points(Basis basis, int p) {
  if (p == 0) return {0.5};
  switch (basis) {
    case Basis::gauss_legendre: return gauss_legendre(p + 1);
    case Basis::gauss_lobatto: return gauss_lobatto(p);
    default: break;
  }
  std::vector<double> x;
  for (int i = 0; i <= p; ++i)
    x.push_back(basis == Basis::open_uniform ? (i + 1.0) / (p + 2) : basis == Basis::open_half ? (i + 0.5) / (p + 1) : double(i) / p);
  return x;
}

NodeMatrix node_matrix(Geometry g, const FeCollection& c, int q, const std::string& where) {
  NodeMatrix r;
  const int p = c.order;
  r.dofs = element_dofs(g, c);
  std::vector<std::array<int, 3>> out = lattice_places(info(g).shape, g == Geometry::pyramid ? 1 : q);
  r.nodes = out.size();
  r.m.assign(r.nodes * r.dofs, 0);
  if (p == 0 || g == Geometry::point) {
    std::fill(r.m.begin(), r.m.end(), 1.0);
    return r;
  }
  if (g == Geometry::pyramid) {
    if (p > 1 || q > 1 || c.family != Family::h1)
      fail_data(fmt::format("the mesh has pyramids on which '{}' or another of its spaces is above order 1", c.name), where,
                "pyramids are supported only with continuous spaces of order 1");
    for (size_t k = 0; k < 5; ++k) r.m[k * 5 + k] = 1;
    return r;
  }
  std::vector<std::array<int, 3>> places;
  if (c.family == Family::h1 || c.listed_as_h1)
    for (const LocalNode& n : local_nodes(g, p)) places.push_back(n.place);
  else places = rows(g, p);
  if (c.inside_around && g == Geometry::cube)
    for (const size_t layer : {places.size() - 8, places.size() - 4}) std::swap(places[layer + 2], places[layer + 3]);

  auto sample = [&](size_t k) {
    std::array<double, 3> x{};
    for (size_t a = 0; a < 3; ++a) x[a] = double(out[k][a]) / q;
    return x;
  };
  if (c.basis == Basis::bernstein) {
    for (size_t k = 0; k < r.nodes; ++k)
      for (size_t d = 0; d < r.dofs; ++d) r.m[k * r.dofs + d] = bernstein(g, p, places[d], sample(k));
    return r;
  }
  const std::vector<double> points = basis_points(c.basis, p);
  const std::vector<double> along = axis_matrix(points, q);
  const int axes = simplex_axes(g), dimension = info(g).dimension;
  const Geometry face = axes == 3 ? Geometry::tetrahedron : Geometry::triangle;
  SimplexNodes from, to;
  std::vector<double> simplex;
  if (axes > 1) from = SimplexNodes(face, p), to = SimplexNodes(face, q), simplex = simplex_matrix(face, points, q);
  for (size_t k = 0; k < r.nodes; ++k)
    for (size_t d = 0; d < r.dofs; ++d) {
      double w = 1;
      if (axes > 1) w = simplex[to.at(out[k]) * from.places.size() + from.at(places[d])];
      for (int a = axes > 1 ? axes : 0; a < dimension; ++a) w *= along[size_t(out[k][size_t(a)] * (p + 1) + places[d][size_t(a)])];
      r.m[k * r.dofs + d] = w;
    }
  return r;
}

}  // namespace sg::mfem

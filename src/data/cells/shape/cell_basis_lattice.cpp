// SPDX-License-Identifier: Apache-2.0
// Lagrange and Bernstein functions of any order: products of one-dimensional factors, computed once per axis.
#include "data/cells/shape/cell_basis.h"

namespace sg::basis {

namespace {

constexpr int most = max_order + 1;

// Values and derivatives of the factors of one axis, numbered by lattice place.
struct Factors {
  double f[most], d[most];
};

// l_i(x) = prod_{j != i} (n x - j) / (i - j): products from both ends, so that nothing is divided by n x - j.
void lagrange_axis(int n, double x, Factors& out) {
  double left[most + 1], left_d[most + 1], right[most + 1], right_d[most + 1];
  left[0] = 1, left_d[0] = 0, right[n + 1] = 1, right_d[n + 1] = 0;
  for (int j = 0; j <= n; ++j) {
    const double y = n * x - j;
    left[j + 1] = left[j] * y, left_d[j + 1] = left_d[j] * y + left[j];
  }
  for (int j = n; j >= 0; --j) {
    const double y = n * x - j;
    right[j] = right[j + 1] * y, right_d[j] = right_d[j + 1] * y + right[j + 1];
  }
  double scale = 1;  // 1 / prod (i - j)
  for (int j = 1; j <= n; ++j) scale /= -j;
  for (int i = 0; i <= n; ++i) {
    out.f[i] = left[i] * right[i + 1] * scale;
    out.d[i] = n * (left_d[i] * right[i + 1] + left[i] * right_d[i + 1]) * scale;
    if (i < n) scale *= -double(n - i) / double(i + 1);
  }
}

// Bernstein polynomials by their recurrence over the order (de Casteljau's triangle).
void bernstein_axis(int n, double x, Factors& out) {
  double b[most] = {1};
  for (int m = 1; m < n; ++m) {
    b[m] = b[m - 1] * x;
    for (int i = m - 1; i > 0; --i) b[i] = b[i] * (1 - x) + b[i - 1] * x;
    b[0] *= 1 - x;
  }
  // b is of order n-1 now: it gives the derivatives.
  for (int i = 0; i <= n; ++i) {
    const double here = i < n ? b[i] : 0, before = i > 0 ? b[i - 1] : 0;
    out.f[i] = here * (1 - x) + before * x;
    out.d[i] = n * (before - here);
  }
}

// Factor a of one barycentric coordinate: Lagrange prod_{m<a} (n l - m)/(m+1), Bernstein l^a / a!.
void barycentric_axis(int n, bool bernstein, double l, Factors& out) {
  out.f[0] = 1, out.d[0] = 0;
  for (int a = 0; a < n; ++a) {
    const double y = bernstein ? l : n * l - a, dy = bernstein ? 1 : n;
    out.f[a + 1] = out.f[a] * y / (a + 1);
    out.d[a + 1] = (out.d[a] * y + out.f[a] * dy) / (a + 1);
  }
}

double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

}  // namespace

void lattice_functions(Form form, bool bernstein, int dimension, std::array<int, 3> orders, std::span<const uint16_t> place, Vec3 rst,
                       double* n, Vec3* dn) {
  const size_t nodes = place.size() / 3;
  Factors x[3], l;
  auto axis = [&](int a) {
    if (bernstein) bernstein_axis(orders[size_t(a)], rst[a], x[a]);
    else lagrange_axis(orders[size_t(a)], rst[a], x[a]);
  };
  if (form == Form::box) {
    for (int a = 0; a < 3; ++a) {
      if (a < dimension) axis(a);
      else x[a].f[0] = 1, x[a].d[0] = 0;
    }
    for (size_t k = 0; k < nodes; ++k) {
      const size_t i = place[3 * k], j = place[3 * k + 1], m = place[3 * k + 2];
      const double jm = x[1].f[j] * x[2].f[m];
      if (n) n[k] = x[0].f[i] * jm;
      if (dn) dn[k] = {x[0].d[i] * jm, x[0].f[i] * x[1].d[j] * x[2].f[m], x[0].f[i] * x[1].f[j] * x[2].d[m]};
    }
    return;
  }
  // A simplex of the first two or three coordinates, times an axis for wedges.
  const int order = orders[0], corners = form == Form::wedge ? 2 : dimension;
  double rest = 1;
  for (int a = 0; a < corners; ++a) rest -= rst[a], barycentric_axis(order, bernstein, rst[a], x[a]);
  barycentric_axis(order, bernstein, rest, l);
  if (form == Form::wedge) axis(2);
  else if (corners == 2) x[2].f[0] = 1, x[2].d[0] = 0;
  const double scale = bernstein ? factorial(order) : 1;
  for (size_t k = 0; k < nodes; ++k) {
    const size_t i = place[3 * k], j = place[3 * k + 1], m = place[3 * k + 2];
    const size_t first = size_t(order) - i - j - (corners == 3 ? m : 0);
    const double f0 = scale * l.f[first], d0 = scale * l.d[first];
    const double ij = x[0].f[i] * x[1].f[j], third = x[2].f[m];
    if (n) n[k] = f0 * ij * third;
    if (dn)
      dn[k] = {(f0 * x[0].d[i] - d0 * x[0].f[i]) * x[1].f[j] * third, (f0 * x[1].d[j] - d0 * x[1].f[j]) * x[0].f[i] * third,
               corners == 3 ? (f0 * x[2].d[m] - d0 * third) * ij : f0 * ij * x[2].d[m]};
  }
}

}  // namespace sg::basis

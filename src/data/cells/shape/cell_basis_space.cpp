// SPDX-License-Identifier: Apache-2.0
// Quadratic (serendipity) families and pyramids: each is given by its nodes and its space of functions, and the shape functions
// follow from both. A space restricted to a face is that of the face's 2D type, so neighbouring cells of any type fit.
#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "data/cells/cell_topology.h"
#include "data/cells/shape/cell_basis.h"

namespace sg::basis {

namespace {

using Powers = std::array<uint8_t, 6>;

// Appends r^a s^b for the listed (a, b), times t^c for c up to `high`.
void extrude(Space& space, std::initializer_list<Powers> flat, int high) {
  for (int c = 0; c <= high; ++c)
    for (Powers p : flat) {
      p[2] = uint8_t(p[2] + c);
      space.powers.push_back(p);
    }
}

void add_middles(CellType linear, size_t edges, std::vector<Vec3>& at) {
  const LinearTopology& t = *linear_topology(linear);
  for (size_t e = 0; e < edges; ++e) at.push_back((at[t.edges[e][0]] + at[t.edges[e][1]]) * 0.5);
}

// Pyramids: w has a positive power wherever u or v has one.
Space pyramid_space(size_t nodes) {
  Space s;
  s.pyramid = true;
  // All quadratics of (u w, v w, t), then the rational ones that the base's r^2 s and r s^2 call for.
  s.powers = {{0, 0, 0, 0}, {1, 0, 1, 0}, {0, 1, 1, 0}, {0, 0, 0, 1}, {2, 0, 2, 0}, {0, 2, 2, 0}, {0, 0, 0, 2},
              {1, 1, 2, 0}, {1, 0, 1, 1}, {0, 1, 1, 1}, {1, 1, 1, 0}, {2, 1, 2, 0}, {1, 2, 2, 0}};
  if (nodes >= 14) s.powers.push_back({2, 2, 2, 0});
  if (nodes == 19) {
    // The cubic bubbles of the four triangles, t w^2 (1-v^2)(1 +- u) and t w^2 (1-u^2)(1 +- v), and one inside.
    for (Powers p : {Powers{0, 0, 2, 1, 0, 1}, {1, 0, 2, 1, 0, 1}, {0, 0, 2, 1, 1, 0}, {0, 1, 2, 1, 1, 0}, {0, 0, 2, 1, 1, 1}})
      s.powers.push_back(p);
  }
  return s;
}

}  // namespace

Space space_of(CellType type, size_t nodes, std::vector<Vec3>& at) {
  using enum CellType;
  Space s;
  const CellType linear = linear_type(type);
  at = reference_corners(linear);
  const std::initializer_list<Powers> quadratic{{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {2, 0, 0, 0}, {1, 1, 0, 0}, {0, 2, 0, 0}};
  const std::initializer_list<Powers> bubbled{{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {2, 0, 0, 0},
                                              {1, 1, 0, 0}, {0, 2, 0, 0}, {1, 1, 0, 1}};
  const std::initializer_list<Powers> serendipity{{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {1, 1, 0, 0},
                                                  {2, 0, 0, 0}, {0, 2, 0, 0}, {2, 1, 0, 0}, {1, 2, 0, 0}};
  const Vec3 third{1.0 / 3, 1.0 / 3, 0};
  if (type == quadratic_quad) {
    add_middles(linear, 4, at);
    extrude(s, serendipity, 0);
  } else if (type == quadratic_linear_quad) {
    at.push_back({0.5, 0, 0}), at.push_back({0.5, 1, 0});
    extrude(s, {{0, 0, 0, 0}, {1, 0, 0, 0}, {2, 0, 0, 0}, {0, 1, 0, 0}, {1, 1, 0, 0}, {2, 1, 0, 0}}, 0);
  } else if (type == biquadratic_triangle || (type == lagrange_triangle && nodes == 7)) {
    s.flat_simplex = true;
    add_middles(linear, 3, at);
    at.push_back(third);
    extrude(s, bubbled, 0);
  } else if (type == quadratic_hexahedron || type == biquadratic_quadratic_hexahedron) {
    add_middles(linear, 12, at);
    if (nodes == 24) {
      // Side faces have a centre, the bottom and the top none: serendipity in (r, s), quadratic in t.
      for (Vec3 c : {Vec3(0, 0.5, 0.5), Vec3(1, 0.5, 0.5), Vec3(0.5, 0, 0.5), Vec3(0.5, 1, 0.5)}) at.push_back(c);
      extrude(s, serendipity, 2);
    } else {
      extrude(s, serendipity, 1);
      extrude(s, {{0, 0, 2, 0}, {1, 0, 2, 0}, {0, 1, 2, 0}, {1, 1, 2, 0}}, 0);
    }
  } else if (type == quadratic_wedge || type == quadratic_linear_wedge) {
    s.flat_simplex = true;
    add_middles(linear, nodes - 6, at);
    extrude(s, quadratic, 1);
    if (nodes == 15) extrude(s, {{0, 0, 2, 0}, {1, 0, 2, 0}, {0, 1, 2, 0}}, 0);
  } else if (type == lagrange_wedge && nodes == 21) {
    s.flat_simplex = true;
    add_middles(linear, 9, at);
    for (Vec3 c : {third, third + Vec3(0, 0, 1), Vec3(0.5, 0, 0.5), Vec3(0.5, 0.5, 0.5), Vec3(0, 0.5, 0.5), third + Vec3(0, 0, 0.5)})
      at.push_back(c);
    extrude(s, bubbled, 2);
  } else if (type == lagrange_tetra && nodes == 15) {
    add_middles(linear, 6, at);
    for (Vec3 c : {third, Vec3(1, 0, 1) / 3.0, Vec3(1, 1, 1) / 3.0, Vec3(0, 1, 1) / 3.0, Vec3(0.25, 0.25, 0.25)}) at.push_back(c);
    extrude(s, quadratic, 0);
    extrude(s, {{0, 0, 1, 0}, {0, 0, 2, 0}, {1, 0, 1, 0}, {0, 1, 1, 0}}, 0);
    extrude(s, {{1, 1, 0, 1}, {1, 0, 1, 1}, {0, 1, 1, 1}, {1, 1, 1, 0}, {1, 1, 1, 1}}, 0);
  } else if (linear == pyramid && (nodes == 13 || nodes == 14 || nodes == 19) && type != bezier_pyramid) {
    add_middles(linear, 8, at);
    if (nodes >= 14) at.push_back({0.5, 0.5, 0});
    if (nodes == 19) {
      for (size_t i = 0; i < 4; ++i) at.push_back((at[i] + at[(i + 1) % 4] + at[4]) / 3.0);
      at.push_back({0.5, 0.5, 0.25});
    }
    s = pyramid_space(nodes);
  }
  return s;
}

void space_functions(const Space& space, Vec3 p, double* f, Vec3* df) {
  constexpr int high = 4;
  double x[6] = {p.x, p.y, p.z, space.flat_simplex ? 1 - p.x - p.y : 1 - p.x - p.y - p.z, 1, 1};
  if (space.pyramid) {
    const double w = 1 - p.z;
    x[0] = w != 0 ? (2 * p.x - 1) / w : 0, x[1] = w != 0 ? (2 * p.y - 1) / w : 0, x[2] = w, x[3] = p.z;
    x[4] = 1 - x[0] * x[0], x[5] = 1 - x[1] * x[1];
  }
  double power[6][high];
  for (int a = 0; a < 6; ++a) {
    power[a][0] = 1;
    for (int i = 1; i < high; ++i) power[a][i] = power[a][i - 1] * x[a];
  }
  auto slope = [&](int a, int e) { return e > 0 ? e * power[a][e - 1] : 0.0; };
  for (size_t i = 0; i < space.powers.size(); ++i) {
    const Powers e = space.powers[i];
    const double a = power[0][e[0]], b = power[1][e[1]], c = power[2][e[2]], d = power[3][e[3]];
    const double g = power[4][e[4]], h = power[5][e[5]];
    if (f) f[i] = a * b * c * d * g * h;
    if (!df) continue;
    if (space.pyramid) {
      // du/dr = 2/w and du/dt = u/w: one power of w takes the division.
      const double lower = e[2] > 0 ? power[2][e[2] - 1] : 0;
      const double du = (slope(0, e[0]) * g - 2 * x[0] * a * slope(4, e[4])) * b * h * d;
      const double dv = (slope(1, e[1]) * h - 2 * x[1] * b * slope(5, e[5])) * a * g * d;
      df[i] = {2 * du * lower, 2 * dv * lower, (x[0] * du + x[1] * dv) * lower + a * b * g * h * (c * slope(3, e[3]) - e[2] * lower * d)};
    } else {
      const double l = a * b * c * slope(3, e[3]);
      df[i] = {slope(0, e[0]) * b * c * d - l, a * slope(1, e[1]) * c * d - l, a * b * slope(2, e[2]) * d - (space.flat_simplex ? 0 : l)};
    }
  }
}

std::vector<double> nodal_coefficients(const Space& space, std::span<const Vec3> at) {
  const size_t n = at.size();
  if (space.powers.size() != n) fail_internal(fmt::format("{} functions for {} nodes", space.powers.size(), n));
  // Rows: [f_i(at_j) as column j | unit matrix], Gauss-Jordan with pivots. C^T = V^-1 with V[j][i] = f_i(at_j).
  std::vector<double> m(n * 2 * n, 0.0), f(n);
  auto row = [&](size_t r) { return m.data() + r * 2 * n; };
  for (size_t j = 0; j < n; ++j) {
    space_functions(space, at[j], f.data(), nullptr);
    std::copy(f.begin(), f.end(), row(j));
    row(j)[n + j] = 1;
  }
  for (size_t c = 0; c < n; ++c) {
    size_t pivot = c;
    for (size_t r = c + 1; r < n; ++r)
      if (std::abs(row(r)[c]) > std::abs(row(pivot)[c])) pivot = r;
    if (!(std::abs(row(pivot)[c]) > 1e-9)) fail_internal("the nodes of a cell do not determine its shape functions");
    std::swap_ranges(row(c), row(c) + 2 * n, row(pivot));
    const double scale = 1 / row(c)[c];
    for (size_t i = 0; i < 2 * n; ++i) row(c)[i] *= scale;
    for (size_t r = 0; r < n; ++r) {
      const double k = row(r)[c];
      if (r == c || k == 0) continue;
      for (size_t i = 0; i < 2 * n; ++i) row(r)[i] -= k * row(c)[i];
    }
  }
  std::vector<double> out(n * n);
  for (size_t k = 0; k < n; ++k)
    for (size_t i = 0; i < n; ++i) {
      const double c = row(i)[n + k], nearest = std::round(c * 256) / 256;  // they are such fractions; take the rounding out
      out[k * n + i] = std::abs(c - nearest) < 1e-9 ? nearest : c;
    }
  return out;
}

}  // namespace sg::basis

// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/zeros/linearisation.h"

#include <algorithm>
#include <functional>

#include "filter/flow/eigen_general.h"

namespace sg {

namespace {

// Below these parts of the largest eigenvalue a real eigenvalue is zero, and a pair of complex ones a double one.
constexpr double zero_part = 1e-9, real_part = 1e-7;

// A vector v with m v = 0; the k-th of several. A matrix of rank 2 has one, and then k does not matter.
Vec3 null_vector(const Mat3& m, int k, double scale) {
  const Vec3 row[3] = {{m.m[0][0], m.m[0][1], m.m[0][2]}, {m.m[1][0], m.m[1][1], m.m[1][2]}, {m.m[2][0], m.m[2][1], m.m[2][2]}};
  Vec3 best, longest;
  for (int i = 0; i < 3; ++i) {
    const Vec3 c = cross(row[i], row[(i + 1) % 3]);
    if (length(c) > length(best)) best = c;
    if (length(row[i]) > length(longest)) longest = row[i];
  }
  if (length(best) > 1e-7 * scale * scale) return normalize(best);
  const Vec3 axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  if (!(length(longest) > 1e-7 * scale)) return axis[k];
  const Vec3 n = normalize(longest);
  int small = 0;
  for (int a = 1; a < 3; ++a)
    if (std::abs(n[a]) < std::abs(n[small])) small = a;
  const Vec3 u = normalize(cross(n, axis[small]));
  return k % 2 ? cross(n, u) : u;
}

double largest_entry(const Mat3& m) {
  double s = 0;
  for (const auto& row : m.m)
    for (const double e : row) s = std::max(s, std::abs(e));
  return s;
}

// Sorts and sets the class; `r.index` is that of the signs.
void classify(Linearisation& r, double weak) {
  double largest = 0;
  for (int k = 0; k < r.count; ++k) largest = std::max(largest, std::hypot(r.re[size_t(k)], r.im[size_t(k)]));
  int in = 0, out = 0, complex = 0;
  bool is_centre = false, zero = !(largest > 0);
  r.index = 1;
  for (size_t k = 0; k < size_t(r.count); ++k) {
    complex += r.im[k] != 0;
    if (r.im[k] != 0) is_centre = is_centre || std::abs(r.re[k]) <= weak * std::abs(r.im[k]);
    else if (std::abs(r.re[k]) <= zero_part * largest) zero = true;
    in += r.re[k]<0, out += r.re[k]> 0;
    if (r.im[k] == 0 && r.re[k] < 0) r.index = -r.index;
  }
  using enum CriticalType;
  if (zero) r.type = degenerate, r.index = 0;
  else if (is_centre) r.type = CriticalType::centre;
  else if (in == r.count) r.type = complex ? attracting_focus : attracting_node;
  else if (out == r.count) r.type = complex ? repelling_focus : repelling_node;
  else if (r.count == 2) r.type = saddle;
  else r.type = in == 1 ? (complex ? spiral_saddle_1_in : saddle_1_in) : (complex ? spiral_saddle_2_in : saddle_2_in);
}

}  // namespace

std::string_view critical_type_name(CriticalType t) {
  constexpr std::string_view names[critical_types] = {"degenerate",
                                                      "saddle",
                                                      "attracting node",
                                                      "repelling node",
                                                      "attracting focus",
                                                      "repelling focus",
                                                      "centre",
                                                      "saddle, 1 in 2 out",
                                                      "saddle, 2 in 1 out",
                                                      "spiral saddle, 1 in 2 out",
                                                      "spiral saddle, 2 in 1 out"};
  return names[int(t)];
}

Linearisation linearise(const Mat3& m, double centre) {
  Linearisation r;
  r.count = 3;
  const double scale = largest_entry(m);
  if (!(scale > 0)) {
    r.vector = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    return r;
  }
  const GeneralEigenvalues e = general_eigenvalues(m);
  const bool spirals = e.complex_pair && e.im >= real_part * scale;
  auto shifted = [&](double value) {
    Mat3 s = m;
    for (int i = 0; i < 3; ++i) s.m[i][i] -= value;
    return s;
  };
  if (spirals) {
    // The plane of the pair is across the left eigenvector of the real one.
    const Vec3 along = null_vector(shifted(e.real[0]), 0, scale), left = null_vector(transpose(shifted(e.real[0])), 0, scale);
    Vec3 x = cross(left, std::abs(left.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0));
    x = normalize(x);
    const Vec3 y = normalize((e.re * x - m * x) / e.im);
    const size_t real = e.real[0] >= e.re ? 0 : 2, pair = e.real[0] >= e.re ? 1 : 0;
    r.re[real] = e.real[0], r.vector[real] = along;
    r.re[pair] = r.re[pair + 1] = e.re, r.im[pair] = e.im, r.im[pair + 1] = -e.im;
    r.vector[pair] = x, r.vector[pair + 1] = y;
  } else {
    if (e.complex_pair) r.re = {e.real[0], e.re, e.re};
    else r.re = {e.real[0], e.real[1], e.real[2]};
    std::sort(r.re.begin(), r.re.end(), std::greater<>());
    int same = 0;
    for (size_t k = 0; k < 3; ++k) {
      same = k > 0 && std::abs(r.re[k] - r.re[k - 1]) < real_part * scale ? same + 1 : 0;
      r.vector[k] = null_vector(shifted(r.re[k]), same, scale);
    }
  }
  classify(r, centre);
  return r;
}

Linearisation linearise_in_plane(const Mat3& m, Vec3 e1, Vec3 e2, double centre) {
  Linearisation r;
  r.count = 2;
  const Vec3 m1 = m * e1, m2 = m * e2;
  const double a = dot(e1, m1), b = dot(e1, m2), c = dot(e2, m1), d = dot(e2, m2);
  const double scale = std::max({std::abs(a), std::abs(b), std::abs(c), std::abs(d)});
  r.vector = {e1, e2, Vec3()};
  if (!(scale > 0)) return r;
  const double mean = (a + d) / 2, half = (a - d) / 2, square = half * half + b * c;
  if (square < -real_part * real_part * scale * scale) {
    const double im = std::sqrt(-square);
    r.re = {mean, mean, 0}, r.im = {im, -im, 0};
    // (m - mean) x = -im y
    r.vector[1] = normalize(-(half * e1 + c * e2) / im);
  } else {
    const double root = std::sqrt(std::max(square, 0.0));
    // The larger one without cancellation, the other from the product.
    const double large = mean + std::copysign(root, mean), small = large != 0 ? (a * d - b * c) / large : -root;
    r.re = {std::max(large, small), std::min(large, small), 0};
    for (size_t k = 0; k < 2; ++k) {
      const double x = r.re[k];
      // Rows (a - x, b) and (c, d - x): a vector across the longer.
      const double l1 = std::hypot(a - x, b), l2 = std::hypot(c, d - x);
      if (std::max(l1, l2) <= 1e-9 * scale) r.vector[k] = k ? e2 : e1;
      else r.vector[k] = normalize(l1 >= l2 ? b * e1 + (x - a) * e2 : (x - d) * e1 + c * e2);
    }
  }
  classify(r, centre);
  return r;
}

}  // namespace sg

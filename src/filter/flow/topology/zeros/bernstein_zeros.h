// SPDX-License-Identifier: Apache-2.0
// All zeros of a system of 2 or 3 polynomials in a box, triangle, tetrahedron or prism.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"

namespace sg {

/// Where zeros count: [0,1]^d, or the part of it with x+y(+z) <= 1, or the prism x+y <= 1.
enum class ZeroDomain : uint8_t { box, simplex, prism };

/// Zeros that far outside still count: the neighbour may miss them by rounding.
constexpr double zero_margin = 1e-9;

/// As many polynomials as variables, each of one degree in every variable, by Bernstein coefficients (of degree 1: the corners' values).
/// A box is left out when the coefficients there have one sign, with the components as they are or after multiplication with the inverse
/// of the mean gradient; it holds one zero at most when the gradients differ by less than 1 from the mean one (then Krawczyk's operator
/// shrinks it); else it is halved. Not thread-safe: one per thread.
class BernsteinZeros {
 public:
  BernsteinZeros(int dimension, int degree);
  int dimension() const { return dimension_; }
  int degree() const { return degree_; }
  size_t size() const { return size_; }  ///< (degree + 1)^dimension coefficients, x fastest
  std::span<double> coefficients(int component) { return std::span(c_).subspan(size_t(component) * size_, size_); }

  /// Appends the zeros in the domain, or within zero_margin of it; accurate to 1e-12 where the gradient is regular. `known`: segments on
  /// which all components vanish; what lies about them is not searched below 1/32. False when zeros are not isolated (more boxes than
  /// isolated ones need); what was found until then has been appended.
  bool solve(ZeroDomain domain, std::vector<Vec3>& zeros, std::span<const std::array<Vec3, 2>> known = {});
  Vec3 value(Vec3 u) const;
  /// m[i][j] = d f_i / d u_j.
  Mat3 gradient(Vec3 u) const;

 private:
  struct Box {
    Vec3 lo, hi;
  };
  void restrict_to(const Box& box);
  bool one_sign() const;
  bool polish(Vec3& u) const;
  void add(Vec3 u, ZeroDomain domain, std::vector<Vec3>& zeros, size_t first) const;
  /// 0: no zero in it; 1: it was shrunk; 2: it was shrunk to what holds one zero, near `u`; 3: halve it.
  int examine(Box& box, Vec3& u);

  int dimension_, degree_;
  size_t size_;
  std::vector<double> c_, part_, work_;
  std::array<double, 3> largest_{};
  std::vector<Box> stack_;
};

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Reverse automatic differentiation: a tape of what was computed, whose one sweep backwards gives the derivatives by all inputs at once.
// Over duals it gives products of the Hessian matrix with their directions.
#pragma once
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/autodiff/functions.h"

namespace sg::autodiff {

template <class T>
class Tape;

/// A number on a tape, or a constant. Compares by its plain value.
template <class T = double>
struct Var {
  using Inner = T;
  T value{};
  Tape<T>* tape = nullptr;
  int32_t node = -1;  ///< -1: a constant

  Var() = default;
  template <class U>
  requires std::convertible_to<const U&, T> Var(const U& v) : value(v) {}  // NOLINT: numbers mix with plain ones

  Var through(const T& f, const T& slope) const {
    Var r(f);
    if (tape) r.tape = tape, r.node = tape->add(node, slope, -1, T(0));
    return r;
  }
  Var through(const Var& b, const T& f, const T& slope_a, const T& slope_b) const {
    if (!tape) return b.through(f, slope_b);
    if (!b.tape) return through(f, slope_a);
    Var r(f);
    r.tape = tape, r.node = tape->add(node, slope_a, b.node, slope_b);
    return r;
  }

  friend Var operator+(const Var& a, const Var& b) { return a.through(b, a.value + b.value, T(1), T(1)); }
  friend Var operator-(const Var& a, const Var& b) { return a.through(b, a.value - b.value, T(1), T(-1)); }
  friend Var operator-(const Var& a) { return a.through(-a.value, T(-1)); }
  friend Var operator*(const Var& a, const Var& b) { return a.through(b, a.value * b.value, b.value, a.value); }
  friend Var operator/(const Var& a, const Var& b) {
    const T f = a.value / b.value;
    return a.through(b, f, T(1) / b.value, -f / b.value);
  }
  Var& operator+=(const Var& b) { return *this = *this + b; }
  Var& operator-=(const Var& b) { return *this = *this - b; }
  Var& operator*=(const Var& b) { return *this = *this * b; }
  Var& operator/=(const Var& b) { return *this = *this / b; }
  friend bool operator<(const Var& a, const Var& b) { return plain(a) < plain(b); }
  friend bool operator>(const Var& a, const Var& b) { return plain(a) > plain(b); }
};

/// One per thread. Variables refer to it: it stays where it is while they live.
template <class T = double>
class Tape {
 public:
  Tape() = default;
  Tape(const Tape&) = delete;
  Tape& operator=(const Tape&) = delete;

  Var<T> input(const T& value) {
    Var<T> x(value);
    x.tape = this, x.node = add(-1, T(0), -1, T(0));
    return x;
  }
  /// Forgets everything, keeping the memory.
  void clear() { nodes_.clear(); }
  size_t size() const { return nodes_.size(); }

  /// Derivatives of `of` by every number on the tape, by node (Var::node of the inputs). One pass over the tape. They stay until the next.
  const std::vector<T>& adjoints(const Var<T>& of) {
    adjoints_.assign(nodes_.size(), T(0));
    if (of.node < 0) return adjoints_;
    adjoints_[size_t(of.node)] = T(1);
    for (size_t i = size_t(of.node) + 1; i-- > 0;) {
      const Node& n = nodes_[i];
      if (n.a >= 0) adjoints_[size_t(n.a)] += n.slope_a * adjoints_[i];
      if (n.b >= 0) adjoints_[size_t(n.b)] += n.slope_b * adjoints_[i];
    }
    return adjoints_;
  }

  /// For Var.
  int32_t add(int32_t a, const T& slope_a, int32_t b, const T& slope_b) {
    nodes_.push_back({a, b, slope_a, slope_b});
    return int32_t(nodes_.size()) - 1;
  }

 private:
  struct Node {
    int32_t a, b;  // what it was made from; -1: nothing
    T slope_a, slope_b;
  };
  std::vector<Node> nodes_;
  std::vector<T> adjoints_;
};

}  // namespace sg::autodiff

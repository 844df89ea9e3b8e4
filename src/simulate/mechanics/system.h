// SPDX-License-Identifier: Apache-2.0
// Mechanical systems by generalized coordinates q: their energies, in numbers that carry derivatives, and where their bodies are.
#pragma once
#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/autodiff/dual.h"
#include "base/autodiff/tape.h"
#include "base/vec.h"

namespace sg::mechanics {

/// A derivative along four directions at once, on a tape: one pass gives four products with the Hessian matrix of the Lagrangian.
constexpr int lanes = 4;
using Along = autodiff::Dual<double, lanes>;
using Traced = autodiff::Var<Along>;
using Moving = autodiff::Dual<double>;  ///< a place and its velocity
template <class X>
using PlaceOf = std::array<X, 3>;

class System {
 public:
  virtual ~System() = default;
  virtual int size() const = 0;                               ///< coordinates
  virtual std::string coordinate(int i) const = 0;            ///< its name, for messages
  virtual std::vector<double> start() const = 0;              ///< q at time 0
  virtual std::vector<double> start_speed() const = 0;        ///< q' at time 0
  virtual std::vector<std::pair<int, int>> rods() const = 0;  ///< pairs of bodies that lines join

  virtual double kinetic(std::span<const double> q, std::span<const double> v) const = 0;
  virtual double potential(std::span<const double> q) const = 0;
  /// Kinetic less potential energy.
  virtual Traced lagrangian(std::span<const Traced> q, std::span<const Traced> v) const = 0;
  /// The bodies, resting ones too; q may carry velocities.
  virtual std::vector<PlaceOf<Moving>> bodies(std::span<const Moving> q) const = 0;
};

/// A system by a functor: F has `template <class X> X kinetic(std::span<const X> q, std::span<const X> v) const`, likewise
/// potential(q) and `std::vector<PlaceOf<X>> bodies(q)`, for any X with arithmetic and elementary functions, and size(), coordinate(i),
/// start(), start_speed() and rods() as in System.
template <class F>
class SystemOf final : public System {
 public:
  explicit SystemOf(F f) : f_(std::move(f)) {}
  int size() const override { return f_.size(); }
  std::string coordinate(int i) const override { return f_.coordinate(i); }
  std::vector<double> start() const override { return f_.start(); }
  std::vector<double> start_speed() const override { return f_.start_speed(); }
  std::vector<std::pair<int, int>> rods() const override { return f_.rods(); }
  double kinetic(std::span<const double> q, std::span<const double> v) const override { return f_.template kinetic<double>(q, v); }
  double potential(std::span<const double> q) const override { return f_.template potential<double>(q); }
  Traced lagrangian(std::span<const Traced> q, std::span<const Traced> v) const override {
    return f_.template kinetic<Traced>(q, v) - f_.template potential<Traced>(q);
  }
  std::vector<PlaceOf<Moving>> bodies(std::span<const Moving> q) const override { return f_.template bodies<Moving>(q); }

 private:
  F f_;
};

}  // namespace sg::mechanics

// SPDX-License-Identifier: Apache-2.0
// Systems to begin with. Each is a functor of energies (SystemOf in system.h); lengths in metres, times in seconds where gravity is 9.81.
#pragma once
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "simulate/mechanics/system.h"

namespace sg::mechanics {

/// Rods without mass, one below the other, with a weight at the end of each; coordinates are their angles from straight down. One rod is
/// the pendulum, two are the double pendulum.
struct PendulumChain {
  std::vector<double> mass, length, angle, turning;
  double gravity;

  int size() const { return int(mass.size()); }
  std::string coordinate(int i) const { return "angle " + std::to_string(i + 1); }
  std::vector<double> start() const { return angle; }
  std::vector<double> start_speed() const { return turning; }
  std::vector<std::pair<int, int>> rods() const {
    std::vector<std::pair<int, int>> r;
    for (int i = 0; i < size(); ++i) r.emplace_back(i, i + 1);
    return r;
  }
  template <class X>
  X kinetic(std::span<const X> q, std::span<const X> v) const {
    using std::sin, std::cos;
    X sum(0), vx(0), vy(0);
    for (size_t i = 0; i < mass.size(); ++i) {
      vx += length[i] * cos(q[i]) * v[i], vy += length[i] * sin(q[i]) * v[i];
      sum += (mass[i] / 2) * (vx * vx + vy * vy);
    }
    return sum;
  }
  template <class X>
  X potential(std::span<const X> q) const {
    using std::cos;
    X sum(0), y(0);
    for (size_t i = 0; i < mass.size(); ++i) y -= length[i] * cos(q[i]), sum += (mass[i] * gravity) * y;
    return sum;
  }
  template <class X>
  std::vector<PlaceOf<X>> bodies(std::span<const X> q) const {
    using std::sin, std::cos;
    std::vector<PlaceOf<X>> r{{X(0), X(0), X(0)}};
    for (size_t i = 0; i < mass.size(); ++i) r.push_back({r.back()[0] + length[i] * sin(q[i]), r.back()[1] - length[i] * cos(q[i]), X(0)});
    return r;
  }
};

/// A planet about a sun that rests at the origin, in the plane: U = -pull mass / r.
struct Orbit {
  double mass, pull;
  std::vector<double> place, velocity;

  int size() const { return 2; }
  std::string coordinate(int i) const { return i ? "y" : "x"; }
  std::vector<double> start() const { return place; }
  std::vector<double> start_speed() const { return velocity; }
  std::vector<std::pair<int, int>> rods() const { return {}; }
  template <class X>
  X kinetic(std::span<const X>, std::span<const X> v) const {
    return (mass / 2) * (v[0] * v[0] + v[1] * v[1]);
  }
  template <class X>
  X potential(std::span<const X> q) const {
    using std::sqrt;
    return (-pull * mass) / sqrt(q[0] * q[0] + q[1] * q[1]);
  }
  template <class X>
  std::vector<PlaceOf<X>> bodies(std::span<const X> q) const {
    return {{X(0), X(0), X(0)}, {q[0], q[1], X(0)}};
  }
};

/// size x size masses in a square of side `length`, level at first, held at two corners and joined by springs along the sides and the
/// diagonals of its meshes; it falls and swings. U = sum of stiffness (|d| - rest)^2 / 2 and of mass gravity z.
class SpringNet {
 public:
  SpringNet(int size, double mass, double length, double stiffness, double gravity);
  int size() const { return int(free_.size()) * 3; }
  std::string coordinate(int i) const { return std::string(1, "xyz"[i % 3]) + " of mass " + std::to_string(free_[size_t(i / 3)]); }
  std::vector<double> start() const;
  std::vector<double> start_speed() const { return std::vector<double>(size_t(size()), 0); }
  std::vector<std::pair<int, int>> rods() const;
  template <class X>
  X kinetic(std::span<const X>, std::span<const X> v) const {
    X sum(0);
    for (const X& u : v) sum += u * u;
    return (mass_ / 2) * sum;
  }
  template <class X>
  X potential(std::span<const X> q) const {
    using std::sqrt;
    const std::vector<PlaceOf<X>> at = bodies<X>(q);
    X sum(0);
    for (const Spring& s : springs_) {
      X square(0);
      for (size_t a = 0; a < 3; ++a) {
        const X d = at[size_t(s.b)][a] - at[size_t(s.a)][a];
        square += d * d;
      }
      const X longer = sqrt(square) - s.rest;
      sum += (s.stiffness / 2) * longer * longer;
    }
    for (size_t i = 2; i < q.size(); i += 3) sum += (mass_ * gravity_) * q[i];
    return sum;
  }
  template <class X>
  std::vector<PlaceOf<X>> bodies(std::span<const X> q) const {
    std::vector<PlaceOf<X>> at;
    for (const Vec3& p : rest_) at.push_back({X(p.x), X(p.y), X(p.z)});
    for (size_t i = 0; i < free_.size(); ++i) at[size_t(free_[i])] = {q[3 * i], q[3 * i + 1], q[3 * i + 2]};
    return at;
  }

 private:
  struct Spring {
    int a, b;
    double rest, stiffness;
    bool side;
  };
  double mass_, gravity_;
  std::vector<Vec3> rest_;
  std::vector<int> free_;  // numbers of the masses that are not held
  std::vector<Spring> springs_;
};

}  // namespace sg::mechanics

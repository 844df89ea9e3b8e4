// SPDX-License-Identifier: Apache-2.0
// One step of an ordinary differential equation x' = v(x, t), by the classic explicit schemes and a symplectic one. A *flow* is explained
// in flow_field.h; here only its velocity is used.
#pragma once
#include <cstdint>

#include "base/schema/enum_words.h"
#include "base/vec.h"

namespace sg {

enum class Scheme : uint8_t { euler, midpoint, heun, rk4, dormand_prince, implicit_midpoint };
constexpr auto enum_words(Scheme) {
  using enum Scheme;
  return std::array{Word{"euler", euler},
                    Word{"midpoint", midpoint},
                    Word{"heun", heun},
                    Word{"rk4", rk4},
                    Word{"dormand_prince", dormand_prince},
                    Word{"implicit_midpoint", implicit_midpoint}};
}

/// Order of the error of a whole path: 1, 2, 2, 4, 5, 2.
constexpr int order_of(Scheme s) {
  constexpr int order[] = {1, 2, 2, 4, 5, 2};
  return order[int(s)];
}

/// A step of the implicit midpoint rule, x1 = x + h v((x + x1) / 2): of order 2 and symplectic (Hairer, Lubich, Wanner: Geometric Numerical
/// Integration, IV.2): in flows of the plane without divergence it keeps areas, and quadratic stream functions to rounding, however many
/// the turns. By fixed-point iteration, which needs |h| times the velocity gradient below 2; false where it does not converge in 100
/// rounds or meets a place without velocity.
template <class Flow>
bool implicit_midpoint_step(Flow& flow, Vec3 x, double t, double h, Vec3 k1, Vec3& out) {
  Vec3 move = h * k1, v;
  double last = HUGE_VAL;
  for (int n = 0; n < 100; ++n) {
    if (!flow(x + 0.5 * move, t + h / 2, v)) return false;
    const Vec3 next = h * v;
    const double change = length(next - move);
    move = next;
    // Until rounding is all that changes.
    if (change <= 1e-15 * length(move) || (change >= last && change <= 1e-12 * length(move))) {
      out = x + move;
      return true;
    }
    last = change;
  }
  return false;
}

/// A particle of place x and velocity v that a force moves: x'' = a(x, t). Velocity Verlet (leapfrog): of order 2, symplectic for forces
/// that depend only on position, so that the energy of orbits does not drift. `a(x, t)` is at the old place and becomes that at the new.
template <class Acceleration>
void symplectic_step(Acceleration&& acceleration, double t, double h, Vec3& x, Vec3& v, Vec3& a) {
  v += (h / 2) * a;
  x += h * v;
  a = acceleration(x, t + h);
  v += (h / 2) * a;
}

/// One step of size h (negative: backwards) from x, where the velocity is k1. False when a stage lies where there is no velocity.
/// Not for dormand_prince.
template <class Flow>
bool fixed_step(Scheme scheme, Flow& flow, Vec3 x, double t, double h, Vec3 k1, Vec3& out) {
  Vec3 k2, k3, k4;
  switch (scheme) {
    case Scheme::euler: out = x + h * k1; return true;
    case Scheme::midpoint:
      if (!flow(x + (h / 2) * k1, t + h / 2, k2)) return false;
      out = x + h * k2;
      return true;
    case Scheme::heun:
      if (!flow(x + h * k1, t + h, k2)) return false;
      out = x + (h / 2) * (k1 + k2);
      return true;
    case Scheme::implicit_midpoint: return implicit_midpoint_step(flow, x, t, h, k1, out);
    default:
      if (!flow(x + (h / 2) * k1, t + h / 2, k2) || !flow(x + (h / 2) * k2, t + h / 2, k3) || !flow(x + h * k3, t + h, k4)) return false;
      out = x + (h / 6) * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
      return true;
  }
}

/// A step of Dormand and Prince's pair of orders 5 and 4 (1980; Hairer, Norsett, Wanner: Solving Ordinary Differential Equations I, II.5),
/// its error estimate, and the interpolant of order 4 between its ends (II.6).
struct DormandPrinceStep {
  Vec3 x1;     ///< at t + h
  Vec3 k7;     ///< velocity there: the first of the next step
  Vec3 error;  ///< difference of the two orders
  Vec3 r[5];
  /// Place at t + theta h, theta in [0, 1].
  Vec3 at(double theta) const {
    const double q = 1 - theta;
    return r[0] + theta * (r[1] + q * (r[2] + theta * (r[3] + q * r[4])));
  }
};

template <class Flow>
bool dormand_prince_step(Flow& flow, Vec3 x, double t, double h, Vec3 k1, DormandPrinceStep& out) {
  Vec3 k2, k3, k4, k5, k6;
  if (!flow(x + h * ((1.0 / 5) * k1), t + h / 5, k2)) return false;
  if (!flow(x + h * ((3.0 / 40) * k1 + (9.0 / 40) * k2), t + 3 * h / 10, k3)) return false;
  if (!flow(x + h * ((44.0 / 45) * k1 - (56.0 / 15) * k2 + (32.0 / 9) * k3), t + 4 * h / 5, k4)) return false;
  if (!flow(x + h * ((19372.0 / 6561) * k1 - (25360.0 / 2187) * k2 + (64448.0 / 6561) * k3 - (212.0 / 729) * k4), t + 8 * h / 9, k5))
    return false;
  if (!flow(x + h * ((9017.0 / 3168) * k1 - (355.0 / 33) * k2 + (46732.0 / 5247) * k3 + (49.0 / 176) * k4 - (5103.0 / 18656) * k5), t + h,
            k6))
    return false;
  const Vec3 move = h * ((35.0 / 384) * k1 + (500.0 / 1113) * k3 + (125.0 / 192) * k4 - (2187.0 / 6784) * k5 + (11.0 / 84) * k6);
  out.x1 = x + move;
  if (!flow(out.x1, t + h, out.k7)) return false;
  const Vec3 k7 = out.k7;
  out.error =
      h * ((71.0 / 57600) * k1 - (71.0 / 16695) * k3 + (71.0 / 1920) * k4 - (17253.0 / 339200) * k5 + (22.0 / 525) * k6 - (1.0 / 40) * k7);
  out.r[0] = x;
  out.r[1] = move;
  out.r[2] = h * k1 - move;
  out.r[3] = move - h * k7 - out.r[2];
  out.r[4] = h * ((-12715105075.0 / 11282082432.0) * k1 + (87487479700.0 / 32700410799.0) * k3 - (10690763975.0 / 1880347072.0) * k4 +
                  (701980252875.0 / 199316789632.0) * k5 - (1453857185.0 / 822651844.0) * k6 + (69997945.0 / 29380423.0) * k7);
  return true;
}

}  // namespace sg

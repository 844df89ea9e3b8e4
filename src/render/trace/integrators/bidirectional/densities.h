// SPDX-License-Identifier: Apache-2.0
// The densities with which the ways to draw a path draw its vertices, and the share of each way (Veach 1997, chapters 9 and 10).
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sg::trace {

/// Of a path x_0 (on a light), x_1, ..., x_k (the eye). All densities are per area, but of x_0 at infinity per solid angle; where a
/// direction is drawn, p_area(x') = p_solid(x -> x') |cos at x'| / |x - x'|^2, and without the distance if x is at infinity, where
/// p is per area across. Strategy s draws x_0 ... x_s-1 from the light and the rest from the camera:
///
///   p_s = from_light[0] ... from_light[s-1] from_camera[s] ... from_camera[k],    p_1 with `asked` for from_light[0].
///
/// Factors that all ways share are left out: chances of straight passage and of Russian roulette. At a mirror or smooth glass, which
/// turns one direction into one other, the two conditional densities stand in the ratio eta_o^2 |cos_o| to eta_i^2 |cos_i|; their common
/// factor drops out, as no way ends there.
struct PathDensities {
  std::vector<double> from_light, from_camera;
  std::vector<uint8_t> delta;    ///< at this vertex the path cannot be joined
  double asked = 0;              ///< of x_0 when it is drawn as seen from x_1
  bool light_can_be_met = true;  ///< by chance

  void reset(size_t count) {
    from_light.assign(count, 0), from_camera.assign(count, 0), delta.assign(count, 0);
    asked = 0, light_can_be_met = true;
  }
  size_t count() const { return from_light.size(); }
  /// Whether a way can find such a path; 0 <= s < count().
  bool possible(size_t s) const { return s == 0 ? light_can_be_met && !delta[0] : !(delta[s] || (s > 1 && delta[s - 1])); }
};

enum class Heuristic {
  balance,  ///< p_s / sum of all p
  power,    ///< p_s^2 / sum of all p^2
};

/// The share of strategy s, for which p_s > 0, of the path. The shares of all that are possible add up to 1. O(count).
double strategy_weight(const PathDensities& path, size_t s, Heuristic heuristic = Heuristic::power);

}  // namespace sg::trace

// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/bidirectional/densities.h"

namespace sg::trace {

namespace {

// Densities may be tiny or huge; their ratios are what counts.
double counts(double ratio, Heuristic heuristic) { return heuristic == Heuristic::power ? ratio * ratio : ratio; }

}  // namespace

double strategy_weight(const PathDensities& p, size_t s, Heuristic heuristic) {
  if (!p.possible(s)) return 0;
  double sum = 1;
  // With more vertices from the light: what this strategy drew from the camera is drawn from the light instead.
  double ratio = s == 1 ? p.from_light[0] / p.asked : 1;
  for (size_t i = s; i + 1 < p.count() && (ratio > 0 || i == 0); ++i) {
    if (i == 0) {
      if (p.possible(1)) sum += counts(p.asked / p.from_camera[0], heuristic);
    }
    ratio *= p.from_light[i] / p.from_camera[i];
    if (i > 0 && p.possible(i + 1)) sum += counts(ratio, heuristic);
  }
  // With fewer.
  ratio = 1;
  for (size_t i = s; i-- > 0;) {
    const double own = i == 0 && s == 1 ? p.asked : p.from_light[i];
    const double before = ratio;
    ratio *= p.from_camera[i] / own;
    // Strategy i; the one that asks has another density of x_0.
    if (p.possible(i)) sum += counts(i == 1 ? ratio * p.asked / p.from_light[0] : ratio, heuristic);
    if (!(ratio > 0) && before > 0) break;
  }
  const double weight = 1 / sum;
  return weight >= 0 ? weight : 0;  // where densities are beyond all numbers
}

}  // namespace sg::trace

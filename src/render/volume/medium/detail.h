// SPDX-License-Identifier: Apache-2.0
// Detail: media that depend on more than the value (on the gradient, or a second field). They are sampled.
#pragma once
#include "color/transfer_function.h"
#include "render/volume/medium/stretch.h"

namespace sg::volume {

/// A medium that depends on more than the value: it is sampled, see composite().
struct Detail {
  const TransferFunction& transfer;
  SecondAxis axis;
  double unit;     ///< world length to which opacity refers
  float most_tau;  ///< represents the tau of opacity 1
  float ink = 0;   ///< extinction that silhouettes and strokes have of their own (Lit::ink of it)
};

/// Optical depth that samples of such a medium may miss in a part.
constexpr float overlooked_depth = 1.0f / 8192;

/// A sample of such a medium. `sample`: its straight colour and opacity.
struct DetailPlace {
  float tau = 0, value = 0, second = 0;
  TransferFunction::Sample sample{};
};
/// At t of a stretch; what it depends on is queried from the walker.
DetailPlace place_at(const Detail& detail, const Stretch& stretch, double t, RayField& walker);
/// Optical depth of a stretch, by Simpson's rule on parts that are halved until it agrees with the trapezoid rule to 1e-3 (absolute, or of
/// the depth of the part) and no line of the curves may lie between its samples, 6 times at most: an estimate, not a bound.
double optical_depth(const Detail& detail, const Stretch& stretch, RayField& walker);
/// Whether these samples, this length apart from first to last, may have missed something drawn between them.
bool overlooks(const Detail& detail, double length, const DetailPlace& a, const DetailPlace& m, const DetailPlace& b);

}  // namespace sg::volume

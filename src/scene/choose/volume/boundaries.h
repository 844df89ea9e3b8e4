// SPDX-License-Identifier: Apache-2.0
// Material boundaries from values and gradients: automatic transfer functions after Kindlmann and Durkin 1998.
#pragma once
#include <string>
#include <vector>

#include "scene/choose/volume/derivatives.h"

namespace sg {

/// A value at which the gradient is larger on average than at the values around it: the middle of the arc that a blurred border of two
/// materials makes in the plane (value, gradient magnitude).
struct MaterialBoundary {
  double value;          ///< the middle of the border
  double lo, hi;         ///< where the mean gradient falls to half of its height over the valleys beside it
  double mean_gradient;  ///< at `value`
  double share;          ///< of the samples that lie between lo and hi
};

/// In ascending order of value, at most `most` of the strongest. Empty when there is none that stands out.
std::vector<MaterialBoundary> material_boundaries(const std::vector<DerivativeSample>& samples, double lo, double hi, size_t most = 4);

/// Opacity around the boundaries, more for each further one, weighted by the gradient (item.detail); returns the reason in one line, or ""
/// and changes nothing when no boundary is found.
std::string show_boundaries(const std::vector<MaterialBoundary>& found, double lo, double hi, OpacityCurve& opacity,
                            TransferDetail& detail);

}  // namespace sg

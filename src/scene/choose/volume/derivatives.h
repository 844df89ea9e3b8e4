// SPDX-License-Identifier: Apache-2.0
// Samples of a scalar field's value, gradient and second derivatives: what automatic transfer functions look at.
#pragma once
#include <vector>

#include "base/context.h"
#include "color/transfer_function.h"
#include "data/dataset.h"

namespace sg {

struct DerivativeSample {
  float value, gradient;  ///< magnitude, per world length
  float second_derivative, curvature;
};

/// At most `most` places, evenly spread over the points (or cells) and the same on every run; those with finite values, away from the
/// border. Lattices: central differences in world space. Other meshes: the operations gradient and, when `with_second`, hessian over the
/// whole field. `component` as in VolumeItem. Empty for meshes without gradients (point clouds).
std::vector<DerivativeSample> sample_derivatives(const DatasetPtr& data, const Field& field, int component, bool with_second, size_t most,
                                                 Context& context);

/// The part of a second axis that matters: gradient: 0 to what one sample in a thousand exceeds; second derivative and curvature: as much
/// below 0 as above; field: its range. Never empty.
Range second_axis_range(const DatasetPtr& data, const Field& field, int component, SecondAxis axis, const Field* second, Context& context);

}  // namespace sg

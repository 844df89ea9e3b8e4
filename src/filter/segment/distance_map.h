// SPDX-License-Identifier: Apache-2.0
// Exact Euclidean distances on images with samples of any spacing.
#pragma once
#include <array>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

/// squared[i]: square of the distance from sample i to the nearest one with set[j] != 0 (infinite when there is none); nearest[i]: that j
/// (UINT32_MAX when there is none; `nearest` may be null). Lower envelopes of parabolas, axis by axis (Felzenszwalb and Huttenlocher
/// 2012): O(samples). `at`: places along each axis.
void distance_transform(const uint8_t* set, const std::array<std::vector<double>, 3>& at, float* squared, uint32_t* nearest,
                        const Context& context);

struct DistanceMapParams {
  FieldName field;
  std::optional<double> min, max;
  bool both_sides = false;
  std::string name = "distance";
};
void describe(Schema& s, DistanceMapParams& p);

/// Adds a field (f32): from each sample the distance to the nearest sample of the set, whose values lie in [min, max] (default: are not
/// zero); 0 in the set. both_sides: inside, minus the distance to the nearest sample that is known not to be in the set. Samples
/// without a value (NaN, hidden) belong to neither and get NaN; infinite where the set is empty. Uniform and rectilinear grids.
DatasetPtr distance_map(const DatasetPtr& in, const DistanceMapParams& p, Context& context);

}  // namespace sg

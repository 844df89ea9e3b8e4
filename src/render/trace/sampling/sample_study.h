// SPDX-License-Identifier: Apache-2.0
// What a kind of sampler is like: its points, how evenly they lie, how much they err, as numbers and as a picture.
#pragma once
#include <vector>

#include "base/schema/schema.h"
#include "base/vec.h"
#include "image/image.h"
#include "render/trace/sampling/sampler.h"

namespace sg {
class Context;
}

namespace sg::trace {

struct SampleStudyParams {
  SamplerKind sampler = SamplerKind::sobol;
  int count = 256;
  int64_t seed = 0;
};
void describe(Schema& s, SampleStudyParams& p);

struct SampleStudy {
  std::vector<Vec2f> points;  ///< of one pixel, in the order in which they are drawn
  double discrepancy = 0;     ///< L2 star discrepancy of these points
  /// Standard error of the mean of exp(x + y) with so many samples, relative to that of independent ones; over 256 pixels.
  double relative_error = 0;
};
/// O(count^2). Throws Error(usage) for parameters out of range.
SampleStudy study_samples(const SampleStudyParams& p);

/// L2 star discrepancy of points in [0, 1)^2, by Warnock's closed form; O(n^2).
double l2_star_discrepancy(const std::vector<Vec2f>& points);

/// From left to right: the points of one pixel; the power spectrum of points, the mean of several pixels, with frequency 0 in the middle
/// and the power of independent points as middle grey; the errors of the mean of exp(x + y) in 96 x 96 pixels, one standard deviation a
/// quarter of the greys.
Image sample_picture(const SampleStudyParams& p, const Context& context);

}  // namespace sg::trace

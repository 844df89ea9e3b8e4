// SPDX-License-Identifier: Apache-2.0
// lic: line integral convolution, the texture of a flow.
#pragma once
#include <optional>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "filter/flow/texture/contrast.h"
#include "filter/flow/texture/convolution.h"

namespace sg {

/// plain: a line for each pixel; fast: long lines that share their sums.
enum class LicMethod { plain, fast };
constexpr auto enum_words(LicMethod) {
  using enum LicMethod;
  return std::array{Word{"plain", plain}, Word{"fast", fast}};
}
enum class LicNoise { white, sparse };
constexpr auto enum_words(LicNoise) {
  using enum LicNoise;
  return std::array{Word{"white", white}, Word{"sparse", sparse}};
}

struct LicParams {
  FieldName field;
  std::optional<double> length;
  double step = 1;
  texture::LineWeights kernel = texture::LineWeights::box;
  double phase = 0;
  int ripples = 2;
  LicMethod method = LicMethod::plain;
  std::optional<LicNoise> noise;
  double density = 0, grain = 0;
  int64_t seed = 1;
  FieldName image;
  texture::Contrast contrast = texture::Contrast::stretch;
  int passes = 1;
  std::optional<double> still;
  int64_t resolution = 0;
};
void describe(Schema& s, LicParams& p);

/// The field "lic" in [0, 1] on a uniform grid: noise, or the field `image` of a second input, averaged along the streamlines of a vector
/// field (Cabral, Leedom 1993); with method=fast along streamlines that share their sums (Stalling, Hege 1995), so that a pixel's
/// value is the mean of those of places in it: the same statistics, not the same numbers. Any flat mesh gives a picture (see
/// texture::make_frame for the grid), a solid one a volume of texture. The input's fields come along, interpolated, to be colours under the
/// texture; a volume gets the field "speed", the colour of its strands. An image gives "lic" as many components as it has, in its own
/// numbers (no contrast). Animation: frames of kernel=ripple with phase = 0, 1/n, 2/n, ... move along the flow, and 1 is 0 again. NaN where
/// the flow has no value; where its speed is not above `still`: 0.5, the image as it is, 0 with sparse noise. Lines end at the border and
/// where there is no flow; the mean is over what there is of them. Throws Error(usage) for data without vectors, other images and curved
/// surfaces. O(pixels length/step); fast: O(pixels).
DatasetPtr lic(const DatasetPtr& input, const DatasetPtr& image, const LicParams& params, Context& context);
/// The operation: one input, or two.
Data lic_of(const std::vector<Data>& inputs, const LicParams& params, Context& context);

}  // namespace sg

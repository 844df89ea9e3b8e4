// SPDX-License-Identifier: Apache-2.0
// advect: fields and images carried along by the flow.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

/// What comes in from outside: the value at the border, or nothing.
enum class InflowBorder { clamp, nan };
constexpr auto enum_words(InflowBorder) {
  using enum InflowBorder;
  return std::array{Word{"clamp", clamp}, Word{"nan", nan}};
}

struct AdvectParams {
  FieldName field;
  std::vector<std::string> carry;
  std::optional<double> time;
  int64_t steps = 0;
  InflowBorder border = InflowBorder::clamp;
  std::vector<double> dye;
  double dye_radius = 0;
  int64_t resolution = 0;
};
void describe(Schema& s, AdvectParams& p);

/// Point fields as they are after the flow has carried them for a time: each pixel of a uniform grid (texture::make_frame) is traced back
/// by Runge-Kutta steps of order 4 through the steady flow, and takes the value at its origin (linear between pixels; one interpolation
/// however long the time, so nothing smears). The fields named in `carry` (none: all scalars and colours) are those of the input, or of the
/// second input: an image, stretched over the grid, that is warped. Types stay for floats; integers become f32, u8 colours stay u8. A path
/// that leaves the grid: border=clamp takes the value at the border, nan none. A path that meets places without velocity stays there.
/// dye=x,y,z,...: places from which dye has come out all the time; point field "dye" in [0, 1]: how near to one of them (within
/// dye_radius, fading to its rim) the pixel's path has passed. Negative times run backwards. Throws Error(usage) as lic() does, for steps
/// beyond 1e6, and for unknown fields. O(pixels steps).
DatasetPtr advect(const DatasetPtr& input, const DatasetPtr& image, const AdvectParams& params, Context& context);
Data advect_of(const std::vector<Data>& inputs, const AdvectParams& params, Context& context);

}  // namespace sg

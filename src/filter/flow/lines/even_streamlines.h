// SPDX-License-Identifier: Apache-2.0
// even_streamlines: lines that fill the picture evenly (Jobard, Lefer 1997), in the plane, on surfaces and in space.
#pragma once
#include <optional>

#include "filter/flow/trace.h"

namespace sg {

struct EvenStreamlinesParams {
  FieldName field;
  std::optional<double> spacing;
  double test = 0.5;
  double min_length = 2;
  double min_speed = 1e-3;
  IntegrationParams integration;
  int64_t max_lines = 20000;
};
void describe(Schema& s, EvenStreamlinesParams& p);

/// Streamlines none of which comes nearer to another, or to a far part of itself, than test * spacing; new ones begin at a distance of
/// `spacing` from existing lines, oldest first: in the plane and on surfaces on both sides, in space in six directions around. Then the
/// gaps are filled from a grid of places, so that parts that no line leads to are reached. Lines shorter than min_length * spacing are not
/// drawn. The result has the fields of streamlines' lines; cell field "seed" counts the lines. Sequential by nature; the same for any
/// number of threads. Throws Error(usage) when there is no flow and for spacings that need more than max_lines.
Data even_streamlines(const Data& in, const EvenStreamlinesParams& p, Context& context);

}  // namespace sg

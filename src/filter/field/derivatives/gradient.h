// SPDX-License-Identifier: Apache-2.0
// gradient: the spatial derivatives of a field.
#pragma once
#include <string>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct GradientParams {
  FieldName field;
  std::string as;
};
void describe(Schema& s, GradientParams& p);

/// The input with one more field, where `field` lies: for each component of it its derivatives along x, y and z, so 3 numbers for
/// a scalar and 9 for a vector (d u_c / d x_a at 3*c + a). f32 for fields of 32 bits and less, f64 for wider ones. Cell fields are
/// values at the middles of the cells.
///
/// Uniform, rectilinear and curvilinear grids: second order, one-sided at the borders; curvilinear ones through the derivatives of
/// the positions. Axes with one point give 0 (curved sheets and lines: the gradient along them). AMR grids: patch by patch.
/// Unstructured and surface meshes: a parabola fitted to the places around (see fitted_derivatives.h), of second order on smooth meshes
/// up to their borders, exact for quadratic functions; where there are too few neighbours for that, exact for linear ones, and a warning
/// says at how many points. On lines and surfaces the gradient along them. Next to NaN values differences are one-sided; a NaN has a NaN
/// gradient. Throws Error(usage) for an unknown field and for point clouds.
DatasetPtr gradient(const DatasetPtr& input, const GradientParams& params, Context& context);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// ftle: how fast neighbours part in a flow (finite-time Lyapunov exponent; Haller 2001; Shadden, Lekien, Marsden 2005).
#pragma once
#include <functional>
#include <optional>

#include "base/context.h"
#include "base/schema.h"
#include "data/dataset.h"
#include "filter/flow/flow_field.h"

namespace sg {

struct FtleParams {
  FieldName field;
  double duration = 1;
  double start = 0;
  std::vector<int64_t> dims;
  int64_t size = 256;
  std::vector<double> bounds;
  double tolerance = 1e-5;
  std::optional<double> offset;
};
void describe(Schema& s, FtleParams& p);

/// Carries one place; called from one thread at a time on each object.
using Carrier = std::function<bool(Vec3 from, Vec3& to)>;

/// What the flow map of a grid of seeds tells, on that grid: point fields "ftle" (ln sqrt(largest eigenvalue of C) / |duration|, C = F^T F,
/// Shadden's definition), "flow map" (where each point went), and for ridges and shear lines the eigenvalues "stretch" (ascending) and unit
/// eigenvectors "stretch direction" (of the largest) and "shrink direction" (of the smallest) of C.
/// F is the derivative of the flow map: central differences between neighbours of the grid (second order; one-sided at the borders), or
/// between `offset` places beside each point. Where a neighbour left the flow the difference is one-sided; without any: NaN.
/// Axes of one point do not count. `make` gives each thread its carrier.
DatasetPtr ftle_of(const UniformGrid& grid, double duration, std::optional<double> offset, const std::function<Carrier()>& make,
                   Context& context);

/// FTLE of a steady flow; of a time series: op ftle with `start` (see unsteady). duration < 0: backward (attracting structures).
DatasetPtr ftle(const DatasetPtr& in, const FtleParams& p, Context& context);

/// The grid of seeds that the parameters ask for, in the box of the flow.
UniformGrid ftle_grid(const Dataset& in, const FtleParams& p);

}  // namespace sg

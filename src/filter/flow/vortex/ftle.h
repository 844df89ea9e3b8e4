// SPDX-License-Identifier: Apache-2.0
// ftle: how fast neighbours separate in a flow (finite-time Lyapunov exponent; Haller 2001; Shadden, Lekien, Marsden 2005).
#pragma once
#include <functional>
#include <optional>
#include <span>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "filter/flow/trace.h"
#include "filter/flow/unsteady/time_interpolation.h"

namespace sg {

struct FtleParams {
  FieldName field;
  std::optional<double> duration;
  std::optional<double> start;
  std::string times;
  TimeInterpolation interpolation = TimeInterpolation::linear;
  std::vector<int64_t> dims;
  int64_t size = 0;
  std::vector<double> bounds;
  std::optional<double> offset;
  bool geographic = false;                           ///< see flow/geographic.h
  IntegrationParams integration{.tolerance = 1e-5};  ///< max_step of dormand_prince by default: 8 step
};
void describe(Schema& s, FtleParams& p);

/// Where places go; `known`: the flow carried them all the way.
using FlowMap = std::function<void(std::span<const Vec3> from, std::vector<Vec3>& to, std::vector<uint8_t>& known)>;

/// Results from the flow map of a grid of seeds, on that grid: point fields "ftle" (ln sqrt(largest eigenvalue of C) / |duration|, C = F^T
/// F, Shadden's definition), "flow map" (where each point went), and for ridges and shear lines the eigenvalues "stretch" (ascending) and
/// unit eigenvectors "stretch direction" (of the largest) and "shrink direction" (of the smallest) of C. F is the derivative of the flow
/// map: central differences between neighbours of the grid (second order; one-sided at the borders), or between points at a distance of
/// `offset` from each point. Where a neighbour left the flow the difference is one-sided; without any: NaN. Axes of one point do not count.
/// `geographic`: x and y are degrees of longitude and latitude, z metres; distances are those on a sphere of 6371 km, and the two
/// directions are a degree of latitude long, in the mesh's coordinates. Stops when `context` is cancelled.
DatasetPtr ftle_of(const UniformGrid& grid, double duration, std::optional<double> offset, const FlowMap& map, bool geographic = false,
                   const Context* context = nullptr);

/// FTLE of a time series from `start` (default: its first time; backwards its last one) over `duration`, or of a steady flow when there is
/// one step. Without a duration: the whole series, or the time in which the mean speed of a steady flow goes a tenth of the mesh's
/// diagonal. duration < 0: backward, which shows attracting structures. Throws Error(usage) when the series does not last as long.
DatasetPtr ftle(const Series& series, const FtleParams& p, Context& context);

}  // namespace sg

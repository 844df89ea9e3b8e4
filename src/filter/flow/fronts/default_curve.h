// SPDX-License-Identifier: Apache-2.0
// Default start of a flow surface.
#pragma once
#include "data/dataset.h"
#include "filter/flow/flow_parts.h"
#include "filter/flow/fronts/seed_curve.h"

namespace sg {

/// A straight line across the flow: through the middle of the mesh, or if the flow is still there, the candidate point with strong flow
/// from which it travels farthest; along the axis of the mesh that is most across the flow there, up to an eighth of the mesh's diagonal to
/// both sides, as far as there is flow (above 2 % of the largest speed). Says on the log which it is. Throws Error(usage) naming `who` when
/// nothing flows.
SeedCurveParams across_the_flow(const FlowParts& parts, std::string_view who, Context& context);

/// A rectangle in the same place and as far: across the flow, or in the plane of a flat mesh.
struct SeedRectangle {
  Vec3 center, normal;
  double size[2];  ///< along rectangle_sides()
};
SeedRectangle rectangle_across_the_flow(const FlowParts& parts, std::string_view who, Context& context);
/// Directions of the edges of a rectangle with this unit normal.
std::pair<Vec3, Vec3> rectangle_sides(Vec3 normal);

/// The flow of the step of a series that is nearest to `start` (default: its first).
FlowParts flow_at(const Series& series, std::optional<double> start, const std::string& field, std::string_view who, Context& context);

}  // namespace sg

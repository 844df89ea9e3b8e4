// SPDX-License-Identifier: Apache-2.0
// Where the border of a flat mesh changes between inflow and outflow, and where flow separates from walls or attaches to them.
#pragma once
#include <string_view>
#include <vector>

#include "filter/flow/topology/critical_points.h"

namespace sg {

enum class SwitchType : uint8_t {
  outer,       ///< the flow touches the border from outside: nothing starts there
  inner,       ///< the flow touches it from inside, a half saddle: a separatrix in both directions
  detachment,  ///< of a wall where the velocity is zero: flow along it meets and leaves
  attachment   ///< flow comes and parts
};
/// "outer", "inner", "detachment", "attachment".
std::string_view switch_type_name(SwitchType t);

struct SwitchPoint {
  Vec3 at;
  Vec3 inward;  ///< unit, into the mesh
  SwitchType type;
  int64_t cell = -1;
  double size = 0;  ///< length of the edge
  int32_t part = 0;
};

/// Places of the border's edges (curved ones by the chords between their nodes) where the velocity, linear along each, is along the
/// border; corners where it goes in by one edge and out by the other. Edges along which the flow runs everywhere have none. On walls:
/// where the shear (derivative of the velocity along the wall, away from it) changes sign. In the order of the edges' cells. Edges of a
/// single cell are not a border where another part or patch lies behind them.
std::vector<SwitchPoint> find_switch_points(const FlowParts& flow, const PlaneFrame& frame, Context& context);

/// Places just inside the border, some on each stretch along which the flow enters (1), leaves (-1) or runs along it (both, as two).
struct BorderSeed {
  Vec3 at;
  double sign;
};
std::vector<BorderSeed> border_seeds(const FlowParts& flow, const PlaneFrame& frame, Context& context);

/// A point cloud with "type" (labels) and "cell".
DatasetPtr switch_points_dataset(const std::vector<SwitchPoint>& points);

}  // namespace sg

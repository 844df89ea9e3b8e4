// SPDX-License-Identifier: Apache-2.0
// The border of flat meshes, as edges.
#pragma once
#include <vector>

#include "filter/flow/flow_parts.h"
#include "filter/flow/topology/zeros/plane_frame.h"

namespace sg {

struct BorderEdge {
  int64_t a, b;  ///< points of its part; the mesh lies to the left
  Vec3 at_a, at_b;
  int64_t cell;
  int32_t part;
};

/// Edges of only one cell of their part, behind which no other part or patch has a flow, in order of parts and cells. Seams, where a grid
/// meets itself, do not count. Curved edges by the chords between their nodes.
std::vector<BorderEdge> border_edges(const FlowParts& flow, const PlaneFrame& frame, Context& context);

/// They as lines with the point field "speed".
DatasetPtr border_dataset(const FlowParts& flow, const std::vector<BorderEdge>& edges);

}  // namespace sg

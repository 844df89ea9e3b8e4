// SPDX-License-Identifier: Apache-2.0
// The scene graph: a tree of nodes, each placed in its parent once or several times, flattened to places in the world.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "base/space/affine.h"
#include "data/dataset.h"
#include "scene/graph/node_params.h"

namespace sg {

/// A node at some moment.
struct SceneNode {
  std::string name;
  int parent = -1;  ///< number of a node before it; -1: the world
  bool visible = true;
  Affine place;                       ///< in the parent
  std::vector<Affine> instances{{}};  ///< of the node in itself: the node, and with it its children, stands at place * instance
};

/// Where a node with these keys is; before the first and after the last as there. Keys are in the order of their times. Interpolated as
/// interpolate() does.
struct PlaceKey {
  double time = 0;
  Affine place;
};
Affine place_at(std::span<const PlaceKey> keys, double time);

/// The places that the points of a dataset are for copies; points of which a field is not finite, or a size or vector zero, are none.
/// Throws Error(usage) as glyph_instances().
std::vector<Affine> places_at(const DatasetPtr& points, const PointInstancesParams& params);

/// Where each node stands in the world, by instances of its ancestors and its own, the ancestors' slowest; none where it or an ancestor is
/// hidden. Throws Error(usage) where one would stand at more than a million places, or where a product of transforms flattens it.
std::vector<std::vector<Affine>> world_places(std::span<const SceneNode> nodes);

}  // namespace sg

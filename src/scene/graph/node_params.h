// SPDX-License-Identifier: Apache-2.0
// Nodes of a scene as a user states them: where each stands in its parent, at which times, and how often.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/schema/schema.h"
#include "base/space/affine.h"
#include "base/space/euler.h"

namespace sg {

/// Scale, then rotation, about a centre, then translation; or a matrix.
struct PlaceParams {
  std::vector<double> scale{1};
  Vec3 axis{0, 0, 1};
  double angle = 0;
  std::optional<Vec3> euler;
  EulerOrder order = EulerOrder::xyz;
  std::vector<double> quaternion;  ///< x, y, z, w, or empty
  Vec3 translate;
  std::optional<Vec3> center;
  std::vector<double> matrix;
};
/// One of several copies.
struct InstanceParams {
  PlaceParams place;
};
/// Where a node is at a time.
struct KeyParams {
  double time = 0;
  PlaceParams place;
};
struct NodeParams {
  PlaceParams place;
  bool visible = true;
  std::optional<double> time;
};
/// Copies at the points of a dataset, as glyphs are placed.
struct PointInstancesParams {
  FieldName vectors, frames, size;
  double scale = 1;
};
void describe(Schema& s, InstanceParams& p);
void describe(Schema& s, KeyParams& p);
void describe(Schema& s, NodeParams& p);
void describe(Schema& s, PointInstancesParams& p);

/// p' = center + rotate(scale (p - center)) + translate, or matrix p. Throws Error(usage) naming `owner` for a matrix of other than 16
/// numbers or with another last row than 0 0 0 1, for what flattens or is not finite, and for rotations stated twice (`stated`: the schema
/// that the words were set in).
Affine affine_of(const PlaceParams& p, const Schema& stated, const std::string& owner);

}  // namespace sg

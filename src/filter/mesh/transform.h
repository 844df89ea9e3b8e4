// SPDX-License-Identifier: Apache-2.0
// Moves, turns and scales a mesh.
#pragma once
#include "base/context.h"
#include "base/schema.h"
#include "data/dataset.h"

namespace sg {

struct TransformParams {
  Vec3 scale{1, 1, 1};
  Vec3 axis{0, 0, 1};
  double angle = 0;
  Vec3 translate{0, 0, 0};
  std::optional<Vec3> center = {};
  std::vector<double> matrix = {};
  bool vectors = true;
};

inline void describe(Schema& s, TransformParams& p) {
  s("scale", p.scale, "Factors along x, y and z, about the center; a negative one mirrors.");
  s("axis", p.axis, "Axis of the rotation, through the center.");
  s("angle", p.angle, "Angle of the rotation, counter-clockwise about the axis.").unit("deg");
  s("translate", p.translate, "Shift, after scaling and rotating.");
  s("center", p.center, "Fixed point of scale and rotation; default: 0,0,0.");
  s("matrix", p.matrix, "A 4x4 matrix, rows first, applied instead of all of these; its last row must be 0,0,0,1.");
  s("vectors", p.vectors, "Turns and scales fields of vectors too (normals stay perpendicular and of length 1).");
}

/// p' = center + rotate(scale * (p - center)) + translate, or matrix * p. A uniform grid stays one when its axes stay at
/// right angles, a rectilinear grid when only scaled along its axes and moved, an AMR grid likewise; otherwise both become
/// curvilinear (an AMR grid: Error(usage)). Listed points keep their element type and their double origin, which takes the large part of
/// the result. Fields of role vectors (3 components) are multiplied by the linear part, normals by its inverse transpose and made unit;
/// integer fields never. Throws Error(usage) for a matrix that is not 16 numbers or singular, a zero scale, or a zero axis with an angle.
DatasetPtr transform(const DatasetPtr& in, const TransformParams& p, Context& ctx);

}  // namespace sg

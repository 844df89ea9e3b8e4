// SPDX-License-Identifier: Apache-2.0
// Moves, turns and scales a mesh.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "filter/mesh/transform/transform_fields.h"

namespace sg {

struct TransformParams {
  static constexpr bool moves_space = true;
  Vec3 scale{1, 1, 1};
  Vec3 axis{0, 0, 1};
  double angle = 0;
  Vec3 translate{0, 0, 0};
  std::optional<Vec3> center = {};
  std::vector<double> matrix = {};
  bool vectors = true;
  FieldLawParams fields = {};
};

inline void describe(Schema& s, TransformParams& p) {
  s("scale", p.scale, "Scale factors along x, y and z, about 'center'; a negative one mirrors.");
  s("axis", p.axis, "Axis of the rotation, through 'center'.");
  s("angle", p.angle, "Angle of the rotation, counter-clockwise about the axis.").unit("deg");
  s("translate", p.translate, "Translation, after scaling and rotating.");
  s("center", p.center, "Fixed point of scale and rotation; default: 0,0,0.");
  s("matrix", p.matrix, "A 4x4 matrix, row by row, applied instead of all of these; its last row must be 0,0,0,1.");
  s("vectors", p.vectors,
    "Transform fields of vectors, normals (kept perpendicular and of unit length) and tensors with the mesh; false: none.");
  s("unmarked", p.fields.unmarked,
    "Also transform unmarked fields: of 3 floats as vectors, as streamlines do (unless named color, rgb, texture or the like), of 9 and 6 "
    "as tensors, of 2 on a mesh of constant z as vectors. A note names them; false: only marked fields.");
  s("turn", p.fields.turn,
    "Further fields to transform, by name: those of 9, 7, 6 and 4 components as tensors, those of 3 and 2 as vectors.");
  s("keep", p.fields.keep, "Fields to leave unchanged, by name.");
  s("gradients", p.fields.gradients,
    "Fields that are derivatives along x, y and z, by name: gradients of scalars (3 components, transformed by the inverse transpose), of "
    "vectors (9, row by row) and symmetric second derivatives (6). gradient(...) and hessian(...) are recognised.");
  s("axial", p.fields.axial,
    "Fields of axial vectors, by name, which mirroring reverses and scaling does not lengthen; curl(...) and vorticity are recognised.");
  s("order", p.fields.order, "Order of tensor components, as in the tensor operations; auto: rows, or vtk for 6.");
}

/// p' = center + rotate(scale * (p - center)) + translate, or matrix * p. A uniform grid stays one when its axes stay at
/// right angles, a rectilinear grid when only scaled along its axes and moved, an AMR grid likewise; otherwise both become
/// curvilinear (an AMR grid: Error(usage)). Listed points keep their element type and their double origin, which takes the large part of
/// the result. Fields change by field_law(): a vector is multiplied by the linear part M, a tensor T becomes M T M^T. Mirrored cells are
/// listed the other way round (turn_mirrored_cells), so that volumes stay positive and faces point outwards; points and cells of mirrored
/// grids are renumbered. Throws Error(usage) for a matrix that is not 16 numbers or singular, a zero scale, or a zero axis with an angle.
DatasetPtr transform(const DatasetPtr& in, const TransformParams& p, Context& ctx);

}  // namespace sg

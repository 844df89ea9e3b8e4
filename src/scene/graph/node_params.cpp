// SPDX-License-Identifier: Apache-2.0
#include "scene/graph/node_params.h"

#include <fmt/core.h>

#include <cmath>

#include "base/error.h"

namespace sg {

namespace {

void describe_place(Schema& s, PlaceParams& p) {
  s("translate", p.translate, "Translation, after scaling and rotating.");
  s("scale", p.scale, "Scale factor, or three along x, y and z, about 'center'; a negative one mirrors.").items(1, 3);
  s("axis", p.axis, "Axis of the rotation, through 'center'.");
  s("angle", p.angle, "Angle of the rotation, counter-clockwise about the axis.").unit("deg");
  s("euler", p.euler,
    "Instead of axis and angle: three angles about the fixed axes, one turn after the other in the order of 'order'. With the second at "
    "+-90 the first and the third turn about one line (gimbal lock).")
      .unit("deg");
  s("order", p.order, "Order of the turns of 'euler': xyz is first about x, last about z.");
  s("quaternion", p.quaternion, "Instead of axis and angle: the rotation as x, y, z, w, as in glTF; of any length.").items(0, 4);
  s("center", p.center, "Fixed point of scale and rotation; default: 0,0,0.");
  s("matrix", p.matrix, "A 4x4 matrix, row by row, applied instead of all of these; its last row must be 0,0,0,1.").items(0, 16);
}

Affine of_matrix(const std::vector<double>& m, const std::string& owner) {
  if (m.size() != 16) fail_usage(fmt::format("the matrix has {} numbers", m.size()), owner, "give 16, row by row");
  if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)
    fail_usage("the last row of the matrix is not 0,0,0,1", owner, "perspective is a property of the camera");
  Affine r;
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) r.linear.m[i][j] = m[4 * i + j];
    r.shift[int(i)] = m[4 * i + 3];
  }
  return r;
}

Mat3 rotation_of(const PlaceParams& p, const std::string& owner) {
  if (p.euler) return euler_matrix(*p.euler, p.order);
  if (p.quaternion.empty()) return with_context(owner, [&] { return turn_about(p.axis, p.angle); });
  if (p.quaternion.size() != 4) fail_usage(fmt::format("the quaternion has {} numbers", p.quaternion.size()), owner, "give x, y, z and w");
  const auto& q = p.quaternion;
  return with_context(owner, [&] { return matrix_of(normalize(Quaternion{q[3], q[0], q[1], q[2]})); });
}

}  // namespace

void describe(Schema& s, InstanceParams& p) { describe_place(s, p.place); }
void describe(Schema& s, KeyParams& p) {
  s("time", p.time,
    "Time at which the node is there; between two of them it moves (translation and stretch evenly, rotation about one axis "
    "along the shorter way), before the first and after the last it rests.")
      .unit("time");
  describe_place(s, p.place);
}
void describe(Schema& s, NodeParams& p) {
  describe_place(s, p.place);
  s("visible", p.visible, "Whether it and its children are drawn.");
  s("time", p.time, "With keys: the moment that is shown; default: that of a film's picture, else the first key's.").unit("time");
}
void describe(Schema& s, PointInstancesParams& p) {
  s("vectors", p.vectors, "Point field of vectors that +x turns to; default: nothing is turned.").takes(fields::point_vectors);
  s("frames", p.frames, "Instead of vectors: point field of 9 numbers, a matrix row by row.").takes(fields::on_points);
  s("size", p.size, "Point field whose absolute value scales each copy.").takes(fields::point_scalars);
  s("scale", p.scale, "Scale factor of all copies.").positive();
}

Affine affine_of(const PlaceParams& p, const Schema& stated, const std::string& owner) {
  const bool turned = stated.stated("axis") || stated.stated("angle");
  if (int(turned) + int(p.euler.has_value()) + int(!p.quaternion.empty()) > 1)
    fail_usage("its rotation is stated twice", owner, "give only one of axis with angle, euler, and quaternion");
  if (stated.stated("order") && !p.euler) fail_usage("order is stated without euler", owner, "give euler=A,B,C");
  Affine r;
  if (!p.matrix.empty()) {
    PlaceParams others;
    Schema all;
    describe_place(all, others);
    all.decls().pop_back();  // the matrix itself
    for (const ParamDecl& d : all.decls())
      if (stated.stated(d.name))
        fail_usage(fmt::format("matrix and {} are both stated", d.name), owner, "the matrix takes the place of all others");
    r = of_matrix(p.matrix, owner);
  } else {
    if (p.scale.size() == 2) fail_usage("scale has two numbers", owner, "give one, or three along x, y and z");
    const Mat3 turn = rotation_of(p, owner);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) r.linear.m[i][j] = turn.m[i][j] * p.scale[p.scale.size() == 3 ? size_t(j) : 0];
    const Vec3 center = p.center.value_or(Vec3());
    r.shift = center - r.linear * center + p.translate;
  }
  if (!is_invertible(r)) fail_usage("the transform flattens what it places", owner, "scale factors must not be 0, nor the matrix singular");
  return r;
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// What the parts of slice() share.
#pragma once
#include "base/context.h"
#include "filter/mesh/plane_cutter.h"

namespace sg::detail {

struct SlicePlane {
  Vec3 origin, normal;
  double snap = 0;  ///< distances below are rounding: the point lies in the plane
  double sign = 1;  ///< -1: the plane touches the mesh from behind, so "in front" and "behind" change places
  double raw(Vec3 p) const {
    const double d = dot(normal, p - origin);
    return std::abs(d) <= snap ? 0.0 : d;
  }
  double operator()(Vec3 p) const { return sign * raw(p); }
};

struct Cut {
  std::vector<SurfaceChunk> chunks;  // ids are crossing keys
  PlaneField field;
  std::shared_ptr<const void> keep;  // what `field` refers to
};

/// Distances of listed points; turns the plane around when nothing lies behind it.
std::vector<double> distances(size_t n, SlicePlane& plane, const std::function<Vec3(size_t)>& at);

/// Cuts a lattice of dimension 3.
Cut cut_lattice(const Mesh& mesh, const std::vector<uint8_t>& states, SlicePlane plane, Context& ctx);

}  // namespace sg::detail

// SPDX-License-Identifier: Apache-2.0
// What the parts of slice() share.
#pragma once
#include <algorithm>
#include <functional>

#include "base/context.h"
#include "base/parallel.h"
#include "filter/mesh/slice/plane_cutter.h"

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
template <class At>
std::vector<double> distances(size_t n, SlicePlane& plane, const At& at) {
  std::vector<double> d(n);
  const double lowest = parallel_reduce(
      n, 1 << 14, HUGE_VAL,
      [&](size_t begin, size_t end) {
        double low = HUGE_VAL;
        for (size_t i = begin; i < end; ++i) {
          d[i] = plane.raw(at(i));
          low = std::min(low, d[i]);
        }
        return low;
      },
      [](double a, double b) { return std::min(a, b); });
  if (lowest == 0) {
    plane.sign = -1;
    for (double& x : d) x = -x;
  }
  return d;
}

/// The cut of a plane through a uniform or rectilinear grid without hidden cells; null where it takes the general way.
DatasetPtr slice_rows(const Dataset& in, const SlicePlane& plane, Context& ctx);

using PlaneSlice = std::function<DatasetPtr(const SlicePlane&)>;
/// The surface of a box, exactly: what `slice_plane` gives for each of its planes, trimmed to the face.
DatasetPtr slice_box(const DatasetPtr& in, const Box3& box, const PlaneSlice& slice_plane, Context& ctx);

/// Cuts a lattice of dimension 3.
Cut cut_lattice(const Mesh& mesh, const std::vector<uint8_t>& states, SlicePlane plane, Context& ctx);

}  // namespace sg::detail

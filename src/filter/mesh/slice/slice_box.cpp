// SPDX-License-Identifier: Apache-2.0
// The surface of a box as a cut: plane by plane, each cut trimmed to its face. A function sampled at corners, as other shapes are, is zero
// all over cells that touch a face of the box from within, and misses edges and corners that lie inside cells.
#include "filter/mesh/append.h"
#include "filter/mesh/clip/clip.h"
#include "filter/mesh/merge_points.h"
#include "filter/mesh/slice/slice_impl.h"

namespace sg::detail {

DatasetPtr slice_box(const DatasetPtr& in, const Box3& box, const PlaneSlice& slice_plane, Context& ctx) {
  const Box3 bounds = in->bounds();
  const double beyond =
      1 + (bounds.empty() ? 0 : bounds.diagonal()) + box.diagonal();  // whether something is in the plane must not depend on rounding
  Context quiet;
  DatasetPtr none;
  std::vector<Data> faces;
  for (int a = 0; a < 3; ++a)
    for (const double sign : {-1.0, 1.0}) {
      ctx.check();
      Vec3 normal;
      normal[a] = sign;
      const ImplicitFunction f = plane_function(sign < 0 ? box.lo : box.hi, normal, bounds);
      const DatasetPtr cut = slice_plane({f.origin, f.normal, f.snap, 1});
      if (!none) none = cut;
      if (cut->cell_count() == 0) continue;
      ClipParams face;
      for (int b = 0; b < 3; ++b) {
        const double more = a == b ? beyond : 0;
        face.box.insert(face.box.end(), {box.lo[b] - more, box.hi[b] + more});
      }
      const DatasetPtr trimmed = std::get<DatasetPtr>(clip(cut, face, quiet));
      if (trimmed->cell_count() > 0) faces.push_back(trimmed);
      else none = trimmed;
    }
  if (faces.empty()) return none;
  DatasetParts out = merge_points(append(faces, {.part = false}, quiet), {.tolerance = 1e-9 * box.diagonal()}, quiet)->parts();
  out.notes = in->notes();
  out.time = in->time();
  return make_dataset(std::move(out));
}

}  // namespace sg::detail

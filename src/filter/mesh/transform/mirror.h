// SPDX-License-Identifier: Apache-2.0
// A mesh and its mirror image: the whole of what was computed as a half.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "filter/mesh/slice/implicit_function.h"

namespace sg {

struct MirrorParams {
  CutAxis axis = CutAxis::x;
  std::optional<double> position = {};
};
inline void describe(Schema& s, MirrorParams& p) {
  s("axis", p.axis, "Axis across which the mirror stands.");
  s("position", p.position, "The mirror's coordinate along it; default: the end of the mesh that is nearer to 0.");
}

/// The mesh together with its image, fields as transform() changes them (vectors, normals and tensors are mirrored). A uniform or
/// rectilinear grid whose mirror stands at one of its ends stays one, twice as long less a layer, numbered the way it was; else the two are
/// put together as append() does, but meshes of cells and surfaces share the points that lie in the mirror, so that no face remains there.
/// Throws Error(usage) for axis 'none'. O(points + cells).
DatasetPtr mirror(const DatasetPtr& in, const MirrorParams& p, Context& ctx);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// From where one sees into a surface that is open on one side: a room, a box, a bowl.
#pragma once
#include <optional>

#include "data/mesh.h"

namespace sg {

/// The unit direction out of the opening; nothing where the surface is closed, or open by less than an eighth of its area. Faces may look
/// outward or inward, as long as most of them agree.
std::optional<Vec3> open_side(const SurfaceMesh& mesh);

}  // namespace sg

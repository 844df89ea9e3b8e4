// SPDX-License-Identifier: Apache-2.0
// From which side most of a surface is seen.
#pragma once
#include <span>

#include "base/vec.h"
#include "data/mesh.h"

namespace sg {

/// `direction` (towards the viewer) turned about `up` by none, one, two or three quarters: the one from which most polygons are seen, after
/// the first term of Plemenos and Benayada's measure, "Intelligent display in scene modelling", GraphiCon 1996. Detail has many polygons: a
/// face more than the back of a head. The direction stays where it is unless another shows a tenth more.
Vec3 telling_direction(std::span<const SurfaceMesh* const> parts, Vec3 direction, Vec3 up);

}  // namespace sg

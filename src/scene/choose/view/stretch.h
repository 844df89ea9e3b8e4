// SPDX-License-Identifier: Apache-2.0
// How much longer than the numbers say the axes of data are drawn, where these measure different things.
#pragma once
#include <span>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Factors for x, y and z; negative: drawn the other way round. Degrees of longitude are as long as they are at the middle latitude;
/// heights, depths and pressures above degrees are drawn 0.3 times as long as the map is wide, and what grows downwards grows downwards. By
/// the notes of the axes (axis_notes.h) of the first dataset that has some; 1 without. `box`: of all of them.
Vec3 chosen_stretch(std::span<const DatasetPtr> data, const Box3& box);

/// Whether the third axis of a map grows downwards without saying so: it is in metres and not below 0, and the farther along it the fewer
/// places have a value, as in a sea, which ends at its floor.
bool is_unstated_depth(const Dataset& data, const Field& field);

/// The mesh with its axes scaled; fields stay as they are, but normals.
DatasetPtr stretched(const DatasetPtr& data, Vec3 factors, const Context& context);

}  // namespace sg

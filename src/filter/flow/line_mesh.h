// SPDX-License-Identifier: Apache-2.0
// Traced lines as a mesh of poly-lines with what every line has. Internal to filter/flow.
#pragma once
#include "filter/flow/packets/packet_lines.h"
#include "filter/flow/streamlines.h"

namespace sg {

/// As lines_dataset() of streamlines.h, in the order of the seeds.
DatasetPtr lines_dataset(const packets::SeedLines& lines, const std::string& velocity_name, const std::string& unit);

/// Name of a value that lines or surfaces of a flow carry themselves ("speed", "time"), next to the velocity: "speed_2" where the
/// velocity is called "speed". (FieldSet::add lets go of the array of a field of the same name.)
std::string own_value(std::string_view value, std::string_view velocity);

/// What f32 positions within the box should count from: its middle where that is far from zero, so that small numbers keep their digits,
/// else zero, so that those about zero stay as they are.
Vec3 near_origin(const Box3& box);

}  // namespace sg

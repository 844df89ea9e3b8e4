// SPDX-License-Identifier: Apache-2.0
// Traced lines as a mesh of poly-lines with what every line has. Internal to filter/flow.
#pragma once
#include "filter/flow/packets/packet_lines.h"

namespace sg {

/// Lines of two points and more, in the order of the seeds: point fields "speed", the velocity, "time", "length"; cell fields "seed" and
/// "stop" (see streamlines.h). f32, about an origin of their own when they lie far from zero.
DatasetPtr lines_dataset(const TracedLines& lines, const std::string& velocity_name, const std::string& unit);
DatasetPtr lines_dataset(const packets::SeedLines& lines, const std::string& velocity_name, const std::string& unit);

}  // namespace sg

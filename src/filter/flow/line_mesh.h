// SPDX-License-Identifier: Apache-2.0
// Traced lines as a mesh of poly-lines with what every line has. Internal to filter/flow.
#pragma once
#include "filter/flow/packets/packet_lines.h"
#include "filter/flow/streamlines.h"

namespace sg {

/// As lines_dataset() of streamlines.h, in the order of the seeds.
DatasetPtr lines_dataset(const packets::SeedLines& lines, const std::string& velocity_name, const std::string& unit);

}  // namespace sg

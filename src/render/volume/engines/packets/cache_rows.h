// SPDX-License-Identifier: Apache-2.0
// Rows of a lattice that share places in the processor's first cache. It has as many ways as lines may stand at the same distance from the
// begin of a page: rows and layers that are a multiple of a page apart, as in 512^3 floats, crowd each other out of it.
#pragma once
#include "render/volume/engines/packets/packet_rays.h"

namespace sg::volume {

/// How many of `rows` times `layers` neighbouring rows fall on the same line of a page; their bytes apart.
size_t rows_on_one_line(size_t rows, size_t layers, size_t row_bytes, size_t layer_bytes);

/// Do the rows that the rays of a packet (`width` pixels across) meet at one depth, in the middle of the volume, crowd each other out?
bool crowded(const Voxels& voxels, const RayPacket& rays, int width, int lanes);

}  // namespace sg::volume

// SPDX-License-Identifier: Apache-2.0
// Numbers as whole ones of few bits.
#pragma once
#include <cstdint>
#include <vector>

#include "base/vec.h"
#include "pipeline/offline/pack/arrays.h"
#include "render/prepare/prepared.h"

namespace sg::offline {

/// Places as whole numbers over their box: at most half of box / (2^bits - 1) off along each axis. {"array","bits","lo","size","origin"}:
/// place = origin + lo + size * code / (2^bits - 1). Values are finite.
Json pack_positions(const std::vector<float>& xyz, Vec3 origin, int bits, ArrayStore& store);

/// Unit vectors folded onto a square (octahedral, Meyer et al. 2010), `bits` for each of its two coordinates. {"array","bits"}.
Json pack_normals(const std::vector<float>& normals, int bits, ArrayStore& store);
/// What is read back of one.
Vec3f unpacked_normal(uint32_t u, uint32_t v, int bits);

/// Positions on a colour scale. Code 0: no value; the scale itself takes the middle 7/8 of the codes, so that its ends are exact and
/// what lies beyond stays beyond. {"array","bits","least","most"}: the outermost positions.
Json pack_scale_positions(const std::vector<double>& t, int bits, ArrayStore& store);
/// The position that a code stands for, NaN for code 0.
double unpacked_scale_position(uint32_t code, int bits, double least, double most);

/// Linear straight RGBA as sRGB bytes. {"array"}.
Json pack_colors(const std::vector<float>& rgba, ArrayStore& store);

}  // namespace sg::offline

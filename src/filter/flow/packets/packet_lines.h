// SPDX-License-Identifier: Apache-2.0
// Lines from seeds by packets, where the mesh, the numbers and the scheme are such that packets know them.
#pragma once
#include <optional>

#include "filter/flow/packets/packets.h"

namespace sg::packets {

/// One direction from one seed; count 0: no velocity at the seed, or not requested.
struct Piece {
  const Record* first = nullptr;
  size_t count = 0;
  StopReason stop = StopReason::outside;
};
struct SeedLines {
  Vec3 origin;                               ///< to be added to the records' places
  std::vector<Piece> backward, forward;      ///< per seed
  std::vector<std::unique_ptr<Lines>> keep;  ///< owns the records
};

/// Nothing when packets do not know how: only for uniform grids of solid cells and for tetrahedra, f32 fields of 3 components, no hidden
/// cells, and midpoint, rk4 or dormand_prince with a tolerance of 1e-12 and more.
std::optional<SeedLines> trace(const FlowField& field, std::span<const Vec3> seeds, TraceDirection direction, const TraceOptions& options,
                               Context& context);

}  // namespace sg::packets

// SPDX-License-Identifier: Apache-2.0
#include "render/volume/engines/engine.h"

namespace sg::volume {

std::unique_ptr<TileEngine> engine_for(const EngineInput& input) {
  // Shadows, occlusion, styles and means of cells are for single rays.
  if (input.volume.averaged) return nullptr;
  if (input.volume.effects) return scattering_packets(input);
  constexpr EngineFactory fastest_first[] = {tolerant_packets, marching_packets, maximum_packets, brick_engine, tetrahedra_engine};
  for (const EngineFactory make : fastest_first)
    if (auto engine = make(input)) return engine;
  return nullptr;
}

}  // namespace sg::volume

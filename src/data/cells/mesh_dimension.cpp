// SPDX-License-Identifier: Apache-2.0
#include "data/cells/mesh_dimension.h"

#include <algorithm>
#include <span>

#include "data/lattice.h"

namespace sg {

int mesh_dimension(const Dataset& d) {
  if (const auto* amr = d.as<AmrGrid>()) return amr->dimension;
  if (is_lattice(d.mesh())) {
    int n = 0;
    for (const size_t points : lattice_dims(d.mesh())) n += points > 1;
    return n;
  }
  if (const auto* u = d.as<UnstructuredMesh>()) {
    if (u->types.empty()) return d.cell_count() > 0 ? cell_type_info(u->single_type).dimension : 0;
    bool seen[256] = {};
    const Array types = u->types.made_packed();
    for (const uint8_t t : std::span(types.view<uint8_t>().data, types.count())) seen[t] = true;
    int most = 0;
    for (int t = 0; t < 256; ++t)
      if (seen[t]) most = std::max(most, cell_type_info(CellType(t)).dimension);
    return most;
  }
  if (const auto* s = d.as<SurfaceMesh>()) return s->polygons.size() + s->strips.size() > 0 ? 2 : s->lines.size() > 0 ? 1 : 0;
  return 0;
}

}  // namespace sg

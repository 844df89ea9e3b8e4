// SPDX-License-Identifier: Apache-2.0
#include "io/vtk/named_linear.h"

#include <algorithm>

namespace sg::vtk {

namespace {

struct Quadratic {
  CellType linear;
  size_t points;
  CellType quadratic;
};
constexpr Quadratic known[] = {
    {CellType::line, 3, CellType::quadratic_edge},
    {CellType::triangle, 6, CellType::quadratic_triangle},
    {CellType::quad, 8, CellType::quadratic_quad},
    {CellType::quad, 9, CellType::biquadratic_quad},
    {CellType::tetra, 10, CellType::quadratic_tetra},
    {CellType::hexahedron, 20, CellType::quadratic_hexahedron},
    {CellType::hexahedron, 27, CellType::triquadratic_hexahedron},
    {CellType::wedge, 15, CellType::quadratic_wedge},
    {CellType::pyramid, 13, CellType::quadratic_pyramid},
};

CellType mended(CellType type, size_t points) {
  const auto at =
      std::find_if(std::begin(known), std::end(known), [&](const Quadratic& q) { return q.linear == type && q.points == points; });
  return at == std::end(known) ? type : at->quadratic;
}

}  // namespace

size_t mend_named_linear(UnstructuredMesh& mesh) {
  const size_t n = mesh.cells.size();
  if (n == 0) return 0;
  if (mesh.types.empty() && mesh.cells.fixed > 0) {
    const CellType type = mended(mesh.single_type, size_t(mesh.cells.fixed));
    const bool changed = type != mesh.single_type;
    mesh.single_type = type;
    return changed ? n : 0;
  }
  const CellsView cells = cells_view(mesh.cells);
  std::vector<uint8_t> types(n);
  size_t count = 0;
  for (size_t c = 0; c < n; ++c) {
    const CellType type = mesh.type(c), better = mended(type, cells.size(c));
    types[c] = uint8_t(better), count += better != type;
  }
  if (count > 0) mesh.types = Array::from_vector(std::move(types));
  return count;
}

}  // namespace sg::vtk

// SPDX-License-Identifier: Apache-2.0
#include "data/cells/plane_normal.h"

namespace sg {

std::optional<Vec3> plane_normal(const Dataset& d, Vec3 towards) {
  if (const auto* g = d.as<UniformGrid>()) {
    for (int a = 0; a < 3; ++a) {
      const Vec3 normal = normalize(cross(g->direction.column((a + 1) % 3), g->direction.column((a + 2) % 3)));
      if (g->dims[size_t(a)] == 1) return dot(normal, towards) < 0 ? -normal : normal;
    }
    return {};
  }
  const auto* m = d.as<SurfaceMesh>();
  if (!m || m->polygons.size() == 0) return {};
  const CellsView c = cells_view(m->polygons);
  const double size = d.bounds().diagonal();
  Vec3 normal;
  for (size_t cell = 0; cell < c.count && !(length(normal) > 0); ++cell) {
    Vec3 sum;  // Newell: twice the area vector
    const Vec3 first = m->points.at(size_t(c.point(cell, 0)));
    for (size_t k = 1; k + 1 < c.size(cell); ++k)
      sum += cross(m->points.at(size_t(c.point(cell, k))) - first, m->points.at(size_t(c.point(cell, k + 1))) - first);
    if (length(sum) > 1e-9 * size * size) normal = normalize(sum);
  }
  if (!(length(normal) > 0)) return {};
  const Vec3 origin = m->points.at(size_t(c.point(0, 0)));
  for (size_t i = 0; i < m->points.count(); ++i)
    if (std::abs(dot(m->points.at(i) - origin, normal)) > 1e-4 * size) return {};
  return dot(normal, towards) < 0 ? -normal : normal;
}

}  // namespace sg

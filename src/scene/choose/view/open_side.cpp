// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/view/open_side.h"

#include <cmath>

#include "filter/mesh/surface_builder.h"

namespace sg {

std::optional<Vec3> open_side(const SurfaceMesh& mesh) {
  const CellsView polygons = cells_view(mesh.polygons);
  Box3 box;
  const PointReader points(mesh.points);
  for (size_t i = 0; i < mesh.points.count(); ++i) box.add(points[i]);
  if (polygons.count == 0 || box.empty()) return {};
  const Vec3 middle = box.center();
  Vec3 missing;  // minus the sum of all area vectors, which of a closed surface is zero
  double area = 0, volume = 0;
  for (size_t c = 0; c < polygons.count; ++c)
    for (size_t k = 1; k + 1 < polygons.size(c); ++k) {
      const auto at = [&](size_t i) { return points[size_t(polygons.point(c, i))] - middle; };
      const Vec3 a = at(0), normal = cross(at(k) - a, at(k + 1) - a) * 0.5;
      missing -= normal, area += length(normal), volume += dot(a, normal) / 3;
    }
  if (!(length(missing) > 0.125 * area)) return {};
  return normalize(volume < 0 ? -missing : missing);
}

}  // namespace sg

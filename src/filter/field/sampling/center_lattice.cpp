// SPDX-License-Identifier: Apache-2.0
#include "filter/field/sampling/center_lattice.h"

#include "base/error.h"
#include "data/lattice.h"

namespace sg {

namespace {

Array middles(const Array& axis) {
  std::vector<double> m;
  for (size_t i = 0; i + 1 < axis.count(); ++i) m.push_back(0.5 * (axis.get(i) + axis.get(i + 1)));
  if (m.empty())
    for (size_t i = 0; i < axis.count(); ++i) m.push_back(axis.get(i));
  return Array::from_vector(std::move(m));
}

}  // namespace

Mesh center_lattice(const Mesh& mesh) {
  if (auto* u = std::get_if<UniformGrid>(&mesh)) {
    UniformGrid g = *u;
    Vec3 half{0, 0, 0};
    for (int a = 0; a < 3; ++a)
      if (g.dims[size_t(a)] > 1) half[a] = 0.5 * g.spacing[a], --g.dims[size_t(a)];
    g.origin = g.origin + g.direction * half;
    return g;
  }
  if (auto* r = std::get_if<RectilinearGrid>(&mesh)) return RectilinearGrid{middles(r->x), middles(r->y), middles(r->z), r->extent_start};
  if (!is_lattice(mesh)) fail_internal("centres were requested of a mesh that is not a lattice");
  const Lattice lattice(mesh);
  const LatticeView& v = lattice.view();
  CurvilinearGrid g;
  g.dims = v.cell_dims();
  size_t step[3];
  for (size_t a = 0; a < 3; ++a) step[a] = v.dims[a] > 1 ? 1 : 0;
  std::vector<double> xyz;
  for (size_t k = 0; k < g.dims[2]; ++k)
    for (size_t j = 0; j < g.dims[1]; ++j)
      for (size_t i = 0; i < g.dims[0]; ++i) {
        Vec3 sum{0, 0, 0};
        for (size_t c = 0; c < 8; ++c)
          sum = sum + v.position(i + (c & 1) * step[0], j + (c >> 1 & 1) * step[1], k + (c >> 2) * step[2]) - v.origin;
        for (int a = 0; a < 3; ++a) xyz.push_back(sum[a] / 8);
      }
  g.points.xyz = Array::from_vector(std::move(xyz), 3);
  g.points.origin = v.origin;
  return g;
}

}  // namespace sg

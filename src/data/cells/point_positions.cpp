// SPDX-License-Identifier: Apache-2.0
#include "data/cells/point_positions.h"

#include "base/parallel.h"
#include "data/lattice.h"

namespace sg {

namespace {

constexpr size_t points_per_chunk = 1 << 15;

void put(Vec3 p, double* out) { out[0] = p.x, out[1] = p.y, out[2] = p.z; }

Array of_lattice(const Mesh& mesh) {
  const Lattice lattice(mesh);
  const LatticeView& v = lattice.view();
  double* out = nullptr;
  Array a = Array::make<double>(v.points(), 3, &out);
  parallel_for(v.points(), points_per_chunk, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p)
      put(v.position(p % v.dims[0], p / v.dims[0] % v.dims[1], p / (v.dims[0] * v.dims[1])), out + 3 * p);
  });
  return a;
}

Array of_listed(const Points& points) {
  if (points.origin == Vec3{0, 0, 0} && points.xyz.type() == ElementType::f64) return points.xyz.made_packed();
  double* out = nullptr;
  Array a = Array::make<double>(points.count(), 3, &out);
  parallel_for(points.count(), points_per_chunk, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) put(points.at(p), out + 3 * p);
  });
  return a;
}

Array of_amr(const AmrGrid& g) {
  double* out = nullptr;
  Array a = Array::make<double>(point_count(Mesh(g)), 3, &out);
  for (const AmrGrid::Level& level : g.levels)
    for (const AmrGrid::Patch& patch : level.patches) {
      const auto cells = patch.cells();
      size_t n[3];
      for (int i = 0; i < 3; ++i) n[i] = i < g.dimension ? cells[size_t(i)] + 1 : 1;
      double* p = out + 3 * patch.point_offset;
      for (size_t k = 0; k < n[2]; ++k)
        for (size_t j = 0; j < n[1]; ++j)
          for (size_t i = 0; i < n[0]; ++i, p += 3)
            put({g.origin.x + level.spacing.x * (double(patch.lo[0]) + double(i)),
                 g.origin.y + level.spacing.y * (double(patch.lo[1]) + double(j)),
                 g.origin.z + level.spacing.z * (double(patch.lo[2]) + double(k))},
                p);
    }
  return a;
}

}  // namespace

Array point_positions(const Mesh& mesh) {
  if (auto* c = std::get_if<CurvilinearGrid>(&mesh)) return of_listed(c->points);
  if (is_lattice(mesh)) return of_lattice(mesh);
  if (auto* u = std::get_if<UnstructuredMesh>(&mesh)) return of_listed(u->points);
  if (auto* s = std::get_if<SurfaceMesh>(&mesh)) return of_listed(s->points);
  if (auto* c = std::get_if<PointCloud>(&mesh)) return of_listed(c->points);
  return of_amr(std::get<AmrGrid>(mesh));
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Whether two time steps have the same mesh.
#include <cstring>

#include "base/parallel.h"
#include "filter/flow/unsteady/unsteady_flow.h"

namespace sg {

namespace {

bool same(const Array& a, const Array& b) {
  if (a.count() != b.count() || a.components() != b.components() || a.type() != b.type()) return false;
  if (a.raw() == b.raw() && a.stride_bytes() == b.stride_bytes() && a.component_stride_bytes() == b.component_stride_bytes()) return true;
  const Array p = a.made_packed(), q = b.made_packed();
  return parallel_reduce(
      p.bytes(), size_t(1) << 20, true,
      [&](size_t begin, size_t end) { return std::memcmp(p.raw() + begin, q.raw() + begin, end - begin) == 0; },
      [](bool x, bool y) { return x && y; });
}

bool same(const CellArray& a, const CellArray& b) {
  return a.fixed == b.fixed && same(a.offsets, b.offsets) && same(a.connectivity, b.connectivity);
}

bool same_points(const Points& a, const Points& b) { return a.origin == b.origin && same(a.xyz, b.xyz); }

struct SameCells {
  bool operator()(const UniformGrid& a, const UniformGrid& b) const { return a.dims == b.dims; }
  bool operator()(const RectilinearGrid& a, const RectilinearGrid& b) const { return a.dims() == b.dims(); }
  bool operator()(const CurvilinearGrid& a, const CurvilinearGrid& b) const { return a.dims == b.dims; }
  bool operator()(const UnstructuredMesh& a, const UnstructuredMesh& b) const {
    return a.points.count() == b.points.count() && a.single_type == b.single_type && same(a.types, b.types) && same(a.cells, b.cells) &&
           same(a.faces, b.faces) && same(a.polyhedron_faces, b.polyhedron_faces) && same(a.degrees, b.degrees) &&
           same(a.weights, b.weights);
  }
  bool operator()(const SurfaceMesh& a, const SurfaceMesh& b) const {
    return a.points.count() == b.points.count() && same(a.vertices, b.vertices) && same(a.lines, b.lines) && same(a.polygons, b.polygons) &&
           same(a.strips, b.strips);
  }
  bool operator()(const PointCloud& a, const PointCloud& b) const { return a.points.count() == b.points.count(); }
  bool operator()(const AmrGrid& a, const AmrGrid& b) const {
    if (a.dimension != b.dimension || a.levels.size() != b.levels.size()) return false;
    for (size_t l = 0; l < a.levels.size(); ++l) {
      const auto &p = a.levels[l], &q = b.levels[l];
      if (p.ratio != q.ratio || p.patches.size() != q.patches.size()) return false;
      for (size_t i = 0; i < p.patches.size(); ++i)
        if (p.patches[i].lo != q.patches[i].lo || p.patches[i].hi != q.patches[i].hi) return false;
    }
    return true;
  }
  template <class A, class B>
  bool operator()(const A&, const B&) const {
    return false;
  }
};

struct SamePlaces {
  bool operator()(const UniformGrid& a, const UniformGrid& b) const {
    return a.origin == b.origin && a.spacing == b.spacing && a.direction == b.direction;
  }
  bool operator()(const RectilinearGrid& a, const RectilinearGrid& b) const { return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z); }
  bool operator()(const AmrGrid& a, const AmrGrid& b) const {
    if (!(a.origin == b.origin)) return false;
    for (size_t l = 0; l < a.levels.size(); ++l)
      if (!(a.levels[l].spacing == b.levels[l].spacing)) return false;
    return true;
  }
  template <class A>
  bool operator()(const A& a, const A& b) const {
    return same_points(a.points, b.points);
  }
  template <class A, class B>
  bool operator()(const A&, const B&) const {
    return false;
  }
};

}  // namespace

bool same_cells(const Dataset& a, const Dataset& b) {
  if (&a == &b) return true;
  return std::visit(SameCells(), a.mesh(), b.mesh()) && same(a.cell_ghost(), b.cell_ghost()) && same(a.point_ghost(), b.point_ghost());
}

bool same_mesh(const Dataset& a, const Dataset& b) {
  return &a == &b || (same_cells(a, b) && std::visit(SamePlaces(), a.mesh(), b.mesh()));
}

}  // namespace sg

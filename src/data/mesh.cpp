// SPDX-License-Identifier: Apache-2.0
#include "data/mesh.h"

#include <algorithm>
#include <map>

#include "base/parallel.h"
#include "data/lattice.h"

namespace sg {

Mesh::Mesh(const Mesh&) = default;
Mesh::Mesh(Mesh&&) noexcept = default;
Mesh& Mesh::operator=(const Mesh&) = default;
Mesh& Mesh::operator=(Mesh&&) noexcept = default;
Mesh::~Mesh() = default;

IndexView index_view(const Array& a) {
  if (a.empty()) return {};
  if (a.type() != ElementType::i64 && a.type() != ElementType::i32) fail_internal("cell indices must be i32 or i64");
  if (!a.packed()) fail_internal("cell indices must be contiguous");
  return {a.raw(), a.type() == ElementType::i64};
}

CellsView cells_view(const CellArray& a) {
  return {index_view(a.connectivity), a.fixed > 0 ? IndexView{} : index_view(a.offsets), a.size(), a.fixed};
}

std::string_view mesh_kind(const Mesh& mesh) {
  constexpr std::string_view names[] = {"uniform", "rectilinear", "curvilinear", "unstructured", "surface", "points", "amr"};
  return names[mesh.index()];
}

namespace {

const Points* listed_points(const Mesh& mesh) {
  if (auto* m = std::get_if<CurvilinearGrid>(&mesh)) return &m->points;
  if (auto* m = std::get_if<UnstructuredMesh>(&mesh)) return &m->points;
  if (auto* m = std::get_if<SurfaceMesh>(&mesh)) return &m->points;
  if (auto* m = std::get_if<PointCloud>(&mesh)) return &m->points;
  return nullptr;
}

size_t lattice_cells(const std::array<size_t, 3>& d) {
  if (d[0] == 0 || d[1] == 0 || d[2] == 0) return 0;
  return std::max<size_t>(d[0] - 1, 1) * std::max<size_t>(d[1] - 1, 1) * std::max<size_t>(d[2] - 1, 1);
}

template <class T>
Box3 bounds_of(const View<T>& v, Vec3 origin) {
  return parallel_reduce(
      v.count, 1 << 16, Box3{},
      [&](size_t begin, size_t end) {
        T lo[3], hi[3];
        for (int c = 0; c < 3; ++c) lo[c] = std::numeric_limits<T>::infinity(), hi[c] = -lo[c];
        for (size_t i = begin; i < end; ++i)
          for (int c = 0; c < 3; ++c) {
            const T x = v(i, c);
            lo[c] = x < lo[c] ? x : lo[c];
            hi[c] = x > hi[c] ? x : hi[c];
          }
        Box3 b;
        b.lo = origin + Vec3(double(lo[0]), double(lo[1]), double(lo[2]));
        b.hi = origin + Vec3(double(hi[0]), double(hi[1]), double(hi[2]));
        return b;
      },
      [](Box3 a, const Box3& b) {
        a.add(b);
        return a;
      });
}

}  // namespace

size_t point_count(const Mesh& mesh) {
  if (const Points* p = listed_points(mesh)) return p->count();
  if (auto* m = std::get_if<AmrGrid>(&mesh)) {
    size_t n = 0;
    for (const auto& level : m->levels)
      for (const auto& patch : level.patches) {
        const auto c = patch.cells();
        n += (c[0] + 1) * (c[1] + 1) * (m->dimension == 3 ? c[2] + 1 : 1);
      }
    return n;
  }
  const auto d = lattice_dims(mesh);
  return d[0] * d[1] * d[2];
}

size_t cell_count(const Mesh& mesh) {
  if (auto* m = std::get_if<UnstructuredMesh>(&mesh)) return m->cells.size();
  if (auto* m = std::get_if<SurfaceMesh>(&mesh)) return m->cell_count();
  if (std::get_if<PointCloud>(&mesh)) return 0;
  if (auto* m = std::get_if<AmrGrid>(&mesh)) {
    size_t n = 0;
    for (const auto& level : m->levels)
      for (const auto& patch : level.patches) {
        const auto c = patch.cells();
        n += c[0] * c[1] * c[2];
      }
    return n;
  }
  return lattice_cells(lattice_dims(mesh));
}

Box3 bounds(const Mesh& mesh) {
  Box3 b;
  if (const Points* p = listed_points(mesh)) {
    if (p->count() == 0) return b;
    return p->xyz.type() == ElementType::f32 ? bounds_of(p->xyz.view<float>(), p->origin) : bounds_of(p->xyz.view<double>(), p->origin);
  }
  if (auto* m = std::get_if<UniformGrid>(&mesh)) {
    if (point_count(mesh) == 0) return b;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 index{corner & 1 ? double(m->dims[0] - 1) : 0.0, corner & 2 ? double(m->dims[1] - 1) : 0.0,
                       corner & 4 ? double(m->dims[2] - 1) : 0.0};
      b.add(m->origin + m->direction * (m->spacing * index));
    }
  } else if (auto* r = std::get_if<RectilinearGrid>(&mesh)) {
    if (point_count(mesh) == 0) return b;
    const Array* axes[3] = {&r->x, &r->y, &r->z};
    Vec3 first, last;
    for (int a = 0; a < 3; ++a) first[a] = axes[a]->get(0), last[a] = axes[a]->get(axes[a]->count() - 1);
    b.add(first);
    b.add(last);
  } else if (auto* g = std::get_if<AmrGrid>(&mesh)) {
    for (const auto& level : g->levels)
      for (const auto& patch : level.patches)
        for (int a = 0; a < 3; ++a) {
          const double lo = g->origin[a] + double(patch.lo[a]) * level.spacing[a];
          const double hi = g->dimension == 2 && a == 2 ? lo : g->origin[a] + double(patch.hi[a] + 1) * level.spacing[a];
          b.lo[a] = std::min(b.lo[a], lo);
          b.hi[a] = std::max(b.hi[a], hi);
        }
  }
  return b;
}

std::vector<std::pair<std::string_view, size_t>> cell_type_counts(const Mesh& mesh) {
  std::array<size_t, 256> counts{};
  auto add = [&](CellType t, size_t n) { counts[size_t(t)] += n; };
  if (is_lattice(mesh)) {
    const auto d = lattice_dims(mesh);
    const int axes = int(d[0] > 1) + int(d[1] > 1) + int(d[2] > 1);
    const bool box = !std::holds_alternative<CurvilinearGrid>(mesh);
    const CellType t[] = {CellType::vertex, CellType::line, box ? CellType::pixel : CellType::quad,
                          box ? CellType::voxel : CellType::hexahedron};
    add(t[axes], cell_count(mesh));
  } else if (auto* g = std::get_if<AmrGrid>(&mesh)) {
    add(g->dimension == 2 ? CellType::pixel : CellType::voxel, cell_count(mesh));
  } else if (auto* u = std::get_if<UnstructuredMesh>(&mesh)) {
    if (u->types.empty()) {
      add(u->single_type, u->cells.size());
    } else {
      const auto types = u->types.view<uint8_t>();
      for (size_t i = 0; i < types.count; ++i) ++counts[types[i]];
    }
  } else if (auto* s = std::get_if<SurfaceMesh>(&mesh)) {
    // A polygon of three or four points is called by its own name, a line of two points likewise.
    auto by_size = [&](const CellArray& cells, size_t a, CellType ta, size_t b, CellType tb, CellType other) {
      const CellsView v = cells_view(cells);
      for (size_t i = 0; i < v.count; ++i) add(v.size(i) == a ? ta : v.size(i) == b ? tb : other, 1);
    };
    by_size(s->vertices, 1, CellType::vertex, 1, CellType::vertex, CellType::poly_vertex);
    by_size(s->lines, 2, CellType::line, 2, CellType::line, CellType::poly_line);
    if (s->polygons.fixed == 3) add(CellType::triangle, s->polygons.size());
    else by_size(s->polygons, 3, CellType::triangle, 4, CellType::quad, CellType::polygon);
    add(CellType::triangle_strip, s->strips.size());
  }
  std::vector<std::pair<std::string_view, size_t>> r;
  for (size_t t = 0; t < counts.size(); ++t)
    if (counts[t]) r.emplace_back(cell_type_info(uint8_t(t)) ? cell_type_info(uint8_t(t))->name : "unknown", counts[t]);
  return r;
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/surface_builder.h"

#include <algorithm>

#include "base/parallel.h"
#include "data/field_ops.h"
#include "filter/mesh/select/id_set.h"

namespace sg {

PointReader::PointReader(const Points& p) : origin(p.origin), keep(p.xyz.made_packed()) {
  if (keep.empty()) return;
  if (keep.type() == ElementType::f32) f32 = keep.view<float>().data;
  else f64 = keep.view<double>().data;
}

CellArray cell_array(const std::vector<const CellList*>& lists, const std::function<int32_t(int64_t)>& number) {
  size_t cells = 0, ids = 0;
  bool same = true;
  uint32_t size = 0;
  for (const CellList* l : lists) {
    cells += l->sizes.size();
    ids += l->ids.size();
    for (uint32_t s : l->sizes) {
      if (size == 0) size = s;
      same = same && s == size;
    }
  }
  CellArray r;
  if (cells == 0) return r;
  if (ids > size_t(INT32_MAX)) fail_usage("the surface has more than 2^31 corners", {}, "take a part of the mesh first");
  int32_t *to = nullptr, *offset = nullptr;
  r.connectivity = Array::make<int32_t>(ids, 1, &to);
  if (same && size > 0) r.fixed = int(size);
  else r.offsets = Array::make<int32_t>(cells + 1, 1, &offset);
  std::vector<size_t> first_id(lists.size()), first_cell(lists.size());
  for (size_t i = 0; i < lists.size(); ++i) first_id[i] = lists[i]->ids.size(), first_cell[i] = lists[i]->sizes.size();
  exclusive_scan(first_id);
  exclusive_scan(first_cell);
  parallel_for(lists.size(), 1, [&](size_t l, size_t) {
    const CellList& list = *lists[l];
    int32_t* at = to + first_id[l];
    for (int64_t id : list.ids) *at++ = number(id);
    if (!offset) return;
    size_t sum = first_id[l];
    for (size_t i = 0; i < list.sizes.size(); ++i) offset[first_cell[l] + i] = int32_t(sum), sum += list.sizes[i];
  });
  if (offset) offset[cells] = int32_t(ids);
  return r;
}

AssembledSurface assemble(const std::vector<SurfaceChunk>& chunks, size_t point_count) {
  IdSet used(point_count);
  parallel_for(chunks.size(), 1, [&](size_t c, size_t) {
    for (const CellList* l : {&chunks[c].vertices, &chunks[c].lines, &chunks[c].polygons, &chunks[c].outlines})
      for (int64_t id : l->ids) used.add(size_t(id));
  });
  used.number();
  AssembledSurface r;
  r.points = used.members();
  auto number = [&](int64_t id) { return int32_t(used.rank(size_t(id))); };
  auto join = [&](CellList SurfaceChunk::*member, bool cells = true) {
    std::vector<const CellList*> lists;
    for (const SurfaceChunk& c : chunks) {
      if ((c.*member).sizes.empty()) continue;
      lists.push_back(&(c.*member));
      if (cells) r.cells.insert(r.cells.end(), (c.*member).sources.begin(), (c.*member).sources.end());
    }
    return cell_array(lists, number);
  };
  r.mesh.vertices = join(&SurfaceChunk::vertices);
  r.mesh.lines = join(&SurfaceChunk::lines);
  r.mesh.polygons = join(&SurfaceChunk::polygons);
  r.outlines = join(&SurfaceChunk::outlines, false);
  return r;
}

Points gather_points(const Points& points, std::span<const int64_t> ids) { return {gather(points.xyz, ids), points.origin}; }

Points lattice_points(const Mesh& mesh, std::span<const int64_t> ids) {
  if (auto* g = std::get_if<CurvilinearGrid>(&mesh)) return gather_points(g->points, ids);
  const Lattice lattice(mesh);
  const LatticeView v = lattice.view();
  double* to = nullptr;
  Points p;
  p.xyz = Array::make<double>(ids.size(), 3, &to);
  parallel_for(ids.size(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t n = begin; n < end; ++n) {
      const auto id = size_t(ids[n]);
      const Vec3 at = v.position(id % v.dims[0], id / v.dims[0] % v.dims[1], id / (v.dims[0] * v.dims[1]));
      for (int c = 0; c < 3; ++c) to[3 * n + size_t(c)] = at[c];
    }
  });
  return p;
}

Points amr_points(const AmrGrid& grid, std::span<const int64_t> ids) {
  struct Home {
    size_t first;
    const AmrGrid::Level* level;
    const AmrGrid::Patch* patch;
  };
  std::vector<Home> homes;
  for (const auto& level : grid.levels)
    for (const auto& patch : level.patches) homes.push_back({patch.point_offset, &level, &patch});
  std::sort(homes.begin(), homes.end(), [](const Home& a, const Home& b) { return a.first < b.first; });
  double* to = nullptr;
  Points p;
  p.xyz = Array::make<double>(ids.size(), 3, &to);
  parallel_for(ids.size(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t n = begin; n < end; ++n) {
      const auto id = size_t(ids[n]);
      const Home& h = *(std::upper_bound(homes.begin(), homes.end(), id, [](size_t x, const Home& home) { return x < home.first; }) - 1);
      const auto c = h.patch->cells();
      const size_t local = id - h.first, nx = c[0] + 1, ny = c[1] + 1;
      const size_t ijk[3] = {local % nx, local / nx % ny, local / (nx * ny)};
      for (size_t a = 0; a < 3; ++a) {
        const bool flat = grid.dimension == 2 && a == 2;
        to[3 * n + a] = grid.origin[int(a)] + double(h.patch->lo[a] + (flat ? 0 : (long long)(ijk[a]))) * h.level->spacing[int(a)];
      }
    }
  });
  return p;
}

Points points_of(const Mesh& mesh, std::span<const int64_t> ids) {
  if (is_lattice(mesh)) return lattice_points(mesh, ids);
  if (auto* m = std::get_if<UnstructuredMesh>(&mesh)) return gather_points(m->points, ids);
  if (auto* m = std::get_if<SurfaceMesh>(&mesh)) return gather_points(m->points, ids);
  if (auto* m = std::get_if<PointCloud>(&mesh)) return gather_points(m->points, ids);
  return amr_points(std::get<AmrGrid>(mesh), ids);
}

namespace {

// Calls f(id) for each point of a cell, for the mesh kinds whose cells have listed or lattice points.
class CellPoints {
 public:
  explicit CellPoints(const Mesh& mesh) {
    if (is_lattice(mesh)) {
      dims_ = lattice_dims(mesh);
    } else if (auto* u = std::get_if<UnstructuredMesh>(&mesh)) {
      lists_.push_back(cells_view(u->cells));
    } else if (auto* s = std::get_if<SurfaceMesh>(&mesh)) {
      for (const CellArray* a : {&s->vertices, &s->lines, &s->polygons, &s->strips}) lists_.push_back(cells_view(*a));
    }
  }
  bool known() const { return dims_[0] || !lists_.empty(); }
  template <class F>
  bool any(size_t cell, F f) const {
    if (dims_[0]) {
      const size_t cx = std::max<size_t>(dims_[0], 2) - 1, cy = std::max<size_t>(dims_[1], 2) - 1;
      const size_t i = cell % cx, j = cell / cx % cy, k = cell / (cx * cy);
      for (size_t c = 0; c < 8; ++c) {
        const size_t p = i + (c & 1), q = j + (c >> 1 & 1), r = k + (c >> 2);
        if (p < dims_[0] && q < dims_[1] && r < dims_[2] && f(p + dims_[0] * (q + dims_[1] * r))) return true;
      }
      return false;
    }
    for (const CellsView& v : lists_) {
      if (cell >= v.count) {
        cell -= v.count;
        continue;
      }
      for (size_t i = v.begin(cell); i < v.end(cell); ++i)
        if (f(size_t(v.connectivity[i]))) return true;
      return false;
    }
    return false;
  }

 private:
  std::array<size_t, 3> dims_{};
  std::vector<CellsView> lists_;
};

// Patches of a level may overlap: the first patch that shows a cell keeps it.
void mark_twins(const AmrGrid& grid, size_t cells, std::vector<uint8_t>& states) {
  for (const auto& level : grid.levels)
    for (size_t p = 1; p < level.patches.size(); ++p)
      for (size_t q = 0; q < p; ++q) {
        const auto &a = level.patches[p], &b = level.patches[q];
        long long lo[3], hi[3];
        bool overlap = true;
        for (size_t x = 0; x < 3; ++x) {
          lo[x] = std::max(a.lo[x], b.lo[x]), hi[x] = std::min(a.hi[x], b.hi[x]);
          overlap = overlap && lo[x] <= hi[x];
        }
        if (!overlap) continue;
        states.resize(cells);
        auto number = [](const AmrGrid::Patch& h, long long i, long long j, long long k) {
          const auto n = h.cells();
          return h.cell_offset + size_t(i - h.lo[0]) + n[0] * (size_t(j - h.lo[1]) + n[1] * size_t(k - h.lo[2]));
        };
        for (long long k = lo[2]; k <= hi[2]; ++k)
          for (long long j = lo[1]; j <= hi[1]; ++j)
            for (long long i = lo[0]; i <= hi[0]; ++i) {
              uint8_t& state = states[number(a, i, j, k)];
              if (state == cell_visible && states[number(b, i, j, k)] != cell_gone) state = cell_duplicate;
            }
      }
}

}  // namespace

std::vector<uint8_t> cell_states(const Dataset& in) {
  std::vector<uint8_t> states;
  const size_t n = in.cell_count();
  if (!in.cell_ghost().empty()) {
    states.resize(n);
    const auto ghost = in.cell_ghost().view<uint8_t>();
    for (size_t c = 0; c < n; ++c) {
      const uint8_t g = ghost[c];
      states[c] = g & (ghost_hidden_cell | ghost_refined_cell) ? cell_gone : g & ghost_duplicate ? cell_duplicate : cell_visible;
    }
  }
  if (!in.point_ghost().empty()) {
    const auto ghost = in.point_ghost().view<uint8_t>();
    const CellPoints cells(in.mesh());
    bool hidden = false;
    for (size_t p = 0; p < ghost.count && !hidden; ++p) hidden = ghost[p] & ghost_hidden_point;
    if (hidden && cells.known()) {
      states.resize(n);
      parallel_for(n, 1 << 14, [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c)
          if (cells.any(c, [&](size_t p) { return (ghost[p] & ghost_hidden_point) != 0; })) states[c] = cell_gone;
      });
    }
  }
  if (auto* g = in.as<AmrGrid>()) mark_twins(*g, n, states);
  if (std::all_of(states.begin(), states.end(), [](uint8_t s) { return s == cell_visible; })) states.clear();
  return states;
}

Field id_field(std::string name, Association association, std::vector<int64_t> ids) {
  return {std::move(name), association, Array::from_vector(std::move(ids)), {}, Role::global_ids};
}

}  // namespace sg

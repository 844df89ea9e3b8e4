// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/cell_topology.h"
#include "filter/mesh/faces/faces_impl.h"

namespace sg::detail {

namespace {

constexpr int64_t off[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

// Corners of the sides x- x+ y- y+ z- z+ of a lattice cell, outward for a right-handed lattice.
constexpr int side_corner[6][4] = {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}};

void add_side(SurfaceChunk& out, const std::array<int64_t, 3>& points, const std::array<int64_t, 3>& cell, int64_t first_point, int side,
              bool mirrored, int64_t id) {
  int64_t quad[4];
  for (int c = 0; c < 4; ++c) {
    const int64_t* o = off[side_corner[side][mirrored ? 3 - c : c]];
    quad[c] = first_point + (cell[0] + o[0]) + points[0] * ((cell[1] + o[1]) + points[1] * (cell[2] + o[2]));
  }
  out.polygons.add(quad, id);
}

// Whether the cell at (i, j, k) is mirrored. Affine and separable lattices: all are or none.
bool is_mirrored(const LatticeView& v, int64_t i, int64_t j, int64_t k) {
  auto at = [&](int64_t a, int64_t b, int64_t c) { return v.position(size_t(i + a), size_t(j + b), size_t(k + c)); };
  Vec3 axis[3];  // sums of the four edges along each axis
  for (int64_t b = 0; b < 2; ++b)
    for (int64_t c = 0; c < 2; ++c) {
      axis[0] += at(1, b, c) - at(0, b, c);
      axis[1] += at(b, 1, c) - at(b, 0, c);
      axis[2] += at(b, c, 1) - at(b, c, 0);
    }
  return dot(axis[0], cross(axis[1], axis[2])) < 0;
}

// Lattices of dimension 0, 1, 2: every cell as it is.
void add_flat_cell(SurfaceChunk& out, const std::array<size_t, 3>& dims, int64_t i, int64_t j, int64_t k, int64_t id) {
  int64_t ids[4];
  size_t n = 0;
  const auto nx = int64_t(dims[0]), ny = int64_t(dims[1]);
  int axes[3], count = 0;
  for (int a = 0; a < 3; ++a)
    if (dims[size_t(a)] > 1) axes[count++] = a;
  constexpr int place[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (int c = 0; c < (count == 2 ? 4 : count == 1 ? 2 : 1); ++c) {
    int64_t p[3] = {i, j, k};
    for (int a = 0; a < count; ++a) p[axes[a]] += place[c][a];
    ids[n++] = p[0] + nx * (p[1] + ny * p[2]);
  }
  (count == 2 ? out.polygons : count == 1 ? out.lines : out.vertices).add(std::span<const int64_t>(ids, n), id);
}

}  // namespace

std::vector<SurfaceChunk> lattice_faces(const Mesh& mesh, const std::vector<uint8_t>& states, const Context& ctx) {
  const Lattice lattice(mesh);
  const LatticeView& v = lattice.view();
  if (v.points() == 0) return {};
  const auto cells = v.cell_dims();
  const int64_t n[3] = {int64_t(cells[0]), int64_t(cells[1]), int64_t(cells[2])};
  const std::array<int64_t, 3> points{int64_t(v.dims[0]), int64_t(v.dims[1]), int64_t(v.dims[2])};
  const bool solid = v.dims[0] > 1 && v.dims[1] > 1 && v.dims[2] > 1;
  const bool listed = v.mode == LatticeView::Mode::listed;
  const bool all_mirrored = solid && !listed && is_mirrored(v, 0, 0, 0);
  const size_t rows = cells[1] * cells[2], grain = std::max<size_t>(1, 16384 / cells[0]);
  std::vector<SurfaceChunk> chunks((rows + grain - 1) / grain);
  parallel_for(
      rows, grain,
      [&](size_t begin, size_t end) {
        SurfaceChunk& out = chunks[begin / grain];
        auto state = [&](int64_t id) { return states.empty() ? uint8_t(cell_visible) : states[size_t(id)]; };
        auto cell = [&](int64_t i, int64_t j, int64_t k, bool inner_sides) {
          const int64_t id = i + n[0] * (j + n[1] * k);
          if (state(id) != cell_visible) return;
          if (!solid) return add_flat_cell(out, v.dims, i, j, k, id);
          const int64_t at[3] = {i, j, k}, stride[3] = {1, n[0], n[0] * n[1]};
          int mirrored = listed ? -1 : int(all_mirrored);
          for (int side = 0; side < 6; ++side) {
            const int axis = side / 2;
            const bool rim = side % 2 ? at[axis] == n[axis] - 1 : at[axis] == 0;
            if (!rim && (!inner_sides || state(id + (side % 2 ? stride[axis] : -stride[axis])) != cell_gone)) continue;
            if (mirrored < 0) mirrored = is_mirrored(v, i, j, k);
            add_side(out, points, {i, j, k}, 0, side, mirrored, id);
          }
        };
        for (size_t row = begin; row < end; ++row) {
          const auto j = int64_t(row) % n[1], k = int64_t(row) / n[1];
          const bool rim = j == 0 || j == n[1] - 1 || k == 0 || k == n[2] - 1;
          if (!solid || rim || !states.empty()) {
            for (int64_t i = 0; i < n[0]; ++i) cell(i, j, k, !states.empty());
          } else {  // inside, only the ends of a row can be seen
            cell(0, j, k, false);
            if (n[0] > 1) cell(n[0] - 1, j, k, false);
          }
        }
      },
      &ctx);
  return chunks;
}

// ---- AMR ----------------------------------------------------------------------------------------------------------------

namespace {

// Answers which patch of a level holds a cell. Patches are sorted by their first axis; a level seldom has more than thousands.
class LevelIndex {
 public:
  explicit LevelIndex(const AmrGrid::Level& level) : level_(level) {
    for (size_t p = 0; p < level.patches.size(); ++p)
      order_.push_back(p), widest_ = std::max(widest_, level.patches[p].hi[0] - level.patches[p].lo[0]);
    std::sort(order_.begin(), order_.end(), [&](size_t a, size_t b) { return level.patches[a].lo[0] < level.patches[b].lo[0]; });
  }
  // Calls f(patch number, cell number in the patch) for each patch that holds the cell, until f returns true.
  template <class F>
  bool any(const std::array<long long, 3>& c, F f) const {
    auto it = std::upper_bound(order_.begin(), order_.end(), c[0], [&](long long x, size_t p) { return x < level_.patches[p].lo[0]; });
    while (it != order_.begin()) {
      const auto& p = level_.patches[*--it];
      if (p.lo[0] < c[0] - widest_) break;
      bool inside = true;
      for (size_t a = 0; a < 3; ++a) inside = inside && c[a] >= p.lo[a] && c[a] <= p.hi[a];
      if (!inside) continue;
      const auto n = p.cells();
      if (f(*it, size_t(c[0] - p.lo[0]) + n[0] * (size_t(c[1] - p.lo[1]) + n[1] * size_t(c[2] - p.lo[2])))) return true;
    }
    return false;
  }

 private:
  const AmrGrid::Level& level_;
  std::vector<size_t> order_;
  long long widest_ = 0;
};

long long floor_div(long long a, long long b) { return a / b - (a % b != 0 && (a < 0) != (b < 0)); }

class AmrWalk {
 public:
  AmrWalk(const AmrGrid& grid, const std::vector<uint8_t>& states, const Array& ghost) : grid_(grid), states_(states), ghost_(ghost) {
    for (const auto& level : grid.levels) index_.emplace_back(level);
  }

  void patch(size_t l, size_t p, SurfaceChunk& out) const {
    const AmrGrid::Patch& patch = grid_.levels[l].patches[p];
    const auto n = patch.cells();
    const std::array<int64_t, 3> points{int64_t(n[0] + 1), int64_t(n[1] + 1), int64_t(n[2] + 1)};
    const Vec3 s = grid_.levels[l].spacing;
    const bool mirrored = s.x * s.y * s.z < 0;
    size_t local = 0;
    for (int64_t k = 0; k < int64_t(n[2]); ++k)
      for (int64_t j = 0; j < int64_t(n[1]); ++j)
        for (int64_t i = 0; i < int64_t(n[0]); ++i, ++local) {
          const size_t id = patch.cell_offset + local;
          if (!states_.empty() && states_[id] != cell_visible) continue;
          const std::array<long long, 3> at{patch.lo[0] + i, patch.lo[1] + j, patch.lo[2] + k};
          if (grid_.dimension == 2) {
            add_side(out, points, {i, j, 0}, int64_t(patch.point_offset), 4, true, int64_t(id));
            continue;
          }
          const int64_t cell[3] = {i, j, k};
          const size_t stride[3] = {1, n[0], n[0] * n[1]};
          for (int side = 0; side < 6; ++side) {
            const int axis = side / 2;
            const bool up = side % 2;
            const bool rim = up ? cell[axis] == int64_t(n[size_t(axis)]) - 1 : cell[axis] == 0;
            if (!rim && filler(up ? id + stride[axis] : id - stride[axis]) == Filler::cell) continue;
            auto next = at;
            next[size_t(axis)] += up ? 1 : -1;
            if (!filled(l, next, size_t(axis), up))
              add_side(out, points, {i, j, k}, int64_t(patch.point_offset), side, mirrored, int64_t(id));
          }
        }
  }

 private:
  // What fills the place of a cell: itself (here or in another patch), finer cells, nothing.
  enum class Filler : uint8_t { nothing, finer, cell };
  Filler filler(size_t id) const {
    if (states_.empty() || states_[id] != cell_gone) return Filler::cell;
    if (ghost_.empty()) return Filler::nothing;
    return (ghost_.view<uint8_t>()[id] & (ghost_refined_cell | ghost_hidden_cell)) == ghost_refined_cell ? Filler::finer : Filler::nothing;
  }
  Filler filler(size_t l, const std::array<long long, 3>& c) const {
    Filler found = Filler::nothing;
    index_[l].any(c, [&](size_t p, size_t local) {
      found = std::max(found, filler(grid_.levels[l].patches[p].cell_offset + local));
      return found == Filler::cell;
    });
    return found;
  }
  // Is a place of level l full along its lower (`low`) or upper side of an axis: by a cell of that level, of a coarser one, or by finer
  // ones?
  bool filled(size_t l, std::array<long long, 3> c, size_t axis, bool low) const {
    const Filler here = filler(l, c);
    if (here == Filler::finer) return filled_by_finer(l, c, axis, low);
    if (here == Filler::cell) return true;
    while (l > 0) {
      for (size_t a = 0; a < 3; ++a) c[a] = floor_div(c[a], std::max(grid_.levels[l].ratio[a], 1));
      if (filler(--l, c) == Filler::cell) return true;
    }
    return false;
  }
  bool filled_by_finer(size_t l, const std::array<long long, 3>& c, size_t axis, bool low) const {
    if (l + 1 >= grid_.levels.size()) return false;
    long long n[3], first[3];
    for (size_t a = 0; a < 3; ++a) {
      n[a] = std::max(grid_.levels[l + 1].ratio[a], 1), first[a] = c[a] * n[a];
      if (a == axis) first[a] += low ? 0 : n[a] - 1, n[a] = 1;
    }
    for (long long k = 0; k < n[2]; ++k)
      for (long long j = 0; j < n[1]; ++j)
        for (long long i = 0; i < n[0]; ++i) {
          const std::array<long long, 3> fine{first[0] + i, first[1] + j, first[2] + k};
          const Filler f = filler(l + 1, fine);
          if (f == Filler::nothing || (f == Filler::finer && !filled_by_finer(l + 1, fine, axis, low))) return false;
        }
    return true;
  }

  const AmrGrid& grid_;
  const std::vector<uint8_t>& states_;
  const Array& ghost_;
  std::vector<LevelIndex> index_;
};

}  // namespace

std::vector<SurfaceChunk> amr_faces(const Dataset& in, const AmrGrid& grid, const std::vector<uint8_t>& states, const Context& ctx) {
  std::vector<std::pair<size_t, size_t>> patches;
  for (size_t l = 0; l < grid.levels.size(); ++l)
    for (size_t p = 0; p < grid.levels[l].patches.size(); ++p) patches.emplace_back(l, p);
  const AmrWalk walk(grid, states, in.cell_ghost());
  std::vector<SurfaceChunk> chunks(patches.size());
  parallel_for(
      patches.size(), 1, [&](size_t i, size_t) { walk.patch(patches[i].first, patches[i].second, chunks[i]); }, &ctx);
  return chunks;
}

}  // namespace sg::detail

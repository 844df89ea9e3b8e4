// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "base/parallel.h"
#include "filter/mesh/slice/slice_impl.h"

namespace sg::detail {

namespace {

// Solid lattices. Affine and separable ones: along a row of points the side changes once at most, so the cut cells of a row are
// found by bisection; curvilinear ones look at every cell.
class LatticeCut {
 public:
  LatticeCut(const Mesh& mesh, SlicePlane& plane) : lattice_(mesh), v_(lattice_.view()), plane_(plane) {
    if (v_.mode == LatticeView::Mode::listed) {
      d_ = distances(v_.points(), plane_, [&](size_t i) { return position(i); });
    } else {
      double lowest = HUGE_VAL;  // at a corner
      for (size_t c = 0; c < 8; ++c)
        lowest = std::min(lowest, distance(c & 1 ? v_.dims[0] - 1 : 0, c & 2 ? v_.dims[1] - 1 : 0, c & 4 ? v_.dims[2] - 1 : 0));
      if (lowest == 0) plane_.sign = -1;
    }
  }
  Vec3 position(size_t id) const { return v_.position(id % v_.dims[0], id / v_.dims[0] % v_.dims[1], id / (v_.dims[0] * v_.dims[1])); }
  double distance(size_t id) const { return d_.empty() ? plane_(position(id)) : d_[id]; }

  void cut(Cut& cut, const std::vector<uint8_t>& states, Context& ctx) const {
    const auto n = v_.cell_dims();
    const size_t grain = std::max<size_t>(1, 65536 / n[0]), rows = n[1] * n[2];
    cut.chunks.resize((rows + grain - 1) / grain);
    parallel_for(
        rows, grain,
        [&](size_t begin, size_t end) {
          PlaneCutter cutter(cut.field, cut.chunks[begin / grain]);
          for (size_t row = begin; row < end; ++row) {
            const size_t j = row % n[1], k = row / n[1];
            const auto [first, last] = range(j, k);
            for (size_t i = first; i < last; ++i) {
              const size_t cell = i + n[0] * row;
              if (!states.empty() && states[cell] != cell_visible) continue;
              cut_cell(cutter, i, j, k, cell);
            }
          }
        },
        &ctx);
  }

 private:
  double distance(size_t i, size_t j, size_t k) const { return d_.empty() ? plane_(v_.position(i, j, k)) : d_[v_.id(i, j, k)]; }

  // Cells of a row that may be cut.
  std::pair<size_t, size_t> range(size_t j, size_t k) const {
    const size_t nx = v_.dims[0];
    if (!d_.empty()) return {0, nx - 1};
    size_t first = nx, last = 0;
    bool any_front = false, any_behind = false;
    for (size_t r = 0; r < 4; ++r) {
      const size_t y = j + (r & 1), z = k + (r >> 1);
      const bool front = distance(0, y, z) >= 0, back_front = distance(nx - 1, y, z) >= 0;
      any_front |= front || back_front;
      any_behind |= !front || !back_front;
      if (front == back_front) continue;
      size_t lo = 0, hi = nx - 1;  // the side changes between lo and hi
      while (hi - lo > 1) {
        const size_t middle = (lo + hi) / 2;
        ((distance(middle, y, z) >= 0) == front ? lo : hi) = middle;
      }
      first = std::min(first, lo), last = std::max(last, hi);
    }
    if (!any_front || !any_behind) return {0, 0};
    if (first >= last) return {0, nx - 1};  // rows on different sides: every cell between them is cut
    bool all[2] = {true, true};             // are the ends of the four rows on one side?
    for (size_t r = 1; r < 4; ++r)
      for (size_t e = 0; e < 2; ++e)
        all[e] = all[e] && (distance(e * (nx - 1), j + (r & 1), k + (r >> 1)) >= 0) == (distance(e * (nx - 1), j, k) >= 0);
    if (!all[0]) first = 0;
    if (!all[1]) last = nx - 1;
    // One cell to spare on each side for rounding of rotated axes; cut_cell looks again.
    return {first > 0 ? first - 1 : 0, std::min(last + 1, nx - 1)};
  }

  void cut_cell(PlaneCutter& cutter, size_t i, size_t j, size_t k, size_t cell) const {
    static const LinearTopology& voxel = *linear_topology(CellType::voxel);
    int64_t ids[8];
    bool front = false, behind = false;
    for (size_t c = 0; c < 8; ++c) {
      const size_t x = i + (c & 1), y = j + (c >> 1 & 1), z = k + (c >> 2);
      ids[c] = int64_t(v_.id(x, y, z));
      const double d = distance(x, y, z);
      if (d != d) return;  // a corner without a position
      front |= d >= 0, behind |= d < 0;
    }
    if (!front || !behind) return;
    cutter.begin_solid();
    for (size_t f = 0; f < 6; ++f) {
      int64_t face[4];
      const auto corner = voxel.face(f);
      for (size_t c = 0; c < 4; ++c) face[c] = ids[corner[c]];
      cutter.add_face(face);
    }
    cutter.end_solid(int64_t(cell));
  }

  Lattice lattice_;
  LatticeView v_;
  SlicePlane& plane_;
  std::vector<double> d_;
};

}  // namespace

Cut cut_lattice(const Mesh& mesh, const std::vector<uint8_t>& states, SlicePlane plane, Context& ctx) {
  struct Held {
    SlicePlane plane;
    LatticeCut cut;
    Held(const Mesh& m, SlicePlane p) : plane(p), cut(m, plane) {}
  };
  auto held = std::make_shared<Held>(mesh, plane);
  Cut cut;
  cut.field = {[h = held.get()](size_t i) { return h->cut.distance(i); }, [h = held.get()](size_t i) { return h->cut.position(i); },
               plane.normal};
  cut.keep = held;
  held->cut.cut(cut, states, ctx);
  return cut;
}

}  // namespace sg::detail

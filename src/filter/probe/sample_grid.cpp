// SPDX-License-Identifier: Apache-2.0
// Scan conversion: slab by slab of a grid's layers, each by one thread. First every cell claims the points that it holds, then the fields
// are evaluated row by row. A tetrahedron claims rows at a time: its barycentric coordinates are linear along them.
#include <algorithm>
#include <mutex>

#include "base/parallel.h"
#include "filter/probe/cell_slabs.h"
#include "filter/probe/place_writer.h"
#include "filter/probe/sample.h"

namespace sg {

bool fits_sample_grid(const LatticeView& g) {
  if (g.mode != LatticeView::Mode::affine) return false;
  for (int a = 0; a < 3; ++a) {
    if (g.dims[size_t(a)] <= 1) continue;
    for (int b = 0; b < 3; ++b)
      if (a == b ? !(g.step[a][b] > 0) : g.step[a][b] != 0) return false;
  }
  return true;
}

namespace {

constexpr uint32_t none = UINT32_MAX;

// The points of some layers: which cell contains them, and where in the cell.
struct Slab {
  std::vector<uint32_t> cell;
  Plane<Vec3> rst;
};

class Scanner {
 public:
  /// `slab` is scratch.
  Scanner(const GridScan& scan, Slab& slab, size_t k0, size_t k1)
      : scan_(scan), probe_(scan.probe()), reader_(scan.map.reader()), slab_(slab), k0_(k0), k1_(k1) {
    slab_.cell.assign(scan.dims[0] * scan.dims[1] * (k1 - k0), none);
    slab_.rst.resize(slab_.cell.size());
  }
  void claim(uint32_t cell) {
    if (scan_.simplices.type(cell) == CellType::tetra) claim_tetra(cell);
    else claim_any(cell);
  }
  void write(FieldSampler& out);

 private:
  void claim_tetra(uint32_t cell);
  void claim_any(uint32_t cell);
  size_t place(size_t i, size_t j, size_t k) const { return i + scan_.dims[0] * (j + scan_.dims[1] * (k - k0_)); }
  const GridScan& scan_;
  CellProbe probe_;
  CellReader reader_;
  Slab& slab_;
  size_t k0_, k1_;
};

// The four barycentric coordinates as b = at(0,0,0) + i * along.x + j * along.y + k * along.z.
struct TetraPlanes {
  Vec3 along[4];
  double at[4];
  Box3 box;
  bool set(const Vec3 p[4]) {
    const Vec3 u = p[1] - p[0], v = p[2] - p[0], w = p[3] - p[0];
    along[1] = cross(v, w), along[2] = cross(w, u), along[3] = cross(u, v);
    const double scale = 1 / dot(u, along[1]);
    if (!std::isfinite(scale)) return false;
    for (int m = 1; m < 4; ++m) along[m] *= scale, at[m] = -dot(along[m], p[0]);
    along[0] = -(along[1] + along[2] + along[3]);
    at[0] = 1 - at[1] - at[2] - at[3];
    for (int m = 0; m < 4; ++m) box.add(p[m]);
    return true;
  }
};

void Scanner::claim_tetra(uint32_t cell) {
  const SimplexArrays& s = scan_.simplices;
  Vec3 p[4];
  const size_t b = s.cells.begin(cell);
  for (size_t m = 0; m < 4; ++m) p[m] = s.point(s.cells.connectivity[b + m]);
  const double tolerance = tetra_tolerance(s.ease, p[1] - p[0]);
  for (Vec3& q : p) q = scan_.to_grid(q);
  // Relative to a grid point nearby, so that nothing cancels.
  const Vec3 base(std::floor(p[0].x), std::floor(p[0].y), std::floor(p[0].z));
  for (Vec3& q : p) q = q - base;
  TetraPlanes t;
  if (!t.set(p)) return;
  ptrdiff_t lo[3], hi[3];
  for (int a = 0; a < 3; ++a) {
    const double grow = 1e-7 * (t.box.hi[a] - t.box.lo[a]);
    GridScan::points_in(t.box.lo[a] - grow + base[a], t.box.hi[a] + grow + base[a], scan_.dims[size_t(a)], lo[a], hi[a]);
  }
  lo[2] = std::max(lo[2], ptrdiff_t(k0_)), hi[2] = std::min(hi[2], ptrdiff_t(k1_) - 1);
  double inverse[4];
  for (int m = 0; m < 4; ++m) inverse[m] = 1 / t.along[m].x;
  for (ptrdiff_t k = lo[2]; k <= hi[2]; ++k)
    for (ptrdiff_t j = lo[1]; j <= hi[1]; ++j) {
      double r[4], from = double(lo[0]) - base.x, to = double(hi[0]) - base.x;
      for (int m = 0; m < 4; ++m) {
        r[m] = t.at[m] + t.along[m].y * (double(j) - base.y) + t.along[m].z * (double(k) - base.z);
        const double slope = t.along[m].x, limit = (-tolerance - r[m]) * inverse[m];
        if (slope > 0) from = limit > from ? limit : from;
        else if (slope < 0) to = limit < to ? limit : to;
        else if (r[m] < -tolerance) to = -HUGE_VAL;
      }
      if (!(from <= to)) continue;
      ptrdiff_t i0 = ptrdiff_t(from), i1 = ptrdiff_t(to);  // rounded to zero: ceil and floor are calls on plain x86-64
      i0 += double(i0)<from, i1 -= double(i1)> to;
      const size_t row = place(size_t(0), size_t(j), size_t(k)) + size_t(ptrdiff_t(base.x));
      for (ptrdiff_t i = i0; i <= i1; ++i) {
        const size_t at = row + size_t(i);
        if (slab_.cell[at] != none) continue;
        slab_.cell[at] = cell;
        const double x = double(i);
        slab_.rst[at] = {r[1] + x * t.along[1].x, r[2] + x * t.along[2].x, r[3] + x * t.along[3].x};
      }
    }
}

void Scanner::claim_any(uint32_t cell) {
  const Box3 box = scan_.box(reader_, cell);
  ptrdiff_t lo[3], hi[3];
  for (int a = 0; a < 3; ++a) GridScan::points_in(box.lo[a], box.hi[a], scan_.dims[size_t(a)], lo[a], hi[a]);
  lo[2] = std::max(lo[2], ptrdiff_t(k0_)), hi[2] = std::min(hi[2], ptrdiff_t(k1_) - 1);
  CellPlace place_in;
  for (ptrdiff_t k = lo[2]; k <= hi[2]; ++k)
    for (ptrdiff_t j = lo[1]; j <= hi[1]; ++j)
      for (ptrdiff_t i = lo[0]; i <= hi[0]; ++i) {
        const size_t at = place(size_t(i), size_t(j), size_t(k));
        if (slab_.cell[at] != none || !probe_.holds(cell, scan_.point(size_t(i), size_t(j), size_t(k)), place_in)) continue;
        slab_.cell[at] = cell, slab_.rst[at] = place_in.rst;
      }
}

void Scanner::write(FieldSampler& out) {
  PlaceWriter writer(std::move(probe_), scan_.simplices, out);
  for (size_t k = k0_; k < k1_; ++k)
    for (size_t j = 0; j < scan_.dims[1]; ++j)
      for (size_t i = 0; i < scan_.dims[0]; ++i) {
        const size_t at = place(i, j, k), to = i + scan_.dims[0] * (j + scan_.dims[1] * k);
        if (slab_.cell[at] == none) writer.add_missing(to);
        else writer.add(to, slab_.cell[at], slab_.rst[at], scan_.point(i, j, k));
      }
}

}  // namespace

void sample_grid(const DatasetPtr& from, const LatticeView& grid, FieldSampler& out, Context& context) {
  const auto& d = grid.dims;
  if (!from->as<UnstructuredMesh>() && !from->as<SurfaceMesh>() && !from->as<CurvilinearGrid>()) {
    sample_points(
        from, grid.points(), [&](size_t i) { return grid.position(i % d[0], i / d[0] % d[1], i / d[0] / d[1]); }, false, out, context);
    return;
  }
  const GridScan scan(from, grid);
  const size_t thickness = std::clamp<size_t>((size_t(1) << 19) / (d[0] * d[1]), 1, 8);
  const CellSlabs slabs = scan.slabs(thickness, false, context);
  // Slabs are large: what one task is done with, the next takes over.
  std::mutex mutex;
  std::vector<std::unique_ptr<Slab>> spare;
  auto take = [&]() -> std::unique_ptr<Slab> {
    std::lock_guard lock(mutex);
    if (spare.empty()) return std::make_unique<Slab>();
    auto slab = std::move(spare.back());
    spare.pop_back();
    return slab;
  };
  parallel_for(
      slabs.size(), 1,
      [&](size_t s, size_t) {
        std::unique_ptr<Slab> slab = take();
        Scanner scanner(scan, *slab, s * thickness, std::min((s + 1) * thickness, d[2]));
        for (size_t c = slabs.begin[s]; c < slabs.begin[s + 1]; ++c) scanner.claim(slabs.cells[c]);
        scanner.write(out);
        std::lock_guard lock(mutex);
        spare.push_back(std::move(slab));
      },
      &context);
}

}  // namespace sg

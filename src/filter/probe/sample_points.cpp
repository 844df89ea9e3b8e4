// SPDX-License-Identifier: Apache-2.0
// Fields at points in any place. Meshes of cells need no tree for it: the points are sorted into buckets of a coarse grid, and each cell
// claims those that it holds, cells in ascending order. Buckets are worked on in slabs, each by one thread.
#include <algorithm>

#include "base/parallel.h"
#include "filter/probe/cell_slabs.h"
#include "filter/probe/place_writer.h"
#include "filter/probe/sample.h"
#include "index/cell_locator.h"

namespace sg {

namespace {

constexpr uint32_t no_cell = UINT32_MAX;
using PointAt = std::function<Vec3(size_t)>;

// Numbers of the points so that neighbours follow one another: sorted by cells of a coarse grid over their box, itself in Morton order.
std::vector<uint32_t> spatial_order(size_t count, const std::function<Vec3(size_t)>& point, const Box3& box) {
  const int bits = count < (size_t(1) << 22) ? 5 : 6;
  const double cells = double(1 << bits);
  const Vec3 size = box.size();
  Vec3 scale;
  for (int a = 0; a < 3; ++a) scale[a] = size[a] > 0 ? cells / size[a] : 0.0;
  std::vector<uint32_t> key(count), order(count);
  parallel_for(count, 1 << 15, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 q = (point(i) - box.lo) * scale;
      uint32_t k = 0;
      for (int a = 0; a < 3; ++a) {
        const auto v = uint32_t(q[a] > 0 ? std::min(q[a], cells - 1) : 0.0);  // NaN: 0
        for (int b = 0; b < bits; ++b) k |= (v >> b & 1) << (3 * b + a);
      }
      key[i] = k;
    }
  });
  std::vector<uint32_t> start((size_t(1) << (3 * bits)) + 1);
  for (uint32_t k : key) ++start[k + 1];
  for (size_t k = 1; k < start.size(); ++k) start[k] += start[k - 1];
  for (size_t i = 0; i < count; ++i) order[start[key[i]]++] = uint32_t(i);
  return order;
}

void sample_by_locator(const DatasetPtr& from, size_t count, const PointAt& point, bool scattered, FieldSampler& out, Context& context) {
  const CellLocator locator(from, context);
  std::vector<uint32_t> order;
  if (scattered && count >= 4096 && count < UINT32_MAX) order = spatial_order(count, point, from->bounds());
  parallel_for(
      count, 4096,
      [&](size_t begin, size_t end) {
        LocatorCursor cursor(locator);
        SampleBlock block;
        for (size_t first = begin; first < end; first += SampleBlock::capacity) {
          block.count = 0;
          for (size_t i = first; i < std::min(first + SampleBlock::capacity, end); ++i) {
            const size_t p = order.empty() ? i : order[i];
            const int64_t cell = cursor.find(point(p));
            if (cell < 0) block.add_missing(p);
            else block.add(p, cell, cursor.ids(), cursor.weights());
          }
          out.write(block);
        }
      },
      &context);
}

// The points that lie in the mesh's box, sorted by bucket; those outside come last.
struct Buckets {
  LatticeView grid;             // bucket borders
  std::array<size_t, 3> dims;   // buckets
  std::vector<uint32_t> start;  // buckets + 2: the last list is of the points outside
  Plane<uint32_t> order;
  Plane<Vec3> at;
  double crowding = 0;  // how many points share a bucket, seen by a point
};

Buckets sort_points(const Dataset& from, size_t count, const PointAt& point) {
  Buckets b;
  const double slack = locate_slack(from);
  Box3 mesh = from.bounds();
  mesh.lo += Vec3(-slack, -slack, -slack), mesh.hi += Vec3(slack, slack, slack);
  auto within = [&](Vec3 x) {
    return x.x >= mesh.lo.x && x.x <= mesh.hi.x && x.y >= mesh.lo.y && x.y <= mesh.hi.y && x.z >= mesh.lo.z && x.z <= mesh.hi.z;
  };
  const Box3 box = parallel_reduce(
      count, 1 << 15, Box3{},
      [&](size_t begin, size_t end) {
        Box3 r;
        for (size_t i = begin; i < end; ++i)
          if (const Vec3 x = point(i); within(x)) r.add(x);
        return r;
      },
      [](Box3 p, const Box3& q) {
        p.add(q);
        return p;
      });
  // Two points a bucket on the average; thin boxes have buckets along their long axes only.
  const Vec3 size = box.empty() ? Vec3() : box.size();
  const double longest = std::max({size.x, size.y, size.z});
  double volume = 1;
  int axes = 0;
  for (int a = 0; a < 3; ++a)
    if (size[a] > 1e-3 * longest) volume *= size[a], ++axes;
  const double edge = axes > 0 ? std::pow(volume / (double(count) * 0.5 + 1), 1.0 / axes) : 1.0;
  b.grid.origin = box.empty() ? mesh.lo : box.lo;
  for (int a = 0; a < 3; ++a) {
    const bool thin = !(size[a] > 1e-3 * longest);
    b.dims[size_t(a)] = thin ? 1 : size_t(std::clamp(std::ceil(size[a] / edge), 1.0, 512.0));
    b.grid.dims[size_t(a)] = b.dims[size_t(a)] + 1;
    const double extent = thin ? std::max({longest, slack, 1e-300}) : size[a];
    b.grid.step[a][a] = extent / double(b.dims[size_t(a)]);
  }
  const size_t buckets = b.dims[0] * b.dims[1] * b.dims[2];
  const Vec3 inverse(1 / b.grid.step[0][0], 1 / b.grid.step[1][1], 1 / b.grid.step[2][2]);
  std::vector<uint32_t> key(count);
  parallel_for(count, 1 << 15, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 x = point(i);
      if (!within(x)) {
        key[i] = uint32_t(buckets);
        continue;
      }
      const Vec3 q = (x - b.grid.origin) * inverse;
      size_t c[3];
      for (int a = 0; a < 3; ++a) c[a] = std::min(size_t(std::max(q[a], 0.0)), b.dims[size_t(a)] - 1);
      key[i] = uint32_t(c[0] + b.dims[0] * (c[1] + b.dims[1] * c[2]));
    }
  });
  b.start.assign(buckets + 3, 0);
  for (uint32_t k : key) ++b.start[k + 2];
  for (size_t k = 2; k < b.start.size(); ++k) {
    if (k < b.start.size() - 1) b.crowding += double(b.start[k]) * double(b.start[k]);
    b.start[k] += b.start[k - 1];
  }
  b.crowding /= double(std::max<size_t>(count, 1));
  b.order.resize(count), b.at.resize(count);
  for (size_t i = 0; i < count; ++i) b.order[b.start[key[i] + 1]++] = uint32_t(i);
  b.start.pop_back();
  parallel_for(count, 1 << 15, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) b.at[i] = point(b.order[i]);
  });
  return b;
}

// Cells against the points of their buckets.
class Claimer {
 public:
  Claimer(const GridScan& scan, const Buckets& buckets, uint32_t* cells, Vec3* rst)
      : scan_(scan), buckets_(buckets), probe_(scan.probe()), reader_(scan.map.reader()), cells_(cells), rst_(rst) {}

  /// Among the bucket layers [k0, k1).
  void claim(uint32_t cell, size_t k0, size_t k1) {
    const SimplexArrays& s = scan_.simplices;
    if (s.type(cell) != CellType::tetra) {
      CellPlace place;
      each_point(scan_.box(reader_, cell), k0, k1, [&](size_t i, Vec3 x) {
        if (cells_[i] != no_cell || !probe_.holds(cell, x, place)) return;
        cells_[i] = cell, rst_[i] = place.rst;
      });
      return;
    }
    Vec3 p[4];
    Box3 box;
    const size_t b = s.cells.begin(cell);
    for (size_t m = 0; m < 4; ++m) box.add(p[m] = s.point(s.cells.connectivity[b + m]));
    const Vec3 u = p[1] - p[0], v = p[2] - p[0], w = p[3] - p[0], size = box.size();
    const double grow = 1e-7 * std::max({size.x, size.y, size.z}), tolerance = tetra_tolerance(s.ease, u);
    box = {scan_.to_grid(box.lo - Vec3(grow, grow, grow)), scan_.to_grid(box.hi + Vec3(grow, grow, grow))};
    const Vec3 vw = cross(v, w), wu = cross(w, u), uv = cross(u, v);
    const double scale = 1 / dot(u, vw);
    each_point(box, k0, k1, [&](size_t i, Vec3 x) {
      const Vec3 d = x - p[0], r = Vec3(dot(d, vw), dot(d, wu), dot(d, uv)) * scale;
      if (in_tetra(r, tolerance) && cells_[i] == no_cell) cells_[i] = cell, rst_[i] = r;
    });
  }

 private:
  template <class F>
  void each_point(const Box3& box, size_t k0, size_t k1, F&& f) {
    size_t lo[3], hi[3];
    for (int a = 0; a < 3; ++a) {
      const double last = double(buckets_.dims[size_t(a)] - 1);
      lo[a] = size_t(GridScan::within(box.lo[a], 0, last)), hi[a] = size_t(GridScan::within(box.hi[a], 0, last));
    }
    for (size_t k = std::max(lo[2], k0); k <= std::min(hi[2], k1 - 1); ++k)
      for (size_t j = lo[1]; j <= hi[1]; ++j) {
        const size_t row = buckets_.dims[0] * (j + buckets_.dims[1] * k);
        for (size_t i = buckets_.start[row + lo[0]], end = buckets_.start[row + hi[0] + 1]; i < end; ++i) f(i, buckets_.at[i]);
      }
  }
  const GridScan& scan_;
  const Buckets& buckets_;
  CellProbe probe_;
  CellReader reader_;
  uint32_t* cells_;
  Vec3* rst_;
};

}  // namespace

void sample_points(const DatasetPtr& from, size_t count, const PointAt& point, bool scattered, FieldSampler& out, Context& context) {
  const bool listed = from->as<UnstructuredMesh>() || from->as<SurfaceMesh>() || from->as<CurvilinearGrid>();
  if (!listed || count >= UINT32_MAX || !std::isfinite(from->bounds().diagonal()))
    return sample_by_locator(from, count, point, scattered, out, context);
  const Buckets buckets = sort_points(*from, count, point);
  if (buckets.crowding > 200) return sample_by_locator(from, count, point, scattered, out, context);
  const GridScan scan(from, buckets.grid);
  const size_t layers = buckets.dims[2], layer = buckets.dims[0] * buckets.dims[1], thickness = std::max<size_t>(1, layers / 32);
  const CellSlabs slabs = scan.slabs(thickness, true, context);
  std::vector<uint32_t> cells(count, no_cell);
  Plane<Vec3> rst(count);
  parallel_for(
      slabs.size(), 1,
      [&](size_t s, size_t) {
        const size_t k0 = s * thickness, k1 = std::min(k0 + thickness, layers);
        Claimer claimer(scan, buckets, cells.data(), rst.data());
        for (size_t c = slabs.begin[s]; c < slabs.begin[s + 1]; ++c) claimer.claim(slabs.cells[c], k0, k1);
        // The last slab takes the points outside with it.
        const size_t first = buckets.start[layer * k0], last = k1 == layers ? count : buckets.start[layer * k1];
        PlaceWriter writer(scan.probe(), scan.simplices, out);
        for (size_t i = first; i < last; ++i) {
          if (cells[i] == no_cell) writer.add_missing(buckets.order[i]);
          else writer.add(buckets.order[i], cells[i], rst[i], buckets.at[i]);
        }
      },
      &context);
}

}  // namespace sg

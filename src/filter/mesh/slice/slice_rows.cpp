// SPDX-License-Identifier: Apache-2.0
// A plane through a lattice whose rows are straight: along a row of points the side changes once at most, so that a row is one number,
// the cut edges of a row are runs, and the number of a vertex is the row's first plus a difference. No search, nothing is stored per point.
#include <algorithm>
#include <tuple>

#include "base/error.h"
#include "base/huge_allocator.h"
#include "base/parallel.h"
#include "data/field_ops.h"
#include "data/lattice.h"
#include "filter/mesh/clip/clip_cases.h"
#include "filter/mesh/slice/slice_impl.h"

namespace sg::detail {

namespace {

constexpr size_t rows_per_chunk = 64;  // rows

class RowSlice {
 public:
  RowSlice(const Mesh& mesh, const SlicePlane& plane) : lattice_(mesh), v_(lattice_.view()), plane_(plane) {
    for (int a = 0; a < 3; ++a) {
      size_t one[3] = {0, 0, 0};
      one[a] = v_.dims[size_t(a)] - 1;
      const double rise = dot(plane_.normal, v_.position(one[0], one[1], one[2]) - v_.position(0, 0, 0));
      rise_[a] = std::abs(rise) <= plane_.snap ? 0 : rise;
    }
    front_first_ = rise_[0] < 0;
    const Vec3 o = v_.position(0, 0, 0), x = v_.position(1, 0, 0) - o, y = v_.position(0, 1, 0) - o, z = v_.position(0, 0, 1) - o;
    mirrored_ = dot(normalize(x), cross(normalize(y), normalize(z))) < 0;
  }

  // The first point of each row on its second side. False when this way cannot do it: points in an oblique plane, a plane that only
  // touches.
  bool find_rows() {
    const size_t rows = v_.dims[1] * v_.dims[2];
    turn_.resize(rows);
    struct Found {
      bool zero = false, behind = false;
    };
    const Found found = parallel_reduce(
        rows, rows_per_chunk, Found(),
        [&](size_t begin, size_t end) {
          Found f;
          for (size_t r = begin; r < end; ++r) {
            turn_[r] = turn_of(r);
            const size_t at = front_first_ ? turn_[r] - 1 : turn_[r];
            f.zero |= at < v_.dims[0] && plane_.raw(place(at, r)) == 0;
            f.behind |= front_first_ ? turn_[r] < v_.dims[0] : turn_[r] > 0;
          }
          return f;
        },
        [](Found a, Found b) {
          return Found{a.zero || b.zero, a.behind || b.behind};
        });
    const int across = int(rise_[0] != 0) + int(rise_[1] != 0) + int(rise_[2] != 0);
    return found.behind && (!found.zero || across == 1);
  }

  DatasetPtr run(const Dataset& in, Context& ctx) {
    number_vertices();
    ctx.check();
    SurfaceMesh mesh;
    std::vector<EdgePoint> edges(vertices_);
    mesh.points.xyz = make_vertices(edges);
    std::vector<int64_t> cells;
    mesh.polygons = make_polygons(cells);
    DatasetParts out;
    carry_interpolated(out.fields, in.fields(), edges);
    carry_gathered(out.fields, in.fields(), Association::cell, cells, Association::cell);
    carry_whole(out.fields, in.fields());
    if (!in.fields().find("original_cell", Association::cell))
      out.fields.add(id_field("original_cell", Association::cell, std::move(cells)));
    out.mesh = std::move(mesh);
    out.notes = in.notes();
    out.time = in.time();
    return make_dataset(std::move(out));
  }

 private:
  Vec3 place(size_t i, size_t row) const { return v_.position(i, row % v_.dims[1], row / v_.dims[1]); }
  bool front(size_t i, size_t row) const { return plane_.raw(place(i, row)) >= 0; }

  uint32_t turn_of(size_t row) const {
    const size_t nx = v_.dims[0];
    if (rise_[0] == 0) return front(0, row) ? 0 : uint32_t(nx);
    const double d = plane_.raw(place(0, row));
    size_t lo = 0, hi = nx;  // the turn lies in [lo, hi]
    if (v_.mode == LatticeView::Mode::affine) {
      const double guess = -d / rise_[0] * double(nx - 1);
      const auto at = size_t(guess > 0 ? std::min(guess, double(nx - 1)) : 0.0);
      lo = at > 0 ? at - 1 : 0, hi = std::min(nx, at + 2);
      if (lo > 0 && front(lo - 1, row) != front_first_) lo = 0;
      if (hi < nx && front(hi, row) == front_first_) hi = nx;
    }
    while (lo < hi) {
      const size_t middle = (lo + hi) / 2;
      if (front(middle, row) == front_first_) lo = middle + 1;
      else hi = middle;
    }
    return uint32_t(lo);
  }

  // Vertices of a row: on its x edge, on the y edges to the next row, on the z edges to the row above.
  struct Runs {
    uint32_t x = 0, y0 = 0, y1 = 0, z0 = 0, z1 = 0;  // y and z edges at points [y0, y1), [z0, z1)
    uint32_t count() const { return x + (y1 - y0) + (z1 - z0); }
  };
  Runs runs(size_t row) const {
    Runs r;
    const uint32_t t = turn_[row];
    r.x = t > 0 && t < v_.dims[0];
    if (row % v_.dims[1] + 1 < v_.dims[1]) std::tie(r.y0, r.y1) = std::minmax(t, turn_[row + 1]);
    if (row / v_.dims[1] + 1 < v_.dims[2]) std::tie(r.z0, r.z1) = std::minmax(t, turn_[row + v_.dims[1]]);
    return r;
  }

  void number_vertices() {
    const size_t rows = turn_.size();
    first_.resize(rows);
    std::vector<size_t> start((rows + rows_per_chunk - 1) / rows_per_chunk);
    parallel_for(rows, rows_per_chunk, [&](size_t begin, size_t end) {
      size_t n = 0;
      for (size_t r = begin; r < end; ++r) n += runs(r).count();
      start[begin / rows_per_chunk] = n;
    });
    vertices_ = exclusive_scan(start);
    if (vertices_ > size_t(INT32_MAX)) fail_usage("the cut has more than 2^31 points", "slice", "take a part of the mesh first");
    parallel_for(rows, rows_per_chunk, [&](size_t begin, size_t end) {
      auto n = uint32_t(start[begin / rows_per_chunk]);
      for (size_t r = begin; r < end; ++r) {
        first_[r] = n;
        n += runs(r).count();
      }
    });
  }

  Array make_vertices(std::vector<EdgePoint>& edges) const {
    double* xyz = nullptr;
    Array r = Array::make<double>(vertices_, 3, &xyz);
    const size_t nx = v_.dims[0], ny = v_.dims[1];
    parallel_for(turn_.size(), rows_per_chunk, [&](size_t begin, size_t end) {
      for (size_t row = begin; row < end; ++row) {
        const Runs n = runs(row);
        if (n.count() == 0) continue;
        size_t at = first_[row];
        auto add = [&](size_t i, size_t j, size_t other) {
          const Vec3 a = place(i, row), b = place(j, other);
          const double da = plane_.raw(a), db = plane_.raw(b), t = da / (da - db);
          const auto ia = uint32_t(i + nx * row), ib = uint32_t(j + nx * other);
          edges[at] = t == 0 ? EdgePoint{ia, ia, 0} : t == 1 ? EdgePoint{ib, ib, 0} : EdgePoint{ia, ib, float(t)};
          const Vec3 p = t == 0 ? a : t == 1 ? b : lerp(a, b, t);
          xyz[3 * at] = p.x, xyz[3 * at + 1] = p.y, xyz[3 * at + 2] = p.z;
          ++at;
        };
        if (n.x) add(turn_[row] - 1, turn_[row], row);
        for (uint32_t i = n.y0; i < n.y1; ++i) add(i, i, row + 1);
        for (uint32_t i = n.z0; i < n.z1; ++i) add(i, i, row + ny);
      }
    });
    return r;
  }

  // Calls f(cell, loop, vertex of each of its cuts) for the cut cells of a row.
  template <class F>
  void each_loop(const clipping::ClipTable& table, size_t j, size_t k, F&& f) const {
    const size_t nx = v_.dims[0], ny = v_.dims[1];
    const size_t row[4] = {j + ny * k, j + 1 + ny * k, j + ny * (k + 1), j + 1 + ny * (k + 1)};
    uint32_t t[4], low = UINT32_MAX, high = 0;
    for (size_t q = 0; q < 4; ++q) t[q] = turn_[row[q]], low = std::min(low, t[q]), high = std::max(high, t[q]);
    const size_t first = low > 0 ? low - 1 : 0, last = std::min<size_t>(high, nx - 1);
    if (first >= last) return;
    Runs n[4];
    for (size_t q = 0; q < 4; ++q) n[q] = runs(row[q]);
    const auto& edges = table.topology().edges;
    uint32_t vertex[12] = {};
    for (size_t i = first; i < last; ++i) {
      uint32_t pattern = 0;
      for (uint32_t c = 0; c < 8; ++c) pattern |= uint32_t((i + (c & 1) < t[c >> 1]) == front_first_) << c;
      for (const auto& loop : table.loops(pattern)) {
        for (const uint8_t code : loop) {
          const auto [a, b] = edges[size_t(code - clipping::first_cut)];
          const uint8_t c = std::min(a, b), axis = uint8_t(a ^ b);
          const size_t q = c >> 1;
          const auto at = uint32_t(i + (c & 1));
          const uint32_t base = first_[row[q]];
          vertex[code - clipping::first_cut] = axis == 1   ? base
                                               : axis == 2 ? base + n[q].x + at - n[q].y0
                                                           : base + n[q].x + (n[q].y1 - n[q].y0) + at - n[q].z0;
        }
        f(i + (nx - 1) * (j + (ny - 1) * k), loop, vertex);
      }
    }
  }

  CellArray make_polygons(std::vector<int64_t>& cells) const {
    const clipping::ClipTable& table = *clipping::clip_table(CellType::voxel);
    const size_t ny = v_.dims[1] - 1, rows = ny * (v_.dims[2] - 1), chunks = (rows + rows_per_chunk - 1) / rows_per_chunk;
    std::vector<size_t> polygon(chunks), id(chunks);
    parallel_for(rows, rows_per_chunk, [&](size_t begin, size_t end) {
      size_t n = 0, ids = 0;
      for (size_t r = begin; r < end; ++r)
        each_loop(table, r % ny, r / ny, [&](size_t, const auto& loop, const uint32_t*) { ++n, ids += loop.size(); });
      polygon[begin / rows_per_chunk] = n, id[begin / rows_per_chunk] = ids;
    });
    const size_t polygons = exclusive_scan(polygon), ids = exclusive_scan(id);
    int32_t *connectivity = nullptr, *offsets = nullptr;
    CellArray r;
    r.connectivity = Array::make<int32_t>(ids, 1, &connectivity);
    r.offsets = Array::make<int32_t>(polygons + 1, 1, &offsets);
    offsets[polygons] = int32_t(ids);
    cells.resize(polygons);
    parallel_for(rows, rows_per_chunk, [&](size_t begin, size_t end) {
      size_t n = polygon[begin / rows_per_chunk], at = id[begin / rows_per_chunk];
      for (size_t row = begin; row < end; ++row)
        each_loop(table, row % ny, row / ny, [&](size_t cell, const auto& loop, const uint32_t* vertex) {
          cells[n] = int64_t(cell);
          offsets[n++] = int32_t(at);
          const size_t begins = at;
          for (const uint8_t code : loop) connectivity[at++] = int32_t(vertex[code - clipping::first_cut]);
          if (mirrored_) std::reverse(connectivity + begins, connectivity + at);
        });
    });
    return r;
  }

  Lattice lattice_;
  LatticeView v_;
  SlicePlane plane_;
  double rise_[3];
  bool front_first_ = false, mirrored_ = false;  // mirrored: the table's loops turn the other way
  Plane<uint32_t> turn_, first_;
  size_t vertices_ = 0;
};

}  // namespace

DatasetPtr slice_rows(const Dataset& in, const SlicePlane& plane, Context& ctx) {
  const Lattice lattice(in.mesh());
  if (lattice.view().mode == LatticeView::Mode::listed) return nullptr;
  RowSlice slice(in.mesh(), plane);
  return slice.find_rows() ? slice.run(in, ctx) : nullptr;
}

}  // namespace sg::detail

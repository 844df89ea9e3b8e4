// SPDX-License-Identifier: Apache-2.0
// Contours of unstructured and surface meshes, cell by cell. A cut edge is known by its two point numbers, so that cells of
// different kinds share it; the edges of all cells are numbered afterwards (contour_edges.h).
#include <fmt/core.h>

#include <cmath>

#include "base/parallel.h"
#include "filter/scalar/contour/cells/contour_cell_scan.h"
#include "filter/scalar/contour/cells/contour_edges.h"
#include "filter/scalar/contour/contour_active.h"
#include "filter/scalar/contour/contour_normals.h"

namespace sg::contouring {

namespace {

constexpr uint8_t inside = 1, unusable = 2;

// A byte per point.
std::vector<uint8_t> classify_points(const Finder& finder, size_t n) {
  std::vector<uint8_t> r(n);
  parallel_for(
      n, 1 << 15,
      [&](size_t begin, size_t end) {
        dispatch(finder.job.samples, [&](auto f) {
          for (size_t p = begin; p < end; ++p) {
            const auto x = f.data[p];
            r[p] = uint8_t((double(x) >= finder.value ? inside : 0) | (x != x ? unusable : 0));
          }
        });
        if (finder.point_ghost.count)
          for (size_t p = begin; p < end; ++p)
            if (finder.point_ghost[p] & ghost_hidden_point) r[p] |= unusable;
      },
      &finder.job.context);
  return r;
}

// Cells of which some points are inside and some not, all of them usable.
constexpr auto is_cut = [](uint32_t any, uint32_t every) { return uint32_t(any == inside) & uint32_t(every == 0); };

// Where to look: in all cells, or in those items of an index that the value crosses.
class Places {
 public:
  Places(const CellActiveIndex* index, double value) : all_(!index) {
    if (index) group_ = index->cells_per_item, items_ = index->index.active(value);
  }
  // Calls f(begin, end) for parts of [begin, end) of the mesh's cells, ascending.
  template <class F>
  void in(size_t begin, size_t end, F&& f) const {
    if (all_) return f(begin, end);
    auto item = std::lower_bound(items_.begin(), items_.end(), uint32_t(begin / group_));
    while (item != items_.end() && *item * group_ < end) {
      const auto first = item;
      while (item + 1 != items_.end() && item[1] == *item + 1) ++item;
      f(std::max(begin, *first * group_), std::min(end, (*item + 1) * group_));
      ++item;
    }
  }

 private:
  bool all_;
  size_t group_ = 1;
  std::vector<uint32_t> items_;
};

// Looks at cells a chunk at a time: cut(cell, found) for those that the surface crosses. Chunks are the same wherever it looks.
template <class Cut>
void find(const Finder& finder, const Places& places, const std::vector<uint8_t>& state, const CellsView& cells, size_t before,
          std::vector<EdgeChunk>& chunks, Cut&& cut) {
  const size_t grain = std::max<size_t>(1 << 13, cells.count / 1024 + 1), first = chunks.size();
  if (cells.count == 0) return;
  chunks.resize(first + (cells.count + grain - 1) / grain);
  parallel_for(
      cells.count, grain,
      [&](size_t begin, size_t end) {
        thread_local std::vector<uint32_t> active;
        thread_local Found found;
        active.resize(end - begin + 1);
        found.clear();
        size_t n = 0;
        places.in(before + begin, before + end,
                  [&](size_t b, size_t e) { n += scan_cells(cells, b - before, e - before, state.data(), active.data() + n, is_cut); });
        for (size_t i = 0; i < n; ++i)
          if (!finder.skipped(before + active[i])) cut(size_t(active[i]), found);
        if (!found.lines.empty() || !found.triangles.empty()) chunks[first + begin / grain].take(found, state.size());
      },
      &finder.job.context);
}

[[noreturn]] void unsupported(const UnstructuredMesh& m, size_t cell) {
  fail_usage(fmt::format("cell {} is a {}, which cannot be contoured", cell, cell_type_info(m.type(cell)).name), "contour",
             "remove it first: -f threshold");
}

std::vector<EdgeChunk> find_cells(const Finder& finder, const Places& places, const std::vector<uint8_t>& state,
                                  const UnstructuredMesh& m) {
  const CellsView cells = cells_view(m.cells);
  std::vector<EdgeChunk> chunks;
  find(finder, places, state, cells, 0, chunks, [&](size_t c, Found& out) {
    const CellType type = m.type(c);
    if (type == CellType::tetra) return finder.tetra(cells, c, out);
    if (cell_cases(type)) return finder.solid(type, cells, c, out);
    const CellTypeInfo& info = cell_type_info(type);
    if (info.dimension < 2) return;
    const size_t n = cells.size(c), b = cells.begin(c);
    auto p = [&](size_t k) { return cells.connectivity[b + k]; };
    if (type == CellType::pixel) {
      const int64_t around[4] = {p(0), p(1), p(3), p(2)};
      finder.polygon(around, c, out);
    } else if (type == CellType::triangle_strip) {
      for (size_t k = 0; k + 2 < n; ++k) {
        const int64_t around[3] = {p(k), p(k + 1 + k % 2), p(k + 2 - k % 2)};
        finder.polygon(around, c, out);
      }
    } else if (type == CellType::triangle || type == CellType::quad || type == CellType::polygon) {
      std::vector<int64_t> around(n);
      for (size_t k = 0; k < n; ++k) around[k] = p(k);
      finder.polygon(around, c, out);
    } else if (type == CellType::polyhedron) {
      cut_polyhedron(finder, m, c, out);
    } else {
      unsupported(m, c);
    }
  });
  return chunks;
}

std::vector<EdgeChunk> find_cells(const Finder& finder, const Places& places, const std::vector<uint8_t>& state, const SurfaceMesh& m) {
  std::vector<EdgeChunk> chunks;
  size_t before = m.vertices.size() + m.lines.size();
  for (const CellArray* list : {&m.polygons, &m.strips}) {
    const CellsView cells = cells_view(*list);
    find(finder, places, state, cells, before, chunks, [&](size_t c, Found& out) {
      const size_t n = cells.size(c);
      std::vector<int64_t> p(n);
      for (size_t k = 0; k < n; ++k) p[k] = cells.point(c, k);
      if (list == &m.polygons) return finder.polygon(p, before + c, out);
      for (size_t k = 0; k + 2 < n; ++k) {
        const int64_t around[3] = {p[k], p[k + 1 + k % 2], p[k + 2 - k % 2]};
        finder.polygon(around, before + c, out);
      }
    });
    before += cells.count;
  }
  return chunks;
}

// Lists of all chunks, one after the other.
template <class Get>
Block<uint32_t> joined(const std::vector<EdgeChunk>& chunks, const std::vector<size_t>& first, Get&& get) {
  Block<uint32_t> b;
  b.allocate(first.back());
  parallel_for(chunks.size(), 1, [&](size_t i, size_t) {
    const auto& list = get(chunks[i]);
    std::copy(list.begin(), list.end(), b.data + first[i]);
  });
  return b;
}

template <class Get>
std::vector<size_t> starts(const std::vector<EdgeChunk>& chunks, Get&& get) {
  std::vector<size_t> first(chunks.size() + 1, 0);
  for (size_t i = 0; i < chunks.size(); ++i) first[i] = get(chunks[i]).size();
  exclusive_scan(first);
  return first;
}

// Points inside cells, in the order of the chunks.
void inner_points(const Finder& finder, const std::vector<EdgeChunk>& chunks, size_t before, Piece& piece, float* xyz) {
  const auto first = starts(
      chunks, [](const EdgeChunk& c) -> const auto& { return c.inner; });
  piece.inner.allocate(first.back());
  piece.inner_corners.allocate(first.back());
  for (size_t i = 0; i < chunks.size(); ++i)
    for (size_t k = 0; k < chunks[i].inner.size(); ++k) {
      const CellPoint& p = chunks[i].inner[k];
      Vec3 x;
      for (size_t c = 0; c < 8; ++c) {
        double w = 1;
        for (size_t a = 0; a < 3; ++a) w *= c >> a & 1 ? p.at[a] : 1 - p.at[a];
        x += (finder.points.at(p.corners[c]) - finder.job.origin) * w;
      }
      piece.inner.data[first[i] + k] = {p.corners[0], {float(p.at[0]), float(p.at[1]), float(p.at[2])}};
      piece.inner_corners.data[first[i] + k] = p.corners;
      for (int a = 0; a < 3; ++a) xyz[3 * (before + first[i] + k) + size_t(a)] = float(x[a]);
    }
}

}  // namespace

Piece contour_cells(const Job& job, double value, const CellActiveIndex* index) {
  const auto* mesh = job.input.as<UnstructuredMesh>();
  const Points& points = mesh ? mesh->points : job.input.as<SurfaceMesh>()->points;
  const Finder finder{job, Positions(points), value};
  std::vector<uint8_t> state = classify_points(finder, points.count());
  const Places places(index, value);
  std::vector<EdgeChunk> chunks =
      mesh ? find_cells(finder, places, state, *mesh) : find_cells(finder, places, state, *job.input.as<SurfaceMesh>());
  std::vector<uint8_t>().swap(state);
  const EdgePoints edges(chunks, job.context);
  size_t inner = 0;
  for (EdgeChunk& c : chunks) c.first_inner = edges.size() + inner, inner += c.inner.size();
  const size_t total = edges.size() + inner;
  if (total > size_t(INT32_MAX)) fail_usage("the surface has more than 2^31 points", "contour", "contour a part of the mesh at a time");

  Piece piece;
  float* xyz = nullptr;
  piece.xyz = Array::make<float>(total, 3, &xyz);
  piece.points.allocate(edges.size());
  edges.each(
      [&](size_t v, uint32_t a, uint32_t b) {
        const double t = crossing(value, finder.f(a), finder.f(b));
        piece.points.data[v] = {a, b, float(t)};
        const Vec3 from = finder.points.at(a) - job.origin, to = finder.points.at(b) - job.origin;
        const Vec3 x = from + (to - from) * t;
        for (int c = 0; c < 3; ++c) xyz[3 * v + size_t(c)] = float(x[c]);
      },
      job.context);
  if (inner > 0) inner_points(finder, chunks, edges.size(), piece, xyz);
  auto connect = [&](auto get, const std::vector<size_t>& first) {
    int32_t* out = nullptr;
    Array a = Array::make<int32_t>(first.back(), 1, &out);
    parallel_for(chunks.size(), 1, [&](size_t i, size_t) {
      const EdgeChunk& c = chunks[i];
      int32_t* to = out + first[i];
      for (uint32_t k : get(c))
        *to++ = int32_t(k & EdgeChunk::inner_bit ? uint32_t(c.first_inner) + (k ^ EdgeChunk::inner_bit) : c.numbers[k]);
    });
    return a;
  };
  auto lines = [](const EdgeChunk& c) -> const auto& { return c.lines; };
  auto triangles = [](const EdgeChunk& c) -> const auto& { return c.triangles; };
  auto line_cells = [](const EdgeChunk& c) -> const auto& { return c.line_cells; };
  auto triangle_cells = [](const EdgeChunk& c) -> const auto& { return c.triangle_cells; };
  piece.lines = connect(lines, starts(chunks, lines));
  piece.triangles = connect(triangles, starts(chunks, triangles));
  if (job.cells) {
    piece.line_cells = joined(chunks, starts(chunks, line_cells), line_cells);
    piece.triangle_cells = joined(chunks, starts(chunks, triangle_cells), triangle_cells);
  }
  std::vector<EdgeChunk>().swap(chunks);
  if (job.normals && mesh && piece.triangles.count() > 0)
    piece.normals = cell_normals(job, *mesh, piece.points.span(), piece.inner.span(), piece.inner_corners.span());
  return piece;
}

}  // namespace sg::contouring

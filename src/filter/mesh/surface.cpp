// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/surface.h"

#include <algorithm>

#include "base/parallel.h"
#include "data/cells/cell_topology.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/surface_builder.h"

namespace sg {

namespace {

constexpr size_t cells_per_chunk = 1 << 13;

void require_small(const SurfaceMesh& mesh) {
  if (mesh.points.count() >= UINT32_MAX || mesh.cell_count() >= UINT32_MAX)
    fail_usage("the surface has more than 2^32 points or cells", {}, "take a part of it first");
}

}  // namespace

DatasetPtr surface_of(const DatasetPtr& in, Context& ctx) { return faces(in, {}, ctx); }

Triangles triangles_of(const SurfaceMesh& mesh) {
  require_small(mesh);
  Triangles r;
  const CellsView polygons = cells_view(mesh.polygons), strips = cells_view(mesh.strips);
  const size_t first_polygon = mesh.vertices.size() + mesh.lines.size(), first_strip = first_polygon + polygons.count;
  if (polygons.fixed == 3 && strips.count == 0) {
    r.indices.resize(3 * polygons.count);
    parallel_for(r.indices.size(), 1 << 16, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) r.indices[i] = uint32_t(polygons.connectivity[i]);
    });
    if (first_polygon > 0) {
      r.cells.resize(polygons.count);
      for (size_t i = 0; i < polygons.count; ++i) r.cells[i] = uint32_t(first_polygon + i);
    }
    return r;
  }
  // A cell of n points makes n-2 triangles, so places are known before any cell is split.
  const size_t cells = polygons.count + strips.count;
  auto size_of = [&](size_t c) { return c < polygons.count ? polygons.size(c) : strips.size(c - polygons.count); };
  std::vector<size_t> start((cells + cells_per_chunk - 1) / cells_per_chunk);
  parallel_for(cells, cells_per_chunk, [&](size_t begin, size_t end) {
    size_t n = 0;
    for (size_t c = begin; c < end; ++c) n += std::max<size_t>(size_of(c), 2) - 2;
    start[begin / cells_per_chunk] = n;
  });
  const size_t total = exclusive_scan(start);
  r.indices.resize(3 * total);
  r.cells.resize(total);
  const PointReader at(mesh.points);
  parallel_for(cells, cells_per_chunk, [&](size_t begin, size_t end) {
    std::vector<Vec3> corner;
    std::vector<uint32_t> local;
    size_t t = start[begin / cells_per_chunk];
    for (size_t c = begin; c < end; ++c) {
      const bool strip = c >= polygons.count;
      const CellsView& v = strip ? strips : polygons;
      const size_t cell = strip ? c - polygons.count : c, first = v.begin(cell), n = v.end(cell) - first;
      if (n < 3) continue;
      const auto cell_id = uint32_t(strip ? first_strip + cell : first_polygon + cell);
      if (n <= 4 && !strip) {  // nearly all cells of nearly all surfaces
        uint32_t v4[4] = {};
        for (size_t k = 0; k < n; ++k) v4[k] = uint32_t(v.connectivity[first + k]);
        r.cells[t] = cell_id;
        uint32_t* to = &r.indices[3 * t++];
        if (n == 3) {
          to[0] = v4[0], to[1] = v4[1], to[2] = v4[2];
          continue;
        }
        const bool other = !first_diagonal_fits(at[v4[0]], at[v4[1]], at[v4[2]], at[v4[3]]);
        const uint32_t split[2][6] = {{v4[0], v4[1], v4[2], v4[0], v4[2], v4[3]}, {v4[0], v4[1], v4[3], v4[1], v4[2], v4[3]}};
        std::copy(split[other], split[other] + 6, to);
        r.cells[t++] = cell_id;
        continue;
      }
      local.clear();
      corner.clear();
      for (size_t k = 0; k < n; ++k) corner.push_back(at[size_t(v.connectivity[first + k])]);
      tessellate_face(strip ? CellType::triangle_strip : CellType::polygon, corner, local);
      for (size_t k = 0; k < local.size(); ++k) r.indices[3 * t + k] = uint32_t(v.connectivity[first + local[k]]);
      for (size_t k = 0; k < local.size() / 3; ++k) r.cells[t + k] = cell_id;
      t += local.size() / 3;
    }
  });
  return r;
}

std::vector<uint32_t> edges_of(const SurfaceMesh& mesh) {
  require_small(mesh);
  // Edges are put into the bucket of their smaller id; buckets of a fixed number of ids are sorted on their own.
  const size_t points = mesh.points.count();
  constexpr size_t buckets = 256;
  const size_t width = points / buckets + 1;
  const CellsView polygons = cells_view(mesh.polygons), strips = cells_view(mesh.strips);
  const size_t cells = polygons.count + strips.count, chunks = (cells + cells_per_chunk - 1) / cells_per_chunk;
  std::vector<std::vector<uint64_t>> found(chunks);
  std::vector<std::array<uint32_t, buckets + 1>> place(chunks);
  parallel_for(cells, cells_per_chunk, [&](size_t begin, size_t end) {
    std::vector<uint64_t> all;
    auto add = [&](int64_t a, int64_t b) {
      if (a != b) all.push_back(uint64_t(std::min(a, b)) << 32 | uint64_t(std::max(a, b)));
    };
    for (size_t c = begin; c < end; ++c) {
      const bool strip = c >= polygons.count;
      const CellsView& v = strip ? strips : polygons;
      const size_t cell = strip ? c - polygons.count : c, first = v.begin(cell), n = v.end(cell) - first;
      for (size_t k = 0; k + 1 < n; ++k) add(v.connectivity[first + k], v.connectivity[first + k + 1]);
      if (strip)
        for (size_t k = 0; k + 2 < n; ++k) add(v.connectivity[first + k], v.connectivity[first + k + 2]);
      else if (n > 2) add(v.connectivity[first + n - 1], v.connectivity[first]);
    }
    auto& at = place[begin / cells_per_chunk];
    at.fill(0);
    for (uint64_t e : all) ++at[size_t(e >> 32) / width + 1];
    for (size_t b = 0; b < buckets; ++b) at[b + 1] += at[b];
    auto& out = found[begin / cells_per_chunk];
    out.resize(all.size());
    auto next = at;
    for (uint64_t e : all) out[next[size_t(e >> 32) / width]++] = e;
  });
  std::vector<std::vector<uint64_t>> sorted(buckets);
  parallel_for(buckets, 1, [&](size_t b, size_t) {
    auto& s = sorted[b];
    for (size_t c = 0; c < chunks; ++c) s.insert(s.end(), found[c].begin() + place[c][b], found[c].begin() + place[c][b + 1]);
    std::sort(s.begin(), s.end());
    s.erase(std::unique(s.begin(), s.end()), s.end());
  });
  std::vector<size_t> start(buckets);
  for (size_t b = 0; b < buckets; ++b) start[b] = sorted[b].size();
  std::vector<uint32_t> r(2 * exclusive_scan(start));
  parallel_for(buckets, 1, [&](size_t b, size_t) {
    uint32_t* to = r.data() + 2 * start[b];
    for (uint64_t e : sorted[b]) *to++ = uint32_t(e >> 32), *to++ = uint32_t(e);
  });
  return r;
}

}  // namespace sg

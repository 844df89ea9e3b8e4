// SPDX-License-Identifier: Apache-2.0
// From cells to triangles and segments.
#include <fmt/core.h>

#include <algorithm>
#include <mutex>

#include "base/error.h"
#include "base/parallel.h"
#include "render/raster/prepared.h"

namespace sg::raster {

namespace {

constexpr size_t grain = 1 << 15;

struct Memory {
  std::weak_ptr<const Dataset> owner;
  std::string key;
  std::shared_ptr<const void> value;
};

bool hidden(const uint8_t* ghost, size_t cell) { return ghost && (ghost[cell] & (ghost_duplicate | ghost_hidden_cell | ghost_refined_cell)); }

Array packed_ghosts(const Dataset& data) { return data.cell_ghost().empty() ? Array() : data.cell_ghost().converted(ElementType::u8).made_packed(); }

const uint8_t* bytes_of(const Array& a) { return a.empty() ? nullptr : reinterpret_cast<const uint8_t*>(a.raw()); }

/// i32 triangles without ghosts are drawn from where they lie.
bool in_place(const SurfaceMesh& mesh, const Dataset& data) {
  const CellArray& p = mesh.polygons;
  return p.fixed == 3 && p.connectivity.type() == ElementType::i32 && p.connectivity.packed() && mesh.strips.size() == 0 && data.cell_ghost().empty();
}

struct Derived {
  Array triangles, cells;
};

/// Fans of the polygons, then the triangles of the strips with every second one turned round.
Derived fans(const SurfaceMesh& mesh, const Dataset& data) {
  const Array ghosts = packed_ghosts(data);
  const uint8_t* ghost = bytes_of(ghosts);
  const CellsView polygons = cells_view(mesh.polygons), strips = cells_view(mesh.strips);
  const size_t before = mesh.vertices.size() + mesh.lines.size(), n = polygons.count + strips.count;
  auto triangles_of_cell = [&](size_t c) -> size_t {
    if (hidden(ghost, before + c)) return 0;
    const size_t k = c < polygons.count ? polygons.size(c) : strips.size(c - polygons.count);
    return k < 3 ? 0 : k - 2;
  };
  const size_t chunks = (n + grain - 1) / grain;
  std::vector<size_t> first(chunks);
  parallel_for(n, grain, [&](size_t begin, size_t end) {
    size_t sum = 0;
    for (size_t c = begin; c < end; ++c) sum += triangles_of_cell(c);
    first[begin / grain] = sum;
  });
  const size_t total = exclusive_scan(first);
  Derived d;
  uint32_t *t = nullptr, *cell = nullptr;
  d.triangles = Array::make<uint32_t>(total, 3, &t), d.cells = Array::make<uint32_t>(total, 1, &cell);
  parallel_for(n, grain, [&](size_t begin, size_t end) {
    size_t at = first[begin / grain];
    for (size_t c = begin; c < end; ++c) {
      const size_t k = triangles_of_cell(c);
      const bool strip = c >= polygons.count;
      const CellsView& v = strip ? strips : polygons;
      const size_t p = strip ? c - polygons.count : c;
      for (size_t i = 0; i < k; ++i, ++at) {
        cell[at] = uint32_t(before + c);
        const size_t a = strip ? i : 0, b = i + 1 + (strip && i % 2), e = i + 2 - (strip && i % 2);
        t[3 * at] = uint32_t(v.point(p, a)), t[3 * at + 1] = uint32_t(v.point(p, b)), t[3 * at + 2] = uint32_t(v.point(p, e));
      }
    }
  });
  return d;
}

}  // namespace

std::shared_ptr<const void> remembered(const DatasetPtr& data, const std::string& key, std::shared_ptr<const void> (*make)(void*), void* argument) {
  static std::mutex mutex;
  static std::vector<Memory> memory;
  {
    std::lock_guard lock(mutex);
    std::erase_if(memory, [](const Memory& m) { return m.owner.expired(); });
    for (const Memory& m : memory)
      if (m.key == key && m.owner.lock() == data) return m.value;
  }
  std::shared_ptr<const void> value = make(argument);
  std::lock_guard lock(mutex);
  if (memory.size() >= 64) memory.erase(memory.begin());
  memory.push_back({data, key, value});
  return value;
}

void packed_positions(const Points& points, const Dataset& data, Array& xyz, Vec3& origin) {
  if (points.xyz.type() == ElementType::f32) {
    xyz = points.xyz.made_packed(), origin = points.origin;
    return;
  }
  // The f32 numbers that are left must be small: they are taken from the middle of the data.
  const Box3& box = data.bounds();
  const Vec3 middle = box.empty() ? points.origin : box.center();
  origin = middle;
  float* out = nullptr;
  xyz = Array::make<float>(points.count(), 3, &out);
  const Vec3 shift = points.origin - middle;
  dispatch(points.xyz, [&](auto v) {
    parallel_for(v.count, grain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        for (int c = 0; c < 3; ++c) out[3 * i + size_t(c)] = float(double(v(i, c)) + shift[c]);
    });
  });
}

TriangleSet triangulate(const DatasetPtr& data, bool& any_polygon) {
  const SurfaceMesh& mesh = *data->as<SurfaceMesh>();
  any_polygon = mesh.polygons.size() + mesh.strips.size() > 0;
  if (mesh.points.count() >= (size_t(1) << 29)) fail_usage(fmt::format("a surface of {} points is too large to draw", mesh.points.count()), "surface", "decimate it or draw its parts");
  TriangleSet s;
  if (mesh.points.xyz.type() == ElementType::f32 && mesh.points.xyz.packed()) {
    packed_positions(mesh.points, *data, s.positions, s.origin);
  } else {
    struct Moved {
      Array xyz;
      Vec3 origin;
    };
    const auto m = derived<Moved>(data, "positions", [&] {
      Moved r;
      packed_positions(mesh.points, *data, r.xyz, r.origin);
      return r;
    });
    s.positions = m->xyz, s.origin = m->origin;
  }
  if (mesh.polygons.connectivity.count() + mesh.strips.connectivity.count() >= (size_t(1) << 31))  // the kernels count in 32 bits
    fail_usage(fmt::format("a surface of {} polygons is too large to draw", mesh.polygons.size()), "surface", "decimate it or draw its parts");
  if (in_place(mesh, *data)) {
    s.triangles = mesh.polygons.connectivity, s.count = mesh.polygons.size();
    s.first_cell = uint32_t(mesh.vertices.size() + mesh.lines.size());
    return s;
  }
  const auto d = derived<Derived>(data, "triangles", [&] { return fans(mesh, *data); });
  s.triangles = d->triangles, s.cells = d->cells, s.count = d->cells.count();
  return s;
}

SegmentSet line_segments(const Dataset& data, const SurfaceMesh& mesh) {
  const Array ghosts = packed_ghosts(data);
  const uint8_t* ghost = bytes_of(ghosts);
  const CellsView lines = cells_view(mesh.lines);
  const size_t before = mesh.vertices.size();
  SegmentSet s;
  for (size_t c = 0; c < lines.count; ++c) {
    if (hidden(ghost, before + c)) continue;
    const size_t n = lines.size(c);
    for (size_t k = 0; k + 1 < n; ++k) {
      s.points.push_back(uint32_t(lines.point(c, k))), s.points.push_back(uint32_t(lines.point(c, k + 1)));
      s.cells.push_back(uint32_t(before + c)), s.groups.push_back(uint32_t(c));
    }
  }
  return s;
}

SegmentSet polygon_edges(const Dataset& data, const SurfaceMesh& mesh) {
  const Array ghosts = packed_ghosts(data);
  const uint8_t* ghost = bytes_of(ghosts);
  const CellsView polygons = cells_view(mesh.polygons), strips = cells_view(mesh.strips);
  const size_t before = mesh.vertices.size() + mesh.lines.size();
  std::vector<std::pair<uint64_t, uint32_t>> edges;  // (low point, high point), first cell
  auto add = [&](int64_t a, int64_t b, size_t cell) {
    if (a != b) edges.push_back({uint64_t(std::min(a, b)) << 32 | uint64_t(std::max(a, b)), uint32_t(before + cell)});
  };
  for (size_t c = 0; c < polygons.count; ++c) {
    if (hidden(ghost, before + c)) continue;
    const size_t n = polygons.size(c);
    for (size_t k = 0; k < n; ++k) add(polygons.point(c, k), polygons.point(c, k + 1 < n ? k + 1 : 0), c);
  }
  for (size_t c = 0; c < strips.count; ++c) {
    if (hidden(ghost, before + polygons.count + c)) continue;
    const size_t n = strips.size(c);
    for (size_t k = 0; k + 1 < n; ++k) {
      add(strips.point(c, k), strips.point(c, k + 1), polygons.count + c);
      if (k + 2 < n) add(strips.point(c, k), strips.point(c, k + 2), polygons.count + c);
    }
  }
  std::sort(edges.begin(), edges.end());
  SegmentSet s;
  for (size_t i = 0; i < edges.size(); ++i) {
    if (i && edges[i].first == edges[i - 1].first) continue;
    s.points.push_back(uint32_t(edges[i].first >> 32)), s.points.push_back(uint32_t(edges[i].first));
    s.cells.push_back(edges[i].second), s.groups.push_back(0);
  }
  return s;
}

}  // namespace sg::raster

// SPDX-License-Identifier: Apache-2.0
// Contours of unstructured and surface meshes, cell by cell. A cut edge is known by its two point numbers, so that cells of
// different kinds share it; the numbers are sorted afterwards to count each edge once.
#include <cmath>

#include "base/parallel.h"
#include "filter/field/gradient_cells.h"
#include "filter/scalar/contour_finder.h"

namespace sg::contouring {

namespace {

template <class Each>
Found find(size_t n, const Context& context, Each&& each) {
  constexpr size_t grain = 4096;
  std::vector<Found> parts((n + grain - 1) / grain);
  parallel_for(
      n, grain,
      [&](size_t begin, size_t end) {
        for (size_t c = begin; c < end; ++c) each(c, parts[begin / grain]);
      },
      &context);
  Found all;
  auto join = [&](auto member) {
    size_t size = 0;
    for (const Found& p : parts) size += (p.*member).size();
    (all.*member).reserve(size);
    for (const Found& p : parts) (all.*member).insert((all.*member).end(), (p.*member).begin(), (p.*member).end());
  };
  join(&Found::lines), join(&Found::triangles), join(&Found::line_cells), join(&Found::triangle_cells);
  return all;
}

[[noreturn]] void unsupported(const UnstructuredMesh& m, size_t cell) {
  fail_usage(fmt::format("cell {} is a {}; only linear cells can be contoured", cell, cell_type_info(m.type(cell)).name), "contour",
             "contours of curved cells are not there yet; slice and faces take them");
}

Found find_cells(const Finder& finder, const UnstructuredMesh& m) {
  const CellsView cells = cells_view(m.cells);
  return find(cells.count, finder.job.context, [&](size_t c, Found& out) {
    if (finder.skipped(c)) return;
    const CellType type = m.type(c);
    if (const CaseTable* table = cell_cases(type)) return finder.solid(*table, cells, c, out);
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
      bool any = false, every = true, good = true;
      for (size_t k = 0; k < n; ++k) {
        const bool in = finder.f(size_t(p(k))) >= finder.value;
        any = any || in, every = every && in, good = good && !finder.bad(p(k));
      }
      if (any && !every && good) cut_polyhedron(finder, m, c, out);
    } else {
      unsupported(m, c);
    }
  });
}

Found find_cells(const Finder& finder, const SurfaceMesh& m) {
  const CellsView polygons = cells_view(m.polygons), strips = cells_view(m.strips);
  const size_t before = m.vertices.size() + m.lines.size();
  return find(polygons.count + strips.count, finder.job.context, [&](size_t c, Found& out) {
    if (finder.skipped(before + c)) return;
    const bool strip = c >= polygons.count;
    const CellsView& cells = strip ? strips : polygons;
    const size_t cell = strip ? c - polygons.count : c, n = cells.size(cell);
    std::vector<int64_t> p(n);
    for (size_t k = 0; k < n; ++k) p[k] = cells.point(cell, k);
    if (!strip) return finder.polygon(p, before + c, out);
    for (size_t k = 0; k + 2 < n; ++k) {
      const int64_t around[3] = {p[k], p[k + 1 + k % 2], p[k + 2 - k % 2]};
      finder.polygon(around, before + c, out);
    }
  });
}

// Distinct edges in order of their point numbers, by buckets of the lower one.
class EdgeNumbers {
 public:
  EdgeNumbers(size_t points, const Found& found) : start_(points + 1, 0) {
    for (const auto* keys : {&found.lines, &found.triangles})
      for (uint64_t k : *keys) ++start_[k >> 32];
    exclusive_scan(start_);
    std::vector<uint32_t> other(start_.back());
    std::vector<size_t> next(start_.begin(), start_.end() - 1);
    for (const auto* keys : {&found.lines, &found.triangles})
      for (uint64_t k : *keys) other[next[k >> 32]++] = uint32_t(k);
    std::vector<size_t> count(points + 1, 0);
    parallel_for(points, 1 << 14, [&](size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p) {
        const auto b = other.begin() + ptrdiff_t(start_[p]), e = other.begin() + ptrdiff_t(start_[p + 1]);
        std::sort(b, e);
        count[p] = size_t(std::unique(b, e) - b);
      }
    });
    std::vector<size_t> first = count;
    exclusive_scan(first);
    other_.resize(first.back());
    parallel_for(points, 1 << 14, [&](size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p)
        std::copy_n(other.begin() + ptrdiff_t(start_[p]), count[p], other_.begin() + ptrdiff_t(first[p]));
    });
    start_ = std::move(first);
  }
  size_t size() const { return other_.size(); }
  int32_t operator()(uint64_t key) const {
    size_t i = start_[key >> 32];
    while (other_[i] != uint32_t(key)) ++i;
    return int32_t(i);
  }
  template <class F>
  void each(F&& f) const {  // f(vertex, a, b), in parallel
    parallel_for(start_.size() - 1, 1 << 14, [&](size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p)
        for (size_t i = start_[p]; i < start_[p + 1]; ++i) f(i, uint32_t(p), other_[i]);
    });
  }

 private:
  std::vector<size_t> start_;
  std::vector<uint32_t> other_;
};

Array make_normals(const Job& job, const Block<EdgePoint>& edges) {
  std::vector<uint32_t> points;
  std::vector<uint32_t> slot(job.input.point_count(), UINT32_MAX);
  for (size_t i = 0; i < edges.count; ++i)
    for (uint32_t p : {edges.data[i].a, edges.data[i].b})
      if (slot[p] == UINT32_MAX) {
        slot[p] = uint32_t(points.size());
        points.push_back(p);
      }
  std::vector<double> g(points.size() * 3);
  least_squares_gradients(job.input, points, job.samples.converted(ElementType::f64), g.data(), job.context);
  float* out = nullptr;
  Array normals = Array::make<float>(edges.count, 3, &out);
  for (size_t i = 0; i < edges.count; ++i) {
    const EdgePoint e = edges.data[i];
    const double *a = &g[3 * slot[e.a]], *b = &g[3 * slot[e.b]], t = double(e.t);
    const Vec3 n = Vec3(a[0], a[1], a[2]) * (1 - t) + Vec3(b[0], b[1], b[2]) * t;
    const double size = length(n);
    for (int c = 0; c < 3; ++c) out[3 * i + size_t(c)] = size > 0 && std::isfinite(size) ? float(-n[c] / size) : 0.0f;
  }
  return normals;
}

Block<uint32_t> cell_block(const std::vector<uint32_t>& v) {
  Block<uint32_t> b;
  b.allocate(v.size());
  std::copy(v.begin(), v.end(), b.data);
  return b;
}

}  // namespace

Piece contour_cells(const Job& job, double value) {
  const auto* mesh = job.input.as<UnstructuredMesh>();
  const Points& points = mesh ? mesh->points : job.input.as<SurfaceMesh>()->points;
  const Finder finder{job, points, value};
  const Found found = mesh ? find_cells(finder, *mesh) : find_cells(finder, *job.input.as<SurfaceMesh>());
  const EdgeNumbers numbers(points.count(), found);
  if (numbers.size() > size_t(INT32_MAX))
    fail_usage("the surface has more than 2^31 points", "contour", "contour a part of the mesh at a time");

  Piece piece;
  float* xyz = nullptr;
  piece.xyz = Array::make<float>(numbers.size(), 3, &xyz);
  piece.points.allocate(numbers.size());
  numbers.each([&](size_t v, uint32_t a, uint32_t b) {
    const double t = crossing(value, finder.f(a), finder.f(b));
    piece.points.data[v] = {a, b, float(t)};
    const Vec3 from = points.at(a) - job.origin, to = points.at(b) - job.origin;
    const Vec3 x = from + (to - from) * t;
    for (int c = 0; c < 3; ++c) xyz[3 * v + size_t(c)] = float(x[c]);
  });
  auto connect = [&](const std::vector<uint64_t>& keys) {
    int32_t* out = nullptr;
    Array a = Array::make<int32_t>(keys.size(), 1, &out);
    parallel_for(keys.size(), 1 << 15, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) out[i] = numbers(keys[i]);
    });
    return a;
  };
  piece.lines = connect(found.lines);
  piece.triangles = connect(found.triangles);
  piece.line_cells = cell_block(found.line_cells);
  piece.triangle_cells = cell_block(found.triangle_cells);
  if (job.normals && !found.triangles.empty()) piece.normals = make_normals(job, piece.points);
  return piece;
}

}  // namespace sg::contouring

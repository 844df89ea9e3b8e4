// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/faces/bilinear_quads.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/nearest_whole.h"
#include "data/field_ops.h"
#include "filter/mesh/surface.h"

namespace sg {

namespace {

constexpr size_t most_parts = 200000;
constexpr int finest = 8;
constexpr double visible = 0.01;  // of the range: twice what one can tell apart on a colour map

// Some quadrilateral has values v0 - v1 + v2 - v3 that are not about zero, as they are where they lie in a plane.
bool twists(const CellsView& polygons, const Field& field) {
  for (int c = 0; c < field.components(); ++c) {
    Range r;
    for (size_t i = 0; i < field.array.count(); ++i)
      if (const double v = field.array.get(i, c); std::isfinite(v)) r.add({v, v});
    for (size_t q = 0; q < polygons.count && !r.empty(); ++q) {
      if (polygons.size(q) != 4) continue;
      const auto at = [&](size_t k) { return field.array.get(size_t(polygons.point(q, k)), c); };
      if (std::abs(at(0) - at(1) + at(2) - at(3)) > 4 * visible * (r.hi - r.lo)) return true;
    }
  }
  return false;
}

// New points as up to four of the old ones with weights; the old ones come first.
struct Mixtures {
  std::vector<int64_t> ids;
  std::vector<double> weights;

  int64_t add(std::array<int64_t, 4> id, std::array<double, 4> weight) {
    ids.insert(ids.end(), id.begin(), id.end()), weights.insert(weights.end(), weight.begin(), weight.end());
    return int64_t(ids.size() / 4) - 1;
  }
};

class Division {
 public:
  Division(const SurfaceMesh& mesh, int n) : polygons_(cells_view(mesh.polygons)), n_(n), edges_(edges_of(mesh)) {
    for (size_t p = 0; p < mesh.points.count(); ++p) mixed_.add({int64_t(p), 0, 0, 0}, {1, 0, 0, 0});
    first_on_edges_ = int64_t(mesh.points.count());
    for (size_t e = 0; e < edges_.size(); e += 2)
      for (int k = 1; k < n_; ++k) mixed_.add({edges_[e], edges_[e + 1], 0, 0}, {1 - share(k), share(k), 0, 0});
    for (size_t c = 0; c < polygons_.count; ++c) polygons_.size(c) == 4 ? divide_quad(c) : divide_triangle(c);
  }

  const Mixtures& points() const { return mixed_; }
  std::vector<int64_t> connectivity, offsets{0}, sources;  ///< of the parts

 private:
  double share(int k) const { return double(k) / n_; }

  // Point k of n from a to b, the same from both sides.
  int64_t on_edge(int64_t a, int64_t b, int k) const {
    if (k == 0 || k == n_ || a == b) return k == n_ ? b : a;
    if (a > b) return on_edge(b, a, n_ - k);
    size_t lo = 0, hi = edges_.size() / 2;
    while (lo < hi) {
      const size_t middle = (lo + hi) / 2;
      const bool before = edges_[2 * middle] != a ? edges_[2 * middle] < a : edges_[2 * middle + 1] < b;
      before ? lo = middle + 1 : hi = middle;
    }
    return first_on_edges_ + int64_t(lo) * (n_ - 1) + k - 1;
  }

  void add_part(std::initializer_list<int64_t> corners, size_t cell) {
    connectivity.insert(connectivity.end(), corners);
    offsets.push_back(int64_t(connectivity.size()));
    sources.push_back(int64_t(cell));
  }

  void divide_quad(size_t cell) {
    int64_t p[4];
    for (size_t k = 0; k < 4; ++k) p[k] = polygons_.point(cell, k);
    std::vector<int64_t> grid;
    for (int j = 0; j <= n_; ++j)
      for (int i = 0; i <= n_; ++i) {
        const double u = share(i), v = share(j);
        if (j == 0) grid.push_back(on_edge(p[0], p[1], i));
        else if (j == n_) grid.push_back(on_edge(p[3], p[2], i));
        else if (i == 0) grid.push_back(on_edge(p[0], p[3], j));
        else if (i == n_) grid.push_back(on_edge(p[1], p[2], j));
        else grid.push_back(mixed_.add({p[0], p[1], p[2], p[3]}, {(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v}));
      }
    const auto at = [&](int i, int j) { return grid[size_t(j * (n_ + 1) + i)]; };
    for (int j = 0; j < n_; ++j)
      for (int i = 0; i < n_; ++i) add_part({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}, cell);
  }

  void divide_triangle(size_t cell) {
    int64_t p[3];
    for (size_t k = 0; k < 3; ++k) p[k] = polygons_.point(cell, k);
    std::vector<int64_t> grid;  // rows j of n + 1 - j points
    std::vector<size_t> row;
    for (int j = 0; j <= n_; ++j) {
      row.push_back(grid.size());
      for (int i = 0; i + j <= n_; ++i) {
        const double u = share(i), v = share(j);
        if (j == 0) grid.push_back(on_edge(p[0], p[1], i));
        else if (i == 0) grid.push_back(on_edge(p[0], p[2], j));
        else if (i + j == n_) grid.push_back(on_edge(p[1], p[2], j));
        else grid.push_back(mixed_.add({p[0], p[1], p[2], 0}, {1 - u - v, u, v, 0}));
      }
    }
    const auto at = [&](int i, int j) { return grid[row[size_t(j)] + size_t(i)]; };
    for (int j = 0; j < n_; ++j)
      for (int i = 0; i + j < n_; ++i) {
        add_part({at(i, j), at(i + 1, j), at(i, j + 1)}, cell);
        if (i + j + 1 < n_) add_part({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}, cell);
      }
  }

  const CellsView polygons_;
  const int n_;
  const std::vector<uint32_t> edges_;
  int64_t first_on_edges_ = 0;
  Mixtures mixed_;
};

Array mixed(const Field& f, const Mixtures& m) {
  Array floats = combine(f.array, m.ids, m.weights, 4);
  if (f.role != Role::colors || f.array.type() != ElementType::u8) return floats;
  std::vector<uint8_t> bytes(floats.count() * size_t(floats.components()));
  const auto v = floats.view<float>();
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = nearest_whole<uint8_t>(double(v.data[i]));
  return Array::from_vector(std::move(bytes), floats.components());
}

}  // namespace

DatasetPtr bilinear_parts(const DatasetPtr& surface, const std::string& field) {
  const SurfaceMesh& mesh = *surface->as<SurfaceMesh>();
  const CellsView polygons = cells_view(mesh.polygons);
  const Field* f = surface->fields().find(field, Association::point);
  if (!f || surface->point_ghost().count() > 0 || mesh.strips.size() > 0 || polygons.count == 0 || polygons.count > most_parts / 4)
    return surface;
  for (size_t c = 0; c < polygons.count; ++c)
    if (polygons.size(c) < 3 || polygons.size(c) > 4) return surface;
  if (!twists(polygons, *f)) return surface;

  int n = finest;
  while (polygons.count * size_t(n * n) > most_parts) --n;
  Division parts(mesh, n);
  const size_t before = mesh.vertices.size() + mesh.lines.size();
  std::vector<int64_t> cells(before);
  for (size_t c = 0; c < before; ++c) cells[c] = int64_t(c);
  for (const int64_t c : parts.sources) cells.push_back(int64_t(before) + c);

  DatasetParts out = surface->parts();
  SurfaceMesh divided = mesh;
  divided.points.xyz = combine(mesh.points.xyz, parts.points().ids, parts.points().weights, 4);
  divided.polygons = {Array::from_vector(std::move(parts.connectivity)), Array::from_vector(std::move(parts.offsets)), 0};
  out.mesh = std::move(divided);
  out.fields = {};
  for (const Field& old : surface->fields()) {
    if (old.association == Association::point) out.fields.add(old.with(mixed(old, parts.points())));
    else out.fields.add(old.association == Association::cell ? old.with(gather(old.array, cells)) : old);
  }
  if (out.cell_ghost.count() > 0) out.cell_ghost = gather(out.cell_ghost, cells);
  out.point_ghost = {};
  return make_dataset(std::move(out));
}

}  // namespace sg

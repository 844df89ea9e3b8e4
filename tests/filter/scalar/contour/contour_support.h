// SPDX-License-Identifier: Apache-2.0
// Grids with a function on them, and what a surface must satisfy.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "data/dataset.h"
#include "data/lattice.h"
#include "filter/scalar/contour/contour.h"
#include "support/test.h"

namespace sg::test {

template <class T, class F>
Field point_field(const Mesh& mesh, std::array<size_t, 3> n, F&& f, const std::string& name = "f") {
  const Lattice lattice(mesh);
  std::vector<T> v;
  for (size_t k = 0; k < n[2]; ++k)
    for (size_t j = 0; j < n[1]; ++j)
      for (size_t i = 0; i < n[0]; ++i) v.push_back(T(f(lattice.view().position(i, j, k))));
  return {name, Association::point, Array::from_vector(std::move(v)), "", Role::scalars};
}

inline UniformGrid uniform(std::array<size_t, 3> n, Vec3 lo, Vec3 hi) {
  UniformGrid g;
  g.dims = n;
  g.origin = lo;
  for (int a = 0; a < 3; ++a) g.spacing[a] = n[size_t(a)] > 1 ? (hi[a] - lo[a]) / double(n[size_t(a)] - 1) : 1.0;
  return g;
}

/// Cube of n^3 points over [-r, r]^3.
template <class T = double, class F>
DatasetPtr cube(size_t n, double r, F&& f) {
  const Mesh g = uniform({n, n, n}, {-r, -r, -r}, {r, r, r});
  FieldSet fields;
  fields.add(point_field<T>(g, {n, n, n}, f));
  return make_dataset(g, fields);
}

/// Square of n^2 points over [-r, r]^2.
template <class F>
DatasetPtr square_grid(size_t n, F&& f, double r = 1.5) {
  const Mesh g = uniform({n, n, 1}, {-r, -r, 0}, {r, r, 0});
  FieldSet fields;
  fields.add(point_field<double>(g, {n, n, 1}, f));
  return make_dataset(g, fields);
}

/// A uniform grid with the given samples and spacing 1.
template <class T>
DatasetPtr grid_of(std::array<size_t, 3> n, std::vector<T> values) {
  UniformGrid g;
  g.dims = n;
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::move(values)), "", Role::scalars});
  return make_dataset(g, fields);
}

/// The contour; what it logs is added to `log`.
inline DatasetPtr contoured(const DatasetPtr& d, const ContourParams& p, std::string* log = nullptr) {
  Context context;
  if (log) context.on_log = [&](LogLevel, std::string_view text) { *log += std::string(text) + "\n"; };
  return contour(d, p, context);
}
inline DatasetPtr contour_at(const DatasetPtr& d, double value) {
  ContourParams p;
  p.values = {value};
  const DatasetPtr r = contoured(d, p);
  validate(r->mesh());  // contour vouches for it without a look
  return r;
}

struct Surface {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<int, 2>> lines;
  explicit Surface(const DatasetPtr& d) {
    const auto& m = *d->as<SurfaceMesh>();
    for (size_t i = 0; i < m.points.count(); ++i) points.push_back(m.points.at(i));
    const CellsView t = cells_view(m.polygons), l = cells_view(m.lines);
    for (size_t i = 0; i < t.count; ++i) triangles.push_back({int(t.point(i, 0)), int(t.point(i, 1)), int(t.point(i, 2))});
    for (size_t i = 0; i < l.count; ++i) lines.push_back({int(l.point(i, 0)), int(l.point(i, 1))});
  }
  Vec3 area_vector(size_t t) const {
    const auto& [a, b, c] = triangles[t];
    return cross(points[size_t(b)] - points[size_t(a)], points[size_t(c)] - points[size_t(a)]) * 0.5;
  }
  double area() const {
    double s = 0;
    for (size_t t = 0; t < triangles.size(); ++t) s += length(area_vector(t));
    return s;
  }
  double volume() const {
    double s = 0;
    for (const auto& [a, b, c] : triangles) s += dot(points[size_t(a)], cross(points[size_t(b)], points[size_t(c)])) / 6;
    return s;
  }
  /// Directed edges -> how often.
  std::map<std::pair<int, int>, int> edges() const {
    std::map<std::pair<int, int>, int> r;
    for (const auto& t : triangles)
      for (size_t k = 0; k < 3; ++k) ++r[{t[k], t[(k + 1) % 3]}];
    return r;
  }
  long euler() const {
    std::set<std::pair<int, int>> e;
    for (const auto& [edge, n] : edges()) e.insert(std::minmax(edge.first, edge.second));
    return long(points.size()) - long(e.size()) + long(triangles.size());
  }
  int components() const {
    std::vector<int> parent(points.size());
    std::iota(parent.begin(), parent.end(), 0);
    auto root = [&](int i) {
      while (parent[size_t(i)] != i) i = parent[size_t(i)] = parent[size_t(parent[size_t(i)])];
      return i;
    };
    for (const auto& t : triangles)
      for (size_t k = 0; k < 2; ++k) parent[size_t(root(t[k]))] = root(t[k + 1]);
    int n = 0;
    for (size_t i = 0; i < points.size(); ++i) n += root(int(i)) == int(i);
    return n;
  }
  bool every_point_used() const {
    std::vector<char> used(points.size());
    for (const auto& t : triangles)
      for (int p : t) used[size_t(p)] = 1;
    for (const auto& l : lines)
      for (int p : l) used[size_t(p)] = 1;
    return std::all_of(used.begin(), used.end(), [](char c) { return c; });
  }
  /// Faults of a surface in a box: edges that are not used once each way (the box's border excepted), and triangles that appear twice.
  int faults(const Box3& box = {}) const {
    int bad = 0;
    auto on_border = [&](int a, int b) {
      for (int x = 0; x < 3; ++x)
        for (double side : {box.lo[x], box.hi[x]})
          if (std::abs(points[size_t(a)][x] - side) < 1e-6 * box.diagonal() &&
              std::abs(points[size_t(b)][x] - side) < 1e-6 * box.diagonal())
            return true;
      return false;
    };
    const auto e = edges();
    for (const auto& [edge, n] : e) {
      const auto back = e.find({edge.second, edge.first});
      if (n != 1) ++bad;
      else if (back == e.end() && (box.empty() || !on_border(edge.first, edge.second))) ++bad;
    }
    std::set<std::array<int, 3>> seen;
    for (auto t : triangles) {
      std::sort(t.begin(), t.end());
      if (!seen.insert(t).second || t[0] == t[1] || t[1] == t[2]) ++bad;
    }
    return bad;
  }
};

inline bool same_bytes(const Array& a, const Array& b) {
  return a.type() == b.type() && a.count() == b.count() && a.components() == b.components() &&
         (a.bytes() == 0 || std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
}

inline bool same_surface(const DatasetPtr& a, const DatasetPtr& b) {
  const auto &x = *a->as<SurfaceMesh>(), &y = *b->as<SurfaceMesh>();
  return x.points.origin == y.points.origin && same_bytes(x.points.xyz, y.points.xyz) &&
         same_bytes(x.polygons.connectivity, y.polygons.connectivity) && same_bytes(x.lines.connectivity, y.lines.connectivity);
}

}  // namespace sg::test

// SPDX-License-Identifier: Apache-2.0
// Analytic shapes as surfaces: sphere, torus, box, cylinder, disc.
#pragma once
#include <algorithm>
#include <map>
#include <numbers>

#include "data/dataset.h"
#include "filter/mesh/surface.h"

namespace sg::test::shapes {

using std::numbers::pi;

struct Builder {
  std::vector<double> xyz;
  std::vector<int64_t> ids, offsets{0};
  int64_t point(Vec3 p) {
    xyz.insert(xyz.end(), {p.x, p.y, p.z});
    return int64_t(xyz.size() / 3) - 1;
  }
  void polygon(std::vector<int64_t> p) {
    ids.insert(ids.end(), p.begin(), p.end());
    offsets.push_back(int64_t(ids.size()));
  }
  SurfaceMesh mesh() const {
    SurfaceMesh m;
    m.points.xyz = Array::from_vector(xyz, 3);
    m.polygons.connectivity = Array::from_vector(ids);
    m.polygons.offsets = Array::from_vector(offsets);
    return m;
  }
  DatasetPtr dataset() const { return make_dataset(mesh()); }
};

/// Octahedron, each triangle cut into 4^levels, points pushed onto the sphere.
inline Builder sphere(int levels, double radius = 1, Vec3 center = {}) {
  Builder b;
  std::vector<Vec3> at = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<std::array<int64_t, 3>> t = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int l = 0; l < levels; ++l) {
    std::map<std::pair<int64_t, int64_t>, int64_t> middle;
    auto mid = [&](int64_t p, int64_t q) {
      const auto key = std::minmax(p, q);
      const auto [i, fresh] = middle.try_emplace({key.first, key.second}, int64_t(at.size()));
      if (fresh) at.push_back(normalize(at[size_t(p)] + at[size_t(q)]));
      return i->second;
    };
    std::vector<std::array<int64_t, 3>> finer;
    for (const auto& [p, q, r] : t) {
      const int64_t x = mid(p, q), y = mid(q, r), z = mid(r, p);
      finer.insert(finer.end(), {{p, x, z}, {x, q, y}, {z, y, r}, {x, y, z}});
    }
    t = finer;
  }
  for (Vec3 p : at) b.point(center + p * radius);
  for (const auto& [p, q, r] : t) b.polygon({p, q, r});
  return b;
}

/// n quads along the large circle, m along the small one; about z.
inline Builder torus(int n, int m, double R, double r) {
  Builder b;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const double u = 2 * pi * i / n, v = 2 * pi * j / m, d = R + r * std::cos(v);
      b.point({d * std::cos(u), d * std::sin(u), r * std::sin(v)});
    }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      auto id = [&](int x, int y) { return int64_t((x % n) * m + y % m); };
      b.polygon({id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  return b;
}

/// [0,a]x[0,b]x[0,c] of six quads with shared corners.
inline Builder box(double a = 1, double b = 1, double c = 1) {
  Builder s;
  for (int k = 0; k < 8; ++k) s.point({k & 1 ? a : 0, k & 2 ? b : 0, k & 4 ? c : 0});
  for (const auto& q :
       std::vector<std::vector<int64_t>>{{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
    s.polygon(q);
  return s;
}

/// Side of n quads and two n-gons, radius 1, z from 0 to h.
inline Builder cylinder(int n, double h, bool lids = true) {
  Builder s;
  std::vector<int64_t> bottom, top;
  for (int i = 0; i < n; ++i) {
    const double u = 2 * pi * i / n;
    bottom.push_back(s.point({std::cos(u), std::sin(u), 0}));
    top.push_back(s.point({std::cos(u), std::sin(u), h}));
  }
  for (size_t i = 0; i < size_t(n); ++i) s.polygon({bottom[i], bottom[(i + 1) % size_t(n)], top[(i + 1) % size_t(n)], top[i]});
  if (lids) {
    s.polygon(top);
    std::reverse(bottom.begin(), bottom.end());
    s.polygon(bottom);
  }
  return s;
}

inline double number(const Table& t, const std::string& column, size_t row = 0) {
  for (const Field& f : t.columns)
    if (f.name == column) return f.array.get(row);
  return -12345;
}

}  // namespace sg::test::shapes

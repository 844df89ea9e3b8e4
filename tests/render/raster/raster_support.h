// SPDX-License-Identifier: Apache-2.0
// Small meshes and one-line pictures for the tests of the rasterizer.
#pragma once
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "render/raster/raster.h"
#include "render/render.h"
#include "support/test.h"

namespace sg::test {

using std::numbers::pi;

inline SurfaceMesh triangle_mesh(std::vector<float> xyz, std::vector<int32_t> triangles, Vec3 origin = {}) {
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::move(xyz), 3), m.points.origin = origin;
  m.polygons.connectivity = Array::from_vector(std::move(triangles)), m.polygons.fixed = 3;
  return m;
}

inline DatasetPtr surface(std::vector<float> xyz, std::vector<int32_t> triangles, FieldSet fields = {}, Vec3 origin = {}) {
  return make_dataset(triangle_mesh(std::move(xyz), std::move(triangles), origin), std::move(fields));
}

/// A quad in the plane z, corners (-a,-a) .. (a,a).
inline DatasetPtr quad(float a, float z, FieldSet fields = {}) {
  return surface({-a, -a, z, a, -a, z, a, a, z, -a, a, z}, {0, 1, 2, 0, 2, 3}, std::move(fields));
}

/// A bumpy torus of 2*n*m triangles with field "height"; `normals` adds analytic ones of the smooth torus.
inline DatasetPtr torus(int n, int m, bool normals = false, Vec3 origin = {}, float bump = 0.03f) {
  std::vector<float> xyz, normal, height;
  std::vector<int32_t> t;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const double u = 2 * pi * i / n, v = 2 * pi * j / m, r = 0.4 + bump * std::sin(8 * u) * std::cos(5 * v), c = 1 + r * std::cos(v);
      for (double q : {c * std::cos(u), c * std::sin(u), r * std::sin(v)}) xyz.push_back(float(q));
      for (double q : {std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v)}) normal.push_back(float(q));
      height.push_back(xyz.back());
      const int a = i * m + j, b = (i + 1) % n * m + j, d = i * m + (j + 1) % m, e = (i + 1) % n * m + (j + 1) % m;
      for (int q : {a, b, e, a, e, d}) t.push_back(q);
    }
  FieldSet f;
  f.add({"height", Association::point, Array::from_vector(std::move(height)), "", Role::scalars});
  if (normals) f.add({"Normals", Association::point, Array::from_vector(std::move(normal), 3), "", Role::normals});
  return surface(std::move(xyz), std::move(t), std::move(f), origin);
}

inline DatasetPtr sphere(int n, float radius) {
  std::vector<float> xyz;
  std::vector<int32_t> t;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i < 2 * n; ++i) {
      const double th = pi * j / n, ph = pi * i / n;
      for (double q : {std::sin(th) * std::cos(ph), std::sin(th) * std::sin(ph), std::cos(th)}) xyz.push_back(float(q) * radius);
      if (j == n) continue;
      const int a = j * 2 * n + i, b = j * 2 * n + (i + 1) % (2 * n);
      for (int q : {a, a + 2 * n, b + 2 * n, a, b + 2 * n, b}) t.push_back(q);
    }
  return surface(std::move(xyz), std::move(t));
}

/// Looks down the z axis from `distance`; parallel pictures are `height` high.
inline Camera front(double distance = 10, double view_angle = 30) {
  Camera c;
  c.position = {0, 0, distance}, c.view_angle = view_angle, c.near_plane = 0.01, c.far_plane = 1000;
  return c;
}
inline Camera front_parallel(double height, double distance = 10) {
  Camera c = front(distance);
  c.parallel = true, c.parallel_height = height;
  return c;
}

struct Picture {
  Frame frame;
  FragmentLists fragments;
  const float* rgba(int x, int y) const { return &frame.rgba[4 * (size_t(y) * size_t(frame.width) + size_t(x))]; }
  float depth(int x, int y) const { return frame.depth[size_t(y) * size_t(frame.width) + size_t(x)]; }
  uint32_t id(int x, int y) const { return frame.ids[size_t(y) * size_t(frame.width) + size_t(x)]; }
  size_t covered() const {
    return size_t(std::count_if(frame.ids.begin(), frame.ids.end(), [](uint32_t i) { return i > 0; }));
  }
};

inline Picture draw(const Scene& scene, const Camera& camera, int w, int h, double pixel_scale = 1) {
  Picture p;
  p.frame = Frame(w, h);
  Context context;
  p.fragments = rasterize(scene, make_projection(camera, w, h), pixel_scale, p.frame, context);
  return p;
}

template <class V>
bool same_bytes(const V& a, const V& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(typename V::value_type)) == 0);
}
inline bool same_bytes(const Picture& a, const Picture& b) {
  return same_bytes(a.frame.rgba, b.frame.rgba) && same_bytes(a.frame.depth, b.frame.depth) && same_bytes(a.frame.ids, b.frame.ids) &&
         same_bytes(a.fragments.start, b.fragments.start) && same_bytes(a.fragments.fragments, b.fragments.fragments);
}

inline SurfaceItem item(DatasetPtr data, Vec3f color = {0.8f, 0.8f, 0.8f}, bool lit = true) {
  SurfaceItem s;
  s.data = std::move(data), s.color = color, s.material.lit = lit;
  return s;
}

/// A white polyline.
inline LinesItem line(std::vector<float> xyz, double width, FieldSet fields = {}) {
  SurfaceMesh m;
  std::vector<int32_t> ids;
  for (size_t i = 0; i < xyz.size() / 3; ++i) ids.push_back(int32_t(i));
  const int n = int(ids.size());
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.lines = {Array::from_vector(std::move(ids)), Array::from_vector<int32_t>({0, n}), 0};
  LinesItem l;
  l.data = make_dataset(m, std::move(fields)), l.width = width, l.color = {1, 1, 1};
  return l;
}

/// A scale from black to white over [lo, hi] in linear light: the colour tells the value.
inline FieldColor grey_by(const std::string& field, double lo, double hi) {
  FieldColor c;
  c.field = field, c.scale.lo = lo, c.scale.hi = hi;
  for (int i = 0; i < 4096; ++i) {
    const float v = srgb_encode(float(i) / 4095.0f);
    c.scale.map.colors.push_back({v, v, v});
  }
  return c;
}

}  // namespace sg::test

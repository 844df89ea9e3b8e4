// SPDX-License-Identifier: Apache-2.0
#include "render/prepare/glyph_set.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"

namespace sg::raster {

namespace {

Vec3 point_of(const float* xyz, uint32_t i) { return {xyz[3 * size_t(i)], xyz[3 * size_t(i) + 1], xyz[3 * size_t(i) + 2]}; }

// Every directed edge has its opposite just once, and the faces look outward.
bool is_closed(const GlyphShape& s, const float* xyz) {
  if (s.triangles < 4) return false;
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  double volume = 0;
  for (size_t t = 0; t < s.triangles; ++t) {
    const uint32_t* c = &s.triangle_list[3 * t];
    for (int k = 0; k < 3; ++k)
      if (++edges[{c[k], c[(k + 1) % 3]}] > 1) return false;
    volume += dot(point_of(xyz, c[0]), cross(point_of(xyz, c[1]), point_of(xyz, c[2])));
  }
  for (const auto& [e, n] : edges)
    if (!edges.contains({e.second, e.first})) return false;
  return volume > 0;
}

void add_face(GlyphShape& s, size_t t, const float* xyz, const NormalSet& normals) {
  const uint32_t* c = &s.triangle_list[3 * t];
  const Vec3 p = point_of(xyz, c[0]), u = point_of(xyz, c[1]) - p, v = point_of(xyz, c[2]) - p, cr = cross(u, v);
  const Vec3 face = normalize(cr);
  Vec3 constant = face;
  Mat3 slope{{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
  const double area2 = dot(cr, cr);
  if (!normals.normals.empty() && area2 > 0) {
    const auto* n = reinterpret_cast<const float*>(normals.normals.raw());
    const auto* number = normals.corners.empty() ? c : reinterpret_cast<const uint32_t*>(normals.corners.raw()) + 3 * t;
    const Vec3 n0 = point_of(n, number[0]), n1 = point_of(n, number[1]) - n0, n2 = point_of(n, number[2]) - n0;
    // The weights of the second and third corner are linear: their gradients lie in the plane of the triangle.
    const Vec3 g1 = cross(v, cr) / area2, g2 = cross(cr, u) / area2;
    for (int r = 0; r < 3; ++r)
      for (int k = 0; k < 3; ++k) slope.m[r][k] = n1[r] * g1[k] + n2[r] * g2[k];
    constant = n0 - slope * p;
    if (length(n0 - face) + length(n1) + length(n2) > 1e-3) s.smooth = true;
  }
  float* f = &s.faces[GlyphShape::row * t];
  for (int r = 0; r < 3; ++r) {
    f[r] = float(face[r]), f[3 + r] = float(constant[r]);
    for (int k = 0; k < 3; ++k) f[6 + 3 * r + k] = float(slope.m[r][k]);
  }
}

GlyphShape make_shape(const DatasetPtr& data, double feature_angle, bool flat) {
  const auto* mesh = data->as<SurfaceMesh>();
  GlyphShape s;
  bool any = false;
  const TriangleSet set = triangulate(data, any);
  s.points = set.positions.count(), s.triangles = set.count;
  if (s.points > (1u << 20) || s.triangles > (1u << 20))
    fail_usage(fmt::format("a shape of {} points and {} triangles is too large for a glyph", s.points, s.triangles), "glyphs",
               "decimate it first");
  std::vector<float> xyz(3 * s.points);
  for (size_t i = 0; i < s.points; ++i)
    for (size_t c = 0; c < 3; ++c) xyz[3 * i + c] = set.xyz()[3 * i + c] + float(set.origin[int(c)]);
  const size_t room = (s.points + 2 * GlyphShape::pad - 1) / GlyphShape::pad * GlyphShape::pad;
  s.x.assign(room, 0), s.y.assign(room, 0), s.z.assign(room, 0);
  for (size_t i = 0; i < room && s.points; ++i) {  // the last point again: what is added must not be clipped where the shape is not
    const size_t from = 3 * std::min(i, s.points - 1);
    s.x[i] = xyz[from], s.y[i] = xyz[from + 1], s.z[i] = xyz[from + 2];
  }
  s.triangle_list.assign(set.indices(), set.indices() + 3 * s.triangles);
  for (int k = 0; k < 3; ++k) {
    s.corners[k].assign((s.triangles + 2 * GlyphShape::pad - 1) / GlyphShape::pad * GlyphShape::pad, 0);
    for (size_t t = 0; t < s.triangles; ++t) s.corners[k][t] = int32_t(s.triangle_list[3 * t + size_t(k)]);
  }
  s.closed = is_closed(s, xyz.data());
  s.faces.resize(GlyphShape::row * s.triangles);
  const NormalSet normals = flat ? NormalSet{} : smooth_normals(set, feature_angle);
  for (size_t t = 0; t < s.triangles; ++t) add_face(s, t, xyz.data(), normals);
  s.segments = line_segments(*data, *mesh);
  return s;
}

}  // namespace

std::shared_ptr<const GlyphShape> glyph_shape(const DatasetPtr& shape, double feature_angle, bool flat) {
  if (!shape || !shape->as<SurfaceMesh>()) fail_usage("a shape must be a surface mesh", "glyphs");
  return derived(shape, fmt::format("glyph shape/{}/{}", feature_angle, flat), [&] { return make_shape(shape, feature_angle, flat); });
}

std::vector<uint32_t> glyph_order(const GlyphInstances& instances) {
  const size_t n = instances.count();
  const float* m = instances.data();
  Box3 box;
  for (size_t i = 0; i < n; ++i)
    if (instances.stands(i)) box.add({m[12 * i + 3], m[12 * i + 7], m[12 * i + 11]});
  constexpr int bits = 10;
  auto spread = [](uint32_t v) {  // ten bits, two zeros between each
    v = (v | v << 16) & 0x030000FF;
    v = (v | v << 8) & 0x0300F00F;
    v = (v | v << 4) & 0x030C30C3;
    return (v | v << 2) & 0x09249249;
  };
  double per[3];
  for (int a = 0; a < 3; ++a) per[a] = box.size()[a] > 0 ? ((1 << bits) - 1) / box.size()[a] : 0;
  std::vector<uint32_t> code(n), order(n), next(n);
  parallel_for(n, 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      order[i] = uint32_t(i);
      for (size_t a = 0; a < 3 && instances.stands(i); ++a)
        code[i] |= spread(uint32_t((double(m[12 * i + 4 * a + 3]) - box.lo[int(a)]) * per[a])) << a;
    }
  });
  for (int pass = 0; pass < 3; ++pass) {  // by digits from the lowest, each pass keeps the order of the one before
    std::vector<size_t> place(1 << bits);
    auto digit = [&](uint32_t i) { return code[i] >> (bits * pass) & ((1u << bits) - 1); };
    for (const uint32_t i : order) ++place[digit(i)];
    exclusive_scan(place);
    for (const uint32_t i : order) next[place[digit(i)]++] = i;
    order.swap(next);
  }
  return order;
}

int glyph_shift(size_t instances, size_t most) {
  int shift = 0;
  while ((size_t(1) << shift) < most) ++shift;
  if ((instances << shift) >= size_t(UINT32_MAX) || instances >= size_t(INT32_MAX) / 12)
    fail_usage(fmt::format("{} glyphs of {} primitives are more than a picture holds", instances, most), "glyphs",
               "use fewer points (glyph_points) or a simpler shape");
  return shift;
}

}  // namespace sg::raster

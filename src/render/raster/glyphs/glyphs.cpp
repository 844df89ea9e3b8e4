// SPDX-License-Identifier: Apache-2.0
// Shapes of glyphs, and their drawing in plain C++.
#include "render/raster/glyphs/glyphs.h"

#include <fmt/core.h>

#include <cmath>
#include <map>

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
  return derived<GlyphShape>(shape, fmt::format("glyph shape/{}/{}", feature_angle, flat),
                             [&] { return make_shape(shape, feature_angle, flat); });
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
               "take fewer points (glyph_points) or a simpler shape");
  return shift;
}

bool glyph_matrix(const GlyphSet& set, const EyeView& v, float pixel_scale, size_t instance, float* m) {
  const float* q = set.instances->data() + 12 * instance;
  if (!(q[0] == q[0])) return false;
  for (int k = 0; k < 12; ++k) m[k] = q[k];
  if (!set.in_pixels) return true;
  const float p[3] = {m[3], m[7], m[11]};
  const float z = to_eye(v, p).z;
  if (!v.parallel && !(z > v.near_plane)) return false;
  const float f = v.parallel ? pixel_scale / v.scale : pixel_scale * z / v.scale;
  for (int k = 0; k < 12; ++k)
    if (k % 4 != 3) m[k] = m[k] * f;
  return true;
}

void draw_glyphs_reference(const GlyphJob& job, size_t begin, size_t end, std::vector<TriangleRecord>& large) {
  std::vector<float> xyz;
  for (size_t k = begin; k < end; ++k) {
    const size_t i = job.set->order ? (*job.set->order)[k] : k;
    float m[12];
    if (!glyph_matrix(*job.set, job.view, job.pixel_scale, i, m)) continue;
    const GlyphShape& s = job.set->shape_of(i);
    xyz.resize(3 * s.points);
    for (size_t p = 0; p < s.points; ++p) glyph_point(m, s.x[p], s.y[p], s.z[p], &xyz[3 * p]);
    const auto first = job.first_primitive + uint32_t(i << job.set->shift);
    draw_triangles_reference({job.view, xyz.data(), s.triangle_list.data(), first, job.small, job.keys}, 0, s.triangles, large);
  }
}

void shade_glyphs(const PreparedItem& item, const EyeView& view, float pixel_scale, const std::vector<Lamp>& lights, ShadeBatch& b) {
  if (b.n == 0) return;
  const GlyphSet& set = *item.glyphs;
  light_glyphs({view, set, pixel_scale, item.material, lights}, b);
  const ColorSource& color = item.color;
  if (color.kind == ColorSource::Kind::constant) {
    for (size_t k = 0; k < 4; ++k) std::fill_n(b.rgba[k], b.n, color.constant[int(k)]);
    return;
  }
  for (size_t i = 0; i < b.n; ++i) {
    const size_t p = b.triangle[i] >> set.shift;
    Vec4f rgba;
    if (color.kind == ColorSource::Kind::scalar) rgba = color.of(color.data()[p]);
    else
      for (int k = 0; k < 4; ++k) rgba[k] = color.data()[4 * p + size_t(k)];
    for (int k = 0; k < 4; ++k) b.rgba[k][i] = rgba[k];
  }
}

std::vector<MarkRecord> glyph_marks(const PreparedItem& item, uint32_t number, const Projection& projection, double pixel_scale) {
  constexpr size_t grain = 1 << 12;
  const GlyphSet& set = *item.glyphs;
  const EyeView view = eye_view(projection, item.origin);
  const size_t n = set.instances->count(), chunks = (n + grain - 1) / grain;
  std::vector<std::vector<MarkRecord>> parts(chunks);
  parallel_for(n, grain, [&](size_t begin, size_t end) {
    MarkRecord r;
    r.half = float(0.5 * item.width * pixel_scale), r.item = number;
    for (size_t i = begin; i < end; ++i) {
      float m[12];
      if (!glyph_matrix(set, view, float(pixel_scale), i, m)) continue;
      const GlyphShape& s = set.shape_of(i);
      for (size_t k = 0; k < s.segments.count(); ++k) {
        Vec3 ends[2];
        for (size_t e = 0; e < 2; ++e) {
          const uint32_t p = s.segments.points[2 * k + e];
          float q[3];
          glyph_point(m, s.x[p], s.y[p], s.z[p], q);
          ends[e] = projection.to_eye(item.origin + Vec3(q[0], q[1], q[2]));
        }
        r.primitive = item.first_primitive + (uint32_t(i) << set.shift) + uint32_t(k), r.group = uint32_t(i);
        if (place_segment(projection, ends[0], ends[1], r)) parts[begin / grain].push_back(r);
      }
    }
  });
  std::vector<MarkRecord> all;
  for (const auto& p : parts) all.insert(all.end(), p.begin(), p.end());
  return all;
}

}  // namespace sg::raster

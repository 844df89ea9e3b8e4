// SPDX-License-Identifier: Apache-2.0
// Shapes of glyphs, and their drawing in plain C++.
#include "render/raster/glyphs/glyphs.h"

#include <fmt/core.h>

#include <cmath>
#include <map>

#include "base/error.h"
#include "base/parallel.h"

namespace sg::raster {

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

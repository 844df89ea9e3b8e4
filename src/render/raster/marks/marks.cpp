// SPDX-License-Identifier: Apache-2.0
#include "render/raster/marks/marks.h"
#include "render/prepare/edge_fade.h"

#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "render/prepare/glyph_set.h"
#include "render/shade/blinn_phong.h"
#include "render/shade/illuminated.h"

namespace sg::raster {

namespace {

constexpr size_t marks_per_chunk = 1 << 13;

Vec3 eye_point(const PreparedItem& item, const Projection& p, uint32_t i) {
  const float* q = reinterpret_cast<const float*>(item.positions.raw()) + 3 * size_t(i);
  return p.to_eye(item.origin + Vec3(q[0], q[1], q[2]));
}

bool finite(Vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void place(const Projection& p, Vec3 eye, double& x, double& y, double& w) {
  const double s = p.parallel ? p.scale : p.scale / eye.z;
  x = p.middle_x() + s * eye.x, y = p.middle_y() - s * eye.y, w = p.parallel ? eye.z : 1 / eye.z;
}

/// Keeps the part of a segment between near and far; false when nothing is left.
bool clip_depth(const Projection& p, Vec3& a, Vec3& b, float& from, float& to) {
  const Vec3 a0 = a, d = b - a;
  double lo = 0, hi = 1;
  auto cut = [&](double fa, double fb) {  // f >= 0 is kept
    if (fa < 0 && fb < 0) hi = -1;
    else if (fa < 0) lo = std::max(lo, fa / (fa - fb));
    else if (fb < 0) hi = std::min(hi, fa / (fa - fb));
  };
  cut(a.z - p.near_plane, b.z - p.near_plane);
  cut(p.far_plane - a.z, p.far_plane - b.z);
  if (lo > hi) return false;
  if (hi < 1) b = a0 + d * hi;
  if (lo > 0) a = a0 + d * lo;
  from = float(lo), to = float(hi);
  return true;
}

void fade_crowded(std::vector<MarkRecord>& edges, size_t gone) {
  const auto all = float(fade_together(gone, edges.size() + gone));
  if (all > 0)
    for (MarkRecord& m : edges) m.fade *= all;
  else edges.clear();
}

bool make_record(const PreparedItem& item, const Projection& p, double pixel_scale, size_t i, MarkRecord& m) {
  const bool line = item.kind == PreparedItem::Kind::lines;
  Vec3 a = eye_point(item, p, line ? item.segments->points[2 * i] : (*item.points)[i]);
  Vec3 b = line ? eye_point(item, p, item.segments->points[2 * i + 1]) : a;
  m.primitive = item.first_primitive + uint32_t(i), m.group = !line                           ? uint32_t(i)
                                                              : item.segments->groups.empty() ? 0
                                                                                              : item.segments->groups[i];
  m.fade = 1;
  if (line && !item.segments->room.empty()) {
    const double depth = 0.5 * (a.z + b.z), pixels = (p.parallel ? p.scale : p.scale / std::max(depth, 1e-300)) / pixel_scale;
    m.fade = float(edge_fade(double(item.segments->room[i]) * pixels));
  }
  if (!place_segment(p, a, b, m)) return false;
  if (!line) m.from = m.to = 0;
  return true;
}

}  // namespace

bool place_segment(const Projection& p, Vec3 a, Vec3 b, MarkRecord& m) {
  if (!finite(a) || !finite(b) || !clip_depth(p, a, b, m.from, m.to)) return false;
  place(p, a, m.ax, m.ay, m.aw), place(p, b, m.bx, m.by, m.bw);
  return finite({m.ax, m.ay, m.aw}) && finite({m.bx, m.by, m.bw}) && !mark_box(m, p.width, p.height).empty();
}

PixelBox mark_box(const MarkRecord& m, int width, int height) {
  const double r = double(m.half) + double(m.halo) + 0.5;
  auto first = [&](double v) { return int(std::clamp(std::ceil(v - r - 0.5), 0.0, 1e6)); };
  auto last = [&](double v, int n) { return int(std::clamp(std::floor(v + r - 0.5), -1.0, double(n - 1))); };
  return {first(std::min(m.ax, m.bx)), first(std::min(m.ay, m.by)), last(std::max(m.ax, m.bx), width), last(std::max(m.ay, m.by), height)};
}

std::vector<MarkRecord> mark_records(const PreparedItem& item, uint32_t number, const Projection& projection, double pixel_scale) {
  const size_t n = item.primitives, chunks = (n + marks_per_chunk - 1) / marks_per_chunk;
  std::vector<std::vector<MarkRecord>> parts(chunks);
  std::vector<size_t> gone(chunks);
  parallel_for(n, marks_per_chunk, [&](size_t begin, size_t end) {
    MarkRecord m;
    m.half = float(0.5 * item.width * pixel_scale), m.halo = float(item.halo * pixel_scale), m.item = number;
    for (size_t i = begin; i < end; ++i)
      if (make_record(item, projection, pixel_scale, i, m)) {
        if (m.fade > 0) parts[begin / marks_per_chunk].push_back(m);
        else gone[begin / marks_per_chunk] += std::hypot(m.bx - m.ax, m.by - m.ay) < roomy_edge * pixel_scale;
      }
  });
  std::vector<MarkRecord> all;
  for (const auto& p : parts) all.insert(all.end(), p.begin(), p.end());
  if (item.segments && !item.segments->room.empty()) fade_crowded(all, std::accumulate(gone.begin(), gone.end(), size_t(0)));
  return all;
}

void MarkTile::draw(const MarkRecord& m, std::vector<Cover>& out) {
  if (last_.empty()) last_.resize(tile_pixels);
  if (m.halo > 0 && last_halo_.empty()) last_halo_.resize(tile_pixels);
  const double half = m.half, wide = half + double(m.halo), r = wide + 0.5, dx = m.bx - m.ax, dy = m.by - m.ay, length2 = dx * dx + dy * dy;
  const bool line = m.from != m.to;
  const Projection& p = projection_;
  // On a slope the surface beside a line comes nearer than the line itself: marks are drawn as if that much nearer.
  const double nearer = 2 * (half + 1) / p.scale;
  double beyond = 0;  // pixels by which a halo may reach over the ends
  if (m.halo > 0) {
    const double depth = p.parallel ? std::abs(m.bw - m.aw) : std::abs(m.bw - m.aw) / std::sqrt(m.aw * m.bw);
    const double steep = depth * p.scale / std::max(std::sqrt(length2), 1e-9);  // pixels of depth per pixel
    beyond = steep <= 2 ? HUGE_VAL : std::max(0.5, 2 * half / (steep - 2));
  }
  const PixelBox all = mark_box(m, p.width, p.height);
  for (int y = std::max(box_.y0, all.y0); y <= std::min(box_.y1, all.y1); ++y) {
    const double cy = y + 0.5;
    double t0 = 0, t1 = 1;  // the part of the segment near this row
    if (dy != 0) {
      const double u = (cy - r - m.ay) / dy, v = (cy + r - m.ay) / dy;
      t0 = std::max(0.0, std::min(u, v)), t1 = std::min(1.0, std::max(u, v));
      if (t0 > t1) continue;
    }
    const double xa = m.ax + t0 * dx, xb = m.ax + t1 * dx;
    const int x0 = int(std::clamp(std::ceil(std::min(xa, xb) - r - 0.5), double(box_.x0), double(box_.x1) + 1));
    const int x1 = int(std::clamp(std::floor(std::max(xa, xb) + r - 0.5), double(box_.x0) - 1, double(box_.x1)));
    for (int x = x0; x <= x1; ++x) {
      const double qx = x + 0.5 - m.ax, qy = cy - m.ay;
      const double free = length2 > 0 ? (qx * dx + qy * dy) / length2 : 0.0, t = std::clamp(free, 0.0, 1.0);
      const double ox = qx - t * dx, oy = qy - t * dy, distance = std::sqrt(ox * ox + oy * oy);
      const double alpha = band_coverage(distance, half);
      const double dark = m.halo > 0 && alpha < 1 ? band_coverage(distance, wide) : 0;
      if (!(alpha > 0) && !(dark > 0)) continue;
      const double w = m.aw + t * (m.bw - m.aw), z = p.parallel ? w : 1 / w, front = p.parallel ? z - nearer : z * (1 - nearer);
      if (!(float(front) < key_depth(keys_[size_t(y) * size_t(p.width) + size_t(x)]))) continue;
      Cover c;
      c.pixel = uint32_t((y - box_.y0) * tile_size + (x - box_.x0));
      c.order = float(front), c.depth = float(z), c.primitive = m.primitive, c.item = m.item, c.alpha = float(alpha) * m.fade;
      if (line) {
        const double s = p.parallel ? t : t * m.bw / w;
        c.s = float(m.from + s * (double(m.to) - m.from)), c.t = 0;
      } else c.s = float(ox / std::max(half, 0.5)), c.t = float(oy / std::max(half, 0.5));
      const double joint = 2 * nearer * (p.parallel ? 1 : z);
      if (alpha > 0) add(c, m.group, joint, out);
      // A halo sinks with the distance: it hides what is clearly behind the line, not its neighbours in a bundle (Everts, Bekker, Roerdink,
      // Isenberg 2009). Beyond the ends of a segment only as far as the line, going on as steeply, stays before it.
      if (!(dark > 0) || std::abs(free - t) * std::sqrt(length2) > beyond) continue;
      const double sunk = 2 * (half + distance) / p.scale * (p.parallel ? 1 : z);
      c.order = float(std::max(front, 0.0) + sunk), c.t = 1, c.alpha = float(dark);
      if (c.order < key_depth(keys_[size_t(y) * size_t(p.width) + size_t(x)])) add(c, m.group, joint, out);
    }
  }
}

void MarkTile::add(const Cover& c, uint32_t group, double joint, std::vector<Cover>& out) {
  Last& seen = (c.t == 1 && !last_halo_.empty() ? last_halo_ : last_)[c.pixel];
  if (seen.item == c.item && seen.group == group) {
    Cover& before = out[seen.at];
    if (std::abs(double(before.order) - double(c.order)) <= joint) {  // a joint of the same polyline
      if (c.alpha > before.alpha || (c.alpha == before.alpha && c.order < before.order)) before = c;
      return;
    }
  }
  seen = {c.item, group, uint32_t(out.size())};
  out.push_back(c);
}

namespace {

// An edge in the colour of what it lies on, but darker, is seen without hiding the field; on dark colours it must be lighter.
void stand_out(PreparedItem::Contrast contrast, const float* under, float* rgb) {
  constexpr float shade = 0.25f, lift = 0.1f;  // share that is left, share of white
  const bool lighter = contrast == PreparedItem::Contrast::lighter;
  for (int k = 0; k < 3; ++k) rgb[k] = lighter ? under[k] + lift * (1 - under[k]) : shade * under[k];
}

}  // namespace

void color_mark(const PreparedItem& item, const std::vector<Lamp>& lights, const Projection& p, const float* under, Cover& c) {
  const uint32_t i = c.primitive - item.first_primitive;
  const ColorSource& source = item.color;
  const bool line = item.kind == PreparedItem::Kind::lines;
  Vec4f rgba = source.constant;
  if (source.kind != ColorSource::Kind::constant) {
    size_t a, b;
    if (item.glyphs) a = b = i >> item.glyphs->shift;
    else if (source.per_cell) a = b = item.segments->cells[i];
    else if (line) a = item.segments->points[2 * size_t(i)], b = item.segments->points[2 * size_t(i) + 1];
    else a = b = (*item.points)[i];
    if (source.nearest) a = b = c.s < 0.5f ? a : b;
    auto at = [&](size_t stride, size_t k) {
      const float u = source.data()[a * stride + k], v = source.data()[b * stride + k];
      return u == v ? u : u + (v - u) * c.s;
    };
    if (source.kind == ColorSource::Kind::scalar) rgba = source.of(at(1, 0));
    else
      for (size_t k = 0; k < 4; ++k) rgba[int(k)] = at(4, k);
  }
  float light = 1, gloss = 0;
  const bool halo = line && c.t == 1;
  if (halo) {
    for (int k = 0; k < 3; ++k) rgba[k] = item.halo_color[k];
  } else if (line && item.shaded) {
    const float *a = reinterpret_cast<const float*>(item.positions.raw()) + 3 * size_t(item.segments->points[2 * size_t(i)]),
                *b = reinterpret_cast<const float*>(item.positions.raw()) + 3 * size_t(item.segments->points[2 * size_t(i) + 1]);
    const Vec3 at = item.origin + Vec3(a[0], a[1], a[2]) * (1 - double(c.s)) + Vec3(b[0], b[1], b[2]) * double(c.s);
    const Vec3 view = p.parallel ? -p.forward : normalize(p.eye - at);
    light_line(item.material, lights, line_tangent(item, i, double(c.s)), view, light, gloss);
  } else if (item.shaded) {  // a little sphere: the offset from the centre is its normal
    const float r2 = std::min(c.s * c.s + c.t * c.t, 1.0f), nz = std::sqrt(1 - r2);
    const Vec3 n = p.right * double(c.s) - p.up * double(c.t) - p.forward * double(nz);
    light_point(item.material, lights, Vec3f(normalize(n)), Vec3f(-p.forward), light, gloss);
  }
  c.alpha *= rgba.w * item.opacity;
  for (int k = 0; k < 3; ++k) c.rgb[k] = rgba[k] * light + gloss;
  if (item.contrast != PreparedItem::Contrast::none && under[3] >= 1) stand_out(item.contrast, under, c.rgb);
}

}  // namespace sg::raster

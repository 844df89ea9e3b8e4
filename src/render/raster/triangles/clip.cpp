// SPDX-License-Identifier: Apache-2.0
// Clipping against the near plane and the guard band (Sutherland & Hodgman 1974), and what is said once per triangle.
#include <algorithm>
#include <cmath>

#include "render/raster/triangles/kernels.h"

namespace sg::raster {

namespace {

struct Vertex {
  double x, y, z;
};

bool to_screen(const EyeView& v, float ex, float ey, float z, ScreenPoint& out) {
  const float w = v.parallel ? z : 1.0f / z;
  const float sx = v.parallel ? ex : ex * w, sy = v.parallel ? ey : ey * w;
  const float px = v.center_x + sx * v.scale, py = v.center_y - sy * v.scale;
  if (!(std::abs(px) < 2 * guard_band && std::abs(py) < 2 * guard_band)) return false;
  out = {int32_t(std::nearbyint(px * float(subpixels))), int32_t(std::nearbyint(py * float(subpixels))), w};
  return true;
}

/// Half space a*x + b*y + c*z + d >= 0 of eye space.
struct HalfSpace {
  double a, b, c, d;
  double operator()(const Vertex& v) const { return a * v.x + b * v.y + c * v.z + d; }
};

int clip(const HalfSpace& h, const Vertex* in, int n, Vertex* out) {
  int m = 0;
  for (int i = 0; i < n; ++i) {
    const Vertex &p = in[i], &q = in[i + 1 < n ? i + 1 : 0];
    const double dp = h(p), dq = h(q);
    if (dp >= 0) out[m++] = p;
    if ((dp >= 0) == (dq >= 0)) continue;
    // From the inner to the outer vertex, so that both triangles of an edge find the same point.
    const Vertex &s = dp >= 0 ? p : q, &e = dp >= 0 ? q : p;
    const double ds = dp >= 0 ? dp : dq, de = dp >= 0 ? dq : dp, t = ds / (ds - de);
    out[m++] = {s.x + t * (e.x - s.x), s.y + t * (e.y - s.y), s.z + t * (e.z - s.z)};
  }
  return m;
}

}  // namespace

void clip_triangle(const EyeView& v, const float* a, const float* b, const float* c, uint32_t primitive, std::vector<TriangleRecord>& out) {
  Vertex one[16], two[16];
  int n = 3;
  const float* points[3] = {a, b, c};
  for (int k = 0; k < 3; ++k) {
    const EyePoint e = to_eye(v, points[k]);
    if (!std::isfinite(e.x) || !std::isfinite(e.y) || !std::isfinite(e.z)) return;
    one[k] = {e.x, e.y, e.z};
  }
  const double s = v.scale, g = guard_band, p = v.parallel ? 0 : g, q = v.parallel ? g : 0;
  const HalfSpace planes[5] = {{0, 0, 1, -double(v.near_plane)}, {s, 0, p, q}, {-s, 0, p, q}, {0, s, p, q}, {0, -s, p, q}};
  Vertex *from = one, *to = two;
  for (const HalfSpace& h : planes) {
    n = clip(h, from, n, to);
    std::swap(from, to);
    if (n < 3) return;
  }
  ScreenPoint screen[16];
  for (int k = 0; k < n; ++k)
    if (!to_screen(v, float(from[k].x), float(from[k].y), std::max(float(from[k].z), v.near_plane), screen[k])) return;
  for (int k = 1; k + 1 < n; ++k) {
    TriangleRecord t;
    const int corner[3] = {0, k, k + 1};
    for (int j = 0; j < 3; ++j) t.x[j] = screen[corner[j]].x, t.y[j] = screen[corner[j]].y, t.w[j] = screen[corner[j]].w;
    t.primitive = primitive;
    if (finish_record(t, v.width, v.height)) out.push_back(t);
  }
}

PixelBox pixel_box(const TriangleRecord& t, int width, int height) {
  constexpr int half = subpixels / 2;
  const int lx = std::min({t.x[0], t.x[1], t.x[2]}), hx = std::max({t.x[0], t.x[1], t.x[2]});
  const int ly = std::min({t.y[0], t.y[1], t.y[2]}), hy = std::max({t.y[0], t.y[1], t.y[2]});
  // The first and last pixel whose centre lies in the box.
  return {std::max((lx + half - 1) >> 8, 0), std::max((ly + half - 1) >> 8, 0), std::min((hx - half) >> 8, width - 1),
          std::min((hy - half) >> 8, height - 1)};
}

bool finish_record(TriangleRecord& t, int width, int height) {
  const int64_t area = (int64_t(t.x[1]) - t.x[0]) * (int64_t(t.y[2]) - t.y[0]) - (int64_t(t.y[1]) - t.y[0]) * (int64_t(t.x[2]) - t.x[0]);
  if (area == 0 || pixel_box(t, width, height).empty()) return false;
  if (area < 0) std::swap(t.x[1], t.x[2]), std::swap(t.y[1], t.y[2]), std::swap(t.w[1], t.w[2]);
  return true;
}

WPlane w_plane(const TriangleRecord& t) {
  const double dx1 = (double(t.x[1]) - t.x[0]) / subpixels, dy1 = (double(t.y[1]) - t.y[0]) / subpixels;
  const double dx2 = (double(t.x[2]) - t.x[0]) / subpixels, dy2 = (double(t.y[2]) - t.y[0]) / subpixels;
  const double area = dx1 * dy2 - dy1 * dx2, dw1 = double(t.w[1]) - t.w[0], dw2 = double(t.w[2]) - t.w[0];
  WPlane p;
  p.gx = (dw1 * dy2 - dw2 * dy1) / area, p.gy = (dw2 * dx1 - dw1 * dx2) / area;
  p.at = t.w[0], p.x = double(t.x[0]) / subpixels, p.y = double(t.y[0]) / subpixels;
  p.lo = std::min({t.w[0], t.w[1], t.w[2]}), p.hi = std::max({t.w[0], t.w[1], t.w[2]});
  return p;
}

}  // namespace sg::raster

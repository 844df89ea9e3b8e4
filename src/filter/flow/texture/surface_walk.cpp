// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/surface_walk.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace sg {

namespace {

constexpr int most_idle = 64;  ///< triangles passed without going anywhere, around a point

/// Length to where the first coordinate becomes zero, and which; a coordinate that hardly changes does not.
inline double way_out(const std::array<double, 3>& b, const std::array<double, 3>& d, int& edge) {
  const double still = 1e-10 * std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])});
  double over = HUGE_VAL, under = 1;  // the least of b / -d as a fraction: one division instead of three
  edge = -1;
  for (int k = 0; k < 3; ++k) {
    const double rate = -d[size_t(k)], left = std::max(b[size_t(k)], 0.0);
    if (rate > still && left * under < over * rate) over = left, under = rate, edge = k;
  }
  return over / under;
}

void go(std::array<double, 3>& b, const std::array<double, 3>& d, double s) {
  double sum = 0;
  for (size_t k = 0; k < 3; ++k) b[k] = std::max(b[k] + d[k] * s, 0.0), sum += b[k];
  for (double& k : b) k /= sum;
}

}  // namespace

SurfaceWalk::SurfaceWalk(const RefinedSurface& surface, std::span<const Vec3> vectors, bool per_triangle)
    : surface_(surface), frames_(surface.triangles.size()) {
  parallel_for(frames_.size(), 1 << 13, [&](size_t begin, size_t end) {
    for (size_t t = begin; t < end; ++t) frames_[t] = frame(t, vectors, per_triangle);
  });
}

SurfaceWalk::Frame SurfaceWalk::frame(size_t triangle, std::span<const Vec3> vectors, bool per_triangle) const {
  const auto& t = surface_.triangles[triangle];
  const Vec3 e1 = surface_.points[t[1]] - surface_.points[t[0]], e2 = surface_.points[t[2]] - surface_.points[t[0]];
  Frame f;
  f.a = dot(e1, e1), f.b = dot(e1, e2), f.c = dot(e2, e2), f.least2 = 0;
  const double inverse = 1 / (f.a * f.c - f.b * f.b);
  for (size_t k = 0; k < 3; ++k) {
    const Vec3 v = vectors[per_triangle ? triangle : t[k]];
    const double x = dot(v, e1), y = dot(v, e2);
    f.u[k] = (f.c * x - f.b * y) * inverse, f.w[k] = (f.a * y - f.b * x) * inverse;
    f.least2 = std::max(f.least2, 1e-18 * dot(v, v));
  }
  return f;
}

SurfaceWalk::Along SurfaceWalk::along(const Frame& f, const std::array<double, 3>& b) {
  const double u = f.u[0] * b[0] + f.u[1] * b[1] + f.u[2] * b[2], w = f.w[0] * b[0] + f.w[1] * b[1] + f.w[2] * b[2];
  return {u, w, u * u * f.a + 2 * u * w * f.b + w * w * f.c};
}

bool SurfaceWalk::rates(const Frame& f, const std::array<double, 3>& b, double sign, Rates& d) {
  const Along v = along(f, b);
  if (!(v.length2 > f.least2) || !(v.length2 < HUGE_VAL)) return false;
  const double scale = sign / std::sqrt(v.length2);
  d = {-(v.u + v.w) * scale, v.u * scale, v.w * scale};
  return true;
}

bool SurfaceWalk::slide(const Frame& f, const Place& at, int corner, double sign, Rates& d) {
  constexpr double place[3][2] = {{0, 0}, {1, 0}, {0, 1}};  // corners by e1 and e2
  const size_t j = size_t((corner + 1) % 3), k = size_t((corner + 2) % 3);
  const double du = place[k][0] - place[j][0], dw = place[k][1] - place[j][1];
  const Along v = along(f, at.b);
  const double product = sign * (v.u * du * f.a + (v.u * dw + v.w * du) * f.b + v.w * dw * f.c);
  const double size = std::sqrt(du * du * f.a + 2 * du * dw * f.b + dw * dw * f.c);
  if (!(std::abs(product) > 1e-6 * size * std::sqrt(v.length2))) return false;
  d = {0, 0, 0};
  d[k] = (product > 0 ? 1 : -1) / size, d[j] = -d[k];
  return true;
}

bool SurfaceWalk::cross(Place& at, int edge) const {
  const int32_t next = surface_.across[at.triangle][size_t(edge)];
  if (next < 0) return false;
  const auto &t = surface_.triangles[at.triangle], &n = surface_.triangles[size_t(next)];
  Place to;
  to.triangle = uint32_t(next);
  for (size_t k = 0; k < 3; ++k) {
    const size_t same = n[k] == t[size_t((edge + 1) % 3)]   ? size_t((edge + 1) % 3)
                        : n[k] == t[size_t((edge + 2) % 3)] ? size_t((edge + 2) % 3)
                                                            : 3;
    to.b[k] = same < 3 ? at.b[same] : 0;
    if (same == 3) to.from = int(k);
  }
  at = to;
  return true;
}

SurfaceWalk::Place SurfaceWalk::start(uint32_t triangle, uint32_t point) const {
  Place p;
  p.triangle = triangle;
  for (size_t k = 0; k < 3; ++k) p.b[k] = surface_.triangles[triangle][k] == point;
  return p;
}

Vec3 SurfaceWalk::position(const Place& at) const {
  const auto& t = surface_.triangles[at.triangle];
  return surface_.points[t[0]] * at.b[0] + surface_.points[t[1]] * at.b[1] + surface_.points[t[2]] * at.b[2];
}

bool SurfaceWalk::advance(Place& at, double length, double sign) const {
  const double nothing = 1e-12 * length;
  int idle = 0;
  while (length > nothing) {
    const Frame& f = frames_[at.triangle];
    Rates d, middle;
    if (!rates(f, at.b, sign, d)) return false;
    int edge;
    double s = std::min(way_out(at.b, d, edge), length);
    if (s <= nothing && edge == at.from && edge >= 0) {  // both sides run into the edge
      if (!slide(f, at, edge, sign, d)) return false;
      s = std::min(way_out(at.b, d, edge), length);
    } else if (s > nothing) {  // midpoint rule
      std::array<double, 3> half = at.b;
      go(half, d, 0.5 * s);
      if (rates(f, half, sign, middle)) d = middle, s = std::min(way_out(at.b, d, edge), length);
    }
    if (s > nothing) go(at.b, d, s), length -= s, idle = 0, at.from = -1;
    if (!(length > nothing)) return true;
    if (edge < 0 || ++idle > most_idle) return false;
    at.b[size_t(edge)] = 0;
    if (!cross(at, edge)) return false;
  }
  return true;
}

}  // namespace sg

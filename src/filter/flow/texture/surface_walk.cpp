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

constexpr double corner_places[3][2] = {{0, 0}, {1, 0}, {0, 1}};  ///< by e1 and e2

double product(const SurfaceFrame& f, const double (&x)[2], const double (&y)[2]) {
  return x[0] * y[0] * f.a + (x[0] * y[1] + x[1] * y[0]) * f.b + x[1] * y[1] * f.c;
}

void go(std::array<double, 3>& b, const std::array<double, 3>& d, double s) {
  double sum = 0;
  for (size_t k = 0; k < 3; ++k) b[k] = std::max(b[k] + d[k] * s, 0.0), sum += b[k];
  for (double& k : b) k /= sum;
}

}  // namespace

template <class D>
SurfaceWalker<D>::SurfaceWalker(const RefinedSurface& surface, std::span<const typename D::Value> values, bool per_triangle)
    : surface_(surface), frames_(surface.triangles.size()) {
  parallel_for(frames_.size(), 1 << 13, [&](size_t begin, size_t end) {
    for (size_t t = begin; t < end; ++t) frames_[t] = frame(t, values, per_triangle);
  });
}

template <class D>
typename D::Frame SurfaceWalker<D>::frame(size_t triangle, std::span<const typename D::Value> values, bool per_triangle) const {
  const auto& t = surface_.triangles[triangle];
  const Vec3 e1 = surface_.points[t[1]] - surface_.points[t[0]], e2 = surface_.points[t[2]] - surface_.points[t[0]];
  Frame f;
  f.a = dot(e1, e1), f.b = dot(e1, e2), f.c = dot(e2, e2);
  std::array<typename D::Value, 3> corners;
  for (size_t k = 0; k < 3; ++k) corners[k] = values[per_triangle ? triangle : t[k]];
  D::set(f, corners, e1, e2);
  return f;
}

template <class D>
bool SurfaceWalker<D>::rates(const Frame& f, const std::array<double, 3>& b, const double (&ahead)[2], double sign, Rates& d) {
  SurfaceDirection v;
  if (!D::at(f, b, v)) return false;
  if constexpr (!D::has_sign)
    if (ahead[0] != 0 || ahead[1] != 0) sign = product(f, {v.u, v.w}, ahead) < 0 ? -1 : 1;
  const double scale = sign / std::sqrt(v.length2);
  d = {-(v.u + v.w) * scale, v.u * scale, v.w * scale};
  return true;
}

template <class D>
bool SurfaceWalker<D>::slide(const Frame& f, int corner, Rates& d) {
  const size_t j = size_t((corner + 1) % 3), k = size_t((corner + 2) % 3);
  const double e[2] = {corner_places[k][0] - corner_places[j][0], corner_places[k][1] - corner_places[j][1]};
  const double along = product(f, {d[1], d[2]}, e), size = std::sqrt(product(f, e, e));
  if (!(std::abs(along) > 1e-6 * size)) return false;
  d = {0, 0, 0};
  d[k] = (along > 0 ? 1 : -1) / size, d[j] = -d[k];
  return true;
}

template <class D>
void SurfaceWalker<D>::unfold(const Frame& f, const Frame& g, const size_t (&ends)[2][2], double (&ahead)[2]) {
  const auto from = [](size_t j, size_t k, double(&e)[2]) {
    e[0] = corner_places[k][0] - corner_places[j][0], e[1] = corner_places[k][1] - corner_places[j][1];
  };
  double e[2], in[2];
  from(ends[0][0], ends[0][1], e);
  const double along = product(f, ahead, e) / product(f, e, e);
  const double across2 = product(f, ahead, ahead) - along * along * product(f, e, e);  // outwards
  from(ends[1][0], ends[1][1], e);
  from(ends[1][0], 3 - ends[1][0] - ends[1][1], in);
  const double lean = product(g, in, e) / product(g, e, e);
  for (int c = 0; c < 2; ++c) in[c] -= lean * e[c];
  const double across = std::sqrt(std::max(across2, 0.0) / product(g, in, in));
  for (int c = 0; c < 2; ++c) ahead[c] = along * e[c] + across * in[c];
}

template <class D>
bool SurfaceWalker<D>::cross(Place& at, int edge) const {
  const int32_t next = surface_.across[at.triangle][size_t(edge)];
  if (next < 0) return false;
  const auto &t = surface_.triangles[at.triangle], &n = surface_.triangles[size_t(next)];
  Place to;
  to.triangle = uint32_t(next);
  const size_t first = size_t((edge + 1) % 3), second = size_t((edge + 2) % 3);
  size_t ends[2][2] = {{first, second}, {0, 1}};
  for (size_t k = 0; k < 3; ++k) {
    const size_t same = n[k] == t[first] ? first : n[k] == t[second] ? second : 3;
    to.b[k] = same < 3 ? at.b[same] : 0;
    if (same == 3) to.from = int(k);
    else ends[1][same == second] = k;
  }
  if constexpr (!D::has_sign) {
    to.ahead[0] = at.ahead[0], to.ahead[1] = at.ahead[1];
    unfold(frames_[at.triangle], frames_[to.triangle], ends, to.ahead);
  }
  at = to;
  return true;
}

template <class D>
typename SurfaceWalker<D>::Place SurfaceWalker<D>::start(uint32_t triangle, uint32_t point) const {
  Place p;
  p.triangle = triangle;
  for (size_t k = 0; k < 3; ++k) p.b[k] = surface_.triangles[triangle][k] == point;
  return p;
}

template <class D>
Vec3 SurfaceWalker<D>::position(const Place& at) const {
  const auto& t = surface_.triangles[at.triangle];
  return surface_.points[t[0]] * at.b[0] + surface_.points[t[1]] * at.b[1] + surface_.points[t[2]] * at.b[2];
}

template <class D>
bool SurfaceWalker<D>::advance(Place& at, double length, double sign) const {
  const double nothing = 1e-12 * length;
  int idle = 0;
  while (length > nothing) {
    const Frame& f = frames_[at.triangle];
    Rates d, middle;
    if (!rates(f, at.b, at.ahead, sign, d)) return false;
    int edge;
    double s = std::min(way_out(at.b, d, edge), length);
    if (s <= nothing && edge == at.from && edge >= 0) {  // both sides run into the edge
      if (!slide(f, edge, d)) return false;
      s = std::min(way_out(at.b, d, edge), length);
    } else if (s > nothing) {  // midpoint rule
      std::array<double, 3> half = at.b;
      go(half, d, 0.5 * s);
      const double ahead[2] = {d[1], d[2]};
      if (rates(f, half, ahead, sign, middle)) d = middle, s = std::min(way_out(at.b, d, edge), length);
    }
    if constexpr (!D::has_sign) at.ahead[0] = d[1], at.ahead[1] = d[2];
    if (s > nothing) go(at.b, d, s), length -= s, idle = 0, at.from = -1;
    if (!(length > nothing)) return true;
    if (edge < 0 || ++idle > most_idle) return false;
    at.b[size_t(edge)] = 0;
    if (!cross(at, edge)) return false;
  }
  return true;
}

template class SurfaceWalker<VectorDirections>;
template class SurfaceWalker<AxisDirections>;

}  // namespace sg

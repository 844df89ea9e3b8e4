// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/surface/surface_walk.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace sg {

namespace {

constexpr int most_idle = 64;       ///< triangles passed without going anywhere, around a point
constexpr int most_passed = 20000;  ///< triangles of one step, as where slivers lead around a point

// Which of three edges a line meets first, by what is so in bits: 1, 2, 4: it goes towards edge 0, 1, 2; 8: 1 comes before 0, 16: 2 before
// 0, 32: 2 before 1. 3: none. A table, because the edge is unpredictable and a branch misprediction costs more than all the rest.
constexpr std::array<uint8_t, 64> first_edges = [] {
  std::array<uint8_t, 64> t{};
  for (unsigned bits = 0; bits < 64; ++bits) {
    unsigned first = bits & 1 ? 0 : 3;
    if ((bits & 2) && (first == 3 || (bits & 8))) first = 1;
    if ((bits & 4) && (first == 3 || (bits & (first == 0 ? 16 : 32)))) first = 2;
    t[bits] = uint8_t(first);
  }
  return t;
}();

/// How far, in units of d, to where the first coordinate becomes zero, and which; a coordinate that hardly changes does not.
inline double way_out(const std::array<double, 3>& b, const std::array<double, 3>& d, int& edge) {
  const double still = -1e-10 * (std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]));
  const unsigned bits = unsigned(d[0] < still) | unsigned(d[1] < still) << 1 | unsigned(d[2] < still) << 2 |
                        unsigned(b[1] * d[0] > b[0] * d[1]) << 3 | unsigned(b[2] * d[0] > b[0] * d[2]) << 4 |
                        unsigned(b[2] * d[1] > b[1] * d[2]) << 5;
  const size_t first = first_edges[bits];
  const double over[4] = {b[0], b[1], b[2], HUGE_VAL}, under[4] = {-d[0], -d[1], -d[2], 1};
  edge = first < 3 ? int(first) : -1;
  return over[first] / under[first];
}

double positive(double x) { return 0.5 * (x + std::abs(x)); }  // or 0, without a branch

constexpr uint32_t no_link = UINT32_MAX;
constexpr size_t after[3] = {1, 2, 0}, before[3] = {2, 0, 1};
constexpr double corner_places[3][2] = {{0, 0}, {1, 0}, {0, 1}};  ///< by e1 and e2

double product(const SurfaceFrame& f, const double (&x)[2], const double (&y)[2]) {
  return x[0] * y[0] * f.a + (x[0] * y[1] + x[1] * y[0]) * f.b + x[1] * y[1] * f.c;
}

void go(std::array<double, 3>& b, const std::array<double, 3>& d, double s) {
  for (size_t k = 0; k < 3; ++k) b[k] = positive(b[k] + d[k] * s);
  const double whole = 2 - (b[0] + b[1] + b[2]);  // one over the sum, which is nearly 1
  for (double& k : b) k *= whole;
}

}  // namespace

template <class D>
SurfaceWalker<D>::SurfaceWalker(const RefinedSurface& surface, std::span<const typename D::Value> values, bool per_triangle, double longest)
    : surface_(surface), longest_(longest), frames_(surface.triangles.size()) {
  parallel_for(frames_.size(), 1 << 13, [&](size_t begin, size_t end) {
    for (size_t t = begin; t < end; ++t) frames_[t] = frame(t, values, per_triangle);
  });
  set_links();
}

template <class D>
void SurfaceWalker<D>::set_links() {
  links_.resize(3 * frames_.size(), no_link);
  parallel_for(frames_.size(), 1 << 13, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for (size_t edge = 0; edge < 3; ++edge) {
        const int32_t next = surface_.across[i][edge];
        if (next < 0) continue;
        const uint32_t first = surface_.triangles[i][after[edge]], second = surface_.triangles[i][before[edge]];
        const auto& n = surface_.triangles[size_t(next)];
        for (uint32_t from = 0; from < 3; ++from) {
          if (n[from] == first || n[from] == second) continue;
          const bool alike = n[after[from]] == second;
          links_[3 * i + edge] = uint32_t(next) << 3 | (alike ? 4u : 0u) | from;
        }
      }
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
inline bool SurfaceWalker<D>::way(const Frame& f, const std::array<double, 3>& b, const double (&ahead)[2], double sign, Rates& d,
                                  double& speed) {
  SurfaceDirection v;
  if (!D::at(f, b, v)) return false;
  if constexpr (!D::has_sign)
    if (ahead[0] != 0 || ahead[1] != 0) sign = product(f, {v.u, v.w}, ahead) < 0 ? -1 : 1;
  d = {-(v.u + v.w) * sign, v.u * sign, v.w * sign};
  speed = std::sqrt(v.length2);
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
  const uint32_t link = links_[3 * size_t(at.triangle) + size_t(edge)];
  if (link == no_link) return false;
  const size_t from = link & 3, first = after[size_t(edge)], second = before[size_t(edge)];
  const bool alike = link & 4;
  const double x = at.b[first], y = at.b[second];
  const uint32_t next = link >> 3;
  if constexpr (!D::has_sign) {
    const size_t ends[2][2] = {{first, second}, {alike ? before[from] : after[from], alike ? after[from] : before[from]}};
    unfold(frames_[at.triangle], frames_[next], ends, at.ahead);
  }
  at.triangle = next, at.from = int(from), at.left = 0;
  at.b[from] = 0, at.b[after[from]] = alike ? y : x, at.b[before[from]] = alike ? x : y;
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
bool SurfaceWalker<D>::aim(Place& at, double sign, double nothing) const {
  const Frame& f = frames_[at.triangle];
  Rates d, middle;
  double speed, faster;
  if (!way(f, at.b, at.ahead, sign, d, speed)) return false;
  int edge;
  double s = way_out(at.b, d, edge);
  if (s * speed <= nothing && edge == at.from && edge >= 0) {  // both sides run into the edge
    const double per_length = 1 / speed;
    for (double& k : d) k *= per_length;
    if (!slide(f, edge, d)) return false;
    speed = 1, s = way_out(at.b, d, edge);
  } else if (s * speed > nothing) {  // midpoint rule
    std::array<double, 3> half;
    const double h = 0.5 * (s * speed <= longest_ ? s : longest_ / speed);
    for (size_t k = 0; k < 3; ++k) half[k] = positive(at.b[k] + d[k] * h);
    const double ahead[2] = {d[1], d[2]};
    if (way(f, half, ahead, sign, middle, faster)) d = middle, speed = faster, s = way_out(at.b, d, edge);
  }
  const double per_length = 1 / speed;
  for (size_t k = 0; k < 3; ++k) at.along[k] = d[k] * per_length;
  at.left = s * speed, at.edge = edge, at.sign = sign;
  if (!(at.left <= longest_)) at.left = longest_, at.edge = -1;
  if constexpr (!D::has_sign) at.ahead[0] = at.along[1], at.ahead[1] = at.along[2];
  return true;
}

template <class D>
bool SurfaceWalker<D>::advance(Place& at, double length, double sign) const {
  const double nothing = 1e-12 * length;
  int idle = 0, passed = 0;
  if (at.sign != sign) at.left = 0;
  while (length > nothing) {
    if (!(at.left > 0) && !aim(at, sign, nothing)) return false;
    const bool whole = at.left <= length;
    const double s = whole ? at.left : length;
    if (s > nothing) go(at.b, at.along, s), length -= s, idle = 0, at.from = -1;
    at.left = whole ? 0 : at.left - s;
    if (!whole || !(length > nothing)) return true;
    if (at.edge < 0 && s > nothing) continue;
    if (at.edge < 0 || ++idle > most_idle || ++passed > most_passed) return false;
    at.b[size_t(at.edge)] = 0;
    if (!cross(at, at.edge)) return false;
  }
  return true;
}

template class SurfaceWalker<VectorDirections>;
template class SurfaceWalker<AxisDirections>;

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "data/cells/shape/mean_value.h"

#include <algorithm>
#include <tuple>

#include "data/cells/cell_topology.h"
#include "data/cells/shape/cell_inverse.h"

namespace sg {

void polygon_weights(std::span<const Vec3> at, Vec3 x, std::span<double> weights) {
  const size_t n = at.size();
  std::fill(weights.begin(), weights.end(), 0.0);
  if (n == 0) return;
  const Vec3 normal = normalize(polygon_vector_area(at));
  auto flat = [&](size_t i) {
    const Vec3 d = at[i % n] - x;
    return d - normal * dot(normal, d);
  };
  double size = 0;
  for (size_t i = 0; i < n; ++i) size = std::max(size, length(flat(i)));
  const double tiny = 1e-12 * size;
  // On a side or a corner: linear there. So are polygons without an area, by their nearest side.
  double best = HUGE_VAL, along = 0;
  size_t side = 0;
  for (size_t i = 0; i < n; ++i) {
    double t;
    const double d = length(nearest_on_segment(flat(i), flat(i + 1), {0, 0, 0}, t));
    if (d < best) best = d, side = i, along = t;
  }
  auto linear = [&] {
    std::fill(weights.begin(), weights.end(), 0.0);
    weights[side] += 1 - along, weights[(side + 1) % n] += along;
  };
  if (!(best > tiny)) return linear();
  // tan(a/2) = sin a / (1 + cos a), both times the two lengths.
  double sum = 0;
  Vec3 d = flat(0);
  for (size_t i = 0; i < n; ++i) {
    const Vec3 e = flat(i + 1);
    const double ld = length(d), le = length(e);
    const double half = dot(cross(d, e), normal) / (ld * le + dot(d, e));
    weights[i] += half / ld, weights[(i + 1) % n] += half / le;
    sum += half / ld + half / le;
    d = e;
  }
  if (!(std::abs(sum) * size > 1e-12)) return linear();
  for (size_t i = 0; i < n; ++i) weights[i] /= sum;
}

int64_t nearest_triangle(std::span<const Vec3> at, std::span<const uint32_t> triangles, Vec3 x, Vec3& nearest, Vec3& l) {
  int64_t found = -1;
  double best = HUGE_VAL;
  for (size_t i = 0; i + 2 < triangles.size(); i += 3) {
    Vec3 bary;
    const Vec3 p = nearest_on_triangle(at[triangles[i]], at[triangles[i + 1]], at[triangles[i + 2]], x, bary);
    const double d2 = dot(p - x, p - x);
    if (d2 < best) best = d2, found = int64_t(i / 3), nearest = p, l = bary;
  }
  return found;
}

double winding_number(std::span<const Vec3> at, std::span<const uint32_t> triangles, Vec3 x) {
  double sum = 0;
  for (size_t i = 0; i + 2 < triangles.size(); i += 3) {
    const Vec3 a = at[triangles[i]] - x, b = at[triangles[i + 1]] - x, c = at[triangles[i + 2]] - x;
    const double la = length(a), lb = length(b), lc = length(c);
    const double volume = dot(a, cross(b, c));
    if (volume != 0)  // in the triangle's plane it is seen edge-on, or from both sides alike
      sum += std::atan2(volume, la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (2 * M_PI);
}

double enclosed_volume(std::span<const Vec3> at, std::span<const uint32_t> triangles) {
  if (at.empty()) return 0;
  double sum = 0;
  const Vec3 o = at[0];
  for (size_t i = 0; i + 2 < triangles.size(); i += 3)
    sum += dot(at[triangles[i]] - o, cross(at[triangles[i + 1]] - o, at[triangles[i + 2]] - o));
  return sum / 6;
}

void solid_weights(std::span<const Vec3> at, std::span<const uint32_t> triangles, Vec3 x, std::span<double> weights) {
  std::fill(weights.begin(), weights.end(), 0.0);
  double size = 0;
  for (Vec3 p : at) size = std::max(size, length(p - x));
  Vec3 near, l;
  const int64_t on = nearest_triangle(at, triangles, x, near, l);
  auto linear = [&] {
    for (int c = 0; c < 3; ++c) weights[triangles[size_t(3 * on + c)]] += l[c];
  };
  if (on < 0) return;
  if (length(near - x) <= 1e-10 * size) return linear();
  // Of each triangle the mean of the unit vectors over its part of the sphere is a combination of its corners' directions:
  // with m = 1/2 sum angle_i n_i, corner i gets n_i.m / (n_i.u_i), n_i the normal of the side opposite to it.
  double sum = 0;
  for (size_t i = 0; i + 2 < triangles.size(); i += 3) {
    Vec3 d[3], u[3], n[3];
    double r[3], angle[3];
    for (size_t c = 0; c < 3; ++c) d[c] = at[triangles[i + c]] - x, r[c] = length(d[c]), u[c] = d[c] / r[c];
    if (std::abs(dot(u[0], cross(u[1], u[2]))) < 1e-13) continue;  // seen edge-on: no part of the sphere
    Vec3 m;
    for (size_t c = 0; c < 3; ++c) {
      const Vec3 a = u[(c + 1) % 3], b = u[(c + 2) % 3], across = cross(a, b);
      const double s = length(across);
      angle[c] = std::atan2(s, dot(a, b));
      n[c] = across / s;
      m += n[c] * (angle[c] / 2);
    }
    for (size_t c = 0; c < 3; ++c) {
      const double w = dot(n[c], m) / (dot(n[c], u[c]) * r[c]);
      weights[triangles[i + c]] += w;
      sum += w;
    }
  }
  if (!(std::abs(sum) > 1e-12 / size)) {
    std::fill(weights.begin(), weights.end(), 0.0);
    return linear();
  }
  for (double& w : weights) w /= sum;
}

void orient_outward(std::span<const Vec3> at, std::vector<uint32_t>& triangles, std::span<const uint32_t> face) {
  struct Side {
    uint32_t a, b, face;
    bool forward;
  };
  std::vector<Side> sides;
  uint32_t faces = 0;
  for (size_t i = 0; i + 2 < triangles.size(); i += 3) {
    faces = std::max(faces, face[i / 3] + 1);
    for (size_t c = 0; c < 3; ++c) {
      const uint32_t a = triangles[i + c], b = triangles[i + (c + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), face[i / 3], a < b});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& p, const Side& q) { return std::tie(p.a, p.b, p.face, p.forward) < std::tie(q.a, q.b, q.face, q.forward); });
  // Neighbours across sides that exactly two faces share; `same` = both run along it the same way, so one must turn.
  struct Link {
    uint32_t to;
    bool same;
  };
  std::vector<std::vector<Link>> links(faces);
  bool consistent = true;
  for (size_t i = 0; i < sides.size();) {
    size_t end = i + 1;
    while (end < sides.size() && sides[end].a == sides[i].a && sides[end].b == sides[i].b) ++end;
    if (end - i == 2 && sides[i].face != sides[i + 1].face) {
      const bool same = sides[i].forward == sides[i + 1].forward;
      links[sides[i].face].push_back({sides[i + 1].face, same}), links[sides[i + 1].face].push_back({sides[i].face, same});
      consistent = consistent && !same;
    }
    i = end;
  }
  std::vector<int8_t> turn(faces, consistent ? 0 : -1);
  for (uint32_t first = 0; first < faces && !consistent; ++first) {
    if (turn[first] >= 0) continue;
    std::vector<uint32_t> stack{first};
    turn[first] = 0;
    while (!stack.empty()) {
      const uint32_t f = stack.back();
      stack.pop_back();
      for (Link l : links[f])
        if (turn[l.to] < 0) turn[l.to] = int8_t(turn[f] ^ int8_t(l.same)), stack.push_back(l.to);
    }
  }
  auto flip = [&](size_t t) { std::swap(triangles[3 * t + 1], triangles[3 * t + 2]); };
  for (size_t t = 0; t < triangles.size() / 3; ++t)
    if (turn[face[t]] == 1) flip(t);
  if (enclosed_volume(at, triangles) < 0)
    for (size_t t = 0; t < triangles.size() / 3; ++t) flip(t);
}

}  // namespace sg

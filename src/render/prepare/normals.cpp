// SPDX-License-Identifier: Apache-2.0
// Smooth normals: the angle-weighted mean of the faces around a point (Thuermer & Wuethrich 1998), split where faces meet sharply.
#include <cmath>

#include "base/parallel.h"
#include "render/prepare/prepared.h"

namespace sg::raster {

namespace {

constexpr size_t triangles_per_chunk = 1 << 13;

Vec3f position(const float* xyz, uint32_t i) { return {xyz[3 * size_t(i)], xyz[3 * size_t(i) + 1], xyz[3 * size_t(i) + 2]}; }

/// Corner numbers (3 * triangle + k) around each point, ascending.
struct Around {
  std::vector<uint32_t> start, corner;
};

Around corners_around(const uint32_t* t, size_t triangles, size_t points) {
  Around a;
  a.start.assign(points + 1, 0);
  a.corner.resize(3 * triangles);
  for (size_t i = 0; i < 3 * triangles; ++i) ++a.start[t[i] + 1];
  for (size_t p = 0; p < points; ++p) a.start[p + 1] += a.start[p];
  std::vector<uint32_t> next(a.start.begin(), a.start.end() - 1);
  for (size_t i = 0; i < 3 * triangles; ++i) a.corner[next[t[i]]++] = uint32_t(i);
  return a;
}

/// Unit normals of the triangles, zero of those without an area, and the angle of each corner.
struct Faces {
  std::vector<Vec3f> normal;
  std::vector<float> angle;
};

Faces faces_of(const TriangleSet& set) {
  const uint32_t* t = set.indices();
  const float* xyz = set.xyz();
  Faces f{std::vector<Vec3f>(set.count), std::vector<float>(3 * set.count)};
  parallel_for(set.count, triangles_per_chunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3f p[3] = {position(xyz, t[3 * i]), position(xyz, t[3 * i + 1]), position(xyz, t[3 * i + 2])};
      const Vec3f c = cross(p[1] - p[0], p[2] - p[0]);
      const float l = length(c);
      const bool good = l > 0 && std::isfinite(l);
      f.normal[i] = good ? c / l : Vec3f();
      for (int k = 0; k < 3; ++k) {
        const Vec3f u = p[(k + 1) % 3] - p[k], v = p[(k + 2) % 3] - p[k];
        f.angle[3 * i + size_t(k)] = good ? std::atan2(length(cross(u, v)), dot(u, v)) : 0.0f;
      }
    }
  });
  return f;
}

}  // namespace

NormalSet smooth_normals(const TriangleSet& set, double feature_angle, const TriangleSet* whole) {
  NormalSet out;
  const TriangleSet& all = whole ? *whole : set;
  const size_t n = set.count, points = set.positions.count();
  if (n == 0 || 3 * all.count >= (size_t(1) << 32)) return out;
  const uint32_t* t = set.indices();
  const Faces faces = faces_of(all), parts = whole ? faces_of(set) : Faces();
  const std::vector<Vec3f>&face = faces.normal, &own_face = whole ? parts.normal : face;
  const std::vector<float>& weight = faces.angle;
  const Around around = corners_around(all.indices(), all.count, points), part = whole ? corners_around(t, n, points) : Around();
  const Around& own = whole ? part : around;
  const float limit = float(std::cos(feature_angle * 3.14159265358979323846 / 180));

  // A point is split when two of its faces differ by more than the angle from its mean normal's side of the fan.
  std::vector<Vec3f> mean(points);
  std::vector<uint8_t> split(points);
  parallel_for(points, triangles_per_chunk, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      Vec3f sum;
      const uint32_t from = around.start[p], to = around.start[p + 1];
      for (uint32_t k = from; k < to; ++k) sum += face[around.corner[k] / 3] * weight[around.corner[k]];
      mean[p] = normalize(sum);
      for (uint32_t a = from; a < to && !split[p]; ++a)
        for (uint32_t b = a + 1; b < to && b < a + 64; ++b)
          if (weight[around.corner[a]] > 0 && weight[around.corner[b]] > 0 &&
              dot(face[around.corner[a] / 3], face[around.corner[b] / 3]) < limit) {
            split[p] = 1;
            break;
          }
    }
  });
  std::vector<size_t> extra(points);
  for (size_t p = 0; p < points; ++p) extra[p] = split[p] ? own.start[p + 1] - own.start[p] : 0;
  const size_t more = exclusive_scan(extra);
  float* normals = nullptr;
  out.normals = Array::make<float>(points + more, 3, &normals);
  uint32_t* corners = nullptr;
  if (more) {
    out.corners = Array::make<uint32_t>(n, 3, &corners);
    std::copy(t, t + 3 * n, corners);
  }
  auto put = [&](size_t at, Vec3f v) { normals[3 * at] = v.x, normals[3 * at + 1] = v.y, normals[3 * at + 2] = v.z; };
  parallel_for(points, triangles_per_chunk, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      put(p, mean[p]);
      if (!split[p]) continue;
      for (uint32_t a = own.start[p]; a < own.start[p + 1]; ++a) {  // each corner takes the faces that meet its own smoothly
        const Vec3f direction = own_face[own.corner[a] / 3];
        Vec3f sum;
        for (uint32_t b = around.start[p]; b < around.start[p + 1]; ++b) {
          const Vec3f other = face[around.corner[b] / 3];
          if (dot(direction, other) >= limit) sum += other * weight[around.corner[b]];
        }
        const size_t at = points + extra[p] + (a - own.start[p]);
        put(at, dot(sum, sum) > 0 ? normalize(sum) : direction);
        corners[own.corner[a]] = uint32_t(at);
      }
    }
  });
  return out;
}

}  // namespace sg::raster

// SPDX-License-Identifier: Apache-2.0
#include "pipeline/offline/pack/flat_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <unordered_map>

#include "base/parallel.h"

namespace sg::offline {

namespace {

constexpr uint32_t unused = 0xFFFFFFFFu;

void add_normal(const float* from, float* to) {
  for (int c = 0; c < 3; ++c) to[c] += from[c];
}

}  // namespace

FlatColors flat_colors(const raster::ColorSource& source, const std::vector<uint32_t>& numbers) {
  using Kind = raster::ColorSource::Kind;
  FlatColors out;
  out.per_cell = source.per_cell;
  if (source.kind == Kind::scalar) {
    out.positions.resize(numbers.size());
    parallel_for(numbers.size(), 1 << 14, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) out.positions[i] = source.scale->position(double(source.data()[numbers[i]]) + source.offset);
    });
  } else if (source.kind == Kind::direct) {
    out.rgba.resize(4 * numbers.size());
    for (size_t i = 0; i < numbers.size(); ++i) std::copy_n(source.data() + 4 * size_t(numbers[i]), 4, &out.rgba[4 * i]);
  }
  return out;
}

FlatSurface flat_surface(const raster::PreparedItem& item) {
  const raster::TriangleSet& set = item.triangles;
  const float* xyz = set.xyz();
  const auto finite = [&](uint32_t p) {
    return std::isfinite(xyz[3 * size_t(p)]) && std::isfinite(xyz[3 * size_t(p) + 1]) && std::isfinite(xyz[3 * size_t(p) + 2]);
  };
  FlatSurface out;
  std::vector<uint32_t> place(set.positions.count(), unused), points, cells, kept;
  for (size_t t = 0; t < set.count; ++t) {
    const uint32_t* c = set.indices() + 3 * t;
    if (!finite(c[0]) || !finite(c[1]) || !finite(c[2]) || c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
    kept.push_back(uint32_t(t));
    for (int k = 0; k < 3; ++k) place[c[k]] = 0;
  }
  for (size_t p = 0; p < place.size(); ++p)  // in their own order, in which neighbours are near each other
    if (place[p] != unused) place[p] = uint32_t(points.size()), points.push_back(uint32_t(p));
  for (const uint32_t t : kept)
    for (int k = 0; k < 3; ++k) out.triangles.push_back(place[set.indices()[3 * size_t(t) + size_t(k)]]);
  out.xyz.resize(3 * points.size());
  for (size_t i = 0; i < points.size(); ++i) std::copy_n(xyz + 3 * size_t(points[i]), 3, &out.xyz[3 * i]);

  if (const Array& normals = item.normals.normals; !normals.empty()) {
    const auto* from = reinterpret_cast<const float*>(normals.raw());
    if (item.normals.corners.empty()) {
      out.normals.resize(3 * points.size());
      for (size_t i = 0; i < points.size(); ++i) std::copy_n(from + 3 * size_t(points[i]), 3, &out.normals[3 * i]);
    } else {
      const auto* numbers = reinterpret_cast<const uint32_t*>(item.normals.corners.raw());
      std::vector<uint32_t> normal_place(normals.count(), unused);
      for (const uint32_t t : kept)
        for (size_t k = 0; k < 3; ++k) {
          const uint32_t n = numbers[3 * size_t(t) + k];
          if (normal_place[n] == unused) {
            normal_place[n] = uint32_t(out.normals.size() / 3);
            out.normals.insert(out.normals.end(), from + 3 * size_t(n), from + 3 * size_t(n) + 3);
          }
          out.corners.push_back(normal_place[n]);
        }
    }
  }
  if (item.color.per_cell)
    for (const uint32_t t : kept) cells.push_back(set.cell(t));
  out.colors = flat_colors(item.color, item.color.per_cell ? cells : points);
  return out;
}

std::vector<uint32_t> clusters_of(const std::vector<float>& xyz, int parts, size_t& count) {
  const size_t n = xyz.size() / 3;
  Box3 box;
  for (size_t i = 0; i < n; ++i) box.add(Vec3{xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]});
  std::vector<uint32_t> cluster(n);
  count = 0;
  if (n == 0) return cluster;
  const double longest = std::max({box.size().x, box.size().y, box.size().z}), per = longest > 0 ? parts / longest : 0;
  std::unordered_map<uint64_t, uint32_t> numbers;
  for (size_t i = 0; i < n; ++i) {
    uint64_t key = 0;
    for (int a = 0; a < 3; ++a) key = key << 21 | uint64_t(std::min(double(parts - 1), (double(xyz[3 * i + size_t(a)]) - box.lo[a]) * per));
    cluster[i] = numbers.try_emplace(key, uint32_t(numbers.size())).first->second;
  }
  count = numbers.size();
  return cluster;
}

FlatSurface clustered(const FlatSurface& in, int parts, bool labels) {
  size_t n = 0;
  const std::vector<uint32_t> cluster = clusters_of(in.xyz, parts, n);
  FlatSurface out;
  std::vector<double> place(3 * n), position(in.colors.positions.empty() || in.colors.per_cell ? 0 : n);
  std::vector<uint32_t> members(n), valued(n);
  for (size_t i = 0; i < in.points(); ++i) {
    const uint32_t c = cluster[i];
    ++members[c];
    for (size_t a = 0; a < 3; ++a) place[3 * size_t(c) + a] += in.xyz[3 * i + a];
    if (position.empty()) continue;
    const double t = in.colors.positions[i];
    if (t != t || (labels && valued[c])) continue;
    position[c] += t, ++valued[c];
  }
  out.xyz.resize(3 * n);
  for (size_t i = 0; i < 3 * n; ++i) out.xyz[i] = float(place[i] / members[i / 3]);
  for (size_t c = 0; c < position.size(); ++c) out.colors.positions.push_back(valued[c] ? position[c] / valued[c] : NAN);
  out.colors.per_cell = in.colors.per_cell;
  if (!in.colors.rgba.empty() && !in.colors.per_cell) {
    out.colors.rgba.resize(4 * n);
    for (size_t i = 0; i < in.points(); ++i)
      for (size_t k = 0; k < 4; ++k) out.colors.rgba[4 * size_t(cluster[i]) + k] += in.colors.rgba[4 * i + k] / float(members[cluster[i]]);
  }
  if (!in.normals.empty()) out.normals.resize(3 * n);
  std::set<std::array<uint32_t, 3>> there;
  for (size_t t = 0; 3 * t < in.triangles.size(); ++t) {
    std::array<uint32_t, 3> c;
    for (size_t k = 0; k < 3; ++k) {
      c[k] = cluster[in.triangles[3 * t + k]];
      if (in.normals.empty()) continue;
      const uint32_t normal = in.corners.empty() ? in.triangles[3 * t + k] : in.corners[3 * t + k];
      add_normal(&in.normals[3 * size_t(normal)], &out.normals[3 * size_t(c[k])]);
    }
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
    std::array<uint32_t, 3> turned = c;  // what turns the other way round is another side
    std::rotate(turned.begin(), std::min_element(turned.begin(), turned.end()), turned.end());
    if (!there.insert(turned).second) continue;
    out.triangles.insert(out.triangles.end(), c.begin(), c.end());
    if (!in.colors.per_cell) continue;
    if (!in.colors.positions.empty()) out.colors.positions.push_back(in.colors.positions[t]);
    if (!in.colors.rgba.empty()) out.colors.rgba.insert(out.colors.rgba.end(), &in.colors.rgba[4 * t], &in.colors.rgba[4 * t] + 4);
  }
  for (size_t c = 0; c < out.normals.size() / 3; ++c) {
    float* v = &out.normals[3 * c];
    const Vec3f unit = normalize(Vec3f{v[0], v[1], v[2]});
    v[0] = unit.x, v[1] = unit.y, v[2] = unit.z;
  }
  return out;
}

}  // namespace sg::offline

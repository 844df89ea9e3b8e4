// SPDX-License-Identifier: Apache-2.0
// Lines and points.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "pipeline/offline/pack/flat_surface.h"
#include "pipeline/offline/pack/json_text.h"
#include "pipeline/offline/pack/pack_items.h"
#include "pipeline/offline/pack/quantize.h"

namespace sg::offline {

namespace {

constexpr uint32_t not_used = 0xFFFFFFFFu;

struct FlatLines {
  std::vector<uint32_t> ends;   // two points a segment
  std::vector<uint32_t> cells;  // of the segments, where colours are those of cells
  std::vector<float> room;
};

// Every `stride`-th point along a polyline, and its last.
FlatLines thinned(const FlatLines& in, size_t stride) {
  FlatLines out;
  const size_t n = in.ends.size() / 2;
  for (size_t i = 0; i < n;) {
    size_t last = i;
    while (last + 1 < n && last + 1 < i + stride && in.ends[2 * last + 1] == in.ends[2 * last + 2] &&
           (in.cells.empty() || in.cells[last] == in.cells[last + 1]))
      ++last;
    out.ends.push_back(in.ends[2 * i]), out.ends.push_back(in.ends[2 * last + 1]);
    if (!in.cells.empty()) out.cells.push_back(in.cells[i]);
    if (!in.room.empty()) out.room.push_back(in.room[i]);
    i = last + 1;
  }
  return out;
}

const float* xyz_of(const raster::PreparedItem& item) { return reinterpret_cast<const float*>(item.positions.raw()); }

bool is_finite(const float* p) { return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]); }

std::string_view word_of_contrast(raster::PreparedItem::Contrast c) {
  using enum raster::PreparedItem::Contrast;
  return c == darker ? "darker" : c == lighter ? "lighter" : "none";
}

size_t one_of(double share) { return std::max<size_t>(1, size_t(std::lround(1 / share))); }

}  // namespace

Json pack_lines(const raster::PreparedItem& item, const Packing& p) {
  const raster::SegmentSet& set = *item.segments;
  const float* xyz = xyz_of(item);
  FlatLines lines;
  for (size_t i = 0; i < set.count(); ++i) {
    const uint32_t a = set.points[2 * i], b = set.points[2 * i + 1];
    if (!is_finite(xyz + 3 * size_t(a)) || !is_finite(xyz + 3 * size_t(b))) continue;
    lines.ends.push_back(a), lines.ends.push_back(b);
    if (item.color.per_cell) lines.cells.push_back(set.cells[i]);
    if (!set.room.empty()) lines.room.push_back(set.room[i]);
  }
  if (lines.ends.empty()) return {};
  const Quality& q = p.quality(lines.ends.size() * 12);
  if (q.marks < 1 && lines.room.empty()) {
    const size_t before = lines.ends.size() / 2;
    lines = thinned(lines, one_of(q.marks));
    if (const size_t after = lines.ends.size() / 2; after < before) p.note(fmt::format("lines of {} segments have {}", before, after));
  }
  std::vector<uint32_t> place(item.positions.count(), not_used), points;
  for (const uint32_t e : lines.ends) place[e] = 0;
  for (size_t i = 0; i < place.size(); ++i)
    if (place[i] != not_used) place[i] = uint32_t(points.size()), points.push_back(uint32_t(i));
  std::vector<float> used(3 * points.size());
  for (size_t i = 0; i < points.size(); ++i) std::copy_n(xyz + 3 * size_t(points[i]), 3, &used[3 * i]);
  std::vector<uint32_t> segments;
  for (const uint32_t e : lines.ends) segments.push_back(place[e]);
  if (q.cluster > 0 && !lines.room.empty()) {  // edges of a surface go with its points
    size_t count = 0;
    const std::vector<uint32_t> cluster = clusters_of(used, q.cluster, count);
    std::vector<double> sum(3 * count);
    std::vector<uint32_t> members(count);
    for (size_t i = 0; i < points.size(); ++i) {
      ++members[cluster[i]];
      for (size_t a = 0; a < 3; ++a) sum[3 * size_t(cluster[i]) + a] += used[3 * i + a];
    }
    used.resize(3 * count);
    for (size_t i = 0; i < used.size(); ++i) used[i] = float(sum[i] / members[i / 3]);
    std::vector<uint32_t> apart;
    std::vector<float> room;
    for (size_t i = 0; 2 * i < segments.size(); ++i) {
      const uint32_t a = cluster[segments[2 * i]], b = cluster[segments[2 * i + 1]];
      if (a != b) apart.push_back(a), apart.push_back(b), room.push_back(lines.room[i]);
    }
    segments = std::move(apart), lines.room = std::move(room);
  }
  Json::Members m{{"kind", text("lines")},
                  {"id", Json(uint64_t(item.id))},
                  {"positions", pack_positions(used, item.origin, q.position_bits, p.arrays)},
                  {"segments", Json(p.arrays.add(segments, 1))},
                  {"color", pack_color(item.color, flat_colors(item.color, item.color.per_cell ? lines.cells : points), q, p)},
                  {"opacity", Json(double(item.opacity))},
                  {"width", Json(item.width)},
                  {"lit", Json(item.shaded)},
                  {"material", numbers({item.material.ambient, item.material.diffuse, item.material.specular, item.material.power})},
                  {"contrast", text(word_of_contrast(item.contrast))},
                  {"halo", Json(item.halo)},
                  {"halo_color", numbers(item.halo_color)}};
  if (!lines.room.empty()) m.emplace_back("room", Json(p.arrays.add(lines.room, 1)));
  return Json(std::move(m));
}

Json pack_points(const raster::PreparedItem& item, const Packing& p) {
  const float* xyz = xyz_of(item);
  const size_t all = item.points ? item.points->size() : item.positions.count();
  const Quality& q = p.quality(all * 16);
  const size_t every = one_of(q.marks);
  std::vector<uint32_t> points;
  for (size_t i = 0; i < all; i += every) {
    const uint32_t n = item.points ? (*item.points)[i] : uint32_t(i);
    if (is_finite(xyz + 3 * size_t(n))) points.push_back(n);
  }
  if (points.empty()) return {};
  if (every > 1) p.note(fmt::format("of {} points one of {} is there", all, every));
  std::vector<float> used(3 * points.size());
  for (size_t i = 0; i < points.size(); ++i) std::copy_n(xyz + 3 * size_t(points[i]), 3, &used[3 * i]);
  Json::Members m{{"kind", text(item.discs ? "discs" : "points")},
                  {"id", Json(uint64_t(item.id))},
                  {"positions", pack_positions(used, item.origin, q.position_bits, p.arrays)},
                  {"color", pack_color(item.color, flat_colors(item.color, points), q, p)},
                  {"opacity", Json(double(item.opacity))},
                  {"size", Json(item.width)},
                  {"lit", Json(item.shaded)},
                  {"material", numbers({item.material.ambient, item.material.diffuse, item.material.specular, item.material.power})}};
  if (item.discs) {
    const auto *normal = reinterpret_cast<const float*>(item.disc_normals.raw()),
               *radius = reinterpret_cast<const float*>(item.disc_radius.raw());
    std::vector<float> normals, radii;
    for (const uint32_t i : points)
      normals.insert(normals.end(), normal + 3 * size_t(i), normal + 3 * size_t(i) + 3), radii.push_back(radius[i]);
    const float grow = std::sqrt(float(every));  // fewer discs still cover what they stand for
    for (float& r : radii) r *= grow;
    m.emplace_back("normals", pack_normals(normals, q.normal_bits, p.arrays));
    m.emplace_back("radii", Json(p.arrays.add(radii, 1)));
  }
  return Json(std::move(m));
}

}  // namespace sg::offline

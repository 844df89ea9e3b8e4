// SPDX-License-Identifier: Apache-2.0
#include "render/trace/geometry/triangles.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "render/trace/geometry/triangle_test.h"

namespace sg::trace {

namespace {

constexpr size_t triangles_per_chunk = 1 << 14;
/// A block is tested at once for little more than a node: what fits into one is never split, so that few places stay free.
constexpr TreeLimits block_limits{.most = wide, .least = wide, .at_once = wide};

bool box_of(const TriangleInput& in, size_t triangle, TreeRecord& r) {
  const Vec3f a = in.corner(triangle, 0), b = in.corner(triangle, 1), c = in.corner(triangle, 2);
  for (int k = 0; k < 3; ++k) r.lo[k] = std::min({a[k], b[k], c[k]}), r.hi[k] = std::max({a[k], b[k], c[k]});
  r.cell = uint32_t(triangle);
  const Vec3f sum = a + b + c;
  return std::isfinite(sum.x) && std::isfinite(sum.y) && std::isfinite(sum.z);
}

Plane<TreeRecord> records_of(const TriangleInput& in) {
  Plane<TreeRecord> records(in.triangles);
  std::vector<size_t> kept(in.triangles / triangles_per_chunk + 1);
  parallel_for(in.triangles, triangles_per_chunk, [&](size_t begin, size_t end) {
    size_t to = begin;
    for (size_t i = begin; i < end; ++i) to += box_of(in, i, records[to]);
    kept[begin / triangles_per_chunk] = to - begin;
  });
  size_t to = 0;
  for (size_t c = 0; c < kept.size(); ++c) {
    const auto from = records.begin() + ptrdiff_t(c * triangles_per_chunk);
    if (to != c * triangles_per_chunk) std::copy(from, from + ptrdiff_t(kept[c]), records.begin() + ptrdiff_t(to));
    to += kept[c];
  }
  records.resize(to);
  return records;
}

/// Whether a packet's boxes and shears serve all of them.
bool alike(const Ray* rays, int count) {
  const int axis = ShearedRay(rays[0]).kz;
  const Vec3f a = rays[0].direction;
  return std::all_of(rays, rays + count, [&](const Ray& r) {
    const Vec3f b = r.direction;
    return can_trace(r) && ShearedRay(r).kz == axis && (a.x < 0) == (b.x < 0) && (a.y < 0) == (b.y < 0) && (a.z < 0) == (b.z < 0);
  });
}

}  // namespace

Triangles::Triangles(const TriangleInput& in, Context& context) {
  if (in.triangles >= size_t(1) << 31) fail_usage("2^31 triangles or more", "path tracer", "draw a part of the data");
  tree_ = WideBvh(build_box_tree(records_of(in), block_limits, context));
  place_.assign(in.triangles, UINT32_MAX);
  blocks_.resize(tree_.leaves().size());
  parallel_for(blocks_.size(), 1 << 11, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const WideLeaf leaf = tree_.leaves()[i];
      TriangleBlock& block = blocks_[i];
      for (uint32_t k = 0; k < uint32_t(wide); ++k) {
        const bool used = k < leaf.count;
        const uint32_t t = used ? tree_.order()[leaf.first + k] : UINT32_MAX;
        block.triangle[k] = t;
        if (used) place_[t] = uint32_t(i) * wide + k;
        for (int c = 0; c < 3; ++c) {
          const Vec3f p = used ? in.corner(t, c) : Vec3f(NAN, NAN, NAN);
          for (int a = 0; a < 3; ++a) block.corner[c][a][k] = p[a];
        }
      }
    }
  });
}

std::array<Vec3f, 3> Triangles::corners(uint32_t triangle) const {
  const uint32_t place = place_[triangle];
  const TriangleBlock& b = blocks_[place / wide];
  std::array<Vec3f, 3> out;
  for (size_t c = 0; c < 3; ++c)
    for (int a = 0; a < 3; ++a) out[c][a] = b.corner[c][a][place % wide];
  return out;
}

uint64_t Triangles::nearest(const Ray* rays, int count, Hit* hits) const {
  if (tree_.empty()) return 0;
  uint64_t found = 0;
  const auto in_packet = [&](int first) { return count - first > 1 && alike(rays + first, std::min(packet_rays, count - first)); };
  for (int first = 0, end; first < count; first = end) {
    const bool packet = in_packet(first);
    end = std::min(first + packet_rays, count);
    while (!packet && end < count && !in_packet(end)) end = std::min(end + packet_rays, count);
    const uint64_t here =
        packet ? nearest_packet(rays + first, end - first, hits + first) : nearest_in_turns(rays + first, end - first, hits + first);
    found |= here << first;
  }
  return found;
}

bool Triangles::nearest_by_reference(const Ray& ray, Hit& hit) const {
  const ShearedRay r(ray);
  bool found = false;
  for (uint32_t i = 0; i < place_.size(); ++i) {
    if (place_[i] == UINT32_MAX) continue;
    const auto c = corners(i);
    float t = 0, u = 0, v = 0;
    if (!meet_triangle(r, c[0], c[1], c[2], hit.t, t, u, v) || (found && t == hit.t)) continue;
    hit.t = t, hit.primitive = i, hit.u = u, hit.v = v, found = true;
  }
  return found;
}

}  // namespace sg::trace

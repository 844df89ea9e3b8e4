// SPDX-License-Identifier: Apache-2.0
// Triangles ready to be traced: a wide tree, and the corners block by block as vector code reads them.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/context.h"
#include "base/huge_allocator.h"
#include "render/trace/tree/ray.h"
#include "render/trace/tree/wide_bvh.h"

namespace sg::trace {

/// Corners in traced coordinates, three numbers a point and three points a triangle, as they lie in a dataset: position = (xyz - middle)
/// scale in double, rounded once.
struct TriangleInput {
  const float* xyz;
  const uint32_t* indices;
  size_t triangles;
  Vec3 middle;
  double scale = 1;

  Vec3f corner(size_t triangle, int k) const {
    const float* p = xyz + 3 * size_t(indices[3 * triangle + size_t(k)]);
    return Vec3f((Vec3(p[0], p[1], p[2]) - middle) * scale);
  }
};

/// Up to eight triangles of a leaf; free places hold NaN, which no ray meets.
struct alignas(64) TriangleBlock {
  float corner[3][3][wide];  ///< [corner][axis][triangle]
  uint32_t triangle[wide];
};

/// What a packet of rays is: so many, whatever the width of vectors.
constexpr int packet_rays = 16;
/// The most rays of a stream: rays of any origin and direction that are followed together.
constexpr int stream_rays = 64;

class Triangles {
 public:
  Triangles() = default;
  /// Triangles with a corner that is not finite are never met. O(n log n).
  Triangles(const TriangleInput& input, Context& context);

  /// The nearest triangle with 0 < t <= hit.t, of several at the same t that with the lowest number; sets t, primitive, u, v.
  bool nearest(const Ray& ray, Hit& hit) const;
  /// Whether any triangle is met at 0 < t <= ray.t_max.
  bool blocked(const Ray& ray) const;
  /// The same of up to stream_rays: bit i of the result of rays[i]. Faster than one by one, the more so the more of their way they share.
  uint64_t blocked(const Ray* rays, int count) const;
  /// The same as nearest() for each of up to stream_rays: bit i of the result where hits[i] was found. Twice as fast where sixteen after
  /// each other start and go in about the same way, and faster for others, too.
  uint64_t nearest(const Ray* rays, int count, Hit* hits) const;
  /// The same by one triangle after the other.
  bool nearest_by_reference(const Ray& ray, Hit& hit) const;

  std::array<Vec3f, 3> corners(uint32_t triangle) const;
  Box3f bounds() const { return tree_.bounds(); }
  const WideBvh& tree() const { return tree_; }
  std::span<const TriangleBlock> blocks() const { return blocks_; }
  /// Tells the processor that corners() of a triangle will be wanted.
  void fetch(uint32_t triangle) const { __builtin_prefetch(&place_[triangle]); }
  size_t count() const { return place_.size(); }
  size_t bytes() const { return tree_.bytes() + blocks_.size() * sizeof(TriangleBlock) + place_.size() * sizeof(place_[0]); }

 private:
  /// Of up to packet_rays with the same longest axis and signs.
  uint32_t nearest_packet(const Ray* rays, int count, Hit* hits) const;
  /// Of any, a few in turns.
  uint64_t nearest_in_turns(const Ray* rays, int count, Hit* hits) const;

  WideBvh tree_;
  Plane<TriangleBlock> blocks_;
  Plane<uint32_t> place_;  ///< of each triangle: block x 8 + place in it; UINT32_MAX: in none
};

}  // namespace sg::trace

// SPDX-License-Identifier: Apache-2.0
// Solids: many balls, discs or capsules and the tree over them.
#pragma once
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "base/context.h"
#include "base/parallel.h"
#include "render/trace/geometry/solid_shapes.h"
#include "render/trace/tree/wide_bvh.h"

namespace sg::trace {

/// Shape is one of solid_shapes.h, in traced coordinates. Those that are not finite are never met. Numbers need not be consecutive.
template <class Shape>
class Solids {
 public:
  Solids() = default;
  Solids(std::vector<Shape> shapes, Context& context) {
    std::vector<Box3f> boxes(shapes.size());
    parallel_for(shapes.size(), 1 << 13, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) boxes[i] = shapes[i].bounds();
    });
    tree_ = WideBvh(Bvh(boxes, {.most = wide, .least = 1, .of_node = 0.3f}, context).take());
    // As they lie in the leaves.
    shapes_.reserve(tree_.order().size());
    for (const uint32_t i : tree_.order()) shapes_.push_back(shapes[i]);
    by_number_.resize(shapes_.size());
    std::iota(by_number_.begin(), by_number_.end(), 0u);
    std::sort(by_number_.begin(), by_number_.end(), [&](uint32_t a, uint32_t b) { return shapes_[a].number < shapes_[b].number; });
  }

  /// As Triangles::nearest.
  bool nearest(const Ray& ray, Hit& hit) const {
    bool found = false;
    walk_leaves(tree_, ray, hit.t, true, [&](uint32_t first, uint32_t count) {
      for (uint32_t i = first; i < first + count; ++i) {
        float t = 0, u = 0;
        if (!shapes_[i].meet(ray, hit.t, t, u) || (t == hit.t && found && shapes_[i].number > hit.primitive)) continue;
        hit.t = t, hit.primitive = shapes_[i].number, hit.u = u, hit.v = 0, found = true;
      }
      return false;
    });
    return found;
  }
  bool blocked(const Ray& ray) const {
    bool found = false;
    walk_leaves(tree_, ray, ray.t_max, false, [&](uint32_t first, uint32_t count) {
      float t = 0, u = 0;
      for (uint32_t i = first; i < first + count && !found; ++i) found = shapes_[i].meet(ray, ray.t_max, t, u);
      return found;
    });
    return found;
  }
  const Shape& shape(uint32_t number) const {
    return shapes_[*std::lower_bound(by_number_.begin(), by_number_.end(), number,
                                     [&](uint32_t i, uint32_t wanted) { return shapes_[i].number < wanted; })];
  }
  const Box3f& bounds() const { return tree_.bounds(); }
  std::span<const Shape> shapes() const { return shapes_; }
  size_t bytes() const { return tree_.bytes() + shapes_.size() * sizeof(Shape) + by_number_.size() * 4; }

 private:
  WideBvh tree_;
  std::vector<Shape> shapes_;
  std::vector<uint32_t> by_number_;
};

}  // namespace sg::trace

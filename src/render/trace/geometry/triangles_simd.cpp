// SPDX-License-Identifier: Apache-2.0
// Rays against a tree of triangles: eight boxes, then eight triangles at once. No fused multiply-add: the same bytes for every width of
// vectors (triangle_test.h is the reference).
#include "render/trace/geometry/triangles.h"

#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/trace/geometry/triangles_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/trace/geometry/leaf-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::trace::HWY_NAMESPACE {

bool nearest_triangle(const Triangles& in, const Ray& ray, Hit& hit) {
  const ShearedRay sheared(ray);
  const LeafRay r(sheared);
  const TriangleBlock* blocks = in.blocks().data();
  bool found = false;
  walk(in.tree().nodes().data(), NodeRay<false>(BoxRay(ray)), hit.t, Children(in.tree().nodes().data(), blocks), [&](uint32_t leaf) {
    if (nearest_in(r, blocks[leaf], hit, found)) in.fetch(hit.primitive);
    return false;
  });
  return found;
}

bool any_triangle(const Triangles& in, const Ray& ray) {
  const ShearedRay sheared(ray);
  const LeafRay r(sheared);
  const TriangleBlock* blocks = in.blocks().data();
  bool found = false;
  walk_any(in.tree().nodes().data(), NodeRay<false>(BoxRay(ray)), ray.t_max, Children(in.tree().nodes().data(), blocks),
           [&](uint32_t leaf) { return found = any_in(r, blocks[leaf], ray.t_max); });
  return found;
}

}  // namespace sg::trace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::trace {

HWY_EXPORT(nearest_triangle);
HWY_EXPORT(any_triangle);

bool Triangles::nearest(const Ray& ray, Hit& hit) const {
  return can_trace(ray) && !tree_.empty() && HWY_DYNAMIC_DISPATCH(nearest_triangle)(*this, ray, hit);
}
bool Triangles::blocked(const Ray& ray) const { return can_trace(ray) && !tree_.empty() && HWY_DYNAMIC_DISPATCH(any_triangle)(*this, ray); }

}  // namespace sg::trace
#endif

// SPDX-License-Identifier: Apache-2.0
// One item of a scene as the path tracer keeps it: in coordinates of its own, so that its tree serves every scene it is part of.
#pragma once
#include <cmath>
#include <memory>

#include "base/parallel.h"
#include "render/prepare/prepared.h"
#include "render/trace/geometry/geometry.h"

namespace sg::trace {

class Geometry::Object {
 public:
  virtual ~Object() = default;

  /// As of Geometry, in the object's coordinates; t in their unit. What is farther than hit.t is no hit either.
  virtual bool nearest(const Ray& ray, Hit& hit) const = 0;
  virtual bool blocked(const Ray& ray) const = 0;
  virtual uint64_t blocked_rays(const Ray* rays, int count) const;
  virtual uint64_t nearest_rays(const Ray* rays, int count, Hit* hits) const;
  /// A place on the surface in double, and its directions.
  struct Place {
    Vec3 place, error;  ///< error: besides the rounding of `place`
    Vec3 normal, shading, along;
  };
  virtual Place at(const Ray& ray, const Hit& hit) const = 0;
  virtual Box3f bounds() const = 0;
  virtual size_t bytes() const = 0;

  uint32_t item = 0;  ///< number in the geometry
  Placement local;

  /// Tells where the object lies in the scene: local = traced * ratio + offset.
  void place(const Placement& scene) {
    ratio_ = local.scale / scene.scale, offset_ = (scene.middle - local.middle) * local.scale;
    moved_ = !(offset_ == Vec3());
    const Box3f b = bounds();
    for (int a = 0; a < 3; ++a) {
      const double lo = outward(b.lo[a], offset_[a]), hi = outward(b.hi[a], offset_[a]),
                   reach = std::abs(lo) > std::abs(hi) ? std::abs(lo) : std::abs(hi);
      box_.lo[a] = float(lo - reach * 0x1p-22), box_.hi[a] = float(hi + reach * 0x1p-22);
    }
  }
  const Box3f& box() const { return box_; }  ///< in the scene
  Ray inward(const Ray& r) const {
    Ray out = r;
    out.t_max = r.t_max * float(ratio_);
    for (int a = 0; a < 3; ++a) out.origin[a] = float(double(r.origin[a]) * ratio_ + offset_[a]);
    return out;
  }
  double ratio() const { return ratio_; }
  bool as_placed() const { return ratio_ == 1 && !moved_; }  ///< its coordinates are the scene's
  Vec3 outward(Vec3 local_place) const { return (local_place - offset_) / ratio_; }
  /// What the rounding of a ray's start in local coordinates is worth in the scene's.
  Vec3 moving_error(Vec3 local_place) const {
    if (!moved_) return {};
    return Vec3(std::abs(local_place.x), std::abs(local_place.y), std::abs(local_place.z)) * (half_unit / ratio_);
  }

 private:
  double outward(double v, double offset) const { return (v - offset) / ratio_; }
  double ratio_ = 1;
  Vec3 offset_;
  bool moved_ = false;
  Box3f box_;
};

using ObjectPtr = std::unique_ptr<Geometry::Object>;

/// What a prepared item becomes; null when there is nothing of it. `pixel` > 0.
ObjectPtr make_object(const raster::PreparedItem& item, const GeometryOptions& options, double pixel, Context& context);

/// Those that points and lines become; lengths in the world.
ObjectPtr ball_object(const raster::PreparedItem& item, double radius, Context& context);
ObjectPtr disc_object(const raster::PreparedItem& item, Context& context);
ObjectPtr tube_object(const raster::PreparedItem& item, double radius, Context& context);
/// The lines of glyphs, each by itself.
ObjectPtr glyph_tube_object(const raster::PreparedItem& item, double radius, double pixel, Context& context);

// Points of an item in the world, and the box around some of them.

/// Point i of packed f32 positions.
inline Vec3 world_point(const Array& xyz, Vec3 origin, size_t i) {
  const float* p = reinterpret_cast<const float*>(xyz.raw()) + 3 * i;
  return origin + Vec3(p[0], p[1], p[2]);
}

/// Of the points number(0), number(1), ... those that are finite.
template <class Number>
Box3 box_of(const Array& xyz, Vec3 origin, size_t count, Number&& number) {
  return parallel_reduce(
      count, size_t(1) << 14, Box3{},
      [&](size_t begin, size_t end) {
        Box3 b;
        for (size_t i = begin; i < end; ++i) {
          const Vec3 p = world_point(xyz, origin, number(i));
          if (std::isfinite(dot(p, p))) b.add(p);
        }
        return b;
      },
      [](Box3 a, const Box3& b) {
        a.add(b);
        return a;
      });
}

inline Box3 grown(Box3 b, double by) {
  if (!b.empty()) b.lo -= Vec3(by, by, by), b.hi += Vec3(by, by, by);
  return b;
}

}  // namespace sg::trace

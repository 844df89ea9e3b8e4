// SPDX-License-Identifier: Apache-2.0
// Geometry: all of a scene as one thing that rays can meet. Surfaces as triangles, points as balls or oriented discs, lines as round tubes,
// glyphs as instances of their shapes, and whatever else is an Object.
#pragma once
#include <memory>
#include <vector>

#include "base/context.h"
#include "render/prepare/prepare.h"
#include "render/trace/geometry/surface_point.h"
#include "render/trace/tree/ray.h"
#include "render/trace/tree/wide_bvh.h"

namespace sg::trace {

struct GeometryOptions;

/// Objects are numbered like PreparedScene::items, and on from there; primitives from 0 in each (the picture's number less
/// first_primitive): what a hit's colour is the items tell. All numbers are in traced coordinates (placement()). Nothing is altered by
/// asking: any number of threads may.
class Geometry {
 public:
  class Object;
  static constexpr int most_together = 64;  ///< rays that are followed together
  Geometry();
  Geometry(Geometry&&) noexcept;
  Geometry& operator=(Geometry&&) noexcept;
  ~Geometry();

  /// Trees of surfaces and discs are kept with their datasets; those of lines and points depend on their radius and are made anew.
  /// O(n log n). Keeps what it needs of the scene. Throws Error(usage) from 2^31 primitives of an object on.
  static Geometry make(const PreparedScene& scene, const GeometryOptions& options, Context& context);

  /// The nearest hit with 0 < t <= ray.t_max; false leaves `hit` as it is.
  bool nearest(const Ray& ray, Hit& hit) const;
  /// Of up to most_together rays: with the same result as one by one, and faster, most where sixteen after each other start at about the
  /// same place in about the same direction, as those of neighbouring pixels. Bit i tells whether hits[i] was set.
  uint64_t nearest(const Ray* rays, int count, Hit* hits) const;
  /// Whether anything is met at 0 < t <= ray.t_max.
  bool blocked(const Ray& ray) const;
  /// The same of up to most_together rays of any kind: bit i of the result of rays[i]. Faster than one by one.
  uint64_t blocked(const Ray* rays, int count) const;
  /// The place of a hit of this ray.
  SurfacePoint at(const Ray& ray, const Hit& hit) const;

  /// Empty when there is nothing to meet.
  const Box3f& bounds() const { return bounds_; }
  const Placement& placement() const { return placement_; }
  size_t bytes() const;

 private:
  /// Object `o` asked for what is nearer than t_max, or as near and of a lower number.
  bool ask(const Object& o, const Ray& ray, float& t_max, bool& found, Hit& hit) const;

  std::vector<std::shared_ptr<Object>> objects_;  // in the order of their numbers
  std::unique_ptr<WideBvh> tree_;                 // of their boxes, where there are many
  Placement placement_;
  Box3f bounds_;
};

/// What has a size in pixels gets one in the world: rays that are reflected know no pixels.
struct GeometryOptions {
  double pixel = 0;         ///< world length of a pixel at the scene's distance; 0: a thousandth of the scene's diagonal
  double line_radius = 0;   ///< world radius of lines; 0: half their width in pixels
  double point_radius = 0;  ///< the same of points that are no discs
  Box3 around;              ///< world: what traced coordinates hold besides
  std::vector<std::shared_ptr<Geometry::Object>> more;  ///< numbered after the items; of this Geometry alone from now on
};

}  // namespace sg::trace

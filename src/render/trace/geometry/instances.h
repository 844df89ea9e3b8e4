// SPDX-License-Identifier: Apache-2.0
// Instances: shapes placed many times, as glyphs are. A tree over their boxes; a ray that meets one is moved into the shape's own
// coordinates.
#pragma once
#include <memory>
#include <vector>

#include "base/context.h"
#include "render/prepare/glyph_set.h"
#include "render/trace/geometry/triangles.h"
#include "render/trace/tree/ray.h"

namespace sg::trace {

/// Where a ray met an instance, in double: places and directions are the instances'.
struct InstancePoint {
  Vec3 place, error;  ///< relative to the instances' origin, not scaled
  Vec3 normal, shading, along;
};

class Instances {
 public:
  Instances() = default;
  /// `factor`: the length of a shape's unit (1; the length of a pixel for shapes whose size is in pixels). `local`: the coordinates of the
  /// rays, of which `origin` (the instances' own) is a place in the world. Flattened ones (no volume) are never met.
  Instances(const raster::GlyphSet& set, double factor, Context& context);

  bool nearest(const Ray& ray, Hit& hit) const;
  bool blocked(const Ray& ray) const;
  InstancePoint point(const Hit& hit) const;
  /// Middle and scale are relative to the instances' origin.
  const Placement& placement() const { return local_; }
  const Box3f& bounds() const { return tree_.bounds(); }
  size_t bytes() const;

 private:
  struct Shape {
    Triangles triangles;
    Placement placement;
    std::shared_ptr<const raster::GlyphShape> glyph;
  };
  struct Matrix {
    Mat3 linear;
    Vec3 at;
  };
  Matrix matrix(uint32_t instance) const;
  const Shape& shape_of(uint32_t instance) const;
  bool into(const Ray& ray, uint32_t instance, Ray& out) const;

  raster::GlyphSet set_;
  double factor_ = 1;
  std::vector<Shape> shapes_;
  Placement local_;
  WideBvh tree_;
};

}  // namespace sg::trace

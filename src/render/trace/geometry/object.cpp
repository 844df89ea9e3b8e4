// SPDX-License-Identifier: Apache-2.0
// Surfaces and glyphs; which item becomes what.
#include "render/trace/geometry/object.h"

#include <utility>

#include "render/trace/geometry/instances.h"
#include "render/trace/geometry/triangles.h"

namespace sg::trace {

namespace {

using raster::PreparedItem;

// Surfaces.

struct PlacedTriangles {
  Placement placement;
  Triangles triangles;
  size_t bytes() const { return triangles.bytes(); }
};

class SurfaceObject : public Geometry::Object {
 public:
  SurfaceObject(const PreparedItem& p, Context& context) : set_(p.triangles), normals_(p.normals) {
    kept_ = raster::derived(p.data, "traced triangles", [&] {
      PlacedTriangles t;
      const auto* corners = set_.indices();
      t.placement = Placement::of(box_of(set_.positions, set_.origin, 3 * set_.count, [&](size_t i) { return corners[i]; }));
      t.triangles = Triangles({set_.xyz(), corners, set_.count, t.placement.middle - set_.origin, t.placement.scale}, context);
      return t;
    });
    local = kept_->placement;
  }
  bool nearest(const Ray& ray, Hit& hit) const override { return kept_->triangles.nearest(ray, hit); }
  bool blocked(const Ray& ray) const override { return kept_->triangles.blocked(ray); }
  uint32_t nearest_packet(const Ray* rays, int count, Hit* hits) const override {
    return kept_->triangles.nearest_packet(rays, count, hits);
  }
  Place at(const Ray&, const Hit& hit) const override {
    const auto c = kept_->triangles.corners(hit.primitive);
    const Vec3 a(c[0]), ab = Vec3(c[1]) - a, ac = Vec3(c[2]) - a;
    Place p;
    p.place = a + ab * double(hit.u) + ac * double(hit.v);
    p.normal = normalize(cross(ab, ac)), p.along = ab;
    p.shading = smooth(hit, p.normal);
    return p;
  }
  Box3f bounds() const override { return kept_->triangles.bounds(); }
  size_t bytes() const override { return kept_->bytes(); }

 private:
  Vec3 smooth(const Hit& hit, Vec3 otherwise) const {
    if (normals_.normals.empty()) return otherwise;
    const uint32_t* corner = normals_.corners.empty() ? set_.indices() : reinterpret_cast<const uint32_t*>(normals_.corners.raw());
    Vec3 n;
    const double weight[3] = {1 - double(hit.u) - double(hit.v), hit.u, hit.v};
    for (size_t k = 0; k < 3; ++k) n += world_point(normals_.normals, {}, corner[3 * size_t(hit.primitive) + k]) * weight[k];
    n = normalize(n);
    return dot(n, n) > 0.5 ? n : otherwise;  // NaN, too
  }
  raster::TriangleSet set_;
  raster::NormalSet normals_;
  std::shared_ptr<const PlacedTriangles> kept_;
};

class GlyphObject : public Geometry::Object {
 public:
  GlyphObject(const PreparedItem& p, double pixel, Context& context)
      : origin_(p.origin), instances_(*p.glyphs, p.glyphs->in_pixels ? pixel : 1, context) {
    local = instances_.placement(), local.middle += origin_;
  }
  bool nearest(const Ray& ray, Hit& hit) const override { return instances_.nearest(ray, hit); }
  bool blocked(const Ray& ray) const override { return instances_.blocked(ray); }
  Place at(const Ray&, const Hit& hit) const override {
    const InstancePoint p = instances_.point(hit);
    const Placement& in = instances_.placement();
    return {(p.place - in.middle) * in.scale, p.error * in.scale, p.normal, p.shading, p.along};
  }
  Box3f bounds() const override { return instances_.bounds(); }
  size_t bytes() const override { return instances_.bytes(); }

 private:
  Vec3 origin_;
  Instances instances_;
};

}  // namespace

uint32_t Geometry::Object::nearest_packet(const Ray* rays, int count, Hit* hits) const {
  uint32_t found = 0;
  for (int i = 0; i < count; ++i) found |= uint32_t(nearest(rays[i], hits[i])) << i;
  return found;
}

ObjectPtr make_object(const PreparedItem& p, const GeometryOptions& options, double pixel, Context& context) {
  const double line = options.line_radius > 0 ? options.line_radius : 0.5 * p.width * pixel;
  const double point = options.point_radius > 0 ? options.point_radius : 0.5 * p.width * pixel;
  if (p.primitives == 0) return nullptr;
  switch (p.kind) {
    case PreparedItem::Kind::surface:
      if (p.glyphs) return std::make_unique<GlyphObject>(p, pixel, context);
      return std::make_unique<SurfaceObject>(p, context);
    case PreparedItem::Kind::lines: return p.glyphs ? glyph_tube_object(p, line, pixel, context) : tube_object(p, line, context);
    case PreparedItem::Kind::points: return p.discs ? disc_object(p, context) : ball_object(p, point, context);
  }
  return nullptr;
}

}  // namespace sg::trace

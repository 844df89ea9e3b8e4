// SPDX-License-Identifier: Apache-2.0
// Surfaces and glyphs; which item becomes what.
#include "render/trace/geometry/object.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "render/prepare/edge_fade.h"
#include "render/trace/geometry/instances.h"
#include "render/trace/geometry/surface_point.h"
#include "render/trace/geometry/triangles.h"

namespace sg::trace {

namespace {

using raster::PreparedItem;

// Surfaces.

struct PlacedTriangles {
  Placement placement;
  Triangles triangles;
  bool inside_out = false;  ///< closed, with triangles that wind so that their normals look into the body
  size_t bytes() const { return triangles.bytes(); }
};

/// A closed surface encloses a volume of sum a . (b x c) / 6, negative where its normals look inward, and its areas as vectors add up to 0;
/// small holes, as scanners leave them, change little.
bool inside_out(const raster::TriangleSet& set, Vec3 middle) {
  struct Sums {
    double volume = 0, area = 0;
    Vec3 areas;
  };
  const auto* corners = set.indices();
  const Sums sums = parallel_reduce(
      set.count, size_t(1) << 14, Sums{},
      [&](size_t begin, size_t end) {
        Sums s;
        for (size_t t = begin; t < end; ++t) {
          Vec3 p[3];
          for (size_t k = 0; k < 3; ++k) p[k] = world_point(set.positions, set.origin, corners[3 * t + k]) - middle;
          const Vec3 area = cross(p[1] - p[0], p[2] - p[0]);
          if (!std::isfinite(dot(area, area))) continue;
          s.volume += dot(p[0], cross(p[1], p[2])), s.areas += area, s.area += length(area);
        }
        return s;
      },
      [](Sums a, const Sums& b) {
        a.volume += b.volume, a.areas += b.areas, a.area += b.area;
        return a;
      });
  return sums.volume < 0 && length(sums.areas) < 0.1 * sums.area;
}

std::shared_ptr<const PlacedTriangles> tree_of(const DatasetPtr& data, const raster::TriangleSet& set, Context& context) {
  return raster::derived(data, "traced triangles", [&] {
    PlacedTriangles t;
    const auto* corners = set.indices();
    t.placement = Placement::of(box_of(set.positions, set.origin, 3 * set.count, [&](size_t i) { return corners[i]; }));
    t.triangles = Triangles({set.xyz(), corners, set.count, t.placement.middle - set.origin, t.placement.scale}, context);
    t.inside_out = inside_out(set, t.placement.middle);
    return t;
  });
}

class SurfaceObject : public Geometry::Object {
 public:
  SurfaceObject(const PreparedItem& p, std::shared_ptr<const PlacedTriangles> tree)
      : set_(p.triangles), normals_(p.normals), kept_(std::move(tree)) {
    local = kept_->placement;
  }
  bool nearest(const Ray& ray, Hit& hit) const override { return kept_->triangles.nearest(ray, hit); }
  bool blocked(const Ray& ray) const override { return kept_->triangles.blocked(ray); }
  uint64_t blocked_rays(const Ray* rays, int count) const override { return kept_->triangles.blocked(rays, count); }
  uint64_t nearest_rays(const Ray* rays, int count, Hit* hits) const override { return kept_->triangles.nearest(rays, count, hits); }
  Place at(const Ray&, const Hit& hit) const override {
    const auto c = kept_->triangles.corners(hit.primitive);
    const Vec3 a(c[0]), ab = Vec3(c[1]) - a, ac = Vec3(c[2]) - a;
    Place p;
    p.place = a + ab * double(hit.u) + ac * double(hit.v);
    p.normal = outer(normalize(cross(ab, ac))), p.along = ab;
    p.shading = smooth(hit, p.normal);
    return p;
  }
  Box3f bounds() const override { return kept_->triangles.bounds(); }
  size_t bytes() const override { return kept_->bytes(); }

 protected:
  Vec3 outer(Vec3 normal) const { return kept_->inside_out ? -normal : normal; }
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

/// A moved copy: its own coordinates are those of its box in the world, its tree lies in those of the original.
class CopyObject final : public SurfaceObject {
 public:
  CopyObject(const PreparedItem& p, std::shared_ptr<const PlacedTriangles> tree) : SurfaceObject(p, std::move(tree)) {
    const Affine& place = p.copy_of->place;
    const Placement& of_tree = kept_->placement;
    Box3 tree_box, box;
    const Box3f b = kept_->triangles.bounds();
    if (!b.empty()) tree_box.add(of_tree.world(b.lo)), tree_box.add(of_tree.world(b.hi));
    box = moved(place, tree_box);
    local = Placement::of(box);
    // local = (place(tree / s + m) - middle) * scale
    out_.linear = scaled(place.linear, local.scale / of_tree.scale), out_.shift = (place(of_tree.middle) - local.middle) * local.scale;
    in_ = inverse(out_);
    for (int a = 0; a < 3; ++a) {
      const double lo = (box.lo[a] - local.middle[a]) * local.scale, hi = (box.hi[a] - local.middle[a]) * local.scale;
      const double more = std::max(std::abs(lo), std::abs(hi)) * 4 * half_unit;
      bounds_.lo[a] = float(lo - more), bounds_.hi[a] = float(hi + more);
    }
    if (box.empty()) bounds_ = {};
  }
  bool nearest(const Ray& ray, Hit& hit) const override { return kept_->triangles.nearest(into(ray), hit); }
  bool blocked(const Ray& ray) const override { return kept_->triangles.blocked(into(ray)); }
  uint64_t nearest_rays(const Ray* rays, int count, Hit* hits) const override {
    Ray moved_rays[stream_rays];
    for (int i = 0; i < count; ++i) moved_rays[i] = into(rays[i]);
    return kept_->triangles.nearest(moved_rays, count, hits);
  }
  Place at(const Ray& ray, const Hit& hit) const override {
    const Place inner = SurfaceObject::at(ray, hit);
    const auto c = kept_->triangles.corners(hit.primitive);
    const Vec3 ab = out_.linear * (Vec3(c[1]) - Vec3(c[0])), ac = out_.linear * (Vec3(c[2]) - Vec3(c[0]));
    Place p;
    p.place = out_(inner.place), p.along = ab, p.normal = outer(normalize(cross(ab, ac)));
    // A ray that starts there is rounded in the tree's coordinates, too.
    for (int r = 0; r < 3; ++r)
      for (int k = 0; k < 3; ++k) p.error[r] += std::abs(out_.linear.m[r][k]) * (std::abs(inner.place[k]) * half_unit + 0x1p-42);
    p.shading = smooth(hit, p.normal);  // the copy's own normals
    return p;
  }
  Box3f bounds() const override { return bounds_; }
  size_t bytes() const override { return 0; }  // those of the original

 private:
  static Mat3 scaled(const Mat3& m, double s) {
    Mat3 r;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) r.m[i][j] = m.m[i][j] * s;
    return r;
  }
  // The direction is not of unit length: t stays what it is.
  Ray into(const Ray& ray) const {
    Ray r;
    r.origin = Vec3f(in_(Vec3(ray.origin))), r.direction = Vec3f(in_.linear * Vec3(ray.direction)), r.t_max = ray.t_max;
    return r;
  }
  Affine out_, in_;  // from the tree's coordinates to the object's own, and back
  Box3f bounds_;
};

bool same_triangles(const raster::TriangleSet& a, const raster::TriangleSet& b) {
  return a.count == b.count && (a.indices() == b.indices() || std::memcmp(a.indices(), b.indices(), 3 * a.count * sizeof(uint32_t)) == 0);
}

/// One that is a copy (PreparedItem::copy_of) shares the tree of its original: a ray is moved into the coordinates of that.
ObjectPtr surface_object(const PreparedItem& p, Context& context) {
  if (p.copy_of && determinant(p.copy_of->place.linear) > 0) {
    bool any = false;
    const raster::TriangleSet original = raster::triangulate(p.copy_of->original, any);
    if (any && same_triangles(original, p.triangles))
      return std::make_unique<CopyObject>(p, tree_of(p.copy_of->original, original, context));
  }
  return std::make_unique<SurfaceObject>(p, tree_of(p.data, p.triangles, context));
}

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

uint64_t Geometry::Object::blocked_rays(const Ray* rays, int count) const {
  uint64_t stopped = 0;
  for (int i = 0; i < count; ++i) stopped |= uint64_t(blocked(rays[i])) << i;
  return stopped;
}

uint64_t Geometry::Object::nearest_rays(const Ray* rays, int count, Hit* hits) const {
  uint64_t found = 0;
  for (int i = 0; i < count; ++i) found |= uint64_t(nearest(rays[i], hits[i])) << i;
  return found;
}

ObjectPtr make_object(const PreparedItem& p, const GeometryOptions& options, double pixel, Context& context) {
  const double line = options.line_radius > 0 ? options.line_radius : 0.5 * p.width * pixel;
  const double point = options.point_radius > 0 ? options.point_radius : 0.5 * p.width * pixel;
  if (p.primitives == 0) return nullptr;
  switch (p.kind) {
    case PreparedItem::Kind::surface:
      if (p.glyphs) return std::make_unique<GlyphObject>(p, pixel, context);
      return surface_object(p, context);
    case PreparedItem::Kind::lines:
      if (!p.glyphs && !p.segments->room.empty() && raster::fade_together(p, pixel) == 0) return nullptr;
      return p.glyphs ? glyph_tube_object(p, line, pixel, context) : tube_object(p, line, context);
    case PreparedItem::Kind::points: return p.discs ? disc_object(p, context) : ball_object(p, point, context);
  }
  return nullptr;
}

}  // namespace sg::trace

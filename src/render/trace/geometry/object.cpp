// SPDX-License-Identifier: Apache-2.0
// From the items of a scene to objects.
#include "render/trace/geometry/object.h"

#include <fmt/core.h>

#include <utility>
#include <vector>

#include "base/parallel.h"
#include "render/trace/geometry/instances.h"
#include "render/trace/geometry/solids.h"
#include "render/trace/geometry/triangles.h"

namespace sg::trace {

namespace {

using raster::PreparedItem;

constexpr size_t points_per_chunk = 1 << 14;

Vec3 world_point(const Array& xyz, Vec3 origin, size_t i) {
  const float* p = reinterpret_cast<const float*>(xyz.raw()) + 3 * i;
  return origin + Vec3(p[0], p[1], p[2]);
}

/// Of the points number(0), number(1), ... those that are finite.
template <class Number>
Box3 box_of(const Array& xyz, Vec3 origin, size_t count, Number&& number) {
  return parallel_reduce(
      count, points_per_chunk, Box3{},
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

Box3 grown(Box3 b, double by) {
  if (!b.empty()) b.lo -= Vec3(by, by, by), b.hi += Vec3(by, by, by);
  return b;
}

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

// Balls, discs, tubes.

template <class Shape>
struct PlacedSolids {
  Placement placement;
  Solids<Shape> solids;
  size_t bytes() const { return solids.bytes(); }
};

template <class Shape>
class SolidObject : public Geometry::Object {
 public:
  explicit SolidObject(std::shared_ptr<const PlacedSolids<Shape>> kept) : kept_(std::move(kept)) { local = kept_->placement; }
  bool nearest(const Ray& ray, Hit& hit) const override { return kept_->solids.nearest(ray, hit); }
  bool blocked(const Ray& ray) const override { return kept_->solids.blocked(ray); }
  Place at(const Ray& ray, const Hit& hit) const override {
    const ShapePoint p = kept_->solids.shape(hit.primitive).point(ray, hit);
    return {p.place, {}, p.normal, p.normal, p.along};
  }
  Box3f bounds() const override { return kept_->solids.bounds(); }
  size_t bytes() const override { return kept_->bytes(); }

 private:
  std::shared_ptr<const PlacedSolids<Shape>> kept_;
};

template <class Shape>
ObjectPtr solid_object(const Placement& placement, std::vector<Shape> shapes, Context& context) {
  PlacedSolids<Shape> s{placement, Solids<Shape>(std::move(shapes), context)};
  return std::make_unique<SolidObject<Shape>>(std::make_shared<const PlacedSolids<Shape>>(std::move(s)));
}

ObjectPtr ball_object(const PreparedItem& p, double radius, Context& context) {
  const auto& numbers = *p.points;
  const Placement placement = Placement::of(grown(box_of(p.positions, p.origin, numbers.size(), [&](size_t i) { return numbers[i]; }), radius));
  std::vector<Ball> balls(numbers.size());
  for (size_t i = 0; i < balls.size(); ++i)
    balls[i] = {placement.traced(world_point(p.positions, p.origin, numbers[i])), float(radius * placement.scale), uint32_t(i)};
  return solid_object(placement, std::move(balls), context);
}

ObjectPtr disc_object(const PreparedItem& p, Context& context) {
  const auto number = [&](size_t i) { return p.points ? (*p.points)[i] : uint32_t(i); };
  const auto* radius = reinterpret_cast<const float*>(p.disc_radius.raw());
  const auto make = [&] {
    const Placement placement = Placement::of(box_of(p.positions, p.origin, p.primitives, number));
    std::vector<Disc> discs(p.primitives);
    for (size_t i = 0; i < discs.size(); ++i) {
      const uint32_t point = number(i);
      const Vec3 n = normalize(world_point(p.disc_normals, {}, point));
      const bool drawn = dot(n, n) > 0.5 && radius[point] > 0;
      discs[i] = {placement.traced(world_point(p.positions, p.origin, point)), Vec3f(n),
                  drawn ? float(double(radius[point]) * placement.scale) : NAN, uint32_t(i)};
    }
    return PlacedSolids<Disc>{placement, Solids<Disc>(std::move(discs), context)};
  };
  const std::string key = fmt::format("traced discs/{}/{}", static_cast<const void*>(p.disc_normals.raw()), static_cast<const void*>(radius));
  return std::make_unique<SolidObject<Disc>>(raster::derived(p.data, key, make));
}

ObjectPtr tube_object(const PreparedItem& p, double radius, Context& context) {
  const auto& points = p.segments->points;
  const Placement placement = Placement::of(grown(box_of(p.positions, p.origin, points.size(), [&](size_t i) { return points[i]; }), radius));
  std::vector<Capsule> tubes(p.segments->count());
  const auto place = [&](uint32_t point) { return placement.traced(world_point(p.positions, p.origin, point)); };
  for (size_t i = 0; i < tubes.size(); ++i)
    tubes[i] = {place(points[2 * i]), place(points[2 * i + 1]), float(radius * placement.scale), uint32_t(i)};
  return solid_object(placement, std::move(tubes), context);
}

/// The lines of glyphs, each by itself.
ObjectPtr glyph_tube_object(const PreparedItem& p, double radius, double pixel, Context& context) {
  const raster::GlyphSet& set = *p.glyphs;
  struct Segment {
    Vec3 a, b;
    uint32_t number;
  };
  std::vector<Segment> segments;
  Box3 box;
  for (size_t i = 0; i < set.instances->count(); ++i) {
    if (!set.instances->stands(i)) continue;
    float m[12];
    for (size_t k = 0; k < 12; ++k) m[k] = set.instances->data()[12 * i + k] * (set.in_pixels && k % 4 != 3 ? float(pixel) : 1.0f);
    const raster::GlyphShape& s = set.shape_of(i);
    for (size_t k = 0; k < s.segments.count(); ++k) {
      Vec3 ends[2];
      for (size_t e = 0; e < 2; ++e) {
        const uint32_t q = s.segments.points[2 * k + e];
        float out[3];
        glyph_point(m, s.x[q], s.y[q], s.z[q], out);
        ends[e] = p.origin + Vec3(out[0], out[1], out[2]);
        box.add(ends[e]);
      }
      segments.push_back({ends[0], ends[1], uint32_t((i << set.shift) + k)});
    }
  }
  const Placement placement = Placement::of(grown(box, radius));
  std::vector<Capsule> tubes(segments.size());
  for (size_t i = 0; i < tubes.size(); ++i)
    tubes[i] = {placement.traced(segments[i].a), placement.traced(segments[i].b), float(radius * placement.scale), segments[i].number};
  return solid_object(placement, std::move(tubes), context);
}

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

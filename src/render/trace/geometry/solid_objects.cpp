// SPDX-License-Identifier: Apache-2.0
// Points as balls or discs, lines as tubes.
#include <fmt/core.h>

#include <utility>
#include <vector>

#include "filter/glyph/instances.h"
#include "render/prepare/glyph_set.h"
#include "render/trace/geometry/object.h"
#include "render/trace/geometry/solids.h"

namespace sg::trace {

namespace {

using raster::PreparedItem;

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

}  // namespace

ObjectPtr ball_object(const PreparedItem& p, double radius, Context& context) {
  const auto& numbers = *p.points;
  const Placement placement =
      Placement::of(grown(box_of(p.positions, p.origin, numbers.size(), [&](size_t i) { return numbers[i]; }), radius));
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
  const std::string key =
      fmt::format("traced discs/{}/{}", static_cast<const void*>(p.disc_normals.raw()), static_cast<const void*>(radius));
  return std::make_unique<SolidObject<Disc>>(raster::derived(p.data, key, make));
}

ObjectPtr tube_object(const PreparedItem& p, double radius, Context& context) {
  const auto& points = p.segments->points;
  const Placement placement =
      Placement::of(grown(box_of(p.positions, p.origin, points.size(), [&](size_t i) { return points[i]; }), radius));
  std::vector<Capsule> tubes(p.segments->count());
  const auto place = [&](uint32_t point) { return placement.traced(world_point(p.positions, p.origin, point)); };
  for (size_t i = 0; i < tubes.size(); ++i)
    tubes[i] = {place(points[2 * i]), place(points[2 * i + 1]), float(radius * placement.scale), uint32_t(i)};
  return solid_object(placement, std::move(tubes), context);
}

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

}  // namespace sg::trace

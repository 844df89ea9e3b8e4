// SPDX-License-Identifier: Apache-2.0
#include "render/trace/isosurface/isosurface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/threads/lending.h"
#include "render/trace/geometry/object.h"
#include "render/volume/natural_units.h"
#include "render/volume/prepare_cast.h"

namespace sg::trace {

namespace {

using volume::RayField;
using volume::Stretch;

/// Of the smallest edge that matters: fields are straight enough on it.
constexpr double reach_share = 0.05;

/// The derivative of a stretch's cubic at t.
double slope(const Stretch& s, double t) {
  const double f = (t - s.from) / (s.to - s.from), g = 1 - f;
  const double d0 = double(s.b[1]) - double(s.b[0]), d1 = double(s.b[2]) - double(s.b[1]), d2 = double(s.b[3]) - double(s.b[2]);
  return 3 * (g * g * d0 + 2 * g * f * d1 + f * f * d2) / (s.to - s.from);
}

/// The longest stretch of a short ray, which has the most digits: of a place between two cells one of the two.
std::optional<Stretch> around(RayField& field, Vec3 from, Vec3 direction, double length) {
  field.start(from, direction, 0, length);
  std::optional<Stretch> longest;
  Stretch s[8];
  for (size_t n; (n = field.next(s)) > 0;)
    for (size_t i = 0; i < n; ++i)
      if (!longest || s[i].to - s[i].from > longest->to - longest->from) longest = s[i];
  return longest;
}

/// What rays find first that come into the box from all six sides, in a grid.
std::vector<float> values_around(RayField& field, const Box3& box) {
  constexpr int n = 8;
  std::vector<float> values;
  for (int axis = 0; axis < 3; ++axis)
    for (const double way : {1.0, -1.0})
      for (int i = 0; i < n * n; ++i) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        Vec3 from = way > 0 ? box.lo : box.hi, direction;
        direction[axis] = way, from[axis] -= way * box.size()[axis];
        from[u] = box.lo[u] + (i % n + 0.5) / n * box.size()[u], from[v] = box.lo[v] + (i / n + 0.5) / n * box.size()[v];
        field.start(from, direction, 0, 3 * box.size()[axis]);
        Stretch first[8];
        if (field.next(first) > 0) values.push_back(first[0].value(first[0].from));
      }
  return values;
}

/// Levels whose surfaces lie around smaller values, as those of distances that are negative within: larger ones are around nearly all of
/// the volume. Surfaces that end at its border are no bodies.
std::vector<bool> around_smaller(RayField& field, const Box3& box, const std::vector<double>& levels) {
  const std::vector<float> values = values_around(field, box);
  std::vector<bool> out;
  for (const double level : levels) {
    const auto larger = std::count_if(values.begin(), values.end(), [&](float v) { return double(v) > level; });
    out.push_back(double(larger) > 0.75 * double(values.size()));
  }
  return out;
}

class IsosurfaceObject : public Geometry::Object {
 public:
  /// `length`: of a world length in the volume's units. Keeps the scene that the volume's item belongs to.
  IsosurfaceObject(std::shared_ptr<const Scene> scene, volume::CastVolume v, double length)
      : scene_(std::move(scene)), volume_(std::move(v)), length_(length), fields_([this] { return volume_.source->walker(); }) {
    Box3 box;
    box.add(volume_.source->bounds.lo / length_), box.add(volume_.source->bounds.hi / length_);
    local = Placement::of(box);
    per_local_ = length_ / local.scale;
    // Coordinates of cells are f32 numbers.
    place_error_ = 4 * half_unit * volume_.source->bounds.diagonal();
    const double beyond = place_error_ / length_;
    const Box3 reach = grown(box, beyond);
    bounds_ = {local.traced(reach.lo), local.traced(reach.hi)};
    around_smaller_ = around_smaller(*fields_.borrow(), volume_.source->bounds, *volume_.levels);
  }

  bool nearest(const Ray& ray, Hit& hit) const override {
    const auto field = fields_.borrow();
    const float up_to = std::min(ray.t_max, hit.t);
    const auto met = first(*field, ray, 0, up_to);
    if (!met) return false;
    const auto t = float(met->t / per_local_);
    if (!(t > 0 && t <= up_to)) return false;
    hit = {}, hit.t = t, hit.primitive = met->level;
    return true;
  }

  bool blocked(const Ray& ray) const override {
    Hit hit;
    return nearest(ray, hit);
  }

  Place at(const Ray& ray, const Hit& hit) const override {
    const auto field = fields_.borrow();
    // Where it is exactly, which a hit's length does not tell.
    const double off = double(hit.t) * 4 * half_unit;
    const auto again = first(*field, ray, double(hit.t) - off, hit.t + float(2 * off));
    const double t = again ? again->t : double(hit.t) * per_local_;
    const Vec3 direction = normalize(Vec3(ray.direction)), place = local.world(ray.origin) * length_ + direction * t;

    // The gradient of the field itself, by its derivatives along the axes: that of the surface that rays meet.
    const double reach = reach_share * volume_.source->edge;
    Vec3 gradient;
    double largest = std::abs((*volume_.levels)[hit.primitive]);
    for (int a = 0; a < 3; ++a) {
      Vec3 axis;
      axis[a] = 1;
      const auto s = around(*field, place - axis * reach, axis, 2 * reach);
      if (!s) continue;
      gradient[a] = slope(*s, std::clamp(reach, s->from, s->to));
      largest = std::max({largest, std::abs(double(s->lowest())), std::abs(double(s->highest()))});
    }
    const double steepness = sg::length(gradient);
    Place p;
    p.place = (place / length_ - local.middle) * local.scale;
    const double outward = around_smaller_[hit.primitive] ? 1 : -1;  // of the gradient
    p.normal = p.shading = steepness > 0 ? gradient * (outward / steepness) : -direction;
    if (volume_.item->shaded) {
      const auto s = around(*field, place - direction * reach, direction, 2 * reach);
      const Vec3 smooth = s ? normalize(Vec3(field->gradient(*s, std::clamp(reach, s->from, s->to))) * outward) : Vec3();
      if (dot(smooth, p.normal) > 0) p.shading = smooth;
    }
    p.along = std::abs(p.normal.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    // Values are f32 numbers, too, off by a few units of the largest near by.
    const double value_error = steepness > 0 ? std::min(8 * half_unit * largest / steepness, reach) : reach;
    const double error = (place_error_ + value_error) / per_local_;
    p.error = {error, error, error};
    return p;
  }

  /// Colour at a place of the world, where it follows another field.
  Vec3f color_at(uint32_t level, Vec3 world) const {
    const auto field = fields_.borrow();
    const Vec3 place = world * length_;
    const double reach = reach_share * volume_.source->edge;
    float second = NAN;
    // Stretches without the level are passed over: one of the axes crosses it.
    for (int a = 0; a < 3 && second != second; ++a) {
      Vec3 axis;
      axis[a] = 1;
      if (const auto s = around(*field, place - axis * reach, axis, 2 * reach))
        second = field->second(*s, std::clamp(reach, s->from, s->to));
    }
    return volume_.color_at(float((*volume_.levels)[level]), second);
  }

  Box3f bounds() const override { return bounds_; }
  size_t bytes() const override { return 0; }  // what it reads belongs to the dataset

 private:
  /// The first crossing with after < t <= up_to, both in local lengths; its own t in the volume's.
  std::optional<volume::Crossing> first(RayField& field, const Ray& ray, double after, float up_to) const {
    volume::DepthRay r{local.world(ray.origin) * length_, normalize(Vec3(ray.direction)), 0, HUGE_VAL};
    if (std::isfinite(up_to)) r.to = double(up_to) * per_local_ * (1 + 4 * half_unit);
    r.from = after * per_local_;
    r.clip(volume_.item->clip);
    if (!(r.from < r.to)) return {};
    field.start(r.origin, r.direction, r.from, r.to);
    return volume::first_crossing(field, *volume_.levels, std::max(r.from, 0.0));
  }

  std::shared_ptr<const Scene> scene_;
  volume::CastVolume volume_;
  double length_, per_local_ = 1, place_error_ = 0;
  Box3f bounds_;
  std::vector<bool> around_smaller_;  // of the levels
  Lending<RayField> fields_;
};

Isosurfaces::Look look_of(const volume::CastVolume& v) {
  Isosurfaces::Look look;
  look.id = v.id, look.made_of = v.item->made_of;
  for (const double level : *v.levels) {
    const Vec3f c = v.medium->at(float(level)).color;
    const double opacity = v.item->opacity.at(level + double(v.source->base));
    look.colors.push_back({c.x, c.y, c.z, float(std::clamp(opacity, 0.0, 1.0))});
  }
  return look;
}

}  // namespace

Isosurfaces isosurfaces_of(const Scene& scene, const Projection& projection, Context& context) {
  Isosurfaces out;
  const auto wanted = [](const Item& item) {
    const auto* v = std::get_if<VolumeItem>(&item);
    return v && v->mode == RayFunction::isosurface && v->method == VolumeMethod::ray;
  };
  if (std::none_of(scene.items.begin(), scene.items.end(), wanted)) return out;
  auto natural = volume::natural_scene(scene);
  const double length = natural ? natural->length : 1;
  const Projection inner = natural ? natural->projection(projection) : projection;
  const auto own = std::make_shared<const Scene>(natural ? std::move(natural->scene) : scene);
  volume::Knobs knobs;
  knobs.coarser = 0;  // bricks are read for what a camera sees; light goes everywhere
  for (size_t i = 0; i < own->items.size(); ++i) {
    if (!wanted(own->items[i])) continue;
    context.check();
    std::shared_ptr<const volume::Volume> lattice;
    volume::CastVolume v = volume::prepare_volume(std::get<VolumeItem>(own->items[i]), uint32_t(i + 1), inner, knobs, context, lattice);
    if (!v.source) continue;
    Isosurfaces::Look look = look_of(v);
    const auto& item = std::get<VolumeItem>(scene.items[i]);
    if (item.pictures && item.made_of)
      look.patches =
          std::make_shared<const LevelPatches>(*item.pictures, *item.made_of, item.data, reach_share * v.source->edge / length, context);
    const auto object = std::make_shared<IsosurfaceObject>(own, std::move(v), length);
    if (item.detail.color_by_second)
      look.color_at = [object, colors = look.colors](uint32_t level, Vec3 place) {
        const Vec3f c = object->color_at(level, place);
        return Vec4f{c.x, c.y, c.z, colors[level].w};
      };
    out.looks.push_back(std::move(look));
    out.objects.push_back(object);
  }
  return out;
}

}  // namespace sg::trace

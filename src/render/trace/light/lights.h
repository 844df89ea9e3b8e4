// SPDX-License-Identifier: Apache-2.0
// Lights: all that shines in a scene, of which a point asks for one at random, or what it sees of them. Traced coordinates; radiance and
// irradiance in linear RGB, of which 1 is a white surface in full light.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "render/trace/light/environment.h"
#include "render/trace/sampling/distribution.h"
#include "render/trace/tree/ray.h"

namespace sg::raster {
struct PlacedPicture;
}

namespace sg::trace {

struct PointLight {
  Vec3f position, intensity;  ///< power per solid angle
};
/// A point that shines into a cone: at full strength near its axis, then smoothly (the square of the cosine's share of the way) to nothing.
struct SpotLight {
  Vec3f position, axis;  ///< axis: unit, where it shines to
  Vec3f intensity;       ///< power per solid angle on the axis
  float inner, outer;    ///< 1 - cos of the angles from the axis up to which it is at full strength, and at which it ends

  float share(Vec3f direction) const {
    const float rise = 1 - dot(direction, axis);
    if (rise <= inner) return 1;
    const float s = rise < outer ? (outer - rise) / (outer - inner) : 0;
    return s * s;
  }
};
/// As far away as the sun: a disc in the sky, or a point of it.
struct DistantLight {
  Vec3f direction;   ///< towards it, unit
  Vec3f irradiance;  ///< of a surface that faces it
  float rise = 0;    ///< 1 - cos of half of the angle that it fills; 0 = sharp shadows
};
struct SphereLight {
  Vec3f middle;
  float radius;
  Vec3f radiance;
};
struct DiscLight {
  Vec3f middle, normal;  ///< shines to the side of the unit normal
  float radius;
  Vec3f radiance;
};
struct RectangleLight {
  Vec3f corner, u, v;  ///< shines to the side of u x v, which are square to each other
  Vec3f radiance;
};
/// A triangle of an item's surface; shines to both sides.
struct TriangleLight {
  Vec3f a, b, c;
  Vec3f radiance;
  uint32_t object = 0, primitive = 0;              ///< as in Hit
  const raster::PlacedPicture* picture = nullptr;  ///< multiplied with the radiance; null: it is the same all over
  std::array<uint32_t, 3> points{};                ///< of the corners in the picture
  float share = 1;                                 ///< of the radiance that the picture leaves, on average

  /// At the place of these weights of the corners.
  Vec3f radiance_at(Vec3f weights) const;
};
using AnyLight = std::variant<PointLight, SpotLight, DistantLight, SphereLight, DiscLight, RectangleLight, TriangleLight>;

/// One light seen from a point.
struct LightSample {
  Vec3f direction;
  float distance;  ///< to where nothing may stand in the way; infinite for distant ones
  Vec3f radiance;  ///< of a delta: irradiance, to be divided by pdf alike
  float pdf;       ///< per solid angle, with the chance of this light; of a delta that chance
  bool delta;
  uint32_t light = 0;  ///< its number
};

/// A light on a ray's way.
struct MetLight {
  uint32_t light;
  Vec3f radiance;
  float distance;  ///< along the ray; infinite for distant ones
  float pdf;       ///< with which sample() from the ray's origin draws its direction, per solid angle, with the chance of this light
};

class Lights {
 public:
  Lights() = default;
  /// `reach`: radius of a ball about the scene, for the power of what is far away. Throws Error(usage) for a light without size or power.
  /// `ask_soft` = false: sample() leaves out an environment that is soft.
  Lights(std::vector<AnyLight> lights, Environment environment, float reach, bool ask_soft = true);

  bool any() const { return choice_.has_value() || !environment_.dark(); }
  size_t count() const { return lights_.size(); }
  /// Whether sample() may find one.
  bool asks() const { return choice_.has_value(); }
  /// One of all lights, drawn by their power. Nothing where it does not shine on the point.
  std::optional<LightSample> sample(Vec3f from, float choice, Vec2f u) const;
  /// Radiance of all lights that are no items along the ray between t_min and t_max, and of what is infinitely far if that is infinite.
  /// Lights hide nothing, each other neither. `pdf`: with which the ray's direction was drawn at its origin; each light gets the share of
  /// that way (power heuristic) beside sample() from there. Infinite: all of it. `absorption`: of the matter from t_min on.
  Vec3f seen(const Ray& ray, float t_min, float pdf, Vec3f absorption = {}) const;
  /// The density with which sample() draws a triangle that is an item, seen from that far at that cosine; 0 for others.
  float triangle_pdf(uint32_t object, uint32_t primitive, float distance, float cosine) const;
  const Environment& environment() const { return environment_; }

  // One by one, for paths that begin at lights; number count() is the environment.

  const AnyLight& light(uint32_t number) const { return lights_[number]; }
  /// That sample() takes it.
  float chance(uint32_t number) const { return choice_ && number < choice_->cells() ? choice_->probability(number) : 0; }
  /// One of them by its chance.
  std::optional<uint32_t> choose(float choice) const;
  /// All that seen() sums, added to `out`.
  void met(const Ray& ray, float t_min, std::vector<MetLight>& out) const;
  /// As of MetLight, of this one; of a delta its chance.
  float pdf(uint32_t number, Vec3f from, Vec3f direction, float distance) const;
  /// Of a triangle that is an item.
  std::optional<uint32_t> number_of(uint32_t object, uint32_t primitive) const;

 private:
  std::vector<AnyLight> lights_;
  Environment environment_;
  std::optional<Distribution1D> choice_;                  // the environment is the last one
  std::vector<uint32_t> met_;                             // those that rays may meet, which are no items
  std::vector<std::pair<uint64_t, uint32_t>> triangles_;  // (object, primitive) to number, sorted
};

}  // namespace sg::trace

// SPDX-License-Identifier: Apache-2.0
// Light as it leaves its source: what paths begin with that go out from the lights. Traced coordinates.
#pragma once
#include <optional>
#include <vector>

#include "render/trace/light/lights.h"
#include "render/trace/tree/ray.h"

namespace sg::trace {

/// A ray of light. Of finite lights the place is drawn first, then the direction; of those at infinity the direction, then where in a disc
/// across it that covers the scene.
struct EmittedRay {
  uint32_t light;
  Vec3f position, direction;  ///< where it goes to
  Vec3f normal;               ///< of the light's surface there; zero where it has none (points, infinity)
  Vec3f weight;               ///< radiance |cos| / (first * second): what the ray carries
  float first, second;        ///< densities: per area and per solid angle; at infinity per solid angle and per area across. Deltas: 1,
                              ///< `first` with the chance of this light
  bool at_infinity;
  float t_max;   ///< how far it goes if nothing is met; inside of a spherical light to its other side
  Vec3f leaves;  ///< `position`, moved off the light's surface to where its ray starts
};

class Emission {
 public:
  /// Of lights that stay; `scene`: the box of all that light can meet.
  Emission(const Lights& lights, const Box3f& scene);

  /// One ray of one light, chosen by its power; `choice`, u, v uniform in [0, 1). Nothing where there is no light.
  std::optional<EmittedRay> sample(float choice, Vec2f u, Vec2f v) const;

  struct Densities {
    float first = 0, second = 0;
  };
  /// Of a ray of that light from a place on it: as EmittedRay, 0 for directions that it does not shine to. `normal` as there.
  Densities pdf(uint32_t light, Vec3f normal, Vec3f direction) const;
  /// The normal of a light's surface at a place of it; zero for points and what is at infinity.
  Vec3f normal(uint32_t light, Vec3f position) const;
  bool at_infinity(uint32_t light) const;
  /// Whether rays can meet it: it has a size, or is a disc in the sky.
  bool can_be_met(uint32_t light) const;

 private:
  std::optional<EmittedRay> from_infinity(uint32_t light, Vec3f towards_light, Vec3f radiance, float pdf, Vec2f u) const;
  float inwards(uint32_t light) const { return inwards_[light]; }

  const Lights& lights_;
  Vec3f middle_;
  float reach_;                 // of the disc
  std::vector<float> inwards_;  // share of the rays of spherical lights that go to their inside: none where nothing is there
};

}  // namespace sg::trace

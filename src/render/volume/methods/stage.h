// SPDX-License-Identifier: Apache-2.0
// Stage: what every classic algorithm needs of an item: the prepared lattice, the rays of pixels, light, and what is refused.
#pragma once
#include <initializer_list>
#include <vector>

#include "render/composite/over.h"
#include "render/shade/lamp.h"
#include "render/volume/methods/layer.h"
#include "render/volume/rays/lit_ray.h"
#include "render/volume/sources/lattice/lattice_volume.h"

namespace sg::volume {

/// A ray ends when less than this share of the light passes (as the ray caster's).
constexpr float opaque_below = 1.0f / 4096;

/// What a method can draw; anything else is a usage error that names method=ray.
struct Limits {
  const char* method;
  std::initializer_list<RayFunction> modes;
  bool rectilinear = false;
  bool perspective = true;
  bool clip = false;
  bool depth_cue = false;
};

/// The ray of a pixel's middle in q: start + t * along, t the world length from its origin; inside the volume, in front of the
/// opaque surfaces and between near and far in [enter, leave).
struct PixelRay {
  Vec3 start, along;
  double enter = 0, leave = -1;
  double first_depth = 0, per_length = 1;  ///< depth = first_depth + t * per_length
};

/// Factor of the colour, and white on top of it.
struct Shade {
  float diffuse = 1, flash = 0;
};

struct Stage {
  const VolumeItem& item;
  const Projection& projection;
  const Frame& opaque;
  Context& context;
  Volume volume;
  bool empty = false;  ///< nothing to draw
  Mat3 to_world;       ///< directions in q -> world
  std::vector<Lamp> lamps;

  size_t pixels() const { return size_t(projection.width) * size_t(projection.height); }
  Vec3 world(Vec3 q) const { return volume.origin + to_world * q; }
  PixelRay ray(int x, int y) const;
  /// Unit direction of sight at a world place.
  Vec3 sight(Vec3 place) const { return projection.parallel ? projection.forward : normalize(place - projection.eye); }
  LitRay lit(Vec3 direction) const;
  /// The same for another direction; only what depends on it is recomputed.
  void light(Vec3 direction, LitRay& lit) const;
  const Transfer& transfer() const { return volume.transfer[0]; }
};

/// Reads and checks the item. Throws Error(usage) for what `limits` leaves out.
Stage make_stage(const LayerInput& input, const Limits& limits);

/// The light model on one sample: the gradient in q, the change of the value over a cell.
Shade shade_sample(const Stage& stage, Vec3f gradient, float per_cell, const LitRay& lit);
/// The same from a normal (world, any length above 0) and how far there is a surface (0 to 1).
Shade shade_normal(Vec3f normal, float surface, const LitRay& lit);
/// World direction of a gradient in q.
inline Vec3f world_gradient(const Stage& stage, Vec3f g) {
  const auto& m = stage.volume.shade_plan.to_world;
  return {m[0][0] * g.x + m[0][1] * g.y + m[0][2] * g.z, m[1][0] * g.x + m[1][1] * g.y + m[1][2] * g.z,
          m[2][0] * g.x + m[2][1] * g.y + m[2][2] * g.z};
}
/// Stored value of a lattice point.
float value_at(const Volume& volume, size_t i, size_t j, size_t k);

/// 1 - exp(-depth) for an optical depth >= 0, to 1e-6 of itself below 1/16 and 5e-7 beyond; the same bits on every machine.
float alpha_of(float optical_depth);

/// Converts what a pixel collected in a mode other than composite to its colour: the value's colour, opaque unless its opacity is 0.
class Ink {
 public:
  explicit Ink(const VolumeItem& item);
  /// `value` in the field's units (NaN: nothing).
  void draw(double value, float rgba[4]) const;

 private:
  const VolumeItem& item_;
  ColorTable table_;
};

/// The derivatives at a lattice point in q and the change over a cell, as the kernels'.
struct PointGradient {
  Vec3f q;
  float per_cell;
};
PointGradient gradient_at_sample(const Volume& volume, size_t i, size_t j, size_t k);

}  // namespace sg::volume

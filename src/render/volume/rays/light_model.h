// SPDX-License-Identifier: Apache-2.0
// Light on one place of a volume: a change of its colour and, in illustrative styles, of its extinction.
#pragma once
#include <cmath>

#include "render/volume/rays/lit_ray.h"

namespace sg::volume {

/// colour' = diffuse * colour + specular * white + tint, tau' = opacity * tau.
struct Lit {
  float diffuse = 1, specular = 0;
  Vec3f tint{0, 0, 0};
  float opacity = 1;
  float ink = 0;  ///< share of Detail::ink that is there besides

  Vec3f color(Vec3f c) const { return Vec3f{c.x * diffuse + specular, c.y * diffuse + specular, c.z * diffuse + specular} + tint; }
};
inline float difference(const Lit& a, const Lit& b) {
  const auto off = [](float x, float y) { return std::abs(x - y); };
  return off(a.diffuse, b.diffuse) + off(a.specular, b.specular) +
         std::max(
             {off(a.tint.x, b.tint.x), off(a.tint.y, b.tint.y), off(a.tint.z, b.tint.z), off(a.opacity, b.opacity), off(a.ink, b.ink)});
}
inline Lit lerp(const Lit& a, const Lit& b, float f) {
  return {a.diffuse + f * (b.diffuse - a.diffuse), a.specular + f * (b.specular - a.specular), a.tint + (b.tint - a.tint) * f,
          a.opacity + f * (b.opacity - a.opacity), a.ink + f * (b.ink - a.ink)};
}

/// Blinn-Phong on both sides of the gradient (world, value per length); where the field changes by less than a surface does over the
/// length `edge`, the colour stays as it is.
Lit light_at(const LitRay& lit, Vec3f gradient, float edge, float per_scale);

/// The same with the effects of lit.effects, which must not be null, at t of the ray. With s how much of a surface there is (0..1), n its
/// normal towards the viewer, v the direction to the viewer, l that to a lamp, a(l) = 1 - shadows + shadows T(l), o = 1 - occlusion hidden:
///   without surface   E = ambient o + (1 - ambient) mean of a(l) by intensity (1 without effects; all there is when not shaded)
///   style none        (1 - s) E + s (ambient o + diffuse sum I (n.l) a(l)); highlights times a(l)
///   silhouette        rim r = s (1 - |n.v|)^3: tau' = tau (1 + 6 r), colour (1 - r)     (after Ebert, Rheingans 2000)
///   tone              w = (1 + n.l a(l))/2 for the strongest lamp: from cool, 0.25 colour + (0, 0.03, 0.20), at w = 0 to warm,
///                     0.75 colour + (0.18, 0.12, 0), at w = 1, by s                     (after Gooch et al. 1998)
///   hatch             L = ambient o + diffuse sum I (n.l) a(l): three families of planes in space, a distance d apart, leave strokes on
///                     surfaces; family k begins where L < 0.75, 0.45, 0.2 and its strokes grow as it gets darker (own; see hatch())
/// ink: r, and for hatching s times the ink of the strokes: with VolumeLight::ink they have an extinction of their own, black;
/// and at last depth_cue: colour (1 - f) + f background, f = depth_cue (depth - near)/(far - near) of the volumes' box.
Lit light_at(const LitRay& lit, double t, Vec3f gradient, float edge, float per_scale);

}  // namespace sg::volume

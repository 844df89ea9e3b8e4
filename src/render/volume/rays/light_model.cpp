// SPDX-License-Identifier: Apache-2.0
#include "render/volume/rays/light_model.h"

#include <algorithm>
#include <cmath>

#include "render/shade/blinn_phong.h"
#include "render/volume/effects/effects.h"

namespace sg::volume {

namespace {

/// What arrives at a place with the normal n (zero = none).
struct Arriving {
  Reflected sum;
  float even = 1;  ///< mean share of their light
  float key = 0;   ///< n.l a(l) of the strongest, from -1 to 1
};

Arriving arriving(const LitRay& lit, Vec3 place, Vec3f normal) {
  Arriving out;
  float sum = 0, all = 0, strongest = 0;
  for (size_t i = 0; i < lit.lights.size(); ++i) {
    const SeenLamp& l = lit.lights[i];
    const float share = lit.effects->arriving(i, place), d = dot(normal, l.light);
    sum += l.intensity * share, all += l.intensity;
    if (l.intensity > strongest) strongest = l.intensity, out.key = d > 0 ? d * share : d;
    out.sum.add(l, d, dot(normal, l.half), lit.material.power, share);
  }
  if (all > 0) out.even = sum / all;
  return out;
}

float smooth(float x) {
  x = std::clamp(x, 0.0f, 1.0f);
  return x * x * (3 - 2 * x);
}

/// Ink of three families of strokes, 0..1. Planes square to axis a, `stroke` apart on the surface whatever its slope: a family fades where
/// the surface lies along its planes. A stroke is as wide as it is dark: (limit - L)/limit of the distance, at most 60 %, edges 15 % soft.
float hatch(const LightEffects& e, Vec3 place, Vec3f normal, float light) {
  constexpr Vec3f axes[3] = {{0.6f, 0.48f, 0.64f}, {-0.64f, 0.6f, 0.48f}, {0.48f, 0.64f, -0.6f}};  // orthonormal but for signs
  constexpr float limits[3] = {0.75f, 0.45f, 0.2f};
  float paper = 1;
  for (int k = 0; k < 3; ++k) {
    const float dark = std::clamp((limits[k] - light) / limits[k], 0.0f, 1.0f);
    const float along = dot(axes[k], normal), slope = std::sqrt(std::max(0.0f, 1 - along * along));
    const double x = dot(Vec3(axes[k]), place - e.centre) / e.stroke;
    const float middle = std::abs(float(x - std::floor(x)) - 0.5f) * 2;  // 0 in the middle of the stroke, 1 between strokes
    const float wide = 0.6f * dark;
    paper *= 1 - smooth((wide + 0.15f - middle) / 0.3f) * smooth(dark * 8) * smooth((slope - 0.2f) * 3);
  }
  return 1 - paper;
}

/// Single scattering: the sum over the lamps of irradiance, phase function and what arrives.
Lit scattered(const LitRay& lit, Vec3 place) {
  const LightEffects& e = *lit.effects;
  float sum = e.glow;
  for (size_t i = 0; i < lit.lights.size(); ++i) {
    const SeenLamp& l = lit.lights[i];
    sum += e.albedo * l.irradiance * e.scatters->density(dot(l.light, lit.direction)) * e.arriving(i, place);
  }
  Lit out{sum, 0, {0, 0, 0}, 1};
  if (e.depth_cue > 0) {
    const float fade = e.fade(place);
    out.diffuse *= 1 - fade, out.tint = lit.background * fade;
  }
  return out;
}

}  // namespace

Lit light_at(const LitRay& lit, double t, Vec3f gradient, float edge, float per_scale) {
  const LightEffects& e = *lit.effects;
  const Material& m = lit.material;
  const Vec3 place = lit.origin + lit.along * t;
  if (e.scatters) return scattered(lit, place);
  const float square = dot(gradient, gradient);
  Vec3f normal{0, 0, 0};
  float surface = 0, facing = 1;
  if (square > 0 && square < 1e30f) {
    const float length = std::sqrt(square), across = dot(gradient, lit.direction);
    surface = std::min(1.0f, length * edge * per_scale), facing = std::min(1.0f, std::abs(across) / length);
    normal = gradient * ((across > 0 ? -1.0f : 1.0f) / length);
  }
  const Arriving a = arriving(lit, place, normal);
  const float open = e.open(place, normal, surface), share = m.lit ? surface : 0;
  const float even = m.ambient < 1 ? m.ambient * open + (1 - m.ambient) * a.even : open;
  const float light = m.ambient * open + m.diffuse * a.sum.diffuse;
  Lit out{even + share * (light - even), share * (m.specular * a.sum.specular), {0, 0, 0}, 1};
  switch (e.style) {
    case LightStyle::none: break;
    case LightStyle::silhouette: {
      const float off = 1 - facing, rim = surface * off * off * off;
      out.diffuse *= 1 - rim, out.specular *= 1 - rim, out.opacity = 1 + 6 * rim, out.ink = rim;
      break;
    }
    case LightStyle::tone: {
      const float w = 0.5f + 0.5f * a.key, cool = 1 - w;
      out.diffuse += surface * (open * (0.25f * cool + 0.75f * w) - out.diffuse);
      out.tint = Vec3f{0.18f * w, 0.03f * cool + 0.12f * w, 0.20f * cool} * surface;
      break;
    }
    case LightStyle::hatch: {
      // Paper between the strokes, whatever the light.
      const float strokes = hatch(e, place, normal, light), paper = 1 - 0.9f * strokes;
      out.ink = surface * strokes;
      out.diffuse += surface * (paper - out.diffuse), out.specular *= 1 - surface;
      break;
    }
  }
  if (e.depth_cue > 0) {
    const float fade = e.fade(place), rest = 1 - fade;
    out.diffuse *= rest, out.specular *= rest, out.tint = out.tint * rest + lit.background * fade;
  }
  return out;
}

Lit light_at(const LitRay& lit, Vec3f gradient, float edge, float per_scale) {
  const float square = dot(gradient, gradient);
  if (!(square > 0) || !(square < 1e30f)) return {};
  const float length = std::sqrt(square), surface = std::min(1.0f, length * edge * per_scale);
  const float side = (dot(gradient, lit.direction) > 0 ? -1.0f : 1.0f) / length;
  const Reflected sum = reflected(lit.lights, gradient, side, lit.material.power);
  const Material& m = lit.material;
  return {1 + surface * (m.ambient + m.diffuse * sum.diffuse - 1), surface * (m.specular * sum.specular)};
}

}  // namespace sg::volume

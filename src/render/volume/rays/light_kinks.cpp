// SPDX-License-Identifier: Apache-2.0
#include "render/volume/rays/light_kinks.h"

#include <algorithm>

#include "render/volume/effects/effects.h"
#include "render/volume/rays/functions.h"

namespace sg::volume {

bool has_kinks(const LitRay& lit) { return !lit.effects || lit.effects->needs_gradient(lit.material.lit); }

LightKinks light_kinks(const LitRay& lit, RayField& walker, const Stretch& s, Vec3f first, Vec3f last) {
  const double length = s.to - s.from;
  const Vec3f g[4] = {first, walker.gradient(s, s.from + length / 3), walker.gradient(s, s.to - length / 3), last};
  LightKinks out;
  const auto look_along = [&](Vec3f d) {
    const float h[4] = {dot(g[0], d), dot(g[1], d), dot(g[2], d), dot(g[3], d)};
    Stretch along{0, 1, {}};
    bernstein_from_thirds(h, along.b);
    if (!(along.lowest() < 0 && along.highest() > 0)) return;
    double ends[4] = {0, 1, 1, 1};
    const int turning = turns(along.b, ends + 1);
    ends[turning + 1] = 1;
    for (int i = 0; i <= turning && out.count < LightKinks::most; ++i) {
      double from = ends[i], to = ends[i + 1];
      const bool before = along.value(from) > 0;
      if ((along.value(to) > 0) == before) continue;
      for (int k = 0; k < 24; ++k) {
        const double middle = 0.5 * (from + to);
        ((along.value(middle) > 0) == before ? from : to) = middle;
      }
      out.at[out.count++] = s.from + length * to;
    }
  };
  look_along(lit.direction);
  for (const SeenLamp& l : lit.lights) look_along(l.light);
  std::sort(out.at, out.at + out.count);
  return out;
}

LightKinks light_kinks(const LitRay& lit, RayField& walker, const Stretch& s) {
  const double beside = hair * (s.to - s.from);
  return light_kinks(lit, walker, s, walker.gradient(s, s.from + beside), walker.gradient(s, s.to - beside));
}

}  // namespace sg::volume

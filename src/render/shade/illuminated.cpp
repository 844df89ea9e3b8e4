// SPDX-License-Identifier: Apache-2.0
#include "render/shade/illuminated.h"

#include <cmath>
#include <numbers>

#include "render/shade/blinn_phong.h"

namespace sg::raster {

void light_line(const Material& m, std::span<const Lamp> lamps, Vec3 tangent, Vec3 view, float& light, float& gloss) {
  using std::numbers::pi;
  light = 1, gloss = 0;
  if (!m.lit) return;
  const double vt = std::clamp(dot(view, tangent), -1.0, 1.0), v_across = std::sqrt(1 - vt * vt);
  const Vec3 v = view - tangent * vt;  // what lies across the line
  double diffuse = 0, specular = 0;
  for (const Lamp& lamp : lamps) {
    const Vec3 to = lamp.direction, half = to + view;
    const double strength = double(lamp.intensity), lt = std::clamp(dot(to, tangent), -1.0, 1.0), across = std::sqrt(1 - lt * lt);
    const double cosine = across * v_across > 1e-12 ? std::clamp(dot(to - tangent * lt, v) / (across * v_across), -1.0, 1.0) : 1.0;
    const double angle = std::acos(cosine);  // between viewer and light around the line
    diffuse += strength * across * (std::sin(angle) + (pi - angle) * cosine) / pi;
    const double ht = dot(half, tangent) / std::max(length(half), 1e-9), h_across = std::sqrt(std::max(0.0, 1 - ht * ht));
    specular += strength * std::sqrt(0.5 * (1 + cosine)) * double(power_of(float(h_across), m.power));
  }
  light = float(double(m.ambient) + double(m.diffuse) * diffuse), gloss = float(double(m.specular) * specular);
}

Vec3 line_tangent(const PreparedItem& item, size_t i, double s) {
  const SegmentSet& set = *item.segments;
  const float* xyz = reinterpret_cast<const float*>(item.positions.raw());
  const auto along = [&](size_t k) {
    const float *a = xyz + 3 * size_t(set.points[2 * k]), *b = xyz + 3 * size_t(set.points[2 * k + 1]);
    return normalize(Vec3(double(b[0]) - a[0], double(b[1]) - a[1], double(b[2]) - a[2]));
  };
  const auto joined = [&](size_t a, size_t b) { return set.points[2 * a + 1] == set.points[2 * b]; };
  const Vec3 own = along(i);
  const Vec3 from = i > 0 && joined(i - 1, i) ? normalize(along(i - 1) + own) : own;
  const Vec3 to = i + 1 < set.count() && joined(i, i + 1) ? normalize(own + along(i + 1)) : own;
  const Vec3 t = normalize(from * (1 - s) + to * s);
  return dot(t, t) > 0 ? t : own;
}

}  // namespace sg::raster

// SPDX-License-Identifier: Apache-2.0
// Light that is scattered once: packets draw what single rays draw.
#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

/// Smoke with holes and edges.
double puffs(Vec3 p) {
  const double wave = std::sin(5 * p.x + 1) * std::sin(4 * p.y + 2) * std::sin(6 * p.z);
  return std::clamp(1.2 - 1.3 * length(p) + 0.4 * wave, 0.0, 1.0);
}

Scene smoke(double tau, PhaseKind phase, ElementType type = ElementType::f32) {
  const double scale = type == ElementType::f32 ? 1 : 200;
  VolumeItem v = item(grid(
                          cube(40, -1, 1), [&](Vec3 p) { return scale * puffs(p); }, type),
                      grey(0, scale), {});
  v.opacity.points = {{0, 0}, {scale, 1 - std::exp(-tau)}};
  v.scattering.light = VolumeLighting::map, v.scattering.phase = phase, v.scattering.glow = 0.1;
  Scene s = scene_of({v});
  s.lights = {{normalize(Vec3{1, 2, 1}), false, 1}, {normalize(Vec3{-1, 0.5, 0.2}), false, 0.4f}};
  return s;
}

}  // namespace

TEST_CASE("volume scattered: packets light smoke as single rays do, thin and dense, by any phase function, of any samples") {
  const Projection views[] = {parallel_view(40, 30, 16, {0.3, -0.4, -1}), perspective_view(40, 30, 40, {2, 1, 3}, {0, 0, 0})};
  for (const Projection& view : views)
    for (const double tau : {0.5, 4.0, 60.0})
      for (const PhaseKind phase : {PhaseKind::isotropic, PhaseKind::henyey_greenstein})
        for (const ElementType type : {ElementType::f32, ElementType::u8}) {
          CAPTURE(tau);
          const Scene scene = smoke(tau, phase, type);
          const Frame packets = draw(scene, view), single = draw(scene, view, {}, by_single_rays(view));
          float brightest = 0;
          for (const float v : single.rgba) brightest = std::max(brightest, v);
          CHECK(brightest > 0.1f);
          CHECK(largest_difference(packets, single) < 1.0f / 256 * std::max(1.0f, brightest));
        }
}

TEST_CASE("volume scattered: the same bytes for one ray at a time") {
  const Projection view = perspective_view(37, 21, 40, {2, 1, 3}, {0, 0, 0});
  const Scene scene = smoke(4, PhaseKind::henyey_greenstein);
  volume::Knobs one;
  one.simd = false;
  CHECK(same_bytes(draw(scene, view), draw(scene, view, one)));
}

// SPDX-License-Identifier: Apache-2.0
#include "render/volume/effects/effects.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "data/memory/memo.h"

namespace sg::volume {

namespace {

void check_share(double value, const char* name) {
  if (!(value >= 0 && value <= 1))
    fail_usage(fmt::format("{} {} is not a valid share", name, value), "volume", "give a number from 0 to 1");
}

}  // namespace

bool scatters_by_map(const VolumeItem& item) { return item.scattering.light == VolumeLighting::map; }

bool scatters_alone(const LightEffects& e) {
  const auto one_map = [](const LampShadows& l) { return l.volumes.size() == 1 && !l.surfaces; };
  return e.scatters && e.depth_cue == 0 && e.shadows == 1 && std::all_of(e.lamps.begin(), e.lamps.end(), one_map);
}

bool has_effects(const VolumeItem& item) {
  const VolumeLight& l = item.light;
  return l.shadows > 0 || l.occlusion > 0 || l.depth_cue > 0 || l.style != LightStyle::none || scatters_by_map(item);
}

void check_light(const VolumeItem& item) {
  const VolumeLight& l = item.light;
  check_share(l.shadows, "shadows"), check_share(l.occlusion, "occlusion"), check_share(l.depth_cue, "depth_cue");
  if (scatters_by_map(item) && (item.shaded || l.occlusion > 0 || l.style != LightStyle::none))
    fail_usage("light=map is light of matter: gradients, occlusion and styles have no part in it", "volume",
               "leave out shaded=, occlusion= and style=, or light=map");
  if ((l.shadows > 0 || l.occlusion > 0 || scatters_by_map(item)) && !info_of(item.mode).absorbs)
    fail_usage("shadows, occlusion and light=map need absorption, which this ray function does not have", "volume",
               "use mode=composite, or leave out shadows=, occlusion= and light=");
  if (scatters_by_map(item) && item.scattering.black_body)
    fail_usage("light=map has no black bodies", "black_body", "use light=single or light=path");
  const VolumeScattering& s = item.scattering;
  check_share(s.albedo, "albedo"), check_share(s.back_share, "back_share");
  for (const double g : {s.anisotropy, s.back_anisotropy})
    if (!(std::abs(g) < 1)) fail_usage(fmt::format("{} is not a valid mean cosine", g), "anisotropy", "give a number between -1 and 1");
  if (!(s.glow >= 0 && std::isfinite(s.glow)))
    fail_usage(fmt::format("glow {} is not a valid radiance", s.glow), "volume", "give 0 or more");
  if (!(l.ink >= 0 && l.ink < 1))
    fail_usage(fmt::format("ink {} is not a valid opacity", l.ink), "volume", "give a number from 0 to below 1");
  if (l.ink > 0 && l.style != LightStyle::silhouette && l.style != LightStyle::hatch)
    fail_usage("ink applies only to silhouettes and hatching strokes", "volume", "add style=silhouette or style=hatch, or leave out ink=");
}

std::vector<std::shared_ptr<const LightMap>> light_maps(const VolumeItem& item, const RaySource& source, const Extinction& extinction,
                                                        std::span<const Vec3> lamps, const Context* context) {
  const std::string key = extinction_key(item, extinction);
  const auto kept = item.data->memo().keep("volume light maps", Recent<LightMap>(), 0);
  LightMap::Plan plan;
  if (extinction.detail) plan.most_samples = size_t(1) << 22;
  std::vector<std::shared_ptr<const LightMap>> maps;
  for (const Vec3& lamp : lamps) {
    std::string with_light = key;
    append_numbers(with_light, {lamp.x, lamp.y, lamp.z});
    maps.push_back(kept->get(with_light, std::max<size_t>(2, lamps.size()),
                             [&] { return LightMap(source, extinction, item.clip, lamp, plan, context); }));
  }
  return maps;
}

std::shared_ptr<const LightEffects> light_effects(const VolumeItem& item, const RaySource& source, const Extinction& extinction,
                                                  const std::vector<LampShadows>& lamps, const Projection& projection, const Box3& drawn,
                                                  const Context* context) {
  if (!has_effects(item)) return nullptr;
  LightEffects e;
  const VolumeLight& l = item.light;
  e.shadows = float(l.shadows), e.occlusion = float(l.occlusion), e.depth_cue = float(l.depth_cue);
  e.style = l.style;
  if (scatters_by_map(item)) {
    e.scatters = PhaseFunction(item.scattering), e.shadows = 1;
    e.albedo = float(item.scattering.albedo), e.glow = float(item.scattering.glow);
  }
  if (e.shadows > 0) e.lamps = lamps;
  if (l.occlusion > 0)
    e.around = item.data->memo().keep("volume occlusion", Recent<Occlusion>(), 0)->get(extinction_key(item, extinction), 2, [&] {
      return Occlusion(source, extinction, item.clip, {}, context);
    });
  e.eye = projection.eye, e.forward = projection.forward;
  double near_end = HUGE_VAL, far_end = -HUGE_VAL;
  for (int c = 0; c < 8; ++c) {
    const Vec3 corner{c & 1 ? drawn.hi.x : drawn.lo.x, c & 2 ? drawn.hi.y : drawn.lo.y, c & 4 ? drawn.hi.z : drawn.lo.z};
    const double depth = dot(corner - e.eye, e.forward);
    near_end = std::min(near_end, depth), far_end = std::max(far_end, depth);
  }
  near_end = std::max(near_end, projection.near_plane);
  e.near_end = near_end, e.per_depth = far_end > near_end ? 1 / (far_end - near_end) : 0;
  e.centre = (source.bounds.lo + source.bounds.hi) * 0.5;
  e.stroke = source.bounds.diagonal() / 120;
  return std::make_shared<const LightEffects>(std::move(e));
}

}  // namespace sg::volume

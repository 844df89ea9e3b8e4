// SPDX-License-Identifier: Apache-2.0
// LightEffects: lighting of a volume beyond Blinn-Phong: shadows, occlusion, fading with depth, illustrative styles.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/context.h"
#include "render/shade/phase_function.h"
#include "render/volume/effects/light_map.h"
#include "render/volume/effects/occlusion.h"
#include "render/volume/effects/surface_shadow.h"
#include "scene/camera.h"
#include "scene/items/volume_item.h"

namespace sg::volume {

/// What may shadow a scene: all composited volumes and the opaque surfaces.
struct LampShadows {
  std::vector<std::shared_ptr<const LightMap>> volumes;
  std::shared_ptr<const SurfaceShadow> surfaces;  ///< or null

  float through_volumes(Vec3 place) const {
    float pass = 1;
    for (const auto& v : volumes) pass *= v->at(place);
    return pass;
  }
  float at(Vec3 place) const { return through_volumes(place) * (surfaces ? surfaces->lit(place) : 1.0f); }
};

/// Of one volume in one picture; shared by all threads.
struct LightEffects {
  float shadows = 0, occlusion = 0, depth_cue = 0;
  LightStyle style = LightStyle::none;
  std::vector<LampShadows> lamps;           ///< one per lamp, or none
  std::shared_ptr<const Occlusion> around;  ///< or null
  Vec3 eye, forward;                        ///< depth = dot(place - eye, forward)
  double near_end = 0, per_depth = 0;       ///< fading: (depth - near_end) * per_depth, within 0..1
  Vec3 centre;                              ///< of the volume
  double stroke = 1;                        ///< world distance of hatching strokes
  std::optional<PhaseFunction> scatters;    ///< light=map: the lamps' light, scattered once, takes the place of all other light
  float albedo = 0, glow = 0;

  bool needs_gradient(bool shaded) const { return shaded || style != LightStyle::none || around; }
  /// Share of light that arrives from a lamp: 1 - shadows + shadows T.
  float arriving(size_t lamp, Vec3 place) const { return lamps.empty() ? 1.0f : 1 - shadows + shadows * lamps[lamp].at(place); }
  /// Share of the ambient light that arrives.
  float open(Vec3 place, Vec3f normal, float surface) const {
    return around ? 1 - occlusion * around->hidden(place, normal, surface) : 1.0f;
  }
  /// Share of the background in the colour, by depth.
  float fade(Vec3 place) const {
    const double f = (dot(place - eye, forward) - near_end) * per_depth;
    return depth_cue * float(f > 0 ? f < 1 ? f : 1 : 0);
  }
};

/// Whether the light of the lamps is scattered once, by their maps.
bool scatters_by_map(const VolumeItem& item);
/// Whether these are nothing but one map for each lamp, of a volume that is alone.
bool scatters_alone(const LightEffects& effects);
/// Whether the item uses any of them.
bool has_effects(const VolumeItem& item);
/// Throws Error(usage) for shares outside 0..1, and shadows or occlusion of what is not composited.
void check_light(const VolumeItem& item);

/// The light that the volume takes from each lamp. Kept with its dataset: those of one picture, at most 16 MiB per lamp (8 MiB where a
/// second axis makes every sample expensive).
std::vector<std::shared_ptr<const LightMap>> light_maps(const VolumeItem& item, const RaySource& source, const Extinction& extinction,
                                                        std::span<const Vec3> lamps, const Context* context);

/// `lamps`: their shadows; not read when the item has none. The last two maps of occlusion are kept with the dataset. `drawn` is the
/// box of all volumes of the scene: they fade together. Null when the item uses no effect.
std::shared_ptr<const LightEffects> light_effects(const VolumeItem& item, const RaySource& source, const Extinction& extinction,
                                                  const std::vector<LampShadows>& lamps, const Projection& projection, const Box3& drawn,
                                                  const Context* context);

}  // namespace sg::volume

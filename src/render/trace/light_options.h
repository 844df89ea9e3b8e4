// SPDX-License-Identifier: Apache-2.0
// How light is followed.
#pragma once
#include <cstdint>

#include "base/schema/enum_words.h"
#include "render/trace/sampling/sampler.h"

namespace sg {

namespace trace {

enum class IntegratorKind {
  ambient_occlusion,  ///< white light from everywhere, of surfaces in reach alone
  whitted,            ///< direct light, mirrors and glass (Whitted 1980): no light from surface to surface
  path,               ///< all light (Kajiya 1986)
  light,              ///< from the lights to the camera: light that mirrors and glass focus; not what is seen in them
  bdpt,               ///< from both ends (Veach 1997): the most of all light that independent paths find
  metropolis,         ///< paths from both ends in chains that stay where it is bright (Kelemen 2002, Hachisuka 2014)
};
constexpr auto enum_words(IntegratorKind) {
  using enum IntegratorKind;
  return std::array{Word{"ambient_occlusion", ambient_occlusion},
                    Word{"whitted", whitted},
                    Word{"path", path},
                    Word{"light", light},
                    Word{"bdpt", bdpt},
                    Word{"metropolis", metropolis}};
}

}  // namespace trace

struct LightOptions {
  trace::IntegratorKind integrator = trace::IntegratorKind::path;
  trace::SamplerKind sampler = trace::SamplerKind::blue_noise;
  double noise = 0.02;  ///< standard error at which a part of the picture is finished, as a share of full scale as displayed
  int paths = 256;      ///< most paths a pixel
  int bounces = 8;      ///< most turns of a path
  uint64_t seed = 0;
  double seconds = 0;     ///< time after which the picture stops where it is, evenly; 0: none
  int stop = 0;           ///< the same by a number of paths a pixel, at most `paths`; 0: none
  bool denoise = false;   ///< denoise/denoise.h
  bool features = false;  ///< keep LightPlanes::albedo and normal
};

}  // namespace sg

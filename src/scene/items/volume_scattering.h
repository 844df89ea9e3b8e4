// SPDX-License-Identifier: Apache-2.0
// VolumeScattering: what a volume does with light that comes from elsewhere.
#pragma once
#include <optional>

#include "base/schema/enum_words.h"

namespace sg {

class Schema;

/// Which light of a volume reaches the viewer.
enum class VolumeLighting {
  emission,  ///< its colours shine by themselves, and are absorbed (Max 1995)
  map,       ///< light of the lamps that was scattered once, with shadows from a map of each (effects/light_map.h)
  single,    ///< light that was scattered once, each ray of it followed
  path,      ///< light that was scattered any number of times
};
constexpr auto enum_words(VolumeLighting) {
  using enum VolumeLighting;
  return std::array{Word{"emission", emission}, Word{"map", map}, Word{"single", single}, Word{"path", path}};
}

/// Where scattered light goes.
enum class PhaseKind {
  isotropic,          ///< everywhere
  rayleigh,           ///< of particles much smaller than the wavelength
  henyey_greenstein,  ///< by a mean cosine (Henyey, Greenstein 1941)
  two_lobe,           ///< two of these, one of them usually backward
};
constexpr auto enum_words(PhaseKind) {
  using enum PhaseKind;
  return std::array{Word{"isotropic", isotropic}, Word{"rayleigh", rayleigh}, Word{"henyey_greenstein", henyey_greenstein},
                    Word{"two_lobe", two_lobe}};
}

/// Extinction is that of the opacity curve, whatever the colour of light. Of light that it takes, a share is scattered, the rest absorbed:
/// so much that a thick body of the value has its colour in even light (single_scatter_albedo; all of it for white), times `albedo`.
struct VolumeScattering {
  std::optional<VolumeLighting> light;  ///< empty = path with an integrator, else emission
  double albedo = 1;
  PhaseKind phase = PhaseKind::isotropic;
  double anisotropy = 0.6;        ///< mean cosine; of Henyey and Greenstein, and of the first lobe
  double back_anisotropy = -0.3;  ///< of the second lobe
  double back_share = 0.3;        ///< what it takes
  double glow = 0;                ///< radiance of white, by which the colours shine themselves
  bool black_body = false;        ///< the field that colours is a temperature in kelvin: `glow` is the luminance at the scale's upper end
};
void describe(Schema& s, VolumeScattering& p);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// PhaseFunction: where a volume scatters light, by the kind that was chosen for it.
#pragma once
#include <algorithm>
#include <numbers>

#include "render/shade/phase.h"
#include "scene/items/volume_scattering.h"

namespace sg {

/// Of the cosine between the directions in which light travels before and after, as of phase.h.
struct PhaseFunction {
  PhaseKind kind = PhaseKind::isotropic;
  float g = 0, back = 0, back_share = 0;

  PhaseFunction() = default;
  explicit PhaseFunction(const VolumeScattering& s)
      : kind(s.phase), g(float(s.anisotropy)), back(float(s.back_anisotropy)), back_share(float(s.back_share)) {}

  float mean_cosine() const {
    switch (kind) {
      case PhaseKind::isotropic:
      case PhaseKind::rayleigh: break;
      case PhaseKind::henyey_greenstein: return g;
      case PhaseKind::two_lobe: return (1 - back_share) * g + back_share * back;
    }
    return 0;
  }
  /// Per solid angle; its integral over all directions is 1.
  float density(float cosine) const {
    switch (kind) {
      case PhaseKind::isotropic: break;
      case PhaseKind::rayleigh: return rayleigh(cosine);
      case PhaseKind::henyey_greenstein: return henyey_greenstein(cosine, g);
      case PhaseKind::two_lobe: return (1 - back_share) * henyey_greenstein(cosine, g) + back_share * henyey_greenstein(cosine, back);
    }
    return 1 / (4 * std::numbers::pi_v<float>);
  }
  /// A cosine drawn by it, for u in [0, 1).
  float sample(float u) const {
    switch (kind) {
      case PhaseKind::isotropic: break;
      case PhaseKind::rayleigh: return sample_rayleigh(u);
      case PhaseKind::henyey_greenstein: return sample_henyey_greenstein(g, u);
      case PhaseKind::two_lobe:
        return u < back_share ? sample_henyey_greenstein(back, u / back_share)
                              : sample_henyey_greenstein(g, std::min((u - back_share) / (1 - back_share), 0x1.fffffep-1f));
    }
    return 2 * u - 1;
  }
};

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "scene/items/volume_scattering.h"

#include "base/schema/schema.h"

namespace sg {

void describe(Schema& s, VolumeScattering& p) {
  s("light", p.light,
    "Which light of the volume is seen: emission, its colours shine by themselves; map, that of the lamps, scattered once, by maps of "
    "their "
    "shadows; single, scattered once, ray by ray; path, any number of times (with these two the picture is drawn by paths). Default: "
    "emission, or path if the picture has an integrator.");
  s("albedo", p.albedo, "Unless light=emission: the share of the light taken that is scattered, times the colour; the rest is absorbed.")
      .range(0, 1);
  s("phase", p.phase, "Where scattered light goes: everywhere, as of small molecules, forward by anisotropy, or in two such lobes.");
  s("anisotropy", p.anisotropy, "Mean cosine of henyey_greenstein and of the first lobe: 0.9 far forward (droplets), 0 everywhere.")
      .range(-0.99, 0.99);
  s("back_anisotropy", p.back_anisotropy, "Mean cosine of the second of two lobes; below 0 goes back.").range(-0.99, 0.99);
  s("back_share", p.back_share, "Share of the second of two lobes.").range(0, 1);
  s("glow", p.glow, "Unless light=emission: how brightly the colours shine besides; 1 is a white surface in full light.").at_least(0);
  s("black_body", p.black_body,
    "The field that colours is a temperature in kelvin: what glows has the colour and brightness of a black body, glow at the upper end of "
    "the range (with opacity by another field: opacity_by or color_by).");
}

}  // namespace sg

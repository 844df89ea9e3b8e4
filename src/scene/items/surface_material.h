// SPDX-License-Identifier: Apache-2.0
// What a surface is made of: one set of parameters with the names and meanings of OpenPBR, of which glTF's metallic-roughness materials
// are a part, and presets by name.
//
// Light meets, in this order, the coat; then metal (base_metalness) or else a boundary of transparent matter; and what passes that enters
// the body: clear (transmission_weight), or diffuse. Colours are linear sRGB, from 0 to 1, lengths those of the data.
#pragma once
#include <optional>

#include "base/schema/enum_words.h"
#include "base/schema/schema.h"
#include "base/vec.h"

namespace sg {

/// Metals of measured indices of refraction (Johnson, Christy 1972, 1974; McPeak et al. 2015 for aluminium).
enum class Metal { gold, silver, copper, aluminium, iron, titanium, chromium, nickel };
constexpr auto enum_words(Metal) {
  using enum Metal;
  return std::array{Word{"gold", gold},           Word{"silver", silver},      Word{"copper", copper},
                    Word{"aluminium", aluminium}, Word{"aluminum", aluminium}, Word{"iron", iron},
                    Word{"titanium", titanium},   Word{"chromium", chromium},  Word{"nickel", nickel}};
}
/// One index for red, green and blue each: those of a metal which at 0 and at 80 degrees reflects what the measured one does, integrated
/// over the spectrum in daylight D65 to linear sRGB (colour matching functions of Wyman, Sloan, Shirley 2013; gold's red, which no screen
/// shows, is 0.995).
struct ConductorIndex {
  Vec3f eta, k;
};
ConductorIndex index_of(Metal metal);

struct SurfaceMaterial {
  Vec3 base_color{0.8, 0.8, 0.8};
  double base_metalness = 0;
  std::optional<Metal> metal;
  double specular_weight = 1;
  double specular_roughness = 0.3;
  double specular_anisotropy = 0;
  double specular_ior = 1.5;
  double transmission_weight = 0;
  Vec3 transmission_color{1, 1, 1};
  double transmission_depth = 0;
  double subsurface_weight = 0;
  Vec3 subsurface_radius{1, 0.5, 0.25};
  double subsurface_anisotropy = 0;
  double coat_weight = 0;
  Vec3 coat_color{1, 1, 1};
  double coat_roughness = 0;
  double coat_ior = 1.6;
  double retro_weight = 0;
  int dielectric_priority = 0;
  Vec3 emission{0, 0, 0};
  bool thin_walled = false;
};
void describe(Schema& s, SurfaceMaterial& m);
/// Throws Error(usage) for a value out of its range: colours that reflect more than arrives, indices of refraction below one.
void check(const SurfaceMaterial& m);

enum class MaterialPreset {
  matte,
  paper,
  plastic,
  satin,
  mirror,
  gold,
  silver,
  copper,
  aluminium,
  iron,
  titanium,
  chromium,
  nickel,
  glass,
  frosted_glass,
  thin_glass,
  water,
  diamond,
  wax,
  skin,
  car_paint,
  retroreflector
};
constexpr auto enum_words(MaterialPreset) {
  using enum MaterialPreset;
  return std::array{Word{"matte", matte},
                    Word{"paper", paper},
                    Word{"plastic", plastic},
                    Word{"satin", satin},
                    Word{"mirror", mirror},
                    Word{"gold", gold},
                    Word{"silver", silver},
                    Word{"copper", copper},
                    Word{"aluminium", aluminium},
                    Word{"aluminum", aluminium},
                    Word{"iron", iron},
                    Word{"titanium", titanium},
                    Word{"chromium", chromium},
                    Word{"nickel", nickel},
                    Word{"glass", glass},
                    Word{"frosted_glass", frosted_glass},
                    Word{"thin_glass", thin_glass},
                    Word{"water", water},
                    Word{"diamond", diamond},
                    Word{"wax", wax},
                    Word{"skin", skin},
                    Word{"car_paint", car_paint},
                    Word{"retroreflector", retroreflector}};
}
/// `size`: diagonal of the body, of which lengths are shares.
SurfaceMaterial preset_material(MaterialPreset preset, double size = 1);
/// What is not stated to be of anything: plastic whose highlights leave the colours of the data alone.
SurfaceMaterial data_material();

}  // namespace sg

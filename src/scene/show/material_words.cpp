// SPDX-License-Identifier: Apache-2.0
#include "scene/show/material_words.h"

#include "base/schema/color_params.h"
#include "image/image.h"

namespace sg {

bool MaterialShow::any() const {
  return material || metal || base_metalness || specular_weight || specular_roughness || specular_ior || transmission_weight ||
         transmission_depth || transmission_color || subsurface_weight || subsurface_radius || subsurface_anisotropy || coat_weight ||
         coat_color || coat_roughness || coat_ior || retro_weight || emission || thin_walled || dielectric_priority;
}

SurfaceMaterial MaterialShow::made(double size) const {
  SurfaceMaterial m = material ? preset_material(*material, size) : data_material();
  const auto take = [](auto& to, const auto& from) {
    if (from) to = *from;
  };
  take(m.base_metalness, base_metalness), take(m.specular_weight, specular_weight), take(m.specular_roughness, specular_roughness);
  take(m.specular_ior, specular_ior);
  take(m.transmission_weight, transmission_weight), take(m.transmission_depth, transmission_depth);
  take(m.transmission_color, transmission_color), take(m.subsurface_weight, subsurface_weight);
  take(m.subsurface_radius, subsurface_radius), take(m.subsurface_anisotropy, subsurface_anisotropy);
  take(m.coat_weight, coat_weight), take(m.coat_color, coat_color), take(m.coat_roughness, coat_roughness), take(m.coat_ior, coat_ior);
  take(m.retro_weight, retro_weight), take(m.emission, emission);
  take(m.thin_walled, thin_walled), take(m.dielectric_priority, dielectric_priority);
  if (metal) {
    m.metal = metal;
    if (!base_metalness && m.base_metalness == 0 && m.retro_weight == 0) m.base_metalness = 1;
    if (m.base_metalness == 1) m.base_color = preset_material(*value_of_word<MaterialPreset>(word_of(*metal)), size).base_color;
  }
  return m;
}

void describe(Schema& s, MaterialShow& p) {
  s("material", p.material,
    "What the surface is made of, where the picture has an integrator; its own colour takes the place of those of a field that is not "
    "stated. sightglass lookdev shows all. Default: plastic of the data's colours.");
  s("metal", p.metal,
    "The metal is this one, by its measured index of refraction, instead of one of the surface's colour. All is metal where neither "
    "base_metalness nor the material says how much.");
  s("base_metalness", p.base_metalness, "Share of metal, instead of the material's.").range(0, 1);
  s("specular_weight", p.specular_weight,
    "How much the boundary reflects, of what its index of refraction says, instead of the material's; 0 = matte.")
      .range(0, 1);
  s("specular_roughness", p.specular_roughness, "From a mirror (0) to a highlight without an edge (1), instead of the material's.")
      .range(0, 1);
  s("specular_ior", p.specular_ior, "Index of refraction, instead of the material's.").range(1, 10);
  s("transmission_weight", p.transmission_weight, "Share of the body that is clear, instead of the material's.").range(0, 1);
  s("transmission_color", p.transmission_color, "Colour of light (red, green, blue) that has passed transmission_depth of the clear body.")
      .unit(linear_color_unit)
      .range(0, 1);
  s("transmission_depth", p.transmission_depth, "Length after which light has that colour; 0 = at once, at the boundary.").at_least(0);
  s("subsurface_weight", p.subsurface_weight, "Share of the body in which light wanders below the surface, instead of the material's.")
      .range(0, 1);
  s("subsurface_radius", p.subsurface_radius, "How far red, green and blue light get there on average, in the data's lengths.").at_least(0);
  s("subsurface_anisotropy", p.subsurface_anisotropy, "Mean cosine of the turns that it takes there; above 0 goes forward.")
      .range(-0.99, 0.99);
  s("coat_weight", p.coat_weight, "Share of the surface that has a clear coat, instead of the material's.").range(0, 1);
  s("coat_color", p.coat_color, "Colour (red, green, blue) that what is below the coat has through it.")
      .unit(linear_color_unit)
      .range(0, 1);
  s("coat_roughness", p.coat_roughness, "Roughness of that coat, instead of the material's.").range(0, 1);
  s("coat_ior", p.coat_ior, "Index of refraction of that coat, instead of the material's.").range(1, 10);
  s("retro_weight", p.retro_weight, "Share of the surface that reflects light back to where it comes from, instead of the material's.")
      .range(0, 1);
  s("emission", p.emission, "Light that the surface gives off by itself: radiance of red, green and blue.")
      .unit(linear_color_unit)
      .at_least(0);
  s("thin_walled", p.thin_walled, "The surface is a sheet, without a body behind it.");
  s("dielectric_priority", p.dielectric_priority,
    "Of clear bodies that touch or overlap: the one of the highest is there, and refracts against the others. 0 = refracts against air.")
      .range(0, 1000);
}

Vec3f own_color(const SurfaceMaterial& m) {
  const Vec3f own(m.base_color);
  return {srgb_encode(own.x), srgb_encode(own.y), srgb_encode(own.z)};
}

}  // namespace sg

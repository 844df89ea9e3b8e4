// SPDX-License-Identifier: Apache-2.0
// The words for what a surface is made of: a preset, and numbers that replace those of it.
#pragma once
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "scene/items/surface_material.h"

namespace sg {

/// Names and meanings are SurfaceMaterial's. Without specular_anisotropy: that wants a direction (varying_material.h).
struct MaterialShow {
  std::optional<MaterialPreset> material;
  std::optional<Metal> metal;
  std::optional<double> base_metalness, specular_weight, specular_roughness, specular_ior, transmission_weight, transmission_depth,
      subsurface_weight, subsurface_anisotropy, coat_weight, coat_roughness, coat_ior, retro_weight;
  std::optional<Vec3> transmission_color, subsurface_radius, coat_color, emission;
  std::optional<bool> thin_walled;
  std::optional<int> dielectric_priority;

  bool any() const;
  /// What is stated has a colour, made().base_color, in the place of those of a field.
  bool has_color() const { return material || metal; }
  /// `size`: diagonal of the body, of which lengths of presets are shares. Without a preset the plastic that data is made of; all of it
  /// becomes metal where one is stated and nothing says how much.
  SurfaceMaterial made(double size) const;
};
void describe(Schema& s, MaterialShow& p);

/// The colour of a material by itself, in sRGB.
Vec3f own_color(const SurfaceMaterial& m);
/// What is stated of the matter of lines, points and glyphs, and its own colour.
template <class Item>
void take(const MaterialShow& p, const Dataset& data, Item& item) {
  if (p.any()) item.made_of = p.made(data.bounds().diagonal());
  if (p.has_color()) item.color = own_color(*item.made_of);
}

}  // namespace sg

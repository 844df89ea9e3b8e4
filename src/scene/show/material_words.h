// SPDX-License-Identifier: Apache-2.0
// The words for what a surface is made of: a preset, and parameters that replace those of it, as numbers or by a field.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "scene/items/surface_material.h"
#include "scene/items/surface_pictures.h"

namespace sg {

/// Names and meanings are SurfaceMaterial's.
struct MaterialShow {
  std::optional<MaterialPreset> material;
  std::optional<double> base_metalness, specular_roughness, specular_ior, transmission_weight, transmission_depth, subsurface_weight,
      coat_weight, coat_roughness;
  std::optional<Vec3> transmission_color, subsurface_radius, emission;
  std::optional<bool> thin_walled;
  std::optional<int> dielectric_priority;

  bool any() const;
  /// `size`: diagonal of the body, of which lengths of presets are shares. Without a preset the plastic that data is made of.
  SurfaceMaterial made(double size) const;
};
void describe(Schema& s, MaterialShow& p);

/// Parameters of a surface that a point field multiplies.
struct MaterialFields {
  FieldName specular_roughness_by, base_metalness_by, transmission_weight_by, subsurface_weight_by, coat_weight_by, emission_by;

  bool any() const;
};
void describe(Schema& s, MaterialFields& p);

/// Adds to the pictures of a surface those that stand for the fields. What `stated` leaves open of what they or pictures multiply is full:
/// these alone decide it. Tells of values that are cut off. Throws Error(usage) for fields that are not there.
void apply(const MaterialFields& fields, const MaterialShow& stated, const Dataset& data, SurfaceMaterial& material,
           SurfacePictures& pictures, Context& context);

}  // namespace sg

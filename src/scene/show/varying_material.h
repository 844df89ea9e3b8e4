// SPDX-License-Identifier: Apache-2.0
// The words for parameters of a material that differ over a surface: by a field of its points, or by a picture on it.
#pragma once
#include <array>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "scene/items/surface_pictures.h"
#include "scene/show/material_words.h"
#include "scene/show/picture.h"

namespace sg {

struct VaryingMaterial {
  std::array<FieldName, material_factors> by;
  std::array<std::string, material_factors> pictures;  ///< files
  FieldName emission_by;
  std::string emission_picture;
  std::optional<double> specular_anisotropy;
  FieldName specular_direction;

  bool any() const { return any_picture() || any_field(); }
  bool any_picture() const;
  bool any_field() const;
};
void describe(Schema& s, VaryingMaterial& p);

/// Adds to the pictures of a surface what the words request: fields as pictures, too. What `stated` leaves open of a number that a field
/// or a picture multiplies is full, so that these alone decide it. Tells of values that are cut off, and of what shows nothing. Throws
/// Error(usage) for fields that are not there, and for what a surface cannot have.
void apply(const VaryingMaterial& varying, const MaterialShow& stated, const PictureShow& where, const Dataset& data,
           SurfaceMaterial& material, SurfacePictures& pictures, Context& context);

}  // namespace sg

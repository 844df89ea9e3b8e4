// SPDX-License-Identifier: Apache-2.0
// MaterialPalette: a material whose roughness and metalness are those of a picture, prepared for the values that it has.
#pragma once
#include <memory>
#include <vector>

#include "image/texture/texture.h"
#include "render/trace/material/material.h"

namespace sg::trace {

/// Roughness in 33 steps, metalness in 9: a Material for each pair that a texel of the picture, or a mean of texels, comes near to. What
/// lies between two texels that differ much takes the nearest pair that there is.
class MaterialPalette {
 public:
  /// `described` holds the factors; roughness is in green, metalness in blue. `length`: as of Material. Some ten milliseconds for each
  /// pair. Throws Error(usage).
  MaterialPalette(const SurfaceMaterial& described, const Texture& texture, double length = 1);

  const Material& at(float roughness_texel, float metalness_texel) const;
  /// Whether any of its materials does (Material::passes_straight()).
  bool passes_straight() const;

 private:
  static size_t pair_of(float roughness, float metalness);
  std::vector<std::shared_ptr<const Material>> materials_;  ///< of all pairs; several may share one
};

}  // namespace sg::trace

// SPDX-License-Identifier: Apache-2.0
// MaterialPalette: a material whose roughness changes from point to point, prepared for the values that are met.
#pragma once
#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "render/trace/material/material.h"

namespace sg::trace {

/// A Material for each of 33 steps of roughness and 9 of the coat's; made when a ray first asks for it, some ten milliseconds each.
class MaterialPalette {
 public:
  /// `described` holds the factors. `length`: as of Material.
  MaterialPalette(const SurfaceMaterial& described, double length) : described_(described), length_(length) {}

  /// What is described, with these shares of its roughness and of its coat's. Lives as long as the palette.
  const Material& at(float roughness, float coat_roughness) const;

 private:
  static constexpr size_t rough_steps = 33, coat_steps = 9;
  const Material& made(size_t place) const;

  SurfaceMaterial described_;
  double length_;
  mutable std::array<std::atomic<const Material*>, rough_steps * coat_steps> materials_{};
  mutable std::vector<std::unique_ptr<const Material>> owned_;
  mutable std::mutex making_;
};

}  // namespace sg::trace

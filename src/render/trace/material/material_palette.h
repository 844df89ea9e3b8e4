// SPDX-License-Identifier: Apache-2.0
// MaterialPalette: a material of which numbers that a Material is prepared for change from point to point, for the values that are met.
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "data/fields/material_table.h"
#include "render/trace/material/material.h"

namespace sg::trace {

class MaterialPalette {
 public:
  /// Those numbers: the first of MaterialFactor, roughness to coat_ior.
  static constexpr size_t numbers = size_t(MaterialFactor::coat_ior) + 1;
  using Varies = std::array<bool, numbers>;
  using Shares = std::array<float, numbers>;

  /// `described` holds the numbers that shares are of. `length`, `around`: as of Material.
  MaterialPalette(const SurfaceMaterial& described, double length, double around, Varies varies);

  /// What is described, with these shares of its numbers. Numbers are kept in steps: 33 where one varies, down to 5 where all five do; of
  /// the two next to a share the one is taken, or the other, in that proportion, by `spot`, the same for the same point. Lives as long as
  /// the palette; made when it is first asked for, some ten milliseconds each.
  const Material& at(const Shares& shares, uint32_t spot) const;

 private:
  const Material& made(size_t place) const;

  SurfaceMaterial described_;
  double length_, around_;
  std::array<uint32_t, numbers> steps_;  // 1 where a number is the same everywhere
  mutable std::vector<std::atomic<const Material*>> materials_;
  mutable std::vector<std::unique_ptr<const Material>> owned_;
  mutable std::mutex making_;
};

}  // namespace sg::trace

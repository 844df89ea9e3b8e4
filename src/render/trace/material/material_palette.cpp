// SPDX-License-Identifier: Apache-2.0
#include "render/trace/material/material_palette.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace sg::trace {

namespace {

constexpr size_t rough_steps = 33, metal_steps = 9, pairs = rough_steps * metal_steps;

size_t step_of(float v, size_t steps) { return size_t(std::clamp(v, 0.f, 1.f) * float(steps - 1) + 0.5f); }

}  // namespace

size_t MaterialPalette::pair_of(float roughness, float metalness) {
  if (!(roughness == roughness && metalness == metalness)) return 0;
  return step_of(metalness, metal_steps) * rough_steps + step_of(roughness, rough_steps);
}

MaterialPalette::MaterialPalette(const SurfaceMaterial& described, const Texture& texture, double length) : materials_(pairs) {
  std::vector<uint8_t> wanted(pairs);
  for (const Texture::Level& l : texture.levels())
    for (const Vec4f& t : l.texels) wanted[pair_of(t.y, t.z)] = 1;
  parallel_for(pairs, 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (!wanted[i]) continue;
      SurfaceMaterial m = described;
      m.specular_roughness *= double(i % rough_steps) / (rough_steps - 1), m.base_metalness *= double(i / rough_steps) / (metal_steps - 1);
      materials_[i] = std::make_shared<const Material>(m, length);
    }
  });
  // The nearest for all others; a step of metalness counts as four of roughness.
  const std::vector<std::shared_ptr<const Material>> made = materials_;
  for (size_t i = 0; i < pairs; ++i) {
    size_t least = SIZE_MAX;
    for (size_t k = 0; k < pairs; ++k) {
      if (!made[k]) continue;
      const auto apart = [](size_t a, size_t b) { return a > b ? a - b : b - a; };
      const size_t off = apart(i % rough_steps, k % rough_steps) + 4 * apart(i / rough_steps, k / rough_steps);
      if (off < least) least = off, materials_[i] = made[k];
    }
  }
}

const Material& MaterialPalette::at(float roughness, float metalness) const { return *materials_[pair_of(roughness, metalness)]; }

bool MaterialPalette::passes_straight() const {
  return std::any_of(materials_.begin(), materials_.end(), [](const auto& m) { return m && m->passes_straight(); });
}

}  // namespace sg::trace

// SPDX-License-Identifier: Apache-2.0
#include "render/trace/material/material_palette.h"

#include <algorithm>

namespace sg::trace {

namespace {

size_t step_of(float v, size_t steps) { return v == v ? size_t(std::clamp(v, 0.f, 1.f) * float(steps - 1) + 0.5f) : 0; }

}  // namespace

const Material& MaterialPalette::at(float roughness, float coat_roughness) const {
  const size_t place = step_of(coat_roughness, coat_steps) * rough_steps + step_of(roughness, rough_steps);
  const Material* known = materials_[place].load(std::memory_order_acquire);
  return known ? *known : made(place);
}

const Material& MaterialPalette::made(size_t place) const {
  const std::lock_guard lock(making_);
  if (const Material* known = materials_[place].load(std::memory_order_acquire)) return *known;
  SurfaceMaterial m = described_;
  m.specular_roughness *= double(place % rough_steps) / (rough_steps - 1);
  m.coat_roughness *= double(place / rough_steps) / (coat_steps - 1);
  owned_.push_back(std::make_unique<const Material>(m, length_, 1, true));
  materials_[place].store(owned_.back().get(), std::memory_order_release);
  return *owned_.back();
}

}  // namespace sg::trace

// SPDX-License-Identifier: Apache-2.0
#include "render/trace/material/material_palette.h"

#include <algorithm>

namespace sg::trace {

namespace {

// By how many numbers vary: so many steps of each that all their materials can be made.
constexpr uint32_t steps_of[] = {1, 33, 17, 9, 7, 5};
static_assert(std::size(steps_of) == MaterialPalette::numbers + 1);

size_t product(const std::array<uint32_t, MaterialPalette::numbers>& steps) {
  size_t all = 1;
  for (const uint32_t n : steps) all *= n;
  return all;
}

}  // namespace

MaterialPalette::MaterialPalette(const SurfaceMaterial& described, double length, double around, Varies varies)
    : described_(described),
      length_(length),
      around_(around),
      steps_([&] {
        const uint32_t steps = steps_of[std::count(varies.begin(), varies.end(), true)];
        std::array<uint32_t, numbers> all{};
        for (size_t i = 0; i < numbers; ++i) all[i] = varies[i] ? steps : 1;
        return all;
      }()),
      materials_(product(steps_)) {}

const Material& MaterialPalette::at(const Shares& shares, uint32_t spot) const {
  size_t place = 0;
  for (size_t i = 0; i < numbers; ++i) {
    if (steps_[i] == 1) continue;
    const float x = shares[i] == shares[i] ? std::clamp(shares[i], 0.f, 1.f) * float(steps_[i] - 1) : 0;
    const auto below = std::min(uint32_t(x), steps_[i] - 2);
    spot = spot * 0x9e3779b9u + 0x7f4a7c15u;
    place = place * steps_[i] + below + (float(spot >> 8) * 0x1p-24f < x - float(below) ? 1 : 0);
  }
  const Material* known = materials_[place].load(std::memory_order_acquire);
  return known ? *known : made(place);
}

const Material& MaterialPalette::made(size_t place) const {
  const std::lock_guard lock(making_);
  if (const Material* known = materials_[place].load(std::memory_order_acquire)) return *known;
  std::array<double, numbers> share;
  share.fill(1);
  size_t rest = place;
  for (size_t i = numbers; i-- > 0; rest /= steps_[i])
    if (steps_[i] > 1) share[i] = double(rest % steps_[i]) / (steps_[i] - 1);
  const auto of = [&](MaterialFactor f) { return share[size_t(f)]; };
  SurfaceMaterial m = described_;
  m.specular_roughness *= of(MaterialFactor::roughness), m.coat_roughness *= of(MaterialFactor::coat_roughness);
  m.specular_weight *= of(MaterialFactor::specular);
  m.specular_ior = 1 + (m.specular_ior - 1) * of(MaterialFactor::ior), m.coat_ior = 1 + (m.coat_ior - 1) * of(MaterialFactor::coat_ior);
  owned_.push_back(std::make_unique<const Material>(m, length_, around_, true));
  materials_[place].store(owned_.back().get(), std::memory_order_release);
  return *owned_.back();
}

}  // namespace sg::trace

// SPDX-License-Identifier: Apache-2.0
#include "render/trace/material/subsurface.h"

#include <algorithm>
#include <cmath>

#include "render/trace/sampling/warp.h"

namespace sg::trace {

DiffusionProfile::DiffusionProfile(float mean_free_path, float surface) : surface_(std::clamp(surface, 0.f, 1.f)) {
  const float beyond = surface_ - 0.8f;
  length_ = mean_free_path / (1.9f - surface_ + 3.5f * beyond * beyond);
}

float DiffusionProfile::pdf(float r) const {
  return (std::exp(-r / length_) + std::exp(-r / (3 * length_))) / (8 * pi * length_ * std::max(r, 1e-12f));
}

float DiffusionProfile::operator()(float r) const { return surface_ * pdf(r); }

float DiffusionProfile::sample(float u) const {
  // A quarter of the light falls off with one length, the rest with three.
  const bool near = u < 0.25f;
  return -std::log1p(-(near ? u * 4 : (u - 0.25f) / 0.75f)) * length_ * (near ? 1 : 3);
}

}  // namespace sg::trace

// SPDX-License-Identifier: Apache-2.0
#include "render/trace/media/collision.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/trace/sampling/local_frame.h"
#include "render/trace/sampling/warp.h"

namespace sg::trace {

float Collision::density(Vec3f along, Vec3f direction) const {
  return on_surface ? std::max(0.f, dot(direction, normal)) / std::numbers::pi_v<float> : phase.density(dot(along, direction));
}

Vec3f Collision::sample(Vec3f along, Vec2f u) const {
  if (on_surface) return normalize(LocalFrame::about(normal).to_world(cosine_hemisphere(u)));
  const float cosine = phase.sample(u.x), sine = std::sqrt(std::max(0.f, 1 - cosine * cosine));
  const float turn = 2 * std::numbers::pi_v<float> * u.y;
  return normalize(LocalFrame::about(along).to_world({sine * std::cos(turn), sine * std::sin(turn), cosine}));
}

}  // namespace sg::trace

// SPDX-License-Identifier: Apache-2.0
// What can be said of particles that do not see each other.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "simulate/particles/obstacles.h"
#include "simulate/run/frames.h"
#include "simulate/run/integrator.h"

namespace sg {

/// What all that falls and bounces has.
struct MotionParams : FrameParams {
  Integrator integrator = Integrator::verlet;
  double step = 0.01;
  std::optional<Vec3> gravity;
  double drag = 0, quadratic_drag = 0, mass = 1;
  std::vector<double> bounds;
  double restitution = 0.5, friction = 0;
};
void describe(Schema& s, MotionParams& p);

/// Of particles that move by themselves.
struct ParticleParams : MotionParams {
  std::vector<double> emitter;
  double rate = 1000, spread = 0, life = 0, tether = 0;
  int count = 0, seed = 1;
  Vec3 velocity{0, 0, 0};
};
void describe(Schema& s, ParticleParams& p);

/// What the field of the first input is to them.
enum class FieldUse : uint8_t { wind, force, none };
constexpr auto enum_words(FieldUse) {
  using enum FieldUse;
  return std::array{Word{"wind", wind}, Word{"force", force}, Word{"none", none}};
}

/// Of those that move in data.
struct ParticlesInParams : ParticleParams {
  FieldName field;
  FieldUse use = FieldUse::wind;
  double strength = 1;
};
void describe(Schema& s, ParticlesInParams& p);

namespace swarm {

/// Throws Error(usage), naming `who`, for numbers that are not finite.
void check(const MotionParams& p, const std::string& who);
/// Equal steps of a frame. Throws Error(usage) beyond a million.
size_t steps_of(const MotionParams& p, const std::string& who);
/// The walls, if any. Throws Error(usage) for a box without extent.
std::optional<Box3> box_of(const MotionParams& p, const std::string& who);
/// Walls and surfaces to bounce off.
Obstacles obstacles_of(const MotionParams& p, std::span<const DatasetPtr> surfaces, const std::string& who, Context& context);

}  // namespace swarm
}  // namespace sg

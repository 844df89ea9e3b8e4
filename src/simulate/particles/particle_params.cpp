// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/particle_params.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/text/text.h"

namespace sg {

void describe(Schema& s, MotionParams& p) {
  describe(s, static_cast<FrameParams&>(p));
  s("integrator", p.integrator, "How they are moved on: forward_euler, backward_euler and symplectic_euler of order 1, verlet 2, rk4 4.");
  s("step", p.step, "Longest step in time: a frame takes as many equal ones as that needs.").unit("time").positive();
  s("gravity", p.gravity, "Acceleration; default: 9.81 along -z, in flat data along -y.");
  s("drag", p.drag, "Force per mass and speed against the air.").at_least(0);
  s("quadratic_drag", p.quadratic_drag, "Force per mass and squared speed against the air.").at_least(0);
  s("mass", p.mass, "Mass of each, for forces that do not grow with it.").positive();
  s("bounds", p.bounds, "Walls to bounce off from inside, as x0,x1,y0,y1,z0,z1.").items(0, 6);
  s("restitution", p.restitution, "Speed across a surface after a bounce as a share of that before.").range(0, 1);
  s("friction", p.friction, "Force along a surface as a share of that across it (Coulomb).").at_least(0);
}

void describe(Schema& s, ParticleParams& p) {
  describe(s, static_cast<MotionParams&>(p));
  s("emitter", p.emitter, "Balls in which particles appear, as x,y,z,radius of each; default: one in the middle.");
  s("rate", p.rate, "Particles per time, of all emitters together.").at_least(0);
  s("count", p.count, "Particles that are there at the beginning.").at_least(0);
  s("velocity", p.velocity, "Velocity at which they appear.");
  s("spread", p.spread, "Speed added to that in a direction by chance, at most.").at_least(0);
  s("life", p.life, "Time after which one vanishes; 0: never.").unit("time").at_least(0);
  s("tether", p.tether, "Stiffness of a spring that ties each to where it appeared.").at_least(0);
  s("seed", p.seed, "Of the numbers that decide by chance.");
}

void describe(Schema& s, ParticlesInParams& p) {
  s("field", p.field, "Vector field of the first input; default: its active vectors.").takes(fields::vectors);
  s("use", p.use,
    "What it is. wind: the velocity of the air, which drag brings near; force: divided by mass, an acceleration. none: the "
    "first input is an obstacle, as further ones are.");
  s("strength", p.strength, "The field is taken times this.");
  describe(s, static_cast<ParticleParams&>(p));
}

namespace swarm {

void check(const MotionParams& p, const std::string& who) {
  const Vec3 g = p.gravity.value_or(Vec3());
  for (const auto& [value, word] : {std::pair{p.step, "step"},
                                    {p.frame, "frame"},
                                    {p.time, "time"},
                                    {p.drag, "drag"},
                                    {p.mass, "mass"},
                                    {p.quadratic_drag, "quadratic_drag"},
                                    {p.friction, "friction"},
                                    {g.x + g.y + g.z, "gravity"}})
    if (!std::isfinite(value)) fail_usage(fmt::format("{} is not finite", exact_number(value)), who + " " + word);
}

size_t steps_of(const MotionParams& p, const std::string& who) {
  const double steps = std::max(1.0, std::ceil(p.frame / p.step * (1 - 1e-12)));
  if (!(steps <= 1e6)) fail_usage("a frame of more than a million steps", who + " step", "take longer steps or shorter frames");
  return size_t(steps);
}

std::optional<Box3> box_of(const MotionParams& p, const std::string& who) {
  if (p.bounds.empty()) return {};
  if (p.bounds.size() != 6) fail_usage(fmt::format("{} numbers are no box", p.bounds.size()), who + " bounds", "give x0,x1,y0,y1,z0,z1");
  Box3 box;
  for (int a = 0; a < 3; ++a) {
    box.lo[a] = p.bounds[size_t(2 * a)], box.hi[a] = p.bounds[size_t(2 * a + 1)];
    if (!(box.lo[a] < box.hi[a]) || !std::isfinite(box.lo[a]) || !std::isfinite(box.hi[a]))
      fail_usage(fmt::format("the box extends from {} to {} along {}", exact_number(box.lo[a]), exact_number(box.hi[a]), "xyz"[a]),
                 who + " bounds", "give finite numbers, the lower one first");
  }
  return box;
}

Obstacles obstacles_of(const MotionParams& p, std::span<const DatasetPtr> surfaces, const std::string& who, Context& context) {
  Obstacles o({p.restitution, p.friction});
  if (const auto box = box_of(p, who)) o.set_box(*box);
  for (const DatasetPtr& s : surfaces) o.add(s, who, context);
  return o;
}

}  // namespace swarm
}  // namespace sg

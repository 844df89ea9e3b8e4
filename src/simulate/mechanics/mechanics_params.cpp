// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/text/text.h"
#include "simulate/mechanics/examples.h"
#include "simulate/mechanics/mechanics.h"

namespace sg {

void describe(Schema& s, MechanicsParams& p) {
  s("system", p.system, "What moves. expression: what kinetic, potential and coordinates say.");
  describe(s, static_cast<FrameParams&>(p));
  s("integrator", p.integrator,
    "How it is moved on. forward_euler gains energy, backward_euler loses it; symplectic_euler (order 1) and verlet (order 2) keep it "
    "bounded; rk4 is of order 4.");
  s("step", p.step, "Longest step in time: a frame takes as many equal ones as that needs.").unit("time").positive();
  s("start", p.start, "Coordinates at the beginning: angles from straight down in radians, or x,y of the orbit.");
  s("speed", p.speed, "Their speeds at the beginning.");
  s("mass", p.mass, "Mass of each body; default: 1, in nets 0.1.");
  s("length", p.length, "Length of each rod, or of the net's side; default: 1.");
  s("gravity", p.gravity, "Acceleration downwards: along -y, in nets along -z.");
  s("stiffness", p.stiffness, "Force per length of the net's springs.").positive();
  s("pull", p.pull, "Acceleration towards the sun at distance 1, in orbits.");
  s("size", p.size, "Masses along a side of the net.").range(2, 16);
  s("trail", p.trail, "Frames through which the way of the last body is seen.").range(0, 100000);
  s("rods", p.rods, "Lines that join the bodies.");
  s("coordinates", p.coordinates, "Names of the coordinates in expressions; the speed of one is its name with _dot.");
  s("kinetic", p.kinetic, "Kinetic energy, an expression as in calc of coordinates and speeds.");
  s("potential", p.potential, "Potential energy, an expression of the coordinates; default: 0.");
  s("places", p.places, "Where bodies are, by expressions of the coordinates: x; y; z of each. Lines join them, from 0,0,0 on.");
}

namespace mechanics {

namespace {

// The list, or `usual` of each where it is empty. Throws for another length, and numbers that are not finite (or positive).
std::vector<double> list_of(const std::vector<double>& given, size_t count, double usual, const char* word, bool positive) {
  if (given.empty()) return std::vector<double>(count, usual);
  if (given.size() != count)
    fail_usage(fmt::format("{} numbers where {} are needed", given.size(), count), fmt::format("mechanics {}", word));
  for (const double v : given)
    if (!std::isfinite(v) || (positive && v <= 0))
      fail_usage(fmt::format("{} is not {}", exact_number(v), positive ? "positive and finite" : "finite"),
                 fmt::format("mechanics {}", word), positive ? "bodies have a mass above 0, rods a length above 0" : "");
  return given;
}

}  // namespace

std::shared_ptr<const System> system_of(const MechanicsParams& p) {
  for (const auto& [value, word] : {std::pair{p.gravity, "gravity"}, {p.stiffness, "stiffness"}, {p.pull, "pull"}, {p.step, "step"}})
    if (!std::isfinite(value)) fail_usage(fmt::format("{} is not finite", exact_number(value)), fmt::format("mechanics {}", word));
  switch (p.system) {
    case MechanicalSystem::pendulum:
    case MechanicalSystem::double_pendulum: {
      const size_t n = p.system == MechanicalSystem::pendulum ? 1 : 2;
      return std::make_shared<SystemOf<PendulumChain>>(
          PendulumChain{list_of(p.mass, n, 1, "mass", true), list_of(p.length, n, 1, "length", true),
                        list_of(p.start, n, n == 1 ? 1.5 : 2.2, "start", false), list_of(p.speed, n, 0, "speed", false), p.gravity});
    }
    case MechanicalSystem::spring_net: {
      if (!p.start.empty() || !p.speed.empty()) fail_usage("the net begins at rest, level", "mechanics", "leave start and speed away");
      return std::make_shared<SystemOf<SpringNet>>(
          SpringNet(p.size, list_of(p.mass, 1, 0.1, "mass", true)[0], list_of(p.length, 1, 1, "length", true)[0], p.stiffness, p.gravity));
    }
    case MechanicalSystem::orbit: {
      std::vector<double> at = p.start.empty() ? std::vector<double>{1, 0} : list_of(p.start, 2, 0, "start", false);
      std::vector<double> v = p.speed.empty() ? std::vector<double>{0, 1.2} : list_of(p.speed, 2, 0, "speed", false);
      if (at[0] == 0 && at[1] == 0) fail_usage("the planet begins in the sun", "mechanics start", "give it a distance");
      return std::make_shared<SystemOf<Orbit>>(Orbit{list_of(p.mass, 1, 1, "mass", true)[0], p.pull, at, v});
    }
    case MechanicalSystem::expression: {
      list_of(p.start, p.start.empty() ? 0 : p.coordinates.size(), 0, "start", false);
      list_of(p.speed, p.speed.empty() ? 0 : p.coordinates.size(), 0, "speed", false);
      return expression_system(p);
    }
  }
  return {};
}

}  // namespace mechanics
}  // namespace sg

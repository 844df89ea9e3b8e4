// SPDX-License-Identifier: Apache-2.0
// Motion of mechanical systems whose energies are known: pendulums, nets of springs, orbits, and what an expression says.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "simulate/mechanics/motion.h"
#include "simulate/run/frames.h"
#include "simulate/run/integrator.h"

namespace sg {

enum class MechanicalSystem : uint8_t { pendulum, double_pendulum, spring_net, orbit, expression };
constexpr auto enum_words(MechanicalSystem) {
  using enum MechanicalSystem;
  return std::array{Word{"pendulum", pendulum}, Word{"double_pendulum", double_pendulum}, Word{"spring_net", spring_net},
                    Word{"orbit", orbit}, Word{"expression", expression}};
}

struct MechanicsParams : FrameParams {
  MechanicalSystem system = MechanicalSystem::double_pendulum;
  Integrator integrator = Integrator::verlet;
  double step = 0.005;
  std::vector<double> start, speed, mass, length;
  double gravity = 9.81, stiffness = 100, pull = 1;
  int size = 6, trail = 100;
  bool rods = true;
  std::vector<std::string> coordinates;
  std::string kinetic, potential, places;
};
void describe(Schema& s, MechanicsParams& p);

namespace mechanics {
/// The system that the parameters ask for. Throws Error(usage) for lists of a wrong length, masses and lengths that are not positive and
/// finite, expressions with mistakes.
std::shared_ptr<const System> system_of(const MechanicsParams& p);
/// That of energies in expressions, system=expression.
std::shared_ptr<const System> expression_system(const MechanicsParams& p);
}  // namespace mechanics

/// A surface mesh of vertices (the bodies, resting ones too), lines (their rods, and the way of the last body through the last `trail`
/// frames) with the point fields velocity and age (time since the point was reached), and, with one value per frame from 0 on, the fields
/// of the whole: moment, kinetic, potential, total and drift, the change of the total energy since the beginning as a share of the largest
/// kinetic energy so far. Throws Error(usage) for singular mass matrices, Error(data) naming the frame where the motion blows up.
DatasetPtr mechanics_source(const MechanicsParams& p, Context& context);
RunCost cost_of_mechanics(const MechanicsParams& p);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Every simulator that stores its state goes on from it to the same bytes.
#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "simulate/fluid/water/flip.h"
#include "simulate/liquid/liquid.h"
#include "simulate/mechanics/mechanics.h"
#include "simulate/particles/bodies/nbody.h"
#include "simulate/particles/particle_run.h"
#include "simulate/pde/advection_diffusion.h"
#include "simulate/pde/heat.h"
#include "simulate/pde/reaction_diffusion.h"
#include "simulate/pde/wave.h"
#include "simulate/run/frames.h"
#include "simulate/run/stored.h"
#include "support/test.h"

using namespace sg;
using test::goes_on;

TEST_CASE("runs: every simulator on a grid goes on from its stored state to the same bytes") {
  Context context;
  {
    HeatParams p, other;
    p.size = 12, p.source = "x*sin(time)", p.frame = 0.1, p.x0 = "time", other.size = 4;
    for (const HeatScheme scheme : {HeatScheme::explicit_euler, HeatScheme::crank_nicolson, HeatScheme::backward_euler}) {
      p.scheme = scheme;
      goes_on("heat", p, other, [&](const HeatParams& q) { return heat(q, context); });
    }
  }
  {
    WaveParams p, other;
    p.size = 16, p.frame = 0.05, p.sides = "absorbing", p.y0 = "sin(9*time)", p.source = "time", other.size = 4;
    goes_on("wave", p, other, [&](const WaveParams& q) { return wave(q, context); });
  }
  {
    ReactionDiffusionParams p, other;
    p.size = 20, p.frame = 4, other.size = 4;
    goes_on("reaction_diffusion", p, other, [&](const ReactionDiffusionParams& q) { return reaction_diffusion(q, context); });
  }
  {
    AdvectionDiffusionParams p, other;
    p.size = 20, p.velocity = "vec(1+time,-y,0)", p.frame = 0.03, p.source = "time", other.size = 4;
    goes_on("advection_diffusion", p, other, [&](const AdvectionDiffusionParams& q) { return advection_diffusion(q, context); });
  }
}

TEST_CASE("runs: water goes on from its stored state") {
  Context context;
  {
    FlipLiquidParams p, other;
    p.size = 24, p.bounds = {0, 2, 0, 1, 0, 0}, p.frame = 0.05, other.size = 8;
    for (const fluid::Transfer transfer : {fluid::Transfer::flip, fluid::Transfer::apic}) {
      p.transfer = transfer;
      goes_on("flip_liquid", p, other, [&](const FlipLiquidParams& q) { return flip_liquid(q, context); });
    }
  }
}

TEST_CASE("runs: mechanical systems go on from their stored states, with their energies and the trail") {
  Context context;
  for (const MechanicalSystem system :
       {MechanicalSystem::double_pendulum, MechanicalSystem::spring_net, MechanicalSystem::orbit, MechanicalSystem::expression})
    for (const Integrator i : {Integrator::forward_euler, Integrator::backward_euler, Integrator::verlet, Integrator::rk4}) {
      MechanicsParams p, other;
      p.system = system, p.integrator = i, p.size = 3, p.trail = 3, p.step = 0.001;
      if (system == MechanicalSystem::expression)
        p.coordinates = {"s"}, p.kinetic = "(1+4*s^2)*s_dot^2/2", p.potential = "9.81*s^2", p.start = {1}, p.places = "s; s^2; 0";
      other.gravity = 1;
      goes_on("mechanics", p, other, [&](const MechanicsParams& q) { return mechanics_source(q, context); });
    }
  // Lists that do not fit together.
  MechanicsParams p, other;
  p.store = test::fresh_folder("stored_energies") + "run", p.time = 2 * p.frame, other.gravity = 1;
  mechanics_source(p, context);
  const std::string key = StateFile(p.store).key();
  for (const size_t energies : {0u, 2u, 3u}) {
    {
      StateWriter file(p.store, key, 2);
      for (int i = 0; i < 4; ++i) file.add(std::vector<double>(2, 0.5));
      file.add(std::vector<double>{1});
      for (int i = 0; i < 5; ++i) file.add(std::vector<double>(i == 3 ? energies : size_t(3), 1.0));
      file.add(std::vector<double>());
      file.commit();
    }
    mechanics_source(other, context);
    p.time = 3 * p.frame;
    if (energies == 3) CHECK_NOTHROW(mechanics_source(p, context));
    else CHECK_THROWS_WITH_AS(mechanics_source(p, context), doctest::Contains("other sizes"), Error);
  }
}

TEST_CASE("runs: particles, stars and smoothed particles go on from their stored states") {
  Context context;
  {
    ParticleParams p, other;
    p.rate = 300, p.frame = 0.1, p.life = 0.45, p.tether = 2, p.spread = 0.5, other.count = 3;
    goes_on("particle_system", p, other, [&](const ParticleParams& q) { return particle_system(q, context); });
  }
  {
    NbodyParams p, other;
    p.count = 60, other.count = 2;
    for (const double angle : {0.0, 0.5}) {
      p.angle = angle;
      goes_on("nbody", p, other, [&](const NbodyParams& q) { return nbody(q, context); });
    }
  }
  {
    LiquidParams p, other;
    p.size = 24, p.frame = 0.05, other.size = 8;
    goes_on("liquid", p, other, [&](const LiquidParams& q) { return liquid_source(q, context); });
  }
}

TEST_CASE("runs: a state whose sum is right and whose lengths do not fit together is refused") {
  Context context;
  ParticleParams p;
  p.rate = 100, p.frame = 0.1, p.store = test::fresh_folder("stored_lengths") + "run", p.time = 0.2;
  particle_system(p, context);
  const std::string key = StateFile(p.store).key();
  ParticleParams other;
  for (const size_t velocities : {2u, 3u, 4u})
    for (const uint64_t frame : {1u, 2u}) {
      {
        StateWriter file(p.store, key, frame);
        file.add(std::vector<uint64_t>{1, 0, 3}), file.add(std::vector<Vec3>(3)), file.add(std::vector<Vec3>(velocities));
        file.add(std::vector<Vec3>()), file.add(std::vector<double>(3)), file.add(std::vector<int64_t>(3));
        file.commit();
      }
      particle_system(other, context);
      if (velocities == 3 && frame == 1) CHECK_NOTHROW(particle_system(p, context));
      else CHECK_THROWS_WITH_AS(particle_system(p, context), doctest::Contains("other sizes"), Error);
    }
  StateWriter short_file(p.store, key, 1);
  short_file.add(std::vector<uint64_t>{1, 0, 3});
  short_file.commit();
  particle_system(other, context);
  CHECK_THROWS_WITH_AS(particle_system(p, context), doctest::Contains("other sizes"), Error);
}

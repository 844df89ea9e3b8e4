// SPDX-License-Identifier: Apache-2.0
// Every simulator that stores its state goes on from it to the same bytes.
#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "simulate/fluid/water/flip.h"
#include "simulate/liquid/liquid.h"
#include "simulate/particles/bodies/nbody.h"
#include "simulate/particles/particle_run.h"
#include "simulate/pde/advection_diffusion.h"
#include "simulate/pde/heat.h"
#include "simulate/pde/mesh/heat_on_mesh.h"
#include "simulate/pde/reaction_diffusion.h"
#include "simulate/pde/wave.h"
#include "simulate/run/frames.h"
#include "support/test.h"

using namespace sg;

namespace {

std::string fields_of(const DatasetPtr& d) {
  std::string out;
  for (const Field& f : d->fields()) {
    out += f.name;
    for (size_t i = 0; i < f.array.count(); ++i)
      for (int c = 0; c < f.components(); ++c) {
        const double v = f.array.get(i, c);
        out.append(reinterpret_cast<const char*>(&v), sizeof v);
      }
  }
  return out;
}

// `run` shows a frame of the parameters; the run of `other` ones takes the place of what is kept in memory.
template <class Params, class Run>
void goes_on(const char* name, Params p, Params other, Run&& run) {
  INFO(name);
  const auto afresh = [&](const Params& q) {
    run(other);
    return fields_of(run(q));
  };
  p.time = 7 * p.frame;
  const std::string unbroken = afresh(p);
  Params stored = p;
  stored.store = test::fresh_folder(std::string("stored_") + name) + "run", stored.time = 4 * p.frame;
  afresh(stored);
  CHECK(StateFile(stored.store).frame() == 4);
  stored.time = p.time;
  CHECK(afresh(stored) == unbroken);
}

}  // namespace

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

TEST_CASE("runs: water goes on from its stored state, and runs in given data are not stored") {
  Context context;
  {
    HeatParams room;
    room.size = 9;
    const DatasetPtr mesh = heat(room, context);
    HeatOnMeshParams p;  // nothing in its state would tell which mesh it was
    p.initial = "x", p.store = test::fresh_folder("stored_heat_on_mesh") + "run";
    CHECK_THROWS_WITH_AS(heat_on_mesh(mesh, p, context), doctest::Contains("given data cannot be stored"), Error);
  }
  {
    FlipLiquidParams p, other;
    p.size = 24, p.bounds = {0, 2, 0, 1, 0, 0}, p.frame = 0.05, other.size = 8;
    for (const fluid::Transfer transfer : {fluid::Transfer::flip, fluid::Transfer::apic}) {
      p.transfer = transfer;
      goes_on("flip_liquid", p, other, [&](const FlipLiquidParams& q) { return flip_liquid(q, context); });
    }
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

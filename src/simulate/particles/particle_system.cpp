// SPDX-License-Identifier: Apache-2.0
// The source and the filter.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "filter/flow/flow_field.h"
#include "simulate/particles/particle_run.h"
#include "simulate/run/frames.h"

namespace sg {

namespace {

// Of those that are there on the mean.
RunCost cost_of_particles(const ParticleParams& p, const std::string& who, double seconds_each) {
  swarm::check(p, who);
  const double lasting = p.life > 0 ? std::min(p.life, p.time) : p.time;
  const double last = (p.life > 0 && p.life < p.time ? 0 : p.count) + p.rate * lasting;
  const double mean = p.life > 0 && p.life < p.time ? p.rate * p.life : p.count + p.rate * p.time / 2;
  return cost_of_run(p, who, uint64_t(std::clamp(last, 0.0, 1e9)) * 64, std::max(mean, 1.0) * seconds_each,
                     double(swarm::steps_of(p, who)));
}

}  // namespace

RunCost cost_of_particle_system(const ParticleParams& p) { return cost_of_particles(p, "particle_system", 1.2e-8); }
RunCost cost_of_particle_system_in(const ParticlesInParams& p) { return cost_of_particles(p, "particle_system_in", 3.5e-8); }

DatasetPtr particle_system(const ParticleParams& p, Context& context) {
  using Run = swarm::ParticleRun;
  swarm::check(p, "particle_system");
  return frame_of_run<Run>(
      "particle_system", p,
      [&] {
        ParticlesInParams all;
        static_cast<ParticleParams&>(all) = p;
        return std::make_unique<Run>(all, "particle_system", nullptr, std::vector<DatasetPtr>(), context);
      },
      context);
}

DatasetPtr particle_system_in(const std::vector<Data>& inputs, const ParticlesInParams& p, Context& context) {
  using Run = swarm::ParticleRun;
  swarm::check(p, "particle_system_in");
  std::vector<DatasetPtr> data;
  GivenData given;
  for (const Data& d : inputs) {
    data.push_back(single_dataset(d, "particle_system_in"));
    if (data.size() > 1 || p.use == FieldUse::none) given.add(data.back());
    else given.add(data.back(), {&flow_field_of(*data[0], p.field.name, "particle_system_in")});
  }
  return frame_of_run<Run>(
      "particle_system_in", p,
      [&] {
        return std::make_unique<Run>(p, "particle_system_in", data[0], std::vector<DatasetPtr>(data.begin() + 1, data.end()), context);
      },
      context, given);
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// The source and the filter.
#include <memory>
#include <vector>

#include "filter/flow/flow_field.h"
#include "simulate/particles/particle_run.h"
#include "simulate/run/frames.h"

namespace sg {

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

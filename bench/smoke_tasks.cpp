// SPDX-License-Identifier: Apache-2.0
// A step of the smoke solver, and beside it the time in which the machine reads and writes all of its fields once.
#include <fmt/core.h>

#include <memory>

#include "base/parallel.h"
#include "bench.h"
#include "simulate/fluid/smoke.h"

namespace sg::bench {

namespace {

// Plumes that are well on their way, of which every frame is one step.
SmokeParams params(int size, bool obstacle) {
  SmokeParams p;
  p.size = size, p.bounds = {0, 1, 0, 1, 0, 1}, p.frame = 0.4 / size, p.swirl = 1;
  p.source = {0.5, 0.5, 0.15, 0.1};
  if (obstacle) p.obstacle = {0.5, 0.5, 0.6, 0.15};
  return p;
}

}  // namespace

void add_smoke_tasks(std::vector<Task>& tasks) {
  for (const int size : {64, 128, 256}) {
    for (const bool obstacle : {false, true})
      tasks.push_back(
          {"smoke_step", fmt::format("{}^3{}", size, obstacle ? " round a ball" : ""), "sightglass:maccormack", "iterations", [=] {
             auto run = std::make_shared<fluid::Smoke<float>>(params(size, obstacle), fluid::SmokeInput(), Context());
             for (int i = 0; i < 10; ++i) run->advance(Context());
             return [=] {
               run->advance(Context());
               return double(run->solved().iterations);
             };
           }});
    tasks.push_back({"smoke_fields", fmt::format("{}^3", size), "machine:read and write once", "bytes", [=] {
                       auto fields = std::make_shared<std::vector<float>>(size_t(size) * size * size * 6, 1.0f);
                       return [=] {
                         parallel_for(fields->size(), 1 << 16, [&](size_t begin, size_t end) {
                           float* const v = fields->data();
                           for (size_t i = begin; i < end; ++i) v[i] = v[i] * 0.999f + 0.001f;
                         });
                         return 2.0 * double(fields->size() * sizeof(float));
                       };
                     }});
  }
}

}  // namespace sg::bench

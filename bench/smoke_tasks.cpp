// SPDX-License-Identifier: Apache-2.0
// A step of the smoke solver, and beside it the time in which the machine reads and writes all of its fields once; the pressure of eddies
// of every size, and how many iterations it takes.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "base/parallel.h"
#include "bench.h"
#include "simulate/fluid/pressure/project.h"
#include "simulate/fluid/smoke.h"
#include "simulate/fluid/walls/solids.h"

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

// Eddies from the size of the box down to a few cells, open above, from pressure 0 on.
std::function<double()> projection(int size, bool obstacle) {
  struct Room {
    fluid::MacGrid grid;
    fluid::Projection<float> projection;
    fluid::Faces<float> before, u;
    fluid::Lattice<float> p;
    std::array<fluid::Lattice<float>, 5> spare;
  };
  const Context context;
  const SmokeParams p = params(size, obstacle);
  const fluid::MacGrid g = fluid::smoke_grid(p, context);
  const fluid::Solids solids(p, {}, g);
  const auto room = std::make_shared<Room>(
      Room{g, {g, solids.walls<float>(fluid::sides_of(p, g, Vec3(0, 0, 1)), 0, context)}, fluid::make_faces<float>(g), {}, {}, {}});
  room->p = fluid::Lattice<float>(g.cells);
  for (size_t a = 0; a < 3; ++a) {
    fluid::Lattice<float>& l = room->before[a];
    parallel_for(l.rows(), 16, [&](size_t begin, size_t end) {
      for (size_t row = begin; row < end; ++row)
        for (size_t i = 0; i < l.n[0]; ++i) {
          const double x = double(i) / size, y = double(row % l.n[1]) / size, z = double(row / l.n[1]) / size;
          double v = 0;
          for (double k = 3; k < size; k *= 3)
            v += std::sin(k * (x + 0.3 * double(a))) * std::cos(1.3 * k * y + z) * std::sin(0.7 * k * z + 1) / std::sqrt(k);
          l.row(row)[i] = float(v);
        }
    });
  }
  return [room] {
    room->u = room->before;
    std::fill(room->p.values.begin(), room->p.values.end(), 0.0f);
    return double(room->projection.apply(room->u, room->p, 1e-5, room->spare, Context()).iterations);
  };
}

}  // namespace

void add_smoke_tasks(std::vector<Task>& tasks, bool large) {
  for (const int size : {64, 128, 256, 512}) {  // 512^3: 10 GB, with --only smoke_pressure alone
    if (size == 512 && !large) continue;
    for (const bool obstacle : {false, true})
      tasks.push_back({"smoke_pressure", fmt::format("{}^3{}", size, obstacle ? " round a ball" : ""), "sightglass:multigrid-pcg",
                       "iterations", [=] { return projection(size, obstacle); }});
  }
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

// SPDX-License-Identifier: Apache-2.0
// Sixteen steps, through which particles are brought in order once, of a million particles in the wind of a 128^3 grid, with a ball of
// triangles in their way; and of stars that pull each other.
#include <fmt/core.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "bench.h"
#include "filter/scalar/contour/contour.h"
#include "simulate/particles/bodies/nbody.h"
#include "simulate/particles/particle_run.h"
#include "simulate/scalar_fields.h"

namespace sg::bench {

namespace {

/// Eddies over [-1,1]^3, f32.
DatasetPtr eddies(size_t n) {
  UniformGrid g;
  g.dims = {n, n, n}, g.origin = {-1, -1, -1}, g.spacing = Vec3(1, 1, 1) * (2.0 / double(n - 1));
  float* v = nullptr;
  Array values = Array::make<float>(n * n * n, 3, &v);
  const double k = std::numbers::pi;
  for (size_t i = 0; i < n * n * n; ++i) {
    const Vec3 p = g.origin + g.spacing * Vec3(double(i % n), double(i / n % n), double(i / n / n));
    v[3 * i] = float(std::sin(k * p.x) * std::cos(k * p.y)), v[3 * i + 1] = float(-std::cos(k * p.x) * std::sin(k * p.y));
    v[3 * i + 2] = float(0.2 * std::sin(k * p.z));
  }
  FieldSet fields;
  fields.add({"velocity", Association::point, std::move(values), "", Role::vectors});
  return make_dataset(g, std::move(fields));
}

std::function<double()> particle_step(Integrator scheme, bool wind, bool obstacle) {
  Context context;
  ParticlesInParams p;
  p.count = 1000000, p.rate = 0, p.drag = 2, p.integrator = scheme, p.gravity = Vec3(0, 0, -0.1), p.use = FieldUse::wind;
  p.emitter = {0, 0, 0, 0.95}, p.bounds = {-1, 1, -1, 1, -1, 1};
  if (!wind) p.use = FieldUse::none;
  std::vector<DatasetPtr> surfaces;
  if (obstacle) {
    SphereParams ball;
    ball.grid.size = 64, ball.grid.bounds = {-1, 1, -1, 1, -1, 1}, ball.radius = 0.3;
    surfaces.push_back(contour(sphere(ball, context), {.values = {0}}, context));
  }
  const auto run = std::make_shared<swarm::ParticleRun>(p, "particle_system_in", wind ? eddies(128) : nullptr, surfaces, context);
  const auto at = std::make_shared<double>(0);
  return [run, at] {
    Context here;
    for (int k = 0; k < 16; ++k) run->step(*at, 0.005, here), *at += 0.005;
    return 16 * double(run->places().size());
  };
}

std::function<double()> star_step(int count, double angle) {
  Context context;
  NbodyParams p;
  p.count = count, p.angle = angle;
  const auto run = std::make_shared<swarm::NbodyRun>(p, context);
  return [run, count] {
    Context here;
    run->step(0.001, here);
    return double(count);
  };
}

}  // namespace

void add_particle_tasks(std::vector<Task>& tasks) {
  for (const auto& [scheme, name] : {std::pair{Integrator::symplectic_euler, "symplectic_euler"}, {Integrator::verlet, "verlet"}}) {
    tasks.push_back({"particle_steps", "16x1M_free", fmt::format("sightglass:{}", name), "particles",
                     [scheme = scheme] { return particle_step(scheme, false, false); }});
    tasks.push_back({"particle_steps", "16x1M_wind", fmt::format("sightglass:{}", name), "particles",
                     [scheme = scheme] { return particle_step(scheme, true, false); }});
    tasks.push_back({"particle_steps", "16x1M_wind_ball", fmt::format("sightglass:{}", name), "particles",
                     [scheme = scheme] { return particle_step(scheme, true, true); }});
  }
  tasks.push_back({"star_step", "100k_angle0.5", "sightglass:verlet", "bodies", [] { return star_step(100000, 0.5); }});
  tasks.push_back({"star_step", "10k_pairs", "sightglass:verlet", "bodies", [] { return star_step(10000, 0); }});
}

}  // namespace sg::bench

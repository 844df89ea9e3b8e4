// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/bodies/nbody.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "base/error.h"
#include "base/random.h"
#include "base/text/text.h"

namespace sg {

void describe(Schema& s, NbodyParams& p) {
  describe(s, static_cast<FrameParams&>(p));
  s("bodies", p.bodies, "x,y,z,vx,vy,vz,mass of each body; default: clusters of stars.");
  s("clusters", p.clusters, "Clusters of mass 1 and radius 1 (Plummer) in a row along x.").range(1, 16);
  s("count", p.count, "Stars of all clusters together.").at_least(2);
  s("apart", p.apart, "Distance from cluster to cluster.").at_least(0);
  s("aside", p.aside, "How far along y a cluster will pass the next one.");
  s("speed", p.speed, "Speed at which clusters come together.");
  s("seed", p.seed, "Of the numbers that decide by chance.");
  s("constant", p.constant, "Constant of gravity.");
  s("softening", p.softening, "Length within which bodies do not feel that they are points.").at_least(0);
  s("angle", p.angle, "Angle below which a group of bodies is seen as one (Barnes, Hut); 0: every pair by itself.").range(0, 1);
  s("integrator", p.integrator, "How they are moved on: forward_euler, backward_euler and symplectic_euler of order 1, verlet 2, rk4 4.");
  s("step", p.step, "Longest step in time: a frame takes as many equal ones as that needs.").unit("time").positive();
}

namespace swarm {

namespace {

Vec3 on_sphere(double u, double w) {
  const double z = 2 * u - 1, across = std::sqrt((1 - z) * (1 + z)), turn = 2 * std::numbers::pi * w;
  return {across * std::cos(turn), across * std::sin(turn), z};
}

// A star of Plummer's model of mass, radius and constant 1 (Aarseth, Henon, Wielen 1974), within radius 8.
std::pair<Vec3, Vec3> plummer_star(uint64_t seed, uint64_t star) {
  uint64_t next = star << 10;
  const auto chance = [&] { return random_unit(seed, next++); };
  const double within = std::pow(64.0 / 65, 1.5), r = 1 / std::sqrt(std::pow(std::max(1e-12, within * chance()), -2.0 / 3) - 1);
  const double a = chance(), b = chance();
  const Vec3 x = r * on_sphere(a, b);
  double q = 0;  // speed as a share of that of escape, of density q^2 (1 - q^2)^(7/2)
  for (int k = 0; k < 200; ++k) {
    q = chance();
    if (0.1 * chance() < q * q * std::pow(1 - q * q, 3.5)) break;
  }
  const double c = chance(), d = chance();
  return {x, q * std::sqrt(2 / std::sqrt(1 + r * r)) * on_sphere(c, d)};
}

}  // namespace

NbodyRun::NbodyRun(const NbodyParams& p, Context& context) : params_(p), pull_{p.constant, p.softening, p.angle} {
  if (!std::isfinite(p.step + p.frame + p.constant + p.softening + p.apart + p.aside + p.speed))
    fail_usage("step, frame, constant, softening, apart, aside and speed are finite numbers", "nbody");
  if (p.count > 50000000 || (context.memory_limit && p.count * 400.0 > double(context.memory_limit)))
    fail_usage(fmt::format("{} stars are more than there is memory for", p.count), "nbody count", "ask for fewer");
  if (p.bodies.size() % 7 != 0)
    fail_usage(fmt::format("{} numbers are no bodies", p.bodies.size()), "nbody bodies", "give x,y,z,vx,vy,vz,mass of each");
  for (size_t i = 0; i < p.bodies.size(); i += 7) {
    const double* b = &p.bodies[i];
    for (int k = 0; k < 7; ++k)
      if (!std::isfinite(b[k])) fail_usage(fmt::format("body {} has a number that is not finite", i / 7), "nbody bodies");
    if (!(b[6] > 0)) fail_usage(fmt::format("body {} has the mass {}", i / 7, exact_number(b[6])), "nbody bodies", "masses are above 0");
    x_.emplace_back(b[0], b[1], b[2]), v_.emplace_back(b[3], b[4], b[5]), mass_.push_back(b[6]), cluster_.push_back(int64_t(i / 7));
  }
  if (p.bodies.empty())
    for (int i = 0; i < p.count; ++i) {
      const int c = int(int64_t(i) * p.clusters / p.count);
      auto [x, v] = plummer_star(uint64_t(p.seed), uint64_t(i));
      const double side = c - (p.clusters - 1) / 2.0;
      v *= std::sqrt(std::max(0.0, p.constant));
      x_.push_back(x + side * Vec3(p.apart, p.aside, 0)), v_.push_back(v - (side > 0 ? 1 : side < 0 ? -1 : 0) * Vec3(p.speed / 2, 0, 0));
      mass_.push_back(double(p.clusters) / p.count), cluster_.push_back(c);
    }
  note(context);
}

void NbodyRun::pull(std::span<const Vec3> x, std::span<Vec3> a, const Context& context) {
  if (!std::equal(x.begin(), x.end(), pulled_at_.begin(), pulled_at_.end())) {
    pulled_at_.assign(x.begin(), x.end());
    pull_there_.resize(x.size()), potential_of_.resize(x.size());
    if (pull_.angle == 0) pull_directly(pull_, x, mass_, pull_there_, potential_of_, &context);
    else Octree(x, mass_, &context).pull(pull_, pull_there_, potential_of_, &context);
  }
  std::copy(pull_there_.begin(), pull_there_.end(), a.begin());
}

void NbodyRun::step(double h, const Context& context) {
  const auto forces = [&](std::span<const Vec3> x, std::span<const Vec3>, double, std::span<Vec3> a) {
    for (size_t i = 0; i < x.size(); ++i)
      if (!std::isfinite(x[i].x + x[i].y + x[i].z))
        fail_data(fmt::format("body {} grew beyond all numbers in frame {} (time {:.6g})", i, moment_.size(),
                              double(moment_.size()) * params_.frame),
                  "nbody", "shorter steps or a larger softening stand close encounters");
    pull(x, a, context);
  };
  swarm::advance(params_.integrator, forces, 0, h, x_, v_, scratch_, true);
}

void NbodyRun::advance(const Context& context) {
  const double steps = std::max(1.0, std::ceil(params_.frame / params_.step * (1 - 1e-12)));
  if (!(steps <= 1e6)) fail_usage("a frame of more than a million steps", "nbody step", "take longer steps or shorter frames");
  for (int k = 0; k < int(steps); ++k) {
    context.check();
    step(params_.frame / steps, context);
  }
  note(context);
}

void NbodyRun::note(const Context& context) {
  const size_t n = x_.size();
  std::vector<Vec3> a(n);
  pull(x_, a, context);
  double kinetic = 0, potential = 0;
  Vec3 momentum, angular;
  for (size_t i = 0; i < n; ++i) {
    kinetic += mass_[i] / 2 * dot(v_[i], v_[i]), potential += mass_[i] / 2 * potential_of_[i];
    momentum += mass_[i] * v_[i], angular += mass_[i] * cross(x_[i], v_[i]);
  }
  if (!std::isfinite(kinetic + potential))
    fail_data(fmt::format("the energy grew beyond all numbers in frame {}", moment_.size()), "nbody",
              "shorter steps or a larger softening stand close encounters");
  moment_.push_back(double(moment_.size()) * params_.frame);
  kinetic_.push_back(kinetic), potential_.push_back(potential), total_.push_back(kinetic + potential);
  for (int c = 0; c < 3; ++c) momentum_.push_back(momentum[c]), angular_.push_back(angular[c]);
}

bool NbodyRun::consistent() const {
  const size_t n = moment_.size();
  return n > 0 && kinetic_.size() == n && potential_.size() == n && total_.size() == n && momentum_.size() == 3 * n &&
         angular_.size() == 3 * n;
}

void NbodyRun::resume(const Context& context) {
  std::vector<Vec3> a(x_.size());
  pull(x_, a, context);
}

DatasetPtr NbodyRun::dataset(const Context&) const {
  std::vector<double> xyz, velocity;
  for (size_t i = 0; i < x_.size(); ++i)
    for (int c = 0; c < 3; ++c) xyz.push_back(x_[i][c]), velocity.push_back(v_[i][c]);
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::move(xyz), 3);
  DatasetParts parts;
  parts.mesh = std::move(cloud);
  parts.time = moment_.back();
  parts.fields.add({"potential", Association::point, Array::from_vector(potential_of_), "", Role::scalars});
  parts.fields.add({"velocity", Association::point, Array::from_vector(std::move(velocity), 3), "", Role::vectors});
  parts.fields.add({"mass", Association::point, Array::from_vector(mass_), "", Role::none});
  parts.fields.add({"cluster", Association::point, Array::from_vector(cluster_), "", Role::labels});
  const auto whole = [&](const char* name, const std::vector<double>& values, int components = 1) {
    parts.fields.add({name, Association::whole, Array::from_vector(values, components), "", Role::none});
  };
  whole("moment", moment_), whole("kinetic", kinetic_), whole("potential energy", potential_), whole("total", total_);
  whole("momentum", momentum_, 3), whole("angular momentum", angular_, 3);
  return make_dataset(std::move(parts));
}

}  // namespace swarm

RunCost cost_of_nbody(const NbodyParams& p) {
  const double n = p.bodies.empty() ? double(p.count) : double(p.bodies.size() / 7), pairs = 4.5e-9 * n * n;
  const double tree = p.angle > 0 ? 5e-7 * n * std::log2(n + 2) * (0.25 / (p.angle * p.angle)) : pairs;
  const double looks = p.integrator == Integrator::backward_euler ? 20 : p.integrator == Integrator::rk4 ? 4 : 1;
  return cost_of_run(p, "nbody", uint64_t(n) * 80, looks * std::min(pairs, tree), equal_steps(p.frame, p.step));
}

DatasetPtr nbody(const NbodyParams& p, Context& context) {
  using Run = swarm::NbodyRun;
  return frame_of_run<Run>(
      "nbody", p, [&] { return std::make_unique<Run>(p, context); }, context);
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/particle_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <type_traits>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/text/text.h"
#include "simulate/particles/ways.h"

namespace sg::swarm {

namespace {

constexpr size_t few = 1 << 15;        // particles whose order does not matter for speed
constexpr size_t steps_together = 16;  // after which they have drifted apart
constexpr size_t block = 256;          // particles that are moved together, within a core's nearest cache
constexpr size_t near = 32;            // of them, whose ways may all be far from obstacles

std::vector<std::array<double, 4>> emitters_of(const ParticlesInParams& p, const std::string& who, const Box3& room, bool flat) {
  if (p.emitter.empty()) {
    const Vec3 c = room.center(), size = room.size();
    const double r = room.empty() ? 0.1 : 0.1 * (flat ? std::min(size.x, size.y) : std::min({size.x, size.y, size.z}));
    return {{c.x, c.y, c.z, r}};
  }
  if (p.emitter.size() % 4 != 0)
    fail_usage(fmt::format("{} numbers are no balls", p.emitter.size()), who + " emitter", "give x,y,z,radius of each");
  std::vector<std::array<double, 4>> balls;
  for (size_t i = 0; i < p.emitter.size(); i += 4) {
    const std::array b{p.emitter[i], p.emitter[i + 1], p.emitter[i + 2], p.emitter[i + 3]};
    if (!std::isfinite(b[0] + b[1] + b[2] + b[3]) || b[3] < 0)
      fail_usage(fmt::format("a ball of radius {}", exact_number(b[3])), who + " emitter", "give finite numbers");
    for (int a = 0; a < (flat ? 2 : 3) && !room.empty(); ++a)
      if (b[size_t(a)] - b[3] < room.lo[a] - 1e-9 * room.diagonal() || b[size_t(a)] + b[3] > room.hi[a] + 1e-9 * room.diagonal())
        fail_usage(fmt::format("the emitter at {}, {}, {} reaches outside", exact_number(b[0]), exact_number(b[1]), exact_number(b[2])),
                   who + " emitter",
                   fmt::format("there is room along {} from {} to {}", "xyz"[a], exact_number(room.lo[a]), exact_number(room.hi[a])));
    balls.push_back(b);
  }
  return balls;
}

// Two zeros between six bits: the order of a curve through cubes of cells (Morton).
uint32_t spread_bits(uint32_t v) {
  v = (v | v << 8) & 0x300f, v = (v | v << 4) & 0x30c3;
  return (v | v << 2) & 0x9249;
}

}  // namespace

ParticleRun::ParticleRun(const ParticlesInParams& p, std::string who, DatasetPtr data, std::vector<DatasetPtr> surfaces, Context& context)
    : params_(p), who_(std::move(who)), obstacles_({}) {
  check(p, who_);
  steps_of(p, who_);
  if (!std::isfinite(p.rate + p.spread + p.life + p.tether + p.strength + p.velocity.x + p.velocity.y + p.velocity.z))
    fail_usage("rate, velocity, spread, life, tether and strength are finite numbers", who_);
  Box3 room;
  if (data) room = data->bounds();
  forces_.flat = data && p.use != FieldUse::none && room.size().z == 0;
  if (data && p.use == FieldUse::none) surfaces.insert(surfaces.begin(), data), room = {};
  if (data && p.use != FieldUse::none) field_ = std::make_unique<Wind>(data, p.field.name, who_, context);
  obstacles_ = obstacles_of(p, surfaces, who_, context);
  if (const auto box = box_of(p, who_)) room = *box;
  if (room.empty())
    for (const DatasetPtr& s : surfaces) {  // without an emitter of its own: above the middle of what there is to bounce off
      const Box3 b = s->bounds();
      const double r = 0.1 * b.diagonal();
      if (p.emitter.empty())
        room.add(b.center() + Vec3(-r, -r, 0.5 * b.size().z + r)), room.add(b.center() + Vec3(r, r, 0.5 * b.size().z + 3 * r));
    }
  emitters_ = emitters_of(p, who_, room, forces_.flat);
  held_ = std::move(surfaces);
  forces_.gravity = p.gravity.value_or(forces_.flat ? Vec3(0, -9.81, 0) : Vec3(0, 0, -9.81));
  forces_.drag = p.drag, forces_.quadratic = p.quadratic_drag, forces_.tether = p.tether, forces_.mass = p.mass;
  forces_.field = field_.get(), forces_.is_wind = p.use == FieldUse::wind, forces_.strength = p.strength;
  if (context.memory_limit) most_ = std::min(most_, double(context.memory_limit) / 250);
  emit(0, 0);
}

void ParticleRun::emit(double t, double h) {
  const double wanted = params_.count + std::floor(params_.rate * (t + h) * (1 + 1e-12));
  if (!(wanted - double(emitted_) + double(x_.size()) <= most_))
    fail_usage(fmt::format("more than {:.3g} particles at time {:.6g}, for which there is no memory", most_, t), who_ + " rate",
               "emit fewer, or give them a life");
  for (; double(emitted_) < wanted; ++emitted_) {
    const auto chance = [&](uint64_t k) { return random_unit(uint64_t(params_.seed), uint64_t(emitted_) * 8 + k); };
    // In a ball, or a disc, evenly.
    const auto in_ball = [&](uint64_t k) {
      const double turn = 2 * std::numbers::pi * chance(k), u = chance(k + 1);
      if (forces_.flat) return std::sqrt(u) * Vec3(std::cos(turn), std::sin(turn), 0);
      const double z = 2 * chance(k + 2) - 1, across = std::sqrt((1 - z) * (1 + z));
      return std::cbrt(u) * Vec3(across * std::cos(turn), across * std::sin(turn), z);
    };
    const auto& e = emitters_[size_t(chance(0) * double(emitters_.size()))];
    x_.push_back(Vec3(e[0], e[1], forces_.flat && field_ ? field_->dataset()->bounds().lo.z : e[2]) + e[3] * in_ball(1));
    Vec3 v = params_.velocity + params_.spread * in_ball(4);
    if (forces_.flat) v.z = 0;
    v_.push_back(v);
    if (params_.tether > 0) home_.push_back(x_.back());
    born_.push_back(t), id_.push_back(emitted_);
  }
}

void ParticleRun::let_die(double t) {
  if (!(params_.life > 0)) return;
  size_t to = 0;
  for (size_t i = 0; i < x_.size(); ++i) {
    if (t - born_[i] > params_.life * (1 - 1e-12)) continue;
    x_[to] = x_[i], v_[to] = v_[i], born_[to] = born_[i], id_[to] = id_[i];
    if (!home_.empty()) home_[to] = home_[i];
    ++to;
  }
  x_.resize(to), v_.resize(to), born_.resize(to), id_.resize(to);
  if (!home_.empty()) home_.resize(to);
}

// Particles in the order of a coarse grid, so that those moved together read the same parts of a field.
void ParticleRun::bring_together(const Context& context) {
  const size_t n = x_.size();
  const Box3 box = parallel_reduce(
      n, 1 << 15, Box3(),
      [&](size_t begin, size_t end) {
        Box3 b;
        for (size_t i = begin; i < end; ++i) b.add(x_[i]);
        return b;
      },
      [](Box3 a, const Box3& b) {
        a.add(b);
        return a;
      },
      &context);
  constexpr int along = 64;
  Vec3 scale;
  for (int a = 0; a < 3; ++a) scale[a] = box.size()[a] > 0 ? along / box.size()[a] : 0;
  std::vector<uint32_t> cell(n), begin_of(along * along * along + 1, 0), order(n);
  parallel_for(
      n, 1 << 15,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          const Vec3 q = (x_[i] - box.lo) * scale;
          const auto at = [](double v) { return spread_bits(uint32_t(std::min(v, along - 1.0))); };
          cell[i] = at(q.x) | at(q.y) << 1 | at(q.z) << 2;
        }
      },
      &context);
  for (const uint32_t c : cell) ++begin_of[c + 1];
  for (size_t c = 0; c + 1 < begin_of.size(); ++c) begin_of[c + 1] += begin_of[c];
  for (size_t i = 0; i < n; ++i) order[begin_of[cell[i]]++] = uint32_t(i);
  const auto reorder = [&](auto& values) {
    if (values.empty()) return;
    std::remove_reference_t<decltype(values)> sorted(n);
    parallel_for(
        n, 1 << 15,
        [&](size_t begin, size_t end) {
          for (size_t i = begin; i < end; ++i) sorted[i] = values[order[i]];
        },
        &context);
    values = std::move(sorted);
  };
  reorder(x_), reorder(v_), reorder(home_), reorder(born_), reorder(id_);
}

void ParticleRun::step(double t, double h, const Context& context) {
  if (field_ && x_.size() > few && steps_++ % steps_together == 0) bring_together(context);
  parallel_for(
      x_.size(), block,
      [&](size_t begin, size_t end) {
        const size_t n = end - begin;
        const std::span<Vec3> x(x_.data() + begin, n), v(v_.data() + begin, n);
        LocalForces forces = forces_;
        if (!home_.empty()) forces.home = std::span<const Vec3>(home_).subspan(begin, n);
        thread_local Scratch scratch;
        thread_local std::vector<Vec3> x0, v0;
        if (!obstacles_.empty()) x0.assign(x.begin(), x.end()), v0.assign(v.begin(), v.end());
        swarm::advance(params_.integrator, forces, t, h, x, v, scratch);
        if (!obstacles_.empty()) {
          std::optional<Obstacles::Walker> walker;
          for (size_t first = 0; first < n; first += near) {
            const size_t last = std::min(n, first + near);
            if (obstacles_.free(box_of_ways(std::span<const Vec3>(x0).subspan(first, last - first), x.subspan(first, last - first))))
              continue;
            if (!walker) walker.emplace(obstacles_);
            for (size_t i = first; i < last; ++i) walker->walk(x0[i], v0[i], x[i], v[i], h);
          }
        }
        if (!any_vast(x) && !any_vast(v)) return;
        for (size_t i = 0; i < n; ++i)
          if (!std::isfinite(x[i].x + x[i].y + x[i].z + v[i].x + v[i].y + v[i].z))
            fail_data(fmt::format("particle {} grew beyond all numbers in frame {} (time {:.6g})", id_[begin + i], frame_ + 1, t + h), who_,
                      params_.integrator == Integrator::backward_euler ? "weaker forces or shorter steps keep it slower"
                                                                       : "shorter steps, or backward_euler, stand stiff forces");
      },
      &context);
}

void ParticleRun::advance(const Context& context) {
  const size_t steps = steps_of(params_, who_);
  const double h = params_.frame / double(steps), begin = double(frame_) * params_.frame;
  for (size_t k = 0; k < steps; ++k) {
    context.check();
    const double t = begin + double(k) * h;
    let_die(t);
    emit(t, h);
    step(t, h, context);
  }
  ++frame_;
}

DatasetPtr ParticleRun::dataset(const Context&) const {
  // In the order in which they appeared.
  const size_t n = x_.size();
  const int64_t first = n ? *std::min_element(id_.begin(), id_.end()) : 0;
  std::vector<uint32_t> place(size_t(emitted_ - first), UINT32_MAX);
  for (size_t i = 0; i < n; ++i) place[size_t(id_[i] - first)] = uint32_t(i);
  std::erase(place, UINT32_MAX);
  const double now = double(frame_) * params_.frame;
  double *xyz = nullptr, *velocity = nullptr, *age = nullptr;
  int64_t* id = nullptr;
  PointCloud cloud;
  cloud.points.xyz = Array::make<double>(n, 3, &xyz);
  Array velocities = Array::make<double>(n, 3, &velocity), ages = Array::make<double>(n, 1, &age), ids = Array::make<int64_t>(n, 1, &id);
  for (size_t i = 0; i < n; ++i) {
    const size_t from = place[i];
    for (size_t a = 0; a < 3; ++a) xyz[3 * i + a] = x_[from][int(a)], velocity[3 * i + a] = v_[from][int(a)];
    age[i] = now - born_[from], id[i] = id_[from];
  }
  DatasetParts parts;
  parts.mesh = std::move(cloud);
  parts.time = now;
  parts.fields.add({"age", Association::point, std::move(ages), "", Role::scalars});
  parts.fields.add({"velocity", Association::point, std::move(velocities), "", Role::vectors});
  parts.fields.add({"id", Association::point, std::move(ids), "", Role::global_ids});
  return make_dataset(std::move(parts));
}

}  // namespace sg::swarm

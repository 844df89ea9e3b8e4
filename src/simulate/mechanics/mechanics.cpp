// SPDX-License-Identifier: Apache-2.0
// The source: a run that keeps its energies and the way of its last body.
#include "simulate/mechanics/mechanics.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <utility>
#include <vector>

#include "base/error.h"

namespace sg {

namespace mechanics {

namespace {

class MechanicsRun {
 public:
  explicit MechanicsRun(const MechanicsParams& p) : params_(p), motion_(system_of(p)) {
    const System& s = motion_.system();
    speed_ = s.start_speed();
    state_ = motion_.state(s.start(), speed_);
    note();
  }

  size_t frame() const { return moment_.size() - 1; }

  void advance(const Context& context) {
    const size_t next = frame() + 1;
    const double steps = std::max(1.0, std::ceil(params_.frame / params_.step * (1 - 1e-12)));
    if (!(steps <= 1e6)) fail_usage("a frame of more than a million steps", "mechanics step", "take longer steps or shorter frames");
    try {
      const size_t between = std::max<size_t>(1, size_t(steps) / 8);  // marks of the trail within a frame
      for (size_t i = 0; i < size_t(steps); ++i) {
        context.check();
        if (i > 0 && i % between == 0 && leaves_trail()) {
          speed_ = motion_.speed(state_);
          mark(double(frame()) * params_.frame + double(i) * params_.frame / steps);
        }
        motion_.step(params_.integrator, params_.frame / steps, state_);
        for (size_t k = 0; k < state_.q.size(); ++k)
          if (!std::isfinite(state_.q[k]) || !std::isfinite(state_.p[k]))
            fail_data("the motion grew beyond all numbers", "mechanics", "take shorter steps or another integrator");
      }
      speed_ = motion_.speed(state_);
    } catch (Error& e) {
      if (e.kind() != ErrorKind::cancelled)
        e.add_context(fmt::format("computing frame {} (time {:.6g})", next, double(next) * params_.frame));
      throw;
    }
    note();
  }

  /// What the next frame depends on, and what is shown of those before it; see simulate/run/frames.h.
  template <class F>
  void each_part(F&& f) {
    f(state_.q), f(state_.p), f(speed_), f(motion_.guess());
    std::array<double, 1> most{most_};
    f(most), most_ = most[0];
    for (Numbers* l : {&moment_, &kinetic_, &potential_, &total_, &drift_}) {
      Growing<Numbers> growing{*l};
      f(growing);
    }
    std::vector<Mark> marks(trail_.begin(), trail_.end());
    Growing<std::vector<Mark>> trail{marks};
    f(trail), trail_.assign(marks.begin(), marks.end());
  }
  bool consistent() const {
    const size_t frames = moment_.size();
    for (const Numbers* l : {&kinetic_, &potential_, &total_, &drift_})
      if (l->size() != frames) return false;
    return frames > 0;
  }

  DatasetPtr dataset(const Context&) const;

 private:
  struct Body {
    Vec3 at, velocity;
  };
  struct Mark {
    Body body;
    double moment;
  };
  std::vector<Body> bodies() const {
    std::vector<Moving> q;
    for (size_t i = 0; i < state_.q.size(); ++i) q.emplace_back(state_.q[i], std::array{speed_[i]});
    std::vector<Body> r;
    for (const auto& b : motion_.system().bodies(q)) r.push_back({{b[0].value, b[1].value, b[2].value}, {b[0].d[0], b[1].d[0], b[2].d[0]}});
    return r;
  }
  // What is kept of a frame.
  void note() {
    const System& s = motion_.system();
    const double k = s.kinetic(state_.q, speed_), u = s.potential(state_.q);
    moment_.push_back(double(moment_.size()) * params_.frame);
    kinetic_.push_back(k), potential_.push_back(u), total_.push_back(k + u);
    most_ = std::max(most_, std::abs(k));
    drift_.push_back(most_ > 0 ? (total_.back() - total_[0]) / most_ : 0);
    if (leaves_trail()) mark(moment_.back());
  }
  // A net's last mass is held.
  bool leaves_trail() const { return params_.trail > 0 && params_.system != MechanicalSystem::spring_net; }
  void mark(double moment) {
    trail_.push_back({bodies().back(), moment});
    const double first = moment - (params_.trail + 1e-9) * params_.frame;
    while (trail_.front().moment < first) trail_.pop_front();
  }

  MechanicsParams params_;
  Motion motion_;
  State state_;
  Numbers speed_, moment_, kinetic_, potential_, total_, drift_;
  double most_ = 0;  // kinetic energy
  std::deque<Mark> trail_;
};

DatasetPtr MechanicsRun::dataset(const Context&) const {
  std::vector<Body> all = bodies();
  const size_t count = all.size();
  std::vector<int64_t> vertices, lines, offsets{0};
  for (size_t i = 0; i < count; ++i) vertices.push_back(int64_t(i));
  if (params_.rods)
    for (const auto& [a, b] : motion_.system().rods()) lines.push_back(a), lines.push_back(b), offsets.push_back(int64_t(lines.size()));
  if (trail_.size() > 1) {
    for (const Mark& m : trail_) lines.push_back(int64_t(all.size())), all.push_back(m.body);
    offsets.push_back(int64_t(lines.size()));
  }
  std::vector<double> xyz, velocity, age;
  for (size_t i = 0; i < all.size(); ++i) {
    for (int a = 0; a < 3; ++a) xyz.push_back(all[i].at[a]), velocity.push_back(all[i].velocity[a]);
    age.push_back(i < count ? 0 : moment_.back() - trail_[i - count].moment);
  }
  SurfaceMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.vertices.connectivity = Array::from_vector(std::move(vertices)), mesh.vertices.fixed = 1;
  mesh.lines.connectivity = Array::from_vector(std::move(lines)), mesh.lines.offsets = Array::from_vector(std::move(offsets));
  DatasetParts parts;
  parts.mesh = std::move(mesh);
  parts.time = moment_.back();
  if (leaves_trail()) parts.fields.add({"age", Association::point, Array::from_vector(std::move(age)), "", Role::scalars});
  parts.fields.add({"velocity", Association::point, Array::from_vector(std::move(velocity), 3), "", Role::vectors});
  for (const auto& [name, values] : {std::pair<const char*, const Numbers*>{"moment", &moment_},
                                     {"kinetic", &kinetic_},
                                     {"potential", &potential_},
                                     {"total", &total_},
                                     {"drift", &drift_}})
    parts.fields.add({name, Association::whole, Array::from_vector(*values), "", Role::none});
  return make_dataset(std::move(parts));
}

}  // namespace
}  // namespace mechanics

RunCost cost_of_mechanics(const MechanicsParams& p) {
  const auto system = mechanics::system_of(p);
  const double n = system->size(), steps = equal_steps(p.frame, p.step), marks = std::min(p.trail, 1000000) * std::min(steps, 9.0);
  const bool by_words = p.system == MechanicalSystem::expression;
  const double bodies = n / 2 + (p.system == MechanicalSystem::spring_net ? 0 : marks);
  return cost_of_run(p, "mechanics", uint64_t(bodies * 56), (by_words ? 2e-5 : 7e-6) + 4.5e-7 * n * n, steps);
}

DatasetPtr mechanics_source(const MechanicsParams& p, Context& context) {
  using Run = mechanics::MechanicsRun;
  return frame_of_run<Run>(
      "mechanics", p, [&] { return std::make_unique<Run>(p); }, context);
}

}  // namespace sg

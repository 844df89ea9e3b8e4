// SPDX-License-Identifier: Apache-2.0
// Bodies that pull each other: planets, clusters of stars that meet.
#pragma once
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"
#include "simulate/particles/bodies/octree.h"
#include "simulate/particles/scheme.h"
#include "simulate/run/frames.h"
#include "simulate/run/integrator.h"

namespace sg {

struct NbodyParams : FrameParams {
  std::vector<double> bodies;
  int clusters = 2, count = 2000, seed = 1;
  double apart = 6, speed = 0.4, aside = 1;
  double constant = 1, softening = 0.05, angle = 0.5;
  Integrator integrator = Integrator::verlet;
  double step = 0.02;
};
void describe(Schema& s, NbodyParams& p);

namespace swarm {

class NbodyRun {
 public:
  /// Throws Error(usage) for masses that are not positive and numbers that are not finite.
  NbodyRun(const NbodyParams& p, Context& context);
  size_t frame() const { return moment_.size() - 1; }
  /// Throws Error(data), naming frame and body, where one leaves all numbers.
  void advance(const Context& context);
  void step(double h, const Context& context);
  DatasetPtr dataset(const Context& context) const;
  /// What the next frame depends on, and what is shown of the frames before; see simulate/run/frames.h.
  template <class F>
  void each_part(F&& f) {
    f(x_), f(v_);
    for (std::vector<double>* l : {&moment_, &kinetic_, &potential_, &total_, &momentum_, &angular_}) {
      Growing<std::vector<double>> growing{*l};
      f(growing);
    }
  }
  bool consistent() const;
  void resume(const Context& context);
  std::span<const Vec3> places() const { return x_; }
  std::span<const Vec3> velocities() const { return v_; }

 private:
  void note(const Context& context);
  /// Accelerations and potentials at these places; those of the last ones again where they are the same.
  void pull(std::span<const Vec3> x, std::span<Vec3> a, const Context& context);
  NbodyParams params_;
  Pull pull_;
  std::vector<Vec3> x_, v_, pulled_at_, pull_there_;
  std::vector<double> mass_, potential_of_;
  std::vector<int64_t> cluster_;
  std::vector<double> moment_, kinetic_, potential_, total_, momentum_, angular_;
  Scratch scratch_;
};

}  // namespace swarm

/// Points with the fields velocity, mass, cluster and potential, and, with one value per frame from 0 on, the fields of the whole: moment,
/// kinetic, potential energy, total, momentum and angular momentum (of three components).
DatasetPtr nbody(const NbodyParams& p, Context& context);
RunCost cost_of_nbody(const NbodyParams& p);

}  // namespace sg

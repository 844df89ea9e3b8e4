// SPDX-License-Identifier: Apache-2.0
// A run of particles that appear, are moved by forces, and bounce off obstacles.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"
#include "simulate/particles/local_forces.h"
#include "simulate/particles/obstacles.h"
#include "simulate/particles/particle_params.h"
#include "simulate/particles/scheme.h"

namespace sg {

namespace swarm {

/// The same bytes for any number of threads: particles are moved in blocks whose borders depend on their number alone.
class ParticleRun {
 public:
  /// `data`: with a field or an obstacle (null: none); `surfaces`: further obstacles. Throws Error(usage) for emitters outside.
  ParticleRun(const ParticlesInParams& p, std::string who, DatasetPtr data, std::vector<DatasetPtr> surfaces, Context& context);
  size_t frame() const { return frame_; }
  /// Throws Error(data), naming frame and particle, where one leaves all numbers.
  void advance(const Context& context);
  void step(double t, double h, const Context& context);
  DatasetPtr dataset(const Context& context) const;
  /// What the next frame depends on; see simulate/run/frames.h.
  template <class F>
  void each_part(F&& f) {
    std::array<uint64_t, 3> counts{frame_, steps_, uint64_t(emitted_)};
    f(counts);
    frame_ = counts[0], steps_ = counts[1], emitted_ = int64_t(counts[2]);
    for (std::vector<Vec3>* l : {&x_, &v_, &home_}) {
      Growing<std::vector<Vec3>> growing{*l};
      f(growing);
    }
    Growing<std::vector<double>> born{born_};
    Growing<std::vector<int64_t>> id{id_};
    f(born), f(id);
  }
  bool consistent() const {
    const size_t n = x_.size();
    return v_.size() == n && born_.size() == n && id_.size() == n && home_.size() == (params_.tether > 0 ? n : 0);
  }
  std::span<const Vec3> places() const { return x_; }
  std::span<const Vec3> velocities() const { return v_; }

 private:
  void emit(double t, double h);
  void let_die(double t);
  void bring_together(const Context& context);

  ParticlesInParams params_;
  std::string who_;
  std::vector<DatasetPtr> held_;
  std::unique_ptr<Wind> field_;
  LocalForces forces_;
  Obstacles obstacles_;
  std::vector<std::array<double, 4>> emitters_;
  std::vector<Vec3> x_, v_, home_;
  std::vector<double> born_;
  std::vector<int64_t> id_;
  int64_t emitted_ = 0;
  size_t steps_ = 0;
  double most_ = 2e8;  ///< particles at a time
  size_t frame_ = 0;
};

}  // namespace swarm

/// Points with the fields velocity, age and id of the particles at the last frame before `time`.
DatasetPtr particle_system(const ParticleParams& p, Context& context);
/// The same in data: the first input's vector field moves them, further inputs are surfaces that they bounce off.
DatasetPtr particle_system_in(const std::vector<Data>& inputs, const ParticlesInParams& p, Context& context);

RunCost cost_of_particle_system(const ParticleParams& p);
RunCost cost_of_particle_system_in(const ParticlesInParams& p);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Smoke that rises, curls round obstacles and leaves the box: incompressible air that carries density and temperature.
#pragma once
#include <array>
#include <optional>

#include "base/context.h"
#include "data/dataset.h"
#include "simulate/fluid/dust/dust.h"
#include "simulate/fluid/pressure/project.h"
#include "simulate/fluid/sources/emission.h"
#include "simulate/fluid/walls/solids.h"
#include "simulate/run/frames.h"

namespace sg {

namespace fluid {

/// The state at a frame. A step (Stam 1999; Bridson 2015, chapter 5): everything is carried by the flow, sources give off smoke, forces and
/// friction change the velocity, and the pressure takes its divergence away.
template <class T>
class Smoke {
 public:
  Smoke(const SmokeParams& p, SmokeInput given, const Context& context);
  /// On to the next frame. Throws Error(data), naming the frame, where the flow grows beyond all numbers.
  void advance(const Context& context);
  size_t frame() const { return frame_; }
  /// That its lattices take, without those of the solver's coarse levels.
  size_t bytes() const;
  const MacGrid& grid() const { return grid_; }
  Faces<T>& velocity() { return velocity_; }
  Lattice<T>& density() { return density_; }
  Lattice<T>& temperature() { return temperature_; }
  const Projection<T>& projection() const { return projection_; }
  size_t steps() const { return steps_; }
  /// How the last pressure was found.
  const SolveReport& solved() const { return solved_; }
  /// What the next frame depends on.
  template <class F>
  void each_part(F&& f) {
    std::array<uint64_t, 2> counts{frame_, steps_};
    f(counts);
    frame_ = counts[0], steps_ = counts[1], time_ = double(frame_) * params_.frame;
    for (Lattice<T>* l : {&velocity_[0], &velocity_[1], &velocity_[2], &density_, &temperature_, &pressure_}) f(l->values);
    if (dust_) dust_->each_part(f);
  }
  const std::optional<Dust<T>>& dust() const { return dust_; }
  /// The cells' middles as the points of a uniform grid with density, temperature, velocity and pressure, and that of `dust`; or the dust.
  DatasetPtr dataset(const Context& context) const;

 private:
  void step(double dt, const Context& context);
  void carry_scalars(double dt, const Context& context);
  void carry_velocity(double dt, Faces<T>& v, const Context& context);
  void push(double dt, const Context& context);
  void give_off(double dt);
  double fastest(const Context& context) const;

  SmokeParams params_;
  MacGrid grid_;
  Vec3 up_;
  Sides sides_;
  Emission<T> emission_;
  Solids solids_;
  std::optional<Dust<T>> dust_;
  Projection<T> projection_;
  Faces<T> velocity_, reflected_;
  Lattice<T> density_, temperature_, pressure_;
  std::array<Lattice<T>, 5> spare_;
  size_t frame_ = 0, steps_ = 0;
  double time_ = 0;
  SolveReport solved_;
};

}  // namespace fluid

/// Point fields density, temperature (f32 or f64), velocity (three components) and pressure of the air at the last frame before
/// `time`. A call that goes on from the time before (a film) computes only the frames between; the result is the same in any order.
DatasetPtr smoke(const SmokeParams& p, Context& context);

/// The same with dust, which the air drags along and which drags the air (simulate/fluid/dust/). The result has also the dust's mass per
/// volume, `dust`, where the air's is 1; or is the dust itself: points with velocity and id.
DatasetPtr dusty_smoke(const DustySmokeParams& p, Context& context);

/// One step a frame is reckoned with.
RunCost cost_of_smoke(const SmokeParams& p);
RunCost cost_of_dusty_smoke(const DustySmokeParams& p);
RunCost cost_of_smoke_round(const SmokeRoundParams& p);
RunCost cost_of_smoke_from(const SmokeFromParams& p);

/// The same about a closed surface, or from inside of one; triangles of any mesh. Without bounds the box is twice as wide as the surface,
/// and three times as high.
DatasetPtr smoke_round(const DatasetPtr& surface, const SmokeRoundParams& p, Context& context);

/// The same from a field's values, inside of any mesh (simulate/fluid/sources/field_source.h). Box as above; flat for flat data.
DatasetPtr smoke_from(const DatasetPtr& data, const SmokeFromParams& p, Context& context);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Smoke that rises, curls round obstacles and leaves the box: incompressible air that carries density and temperature.
#pragma once
#include "data/dataset.h"
#include "simulate/fluid/project.h"
#include "simulate/fluid/smoke_params.h"

namespace sg {

namespace fluid {

/// The state at a frame. A step (Stam 1999; Bridson 2015, chapter 5): everything is carried by the flow, sources give off smoke, forces and
/// friction change the velocity, and the pressure takes its divergence away.
template <class T>
class Smoke {
 public:
  Smoke(const SmokeParams& p, const Context& context);
  /// On to the next frame. Throws Error(data), naming the frame, where the flow grows beyond all numbers.
  void advance(const Context& context);
  size_t frame() const { return frame_; }
  const MacGrid& grid() const { return grid_; }
  Faces<T>& velocity() { return velocity_; }
  Lattice<T>& density() { return density_; }
  Lattice<T>& temperature() { return temperature_; }
  const Projection<T>& projection() const { return projection_; }
  /// How the last pressure was found.
  const SolveReport& solved() const { return solved_; }
  /// The cells' middles as the points of a uniform grid with density, temperature, velocity and pressure.
  DatasetPtr dataset(const Context& context) const;

 private:
  void step(double dt, const Context& context);
  void give_off();
  double fastest(const Context& context) const;

  SmokeParams params_;
  MacGrid grid_;
  Vec3 up_;
  std::vector<Ball> sources_;
  Projection<T> projection_;
  Faces<T> velocity_;
  Lattice<T> density_, temperature_, pressure_;
  std::array<Lattice<T>, 5> spare_;
  size_t frame_ = 0;
  SolveReport solved_;
};

}  // namespace fluid

/// Point fields density, temperature (f32 or f64), velocity (three components) and pressure of the air at the last frame before
/// `time`. A call that goes on from the time before (a film) computes only the frames between; the result is the same in any order.
DatasetPtr smoke(const SmokeParams& p, Context& context);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Water with a free surface: particles carry the velocity, a staggered grid keeps it free of divergence.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "simulate/fluid/pressure/project.h"
#include "simulate/fluid/smoke_params.h"
#include "simulate/fluid/walls/solids.h"
#include "simulate/fluid/water/transfer.h"

namespace sg {

enum class LiquidShow { grid, particles };
constexpr auto enum_words(LiquidShow) { return std::array{Word{"grid", LiquidShow::grid}, Word{"particles", LiquidShow::particles}}; }

struct FlipLiquidParams : FrameParams {
  int size = 48;
  std::vector<double> bounds, water, obstacle;
  std::optional<Vec3> gravity;
  fluid::Transfer transfer = fluid::Transfer::apic;
  double flip_share = 0.97, cfl = 2, tolerance = 1e-5;
  int per_axis = 2;
  LiquidShow show = LiquidShow::grid;
};
void describe(Schema& s, FlipLiquidParams& p);

namespace fluid {

/// The state at a frame. A step: velocities of the particles go to the grid, weight pulls, the pressure takes the divergence away with air
/// (cells without particles) at pressure 0, velocities go back to the particles, and these move with the grid's flow.
class FlipLiquid {
 public:
  FlipLiquid(const FlipLiquidParams& p, const Context& context);
  /// On to the next frame. Throws Error(data), naming the frame, where the flow grows beyond all numbers.
  void advance(const Context& context);
  size_t frame() const { return frame_; }
  const MacGrid& grid() const { return grid_; }
  const std::vector<Particle3>& particles() const { return particles_; }
  const Faces<double>& velocity() const { return u_; }
  /// Kinetic and potential energy of the particles, each of mass 1 / (their number).
  double energy() const;
  size_t bytes() const;
  template <class F>
  void each_part(F&& f) {
    std::array<uint64_t, 1> count{frame_};
    f(count), f(particles_), f(pressure_.values);
    frame_ = count[0];
  }
  /// The particles with velocity, or the middles of cells with `water`, the share of each that is full, and velocity.
  DatasetPtr dataset(const Context& context) const;

 private:
  void step(double dt, const Context& context);
  void keep_inside(Vec3& x) const;
  DatasetPtr cloud() const;

  FlipLiquidParams params_;
  MacGrid grid_;
  Vec3 gravity_;
  std::vector<Ball> balls_;
  Projection<double> projection_;
  Faces<double> u_;
  Lattice<double> pressure_;
  std::vector<Particle3> particles_;
  size_t frame_ = 0;
};

}  // namespace fluid

/// Water that begins as the boxes `water` at rest, at the last frame before `time`.
DatasetPtr flip_liquid(const FlipLiquidParams& p, Context& context);
/// Two steps a frame are reckoned with.
RunCost cost_of_flip(const FlipLiquidParams& p);

}  // namespace sg

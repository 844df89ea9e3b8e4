// SPDX-License-Identifier: Apache-2.0
// UnsteadyFlow: a vector field that changes with time, a window of a few time steps of a series in memory. UnsteadyCursor: asks it at
// places and times, one per thread; it is a *flow* as flow_field.h explains.
//
// Everything that moves through it advances interval by interval of the series, all together, so that each step is loaded once:
//   UnsteadyFlow flow(series, "velocity", TimeInterpolation::linear, context);
//   for (size_t k = flow.interval_of(start, 1); k < flow.intervals(); ++k) {
//     flow.open(k, context);
//     parallel_for(..., [&](size_t begin, size_t end) { UnsteadyCursor cursor(flow); ... from flow.begin() to flow.end() ... });
//   }
#pragma once
#include <span>
#include <string>
#include <vector>

#include "filter/flow/flow_field.h"
#include "filter/flow/unsteady/time_interpolation.h"

namespace sg {

/// linear: between two steps. cubic: Hermite through two steps with slopes from four (three-point differences on uneven times; one step
/// less at the ends of the series): C1 in time.
class UnsteadyFlow {
 public:
  /// How the meshes of the open steps belong together: one mesh; one set of cells whose points move (then velocities are mixed at points
  /// that move along, so that a particle at rest in its cell stays in it); or nothing in common (then they are mixed at places in space).
  enum class Meshes : uint8_t { same, moving, changed };

  /// `field` as in FlowField; the parts of a collection that have it (flow_meshes) are joined to one mesh. Nothing is loaded yet. Throws
  /// Error(usage) for a series of one step and Error(data) for times that do not grow.
  /// `geographic`: velocities in m/s over degrees are converted, see geographic.h.
  UnsteadyFlow(Series series, std::string field, TimeInterpolation interpolation, Context& context, bool geographic = false);

  const std::vector<double>& times() const { return series_.times; }
  size_t intervals() const { return series_.times.size() - 1; }
  /// The interval in which something that is at `t` moves on in the direction `sign`; t must lie in the series, see covers().
  size_t interval_of(double t, int sign) const;
  bool covers(double t) const { return t >= times().front() && t <= times().back(); }

  /// Loads what interval k needs and lets go what it does not. Cursors of another interval end here. Errors of a step name it.
  void open(size_t k, Context& context);
  size_t interval() const { return interval_; }
  double begin() const { return times()[interval_]; }
  double end() const { return times()[interval_ + 1]; }

  /// The open steps, in order; begin() is that of steps()[base()].
  std::span<const FlowField> steps() const { return steps_; }
  std::span<const size_t> numbers() const { return numbers_; }
  size_t base() const { return base_; }
  Meshes meshes() const { return meshes_; }
  /// Weights of the open steps at a time, their sum is 1.
  void time_weights(double t, double out[4]) const;
  /// Where the points of the open steps are, for Meshes::moving: 3 packed f64 a point.
  std::span<const Array> positions() const { return positions_; }
  TimeInterpolation interpolation() const { return interpolation_; }
  /// With `geographic`: seconds in a unit of time.
  double seconds() const { return seconds_; }
  /// Largest speed in the open steps.
  double largest_speed() const;

 private:
  FlowField load(size_t step, Context& context);
  Series series_;
  std::string field_;
  TimeInterpolation interpolation_;
  bool geographic_ = false;
  double seconds_ = 1;
  size_t interval_ = SIZE_MAX, base_ = 0;
  std::vector<FlowField> steps_;
  std::vector<size_t> numbers_;
  std::vector<Array> positions_;
  Meshes meshes_ = Meshes::same;
};

/// Equal geometry, cells and ghosts: identical arrays, or arrays of equal bytes.
bool same_mesh(const Dataset& a, const Dataset& b);
/// Equal cells and ghosts; points may be at different positions.
bool same_cells(const Dataset& a, const Dataset& b);

class UnsteadyCursor {
 public:
  /// For the interval currently open.
  explicit UnsteadyCursor(const UnsteadyFlow& flow);
  UnsteadyCursor(UnsteadyCursor&&) noexcept;
  ~UnsteadyCursor();

  /// False outside the mesh of that time, in hidden cells, where it is NaN, and for times outside the open interval.
  bool operator()(Vec3 x, double t, Vec3& v);
  double cell_length() const;
  Vec3 snap(Vec3 x);
  /// A field at the last place and time: `values` of each open step (steps()[j]'s), on points or on cells. NaN where there is none.
  double value(std::span<const Array> values, Association association, int component) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sg

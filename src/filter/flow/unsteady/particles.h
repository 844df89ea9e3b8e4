// SPDX-License-Identifier: Apache-2.0
// Particles that an unsteady flow carries: all of them advance together through one interval of the series after the other.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "filter/flow/trace.h"
#include "filter/flow/unsteady/unsteady_flow.h"

namespace sg {

struct Particle {
  Vec3 x;
  Vec3 v{0, 0, 0};  ///< velocity there, once it has started
  double t = 0;
  double next = 0;                       ///< size of the next step, a time without sign; 0: by the options
  int32_t steps = 0;                     ///< so far
  bool started = false;                  ///< v is known and x lies in the mesh
  bool ended = false;                    ///< moves no more:
  StopReason why = StopReason::outside;  ///< ... outside (also: where there is no velocity) or steps
};

/// Places on the ways of particles, the end of each step; of one particle in order.
struct Way {
  std::vector<size_t> particle;
  std::vector<Vec3> x, v;
  std::vector<double> t;
  size_t size() const { return t.size(); }
};

/// Moves every particle that has not ended from its own time to `until`, both in the open interval, in the direction `sign` of time; those
/// whose time is not yet reached wait. A particle at rest stays. Steps as in TraceOptions (closed, max_length, max_time and min_speed have
/// no meaning here; max_steps counts those of a particle's life); none crosses the end of an interval. One that starts where there is no
/// velocity ends at once. With `way` the end of each step is added to it, and the start of those that start. In parallel; the same for any
/// number of threads. Fastest where particles that follow each other are neighbours.
void advance(const UnsteadyFlow& flow, std::span<Particle> particles, double until, int sign, const TraceOptions& options, Context& context,
             Way* way = nullptr);

/// Numbers of places so that neighbours in space follow each other (Morton order in their box).
std::vector<size_t> space_order(std::span<const Vec3> places);

/// Fields of the steps at places and times of the open interval.
class CarriedFields {
 public:
  /// All fields of the mesh but the velocity and whole ones; names that a step lacks are NaN there.
  void open(const UnsteadyFlow& flow);
  /// Appends the values at each place; NaN where there are none.
  void sample(const UnsteadyFlow& flow, std::span<const Vec3> x, std::span<const double> t, Context& context);
  /// As point fields of the places sampled so far, in the order `place`; nothing stays here.
  FieldSet take(std::span<const size_t> place);
  bool empty() const { return columns_.empty(); }

 private:
  struct Column {
    std::string name, unit;
    Association association = Association::point;
    int components = 1;
    std::vector<float> values;
  };
  std::vector<Column> columns_;
  bool known_ = false;
};

}  // namespace sg

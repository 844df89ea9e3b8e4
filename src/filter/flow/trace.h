// SPDX-License-Identifier: Apache-2.0
// Lines of a flow: from seeds along the velocity until something ends them.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/schema/schema.h"
#include "filter/flow/flow_parts.h"
#include "filter/flow/integrator.h"

namespace sg {

/// Shared by every operation that follows a flow.
enum class StepUnit : uint8_t { cells, length, time };
constexpr auto enum_words(StepUnit) {
  using enum StepUnit;
  return std::array{Word{"cells", cells}, Word{"length", length}, Word{"time", time}};
}

struct IntegrationParams {
  Scheme integrator = Scheme::dormand_prince;
  double step = 0.5;
  StepUnit step_unit = StepUnit::cells;
  double tolerance = 1e-4;
  std::optional<double> min_step, max_step;
};
void describe(Schema& s, IntegrationParams& p);

struct StopParams {
  std::optional<double> max_length, max_time;
  int64_t max_steps = 2000;
  double min_speed = 1e-9;
  bool closed = true;
};
void describe(Schema& s, StopParams& p);

enum class StopReason : uint8_t { outside, length, time, steps, speed, closed, error };
constexpr auto enum_words(StopReason) {
  using enum StopReason;
  return std::array{Word{"outside", outside}, Word{"length", length}, Word{"time", time},  Word{"steps", steps},
                    Word{"speed", speed},     Word{"closed", closed}, Word{"error", error}};
}

/// What the words mean, resolved once.
struct TraceOptions {
  Scheme scheme = Scheme::dormand_prince;
  StepUnit unit = StepUnit::cells;  ///< of the three step sizes
  double step = 0.5;                ///< fixed schemes: every step; dormand_prince: the first one
  double min_step = 0.01, max_step = 1;
  double tolerance = 1e-4;  ///< dormand_prince: error of a step, in cell sizes
  double max_length = HUGE_VAL, max_time = HUGE_VAL;
  int64_t max_steps = 2000;
  double min_speed = 0;  ///< absolute
  bool closed = true;    ///< end where the line comes back to its seed, as closely as steps are exact (1e-4 to 1e-2 of a cell)
};
/// Throws Error(usage) for sizes that are not positive or bad names. `largest_speed` scales min_speed.
TraceOptions trace_options(const IntegrationParams& integration, const StopParams& stop, double largest_speed);

/// Throws Error(usage) naming `who` for a path through more than `most` cells of this flow in `duration`, which no number of steps can
/// follow, and for steps so small that max_steps of them are nowhere near the size of a cell (measured in time: near the duration, where it
/// is finite).
void check_way(const FlowField& flow, double duration, double most, const TraceOptions& options, std::string_view who);

/// How many steps of the largest size a particle of the usual speed takes in `duration`.
double usual_steps(const FlowField& flow, double duration, const TraceOptions& options);

/// Points of many lines, one line after the other; `time` grows with the flow (falls when traced backwards from 0).
struct TracedLines {
  std::vector<size_t> begin{0};  ///< lines + 1
  std::vector<Vec3> points;
  std::vector<double> time;  ///< since the seed
  std::vector<double> arc;   ///< length since the seed
  std::vector<Vec3> velocity;
  std::vector<int64_t> seed;     ///< per line: which seed
  std::vector<StopReason> stop;  ///< per line
  size_t lines() const { return begin.size() - 1; }
};

/// Follows the flow from `seed`; `direction` 1 or -1. Appends one line (the seed first) unless there is no velocity at the seed: false.
/// A step that leaves the mesh is halved up to ten times, so that lines end at the border. Template: trace_line.h.
/// Both directions of a seed make one line, backward part first (its times negative).
enum class TraceDirection : uint8_t { forward, backward, both };
constexpr auto enum_words(TraceDirection) {
  using enum TraceDirection;
  return std::array{Word{"forward", forward}, Word{"backward", backward}, Word{"both", both}};
}

/// From all seeds, in parallel: the same lines for any number of threads, in the order of the seeds. Seeds without velocity give no line.
TracedLines trace_lines(const FlowField& field, std::span<const Vec3> seeds, TraceDirection direction, const TraceOptions& options,
                        Context& context);
/// The same through all parts of a collection: lines cross from part to part.
TracedLines trace_lines(const FlowParts& parts, std::span<const Vec3> seeds, TraceDirection direction, const TraceOptions& options,
                        Context& context);

}  // namespace sg

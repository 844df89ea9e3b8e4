// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/trace.h"

#include <fmt/core.h>

#include "base/parallel.h"
#include "filter/flow/trace_line.h"

namespace sg {

void describe(Schema& s, IntegrationParams& p) {
  s("integrator", p.integrator,
    "Integration scheme: dormand_prince adapts its steps to the tolerance, the others use fixed steps; implicit_midpoint is symplectic.");
  s("step", p.step, "Step size (dormand_prince: of the first step), in step_unit.").positive();
  s("step_unit", p.step_unit, "Unit of steps: local cell size, length, or time.");
  s("tolerance", p.tolerance, "dormand_prince: error per step, in local cell sizes.").positive();
  s("min_step", p.min_step, "dormand_prince: smallest step, in step_unit; default: a fiftieth of step.");
  s("max_step", p.max_step, "dormand_prince: largest step, in step_unit; default: step, which keeps lines smooth.");
}

void describe(Schema& s, StopParams& p) {
  s("max_length", p.max_length, "Maximum length of a line; default: no limit.").unit("length");
  s("max_time", p.max_time, "Maximum time along a line; default: no limit.").unit("time");
  s("max_steps", p.max_steps, "Maximum number of steps in each direction.").range(1, 1e9);
  s("min_speed", p.min_speed,
    "Lines end where the speed is below this fraction of its largest value. The default of 1e-9 becomes 0.02 for streamlines where most of "
    "a grid is noise, as around the vessels of a scan.")
      .range(0, 1);
  s("closed", p.closed, "End lines where they return to their seed.");
}

TraceOptions trace_options(const IntegrationParams& p, const StopParams& stop, double largest_speed) {
  TraceOptions o;
  o.scheme = p.integrator, o.unit = p.step_unit;
  o.step = p.step, o.tolerance = p.tolerance;
  o.min_step = p.min_step.value_or(p.step / 50), o.max_step = p.max_step.value_or(p.step);
  if (!(o.min_step > 0) || !(o.max_step >= o.min_step))
    fail_usage(fmt::format("min_step {} and max_step {} leave no valid step", o.min_step, o.max_step), "integrator",
               "choose 0 < min_step <= max_step");
  o.max_length = stop.max_length.value_or(HUGE_VAL), o.max_time = stop.max_time.value_or(HUGE_VAL);
  if (!(o.max_length > 0) || !(o.max_time > 0)) fail_usage("lines would have no length", "max_length, max_time", "give positive numbers");
  o.max_steps = stop.max_steps, o.min_speed = stop.min_speed * largest_speed, o.closed = stop.closed;
  return o;
}

void check_way(const FlowField& flow, double duration, double most, const TraceOptions& o, std::string_view who) {
  const double cell = flow.usual_cell(), cells = flow.usual_speed() * std::abs(duration) / cell;
  if (std::isfinite(duration) && cells > most)
    fail_usage(fmt::format("in a time of {:.4g} this flow crosses {:.3g} cells, too many to trace", std::abs(duration), cells),
               std::string(who), "check that the units of time, velocity and mesh are consistent");
  const double step = o.scheme == Scheme::dormand_prince ? o.max_step : o.step, reach = step * double(o.max_steps);
  constexpr double nowhere = 1e-6;
  const double goal = o.unit == StepUnit::cells ? 1 : o.unit == StepUnit::length ? cell : std::abs(duration);
  if (std::isfinite(goal) && reach < nowhere * goal)
    fail_usage(fmt::format("{} steps of {:.4g} (step_unit={}) do not cross a cell", o.max_steps, step, word_of(o.unit)),
               fmt::format("{} step", who),
               fmt::format("use larger steps: {:.4g} would cross one cell in that number", goal / double(o.max_steps)));
}

double usual_steps(const FlowField& flow, double duration, const TraceOptions& o) {
  const double step = o.scheme == Scheme::dormand_prince ? o.max_step : o.step, way = flow.usual_speed() * std::abs(duration);
  return (o.unit == StepUnit::cells ? way / flow.usual_cell() : o.unit == StepUnit::length ? way : std::abs(duration)) / step;
}

namespace {

void begin_line(TracedLines& out, Vec3 x, Vec3 v) {
  out.points.push_back(x), out.velocity.push_back(v), out.time.push_back(0), out.arc.push_back(0);
}

template <class T>
void reverse_tail(std::vector<T>& v, size_t from) {
  std::reverse(v.begin() + ptrdiff_t(from), v.end());
}

template <class Flow>
void trace_seed(Flow& flow, Vec3 seed, int64_t number, TraceDirection direction, const TraceOptions& o, TracedLines& out) {
  const Vec3 x = flow.snap(seed);
  Vec3 v;
  if (!flow(x, 0, v)) return;
  const size_t first = out.points.size();
  StopReason stop = StopReason::closed;
  begin_line(out, x, v);
  if (direction != TraceDirection::forward) {
    stop = trace_line(flow, 0, -1, o, out);
    reverse_tail(out.points, first), reverse_tail(out.velocity, first), reverse_tail(out.time, first), reverse_tail(out.arc, first);
    for (size_t i = first; i < out.arc.size(); ++i) out.arc[i] = -out.arc[i];
    // A closed orbit is whole already.
    if (direction == TraceDirection::both && stop != StopReason::closed) {
      flow(x, 0, v);
      stop = trace_line(flow, 0, 1, o, out);
    }
  } else {
    stop = trace_line(flow, 0, 1, o, out);
  }
  out.begin.push_back(out.points.size());
  out.seed.push_back(number), out.stop.push_back(stop);
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

template <class Cursor, class Source>
TracedLines trace_all(const Source& field, std::span<const Vec3> seeds, TraceDirection direction, const TraceOptions& o, Context& context) {
  constexpr size_t grain = 16;
  std::vector<TracedLines> parts((seeds.size() + grain - 1) / grain);
  parallel_for(
      seeds.size(), grain,
      [&](size_t begin, size_t end) {
        Cursor flow(field);
        for (size_t i = begin; i < end; ++i) trace_seed(flow, seeds[i], int64_t(i), direction, o, parts[begin / grain]);
      },
      &context);
  TracedLines out;
  size_t points = 0;
  for (const TracedLines& p : parts) points += p.points.size();
  out.points.reserve(points), out.time.reserve(points), out.arc.reserve(points), out.velocity.reserve(points);
  for (TracedLines& p : parts) {
    for (size_t i = 1; i < p.begin.size(); ++i) out.begin.push_back(p.begin[i] + out.points.size());
    append(out.points, p.points), append(out.time, p.time), append(out.arc, p.arc), append(out.velocity, p.velocity);
    append(out.seed, p.seed), append(out.stop, p.stop);
    p = {};
  }
  return out;
}

}  // namespace

TracedLines trace_lines(const FlowField& field, std::span<const Vec3> seeds, TraceDirection direction, const TraceOptions& o,
                        Context& context) {
  return trace_all<FlowCursor>(field, seeds, direction, o, context);
}

TracedLines trace_lines(const FlowParts& parts, std::span<const Vec3> seeds, TraceDirection direction, const TraceOptions& o,
                        Context& context) {
  if (parts.count() == 1) return trace_all<FlowCursor>(parts.fields().front(), seeds, direction, o, context);
  return trace_all<PartsCursor>(parts, seeds, direction, o, context);
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/heat.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/text/text.h"
#include "simulate/pde/expressions.h"

namespace sg {

void describe(Schema& s, HeatParams& p) {
  describe(s, static_cast<pde::RoomParams&>(p));
  describe(s, static_cast<FrameParams&>(p));
  s("initial", p.initial, "Temperature at time 0: an expression of x, y and z; default: a round bump of height 1.");
  s("diffusivity", p.diffusivity, "kappa, length^2 per time.").range(0, 1e100);
  s("source", p.source, "Temperature that is added per time: an expression of x, y, z and time.");
  s("scheme", p.scheme,
    "explicit: stable up to steps of 1/(2 kappa sum of 1/h^2). backward_euler: any step, of first order. crank_nicolson: any step, of "
    "second order; steps far beyond the explicit limit let jumps of the initial values ring.");
  s("step", p.step, "Time step; default: explicit half the limit, else one step a frame.").unit("time").positive();
  s("solver", p.solver, "How the equations of an implicit step are solved.");
  s("tolerance", p.tolerance, "What may be left of their residual, as a share of the right side.").range(1e-14, 0.1);
}

namespace pde {

namespace {

double heat_limit(const HeatParams& p, const Room& room) { return 1 / (2 * p.diffusivity * room.couplings()); }

}  // namespace

Heat::Heat(const HeatParams& p, const Context& context)
    : params_(p),
      room_(make_room(p, "heat", 60, false, context)),
      steps_(steps_of_frame(p.frame, p.step, p.scheme == HeatScheme::explicit_euler ? limit() / 2 : p.frame, "heat")),
      sides_(room_, "heat", 0, context),
      u_(values_of(p.initial.empty() ? bump_in(room_, 60, {0.35, 0.6, 0.5}) : p.initial, room_.grid(), 0, "heat initial", context)),
      source_(values_of(p.source, room_.grid(), 0, "heat source", context)),
      rate_(room_.n()),
      source_moves_(depends_on_time(p.source)) {
  if (!(p.diffusivity >= 0) || !std::isfinite(p.diffusivity))
    fail_usage(fmt::format("a diffusivity of {}", exact_number(p.diffusivity)), "heat diffusivity",
               "give 0 or more: backwards in time heat has no solution");
  if (p.scheme == HeatScheme::explicit_euler) return;
  const double share = p.scheme == HeatScheme::crank_nicolson ? 0.5 : 1;
  solver_ = std::make_unique<LinearSolver>(Operator{room_.axes, 1, share * steps_.length * p.diffusivity},
                                           SolveOptions{p.solver, p.tolerance, 10000, {}}, "heat");
}

double Heat::limit() const { return heat_limit(params_, room_); }

void Heat::step(double time, const Context& context) {
  const double dt = steps_.length, kappa = params_.diffusivity, next = time + dt;
  const double before = params_.scheme == HeatScheme::backward_euler ? 0 : params_.scheme == HeatScheme::crank_nicolson ? 0.5 : 1;
  double *const u = u_.values.data(), *const rate = rate_.values.data();
  const size_t count = u_.values.size();
  if (before > 0) {
    laplacian(room_, u_, sides_, rate_, context);
    const double* const s = source_.values.data();
    each_index(count, context, [=](size_t i) { rate[i] = u[i] + dt * before * (kappa * rate[i] + s[i]); });
  } else {
    rate_.values = u_.values;
  }
  sides_.update(next, context);
  if (source_moves_) source_ = values_of(params_.source, room_.grid(), next, "heat source", context);
  if (!solver_) {
    std::swap(u_, rate_);
    return;
  }
  const double after = dt * (1 - before);
  const double* const s = source_.values.data();
  each_index(count, context, [=](size_t i) { rate[i] += after * s[i]; });
  sides_.add_to(rate_, after * kappa);
  const SolveHistory h = solver_->solve(rate_, u_, context);
  if (!h.reached)
    fail_data(fmt::format("step {} (time {:.6g}) is solved to {:.3g} only", taken_ + 1, next, h.residuals.back()), "heat",
              "a larger tolerance, a shorter step or solver=multigrid");
}

void Heat::advance(const Context& context) {
  for (size_t i = 0; i < steps_.count; ++i) {
    context.check();
    step(double(frame_) * params_.frame + double(i) * steps_.length, context);
    ++taken_;
    check_finite(u_, "heat", taken_, double(taken_) * steps_.length,
                 solver_ ? "smaller values and sources stay finite"
                         : fmt::format("explicit steps are stable up to {:.4g}; leave step open or take scheme=backward_euler", limit()),
                 context);
  }
  ++frame_;
}

void Heat::resume(const Context& context) {
  const double time = steps_.last_before(frame_, params_.frame) + steps_.length;
  sides_.update(time, context);
  if (source_moves_) source_ = values_of(params_.source, room_.grid(), time, "heat source", context);
}

DatasetPtr Heat::dataset(const Context& context) const {
  Field temperature = whole_field(room_, u_, sides_, "temperature", params_.type, context);
  temperature.look.one_sided = true;
  return room_dataset(room_, double(frame_) * params_.frame, {std::move(temperature)});
}

}  // namespace pde

RunCost cost_of_heat(const HeatParams& p) {
  const pde::Room room = pde::make_room(p, "heat", 60, false, Context());
  const bool forward = p.scheme == HeatScheme::explicit_euler;
  const double step = p.step.value_or(forward ? pde::heat_limit(p, room) / 2 : p.frame);
  return cost_of_run(p, "heat", room.count() * (p.type == FieldType::f64 ? 8 : 4), double(room.count()) * (forward ? 3e-9 : 3e-7),
                     equal_steps(p.frame, step));
}

DatasetPtr heat(const HeatParams& p, Context& context) {
  const pde::Room room = pde::make_room(p, "heat", 60, false, context);
  const double limit = pde::heat_limit(p, room);
  if (p.scheme == HeatScheme::explicit_euler && p.step && std::min(*p.step, p.frame) > limit * (1 + 1e-9))
    context.warn(fmt::format("heat: explicit steps of {:.4g} are beyond the limit of {:.4g}: the values will grow",
                             std::min(*p.step, p.frame), limit));
  return frame_of_run<pde::Heat>(
      "heat", p, [&] { return std::make_unique<pde::Heat>(p, context); }, context);
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/wave.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "base/error.h"
#include "base/text/text.h"
#include "simulate/pde/expressions.h"

namespace sg {

void describe(Schema& s, WaveParams& p) {
  describe(s, static_cast<pde::RoomParams&>(p));
  describe(s, static_cast<FrameParams&>(p));
  s("initial", p.initial, "Height at time 0: an expression of x, y and z; default: a round bump of height 1.");
  s("velocity", p.velocity, "Its change per time at time 0: an expression of x, y and z.");
  s("speed", p.speed, "Speed of the waves, length per time.").range(0, 1e100);
  s("source", p.source, "Acceleration of the height: an expression of x, y, z and time.");
  s("step", p.step, "Time step; stable up to 1 / (speed sqrt(sum of 1/h^2)). Default: just below that.").unit("time").positive();
}

namespace pde {

namespace {

double wave_limit(const WaveParams& p, const Room& room) { return 1 / (p.speed * std::sqrt(room.couplings())); }

}  // namespace

Wave::Wave(const WaveParams& p, const Context& context)
    : params_(p),
      room_(make_room(p, "wave", 80, true, context)),
      initial_(p.initial.empty() ? bump_in(room_, 150, {0.35, 0.6, 0.5}) : p.initial),
      steps_(steps_of_frame(p.frame, p.step, 0.98 * limit(), "wave")),
      sides_(room_, "wave", 0, context),
      u_(values_of(initial_, room_.grid(), 0, "wave initial", context)),
      before_(room_.n()),
      velocity_(values_of(p.velocity, room_.grid(), 0, "wave velocity", context)),
      source_(values_of(p.source, room_.grid(), 0, "wave source", context)),
      rate_(room_.n()),
      source_moves_(depends_on_time(p.source)) {
  if (!(p.speed >= 0) || !std::isfinite(p.speed))
    fail_usage(fmt::format("a speed of {}", exact_number(p.speed)), "wave speed", "give 0 or more");
  for (size_t s = 0; s < 6; ++s)
    if (room_.sides()[s].kind == SideKind::absorbing && !sides_.of(s).values.empty())
      sides_.of(s) = values_of(initial_, side_grid(room_, s), 0, "wave initial", context);
}

double Wave::limit() const { return wave_limit(params_, room_); }

void Wave::step(double time, const Context& context) {
  const double dt = steps_.length, c = params_.speed, c2 = c * c;
  laplacian(room_, u_, sides_, rate_, context);
  double *const u = u_.values.data(), *const before = before_.values.data();
  const double *const rate = rate_.values.data(), *const s = source_.values.data(), *const v = velocity_.values.data();
  if (taken_ == 0)
    each_index(u_.values.size(), context, [=](size_t i) { before[i] = u[i] + dt * v[i] + dt * dt / 2 * (c2 * rate[i] + s[i]); });
  else each_index(u_.values.size(), context, [=](size_t i) { before[i] = 2 * u[i] - before[i] + dt * dt * (c2 * rate[i] + s[i]); });
  std::swap(u_, before_);
  for (size_t side = 0; side < 6; ++side) {
    if (room_.sides()[side].kind != SideKind::absorbing || sides_.of(side).values.empty()) continue;
    const double h = room_.axes[side / 2].h(), k = (c * dt - h) / (c * dt + h);
    Values& g = sides_.of(side);
    SideValues::each(u_.n, side,
                     [&](size_t place, size_t at) { g.values[at] = before_.values[place] + k * (u_.values[place] - g.values[at]); });
  }
  sides_.update(time + dt, context);
  if (source_moves_) source_ = values_of(params_.source, room_.grid(), time + dt, "wave source", context);
}

void Wave::advance(const Context& context) {
  for (size_t i = 0; i < steps_.count; ++i) {
    context.check();
    step(double(frame_) * params_.frame + double(i) * steps_.length, context);
    ++taken_;
    check_finite(u_, "wave", taken_, double(taken_) * steps_.length, fmt::format("steps are stable up to {:.4g}; leave step open", limit()),
                 context);
  }
  ++frame_;
}

void Wave::resume(const Context& context) {
  const double time = steps_.last_before(frame_, params_.frame) + steps_.length;
  if (taken_ > 0) sides_.update(time, context);
  if (source_moves_ && taken_ > 0) source_ = values_of(params_.source, room_.grid(), time, "wave source", context);
}

DatasetPtr Wave::dataset(const Context& context) const {
  Field height = whole_field(room_, u_, sides_, "height", params_.type, context);
  height.look.two_sided = true;
  return room_dataset(room_, double(frame_) * params_.frame, {std::move(height)});
}

}  // namespace pde

RunCost cost_of_wave(const WaveParams& p) {
  const pde::Room room = pde::make_room(p, "wave", 80, true, Context());
  return cost_of_run(p, "wave", room.count() * (p.type == FieldType::f64 ? 8 : 4), double(room.count()) * 3e-9,
                     equal_steps(p.frame, p.step.value_or(0.98 * pde::wave_limit(p, room))));
}

DatasetPtr wave(const WaveParams& p, Context& context) {
  const double limit = pde::wave_limit(p, pde::make_room(p, "wave", 80, true, context));
  if (p.step && std::min(*p.step, p.frame) > limit * (1 + 1e-9))
    context.warn(
        fmt::format("wave: steps of {:.4g} are beyond the limit of {:.4g}: the values will grow", std::min(*p.step, p.frame), limit));
  return frame_of_run<pde::Wave>(
      "wave", p, [&] { return std::make_unique<pde::Wave>(p, context); }, context);
}

}  // namespace sg

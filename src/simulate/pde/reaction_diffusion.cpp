// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/reaction_diffusion.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/text/text.h"
#include "simulate/pde/expressions.h"

namespace sg {

void describe(Schema& s, ReactionDiffusionParams& p) {
  describe(s, static_cast<pde::RoomParams&>(p));
  describe(s, static_cast<FrameParams&>(p));
  s("model", p.model, "gray_scott: spots and stripes that feed on u. fitzhugh_nagumo: waves and spirals in an excitable medium.");
  s("initial_u", p.initial_u, "u at time 0: an expression of x, y and z; default: the model's own.");
  s("initial_v", p.initial_v, "v at time 0, likewise.");
  s("diffusivity_u", p.diffusivity_u,
    "Du, length^2 per time; default: 8e-6 (fitzhugh_nagumo: 2e-5) times the square of the longest side, which counts as 128 cells at "
    "least.")
      .range(0, 1e100);
  s("diffusivity_v", p.diffusivity_v, "Dv; default: half of that (fitzhugh_nagumo: 0).").range(0, 1e100);
  s("feed", p.feed, "gray_scott: how fast u comes in and both go out.");
  s("kill", p.kill, "gray_scott: how fast v goes out besides.");
  s("threshold", p.threshold, "fitzhugh_nagumo: how far the medium is from waking by itself.");
  s("damping", p.damping, "fitzhugh_nagumo: share of v that it loses.");
  s("recovery", p.recovery, "fitzhugh_nagumo: how fast v follows u.");
  s("step", p.step, "Time step; default: what diffusion and reaction allow.").unit("time").positive();
}

namespace pde {

namespace {

struct Beginning {
  std::string u, v;
};
Beginning beginning_of(const ReactionDiffusionParams& p, const Room& room) {
  const std::string x = place_in(room, 0), y = place_in(room, 1), z = place_in(room, 2);
  Beginning b;
  if (p.model == Reaction::gray_scott) {
    constexpr double spots[][3] = {{0.5, 0.5, 0.1}, {0.25, 0.3, 0.05}, {0.7, 0.28, 0.06}, {0.35, 0.75, 0.05}, {0.8, 0.7, 0.04}};
    std::string inside;
    for (const auto& s : spots)
      inside += fmt::format("{}hypot(hypot({}-{},{}-{}),{}-0.5)<{}", inside.empty() ? "" : "||", x, s[0], y, s[1], z, s[2]);
    b = {fmt::format("if({},0.5,1)", inside), fmt::format("if({},0.25,0)", inside)};
  } else {  // a wave with a free end, which curls up
    b = {fmt::format("if({}<0.5&&abs({}-0.5)<0.05,2,-1.2)", x, y), fmt::format("if({0}<0.5&&{1}<0.45&&{1}>0.3,1,-0.62)", x, y)};
  }
  if (!p.initial_u.empty()) b.u = p.initial_u;
  if (!p.initial_v.empty()) b.v = p.initial_v;
  return b;
}

// What is given, or what makes patterns of about a tenth of the longest side; larger where cells would be too long for them.
double rd_diffusivity(const std::optional<double>& given, double own, const Room& room) {
  double longest = 0;
  for (const Axis& a : room.axes) longest = std::max(longest, a.length);
  return given.value_or(own * std::max(longest * longest, room.smallest_h() * room.smallest_h() * 128 * 128));
}

std::array<double, 2> rd_diffusivities(const ReactionDiffusionParams& p, const Room& room) {
  const bool spots = p.model == Reaction::gray_scott;
  return {rd_diffusivity(p.diffusivity_u, spots ? 8e-6 : 2e-5, room), rd_diffusivity(p.diffusivity_v, spots ? 4e-6 : 0, room)};
}

constexpr const char* rd_name = "reaction_diffusion";

// Diffusion and reaction shrink what is fastest at these rates together; the method's region of stability ends at 2.51 of them.
double rd_step(const ReactionDiffusionParams& p, const Room& room, double d) {
  const double reaction = p.model == Reaction::gray_scott ? 1 : 4;  // fitzhugh_nagumo: u^2 - 1 at the largest u, about 2.2
  return std::min(0.7 * 2.51 / (4 * d * room.couplings() + reaction), 1.0);
}

}  // namespace

ReactionDiffusion::ReactionDiffusion(const ReactionDiffusionParams& p, const Context& context)
    : params_(p),
      room_(make_room(p, rd_name, 100, false, context)),
      du_(rd_diffusivities(p, room_)[0]),
      dv_(rd_diffusivities(p, room_)[1]),
      steps_(steps_of_frame(p.frame, p.step, rd_step(p, room_, std::max(du_, dv_)), rd_name)),
      sides_(room_, rd_name, 0, context) {
  for (const double d : {du_, dv_})
    if (!(d >= 0) || !std::isfinite(d)) fail_usage(fmt::format("a diffusivity of {}", exact_number(d)), rd_name, "give 0 or more");
  const Beginning b = beginning_of(p, room_);
  values_ = {values_of(b.u, room_.grid(), 0, "reaction_diffusion initial_u", context),
             values_of(b.v, room_.grid(), 0, "reaction_diffusion initial_v", context)};
  base_ = slope_ = values_;
}

void ReactionDiffusion::rates(const std::vector<Values>& at, double time, std::vector<Values>& out, const Context& context) {
  sides_.update(time, context);
  for (size_t f = 0; f < 2; ++f) laplacian(room_, at[f], sides_, out[f], context);
  const double *const u = at[0].values.data(), *const v = at[1].values.data();
  double *const a = out[0].values.data(), *const b = out[1].values.data();
  const double du = du_, dv = dv_, feed = params_.feed, kill = params_.kill;
  const double threshold = params_.threshold, damping = params_.damping, recovery = params_.recovery;
  if (params_.model == Reaction::gray_scott)
    each_index(at[0].values.size(), context, [=](size_t i) {
      const double r = u[i] * v[i] * v[i];
      a[i] = du * a[i] - r + feed * (1 - u[i]), b[i] = dv * b[i] + r - (feed + kill) * v[i];
    });
  else
    each_index(at[0].values.size(), context, [=](size_t i) {
      a[i] = du * a[i] + u[i] - u[i] * u[i] * u[i] / 3 - v[i], b[i] = dv * b[i] + recovery * (u[i] + threshold - damping * v[i]);
    });
}

void ReactionDiffusion::advance(const Context& context) {
  for (size_t i = 0; i < steps_.count; ++i) {
    context.check();
    const double time = double(frame_) * params_.frame + double(i) * steps_.length;
    shu_osher_step(values_, base_, slope_, time, steps_.length, context,
                   [&](const std::vector<Values>& at, double t, std::vector<Values>& out) { rates(at, t, out, context); });
    ++taken_;
    for (const Values& v : values_)
      check_finite(v, rd_name, taken_, time + steps_.length, "shorter steps, or initial values nearer to 1", context);
  }
  ++frame_;
  resume(context);
}

void ReactionDiffusion::resume(const Context& context) { sides_.update(double(frame_) * params_.frame, context); }

DatasetPtr ReactionDiffusion::dataset(const Context& context) const {
  std::vector<Field> fields{whole_field(room_, values_[1], sides_, "v", params_.type, context),
                            whole_field(room_, values_[0], sides_, "u", params_.type, context)};
  for (Field& f : fields) f.look.one_sided = params_.model == Reaction::gray_scott;
  return room_dataset(room_, double(frame_) * params_.frame, std::move(fields));
}

}  // namespace pde

RunCost cost_of_reaction_diffusion(const ReactionDiffusionParams& p) {
  const pde::Room room = pde::make_room(p, pde::rd_name, 100, false, Context());
  const auto [u, v] = pde::rd_diffusivities(p, room);
  return cost_of_run(p, pde::rd_name, 2 * room.count() * (p.type == FieldType::f64 ? 8 : 4), double(room.count()) * 2e-8,
                     equal_steps(p.frame, p.step.value_or(pde::rd_step(p, room, std::max(u, v)))));
}

DatasetPtr reaction_diffusion(const ReactionDiffusionParams& p, Context& context) {
  return frame_of_run<pde::ReactionDiffusion>(
      "reaction_diffusion", p, [&] { return std::make_unique<pde::ReactionDiffusion>(p, context); }, context);
}

}  // namespace sg

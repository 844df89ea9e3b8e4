// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/advection_diffusion.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "base/error.h"
#include "base/text/text.h"
#include "simulate/pde/expressions.h"
#include "simulate/pde/stencil.h"

namespace sg {

void describe(Schema& s, AdvectionDiffusionParams& p) {
  describe(s, static_cast<pde::RoomParams&>(p));
  describe(s, static_cast<FrameParams&>(p));
  s("initial", p.initial, "Concentration at time 0: an expression of x, y and z; default: 1 in a ball.");
  s("velocity", p.velocity,
    "Of the flow: an expression of x, y, z and time with three components, vec(u,v,w); default: about the middle, along a line from end to "
    "end in time 1.");
  s("source", p.source, "What is added per time: an expression of x, y, z and time.");
  s("diffusivity", p.diffusivity, "kappa, length^2 per time.").range(0, 1e100);
  s("scheme", p.scheme,
    "Value at the faces of cells: upwind smears; central oscillates where cells are longer than 2 kappa/|u|; limited does neither.");
  s("step", p.step, "Time step; default: what the fastest flow and diffusion allow.").unit("time").positive();
}

namespace pde {

namespace {

constexpr const char* ad_name = "advection_diffusion";

}  // namespace

AdvectionDiffusion::AdvectionDiffusion(const AdvectionDiffusionParams& p, const Context& context)
    : params_(p),
      room_(make_room(p, ad_name, 120, false, context)),
      sides_(room_, ad_name, 0, context),
      source_(values_of(p.source, room_.grid(), 0, "advection_diffusion source", context)),
      flow_moves_(depends_on_time(p.velocity)),
      source_moves_(depends_on_time(p.source)) {
  const bool line = room_.axes[0].flat() || room_.axes[1].flat();
  const std::string x = place_in(room_, 0), y = place_in(room_, 1);
  if (params_.velocity.empty()) {
    double longest = 0;
    for (const Axis& a : room_.axes) longest = std::max(longest, a.length);
    const std::string l = exact_number(longest);
    params_.velocity = line ? fmt::format("vec({0},{0},{0})", l)
                            : fmt::format("{}*vec({}-{},{}-{},0)", l, exact_number(room_.axes[1].length / longest / 2), y, x,
                                          exact_number(room_.axes[0].length / longest / 2));
  }
  if (params_.initial.empty())  // the ball is the top of a bump
    params_.initial = bump_in(room_, 1, line ? std::array{0.3, 0.3, 0.3} : std::array{0.5, 0.75, 0.5}) + ">exp(-0.0225)";
  values_ = {values_of(params_.initial, room_.grid(), 0, "advection_diffusion initial", context)};
  base_ = slope_ = values_;
  if (!(p.diffusivity >= 0) || !std::isfinite(p.diffusivity))
    fail_usage(fmt::format("a diffusivity of {}", exact_number(p.diffusivity)), "advection_diffusion diffusivity", "give 0 or more");
  steps_of_frame(p.frame, p.step, p.frame, ad_name);
  find_velocity(0, context);
}

void AdvectionDiffusion::find_velocity(double time, const Context& context) {
  for (size_t a = 0; a < 3; ++a) {
    if (room_.axes[a].flat()) continue;
    UniformGrid faces = room_.grid();
    ++faces.dims[a];
    faces.origin[int(a)] -= faces.spacing[int(a)] / 2;
    velocity_[a] = values_of(params_.velocity, faces, time, "advection_diffusion velocity", context, int(a));
  }
}

double AdvectionDiffusion::limit(const Context& context) const {
  double rate = 2 * params_.diffusivity * room_.couplings();
  for (size_t a = 0; a < 3; ++a)
    if (!room_.axes[a].flat()) rate += fluid::largest(velocity_[a], context) / room_.axes[a].h();
  return 1 / rate;
}

// Takes what the flow carries through the faces across an axis from `out`.
void AdvectionDiffusion::carry(size_t axis, const Values& c, Values& out, const Context& context) const {
  const Axis& line = room_.axes[axis];
  const size_t n = line.n;
  size_t stride = 1;
  for (size_t a = 0; a < axis; ++a) stride *= c.n[a];
  const size_t lines = c.values.size() / n;
  const FluxScheme scheme = params_.scheme;
  const double per = 1 / line.h();
  const Values &low = sides_.of(2 * axis), &high = sides_.of(2 * axis + 1);
  const bool round = line.lo.kind == SideKind::periodic;
  parallel_for(
      lines, rows_at_once,
      [&](size_t begin, size_t end) {
        std::vector<double> v(n + 4), flux(n + 1);  // two values beyond each side
        for (size_t l = begin; l < end; ++l) {
          const size_t inner = l % stride, outer = l / stride;
          const double* const from = c.values.data() + inner + outer * n * stride;
          const double* const speed = velocity_[axis].values.data() + inner + outer * (n + 1) * stride;
          for (size_t i = 0; i < n; ++i) v[i + 2] = from[i * stride];
          v[1] = round ? v[n + 1] : line.lo.wall() ? low.values[l] : v[2];
          v[0] = round ? v[n] : v[1];
          v[n + 2] = round ? v[2] : line.hi.wall() ? high.values[l] : v[n + 1];
          v[n + 3] = round ? v[3] : v[n + 2];
          if (round && n == 2) v[0] = v[2];
          for (size_t f = 0; f <= n; ++f) {
            const double u = speed[f * stride];
            const double* const at = v.data() + f + 1;  // at[0] before the face, at[1] behind it
            double value = u > 0 ? at[0] : at[1];
            if (scheme == FluxScheme::central) value = (at[0] + at[1]) / 2;
            if (scheme == FluxScheme::limited) {
              const double s = u > 0 ? at[0] - at[-1] : at[1] - at[2], t = u > 0 ? at[1] - at[0] : at[0] - at[1];
              if (s * t > 0) value += s * t / (s + t);
            }
            flux[f] = u * value;
          }
          double* const to = out.values.data() + inner + outer * n * stride;
          for (size_t i = 0; i < n; ++i) to[i * stride] -= (flux[i + 1] - flux[i]) * per;
        }
      },
      &context);
}

void AdvectionDiffusion::advance(const Context& context) {
  const double start = double(frame_) * params_.frame;
  if (flow_moves_) find_velocity(start, context);
  const Steps steps = steps_of_frame(params_.frame, params_.step, 0.5 * limit(context), ad_name);
  for (size_t i = 0; i < steps.count; ++i) {
    context.check();
    const double time = start + double(i) * steps.length;
    shu_osher_step(values_, base_, slope_, time, steps.length, context,
                   [&](const std::vector<Values>& at, double t, std::vector<Values>& out) {
                     sides_.update(t, context);
                     if (flow_moves_) find_velocity(t, context);
                     if (source_moves_) source_ = values_of(params_.source, room_.grid(), t, "advection_diffusion source", context);
                     laplacian(room_, at[0], sides_, out[0], context);
                     double* const to = out[0].values.data();
                     const double* const s = source_.values.data();
                     const double kappa = params_.diffusivity;
                     each_index(out[0].values.size(), context, [=](size_t k) { to[k] = kappa * to[k] + s[k]; });
                     for (size_t a = 0; a < 3; ++a)
                       if (!room_.axes[a].flat()) carry(a, at[0], out[0], context);
                   });
    ++taken_;
    check_finite(values_[0], ad_name, taken_, time + steps.length,
                 fmt::format("steps are stable up to about {:.4g}; leave step open", limit(context)), context);
  }
  ++frame_;
  sides_.update(double(frame_) * params_.frame, context);
}

void AdvectionDiffusion::resume(const Context& context) { sides_.update(double(frame_) * params_.frame, context); }

DatasetPtr AdvectionDiffusion::dataset(const Context& context) const {
  Field concentration = whole_field(room_, values_[0], sides_, "concentration", params_.type, context);
  concentration.look.one_sided = true;
  return room_dataset(room_, double(frame_) * params_.frame, {std::move(concentration)});
}

}  // namespace pde

RunCost cost_of_advection_diffusion(const AdvectionDiffusionParams& p) {
  const pde::Room room = pde::make_room(p, "advection_diffusion", 120, false, Context());
  double steps = p.step ? equal_steps(p.frame, *p.step) : 0;
  if (!p.step) {  // as the flow at the beginning allows, which is looked at on a coarse grid
    AdvectionDiffusionParams coarse = p;
    coarse.size = std::min(p.size, 24), coarse.initial = coarse.source = "0", coarse.diffusivity = 0;
    const Context context;
    const double rate = 1 / pde::AdvectionDiffusion(coarse, context).limit(context),
                 finer = pde::make_room(coarse, "advection_diffusion", 120, false, context).smallest_h() / room.smallest_h();
    steps = equal_steps(p.frame, 0.5 / (2 * p.diffusivity * room.couplings() + rate * finer));
  }
  return cost_of_run(p, "advection_diffusion", room.count() * (p.type == FieldType::f64 ? 8 : 4), double(room.count()) * 5e-8, steps);
}

DatasetPtr advection_diffusion(const AdvectionDiffusionParams& p, Context& context) {
  return frame_of_run<pde::AdvectionDiffusion>(
      "advection_diffusion", p, [&] { return std::make_unique<pde::AdvectionDiffusion>(p, context); }, context);
}

}  // namespace sg

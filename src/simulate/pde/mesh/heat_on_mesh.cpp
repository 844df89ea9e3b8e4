// SPDX-License-Identifier: Apache-2.0
#include "simulate/pde/mesh/heat_on_mesh.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "base/union_find.h"
#include "filter/field/calc/calc.h"
#include "simulate/pde/expressions.h"
#include "simulate/pde/march.h"
#include "simulate/pde/mesh/mesh_numbers.h"

namespace sg {

void describe(Schema& s, HeatOnMeshParams& p) {
  describe(s, static_cast<FrameParams&>(p));
  s("steady", p.steady,
    "The temperatures at which nothing changes any more, instead of those at a time: Laplace's and Poisson's equation.");
  s("field", p.field, "Temperature at time 0, unless initial gives it; default: the active scalar, or 0 where values are held.")
      .takes(fields::scalars);
  s("initial", p.initial, "Temperature at time 0 as an expression of x, y, z and fields.");
  s("held", p.held,
    "Where values are held: an expression that is not 0 there, such as border, z<0.1 or label==3. border: points on the border. Cells "
    "hold all of their points. Default: nowhere.");
  s("value", p.value, "The values held: an expression, also of time; default: the initial ones.");
  s("source", p.source, "Temperature that is added per time: an expression of x, y, z, time and fields.");
  s("diffusivity", p.diffusivity,
    "kappa, length^2 per time: a number, field or expression, 0 or more. Default: the square of the mesh's diagonal / 50, so that heat "
    "crosses the mesh in a time of about 5.");
  s("scheme", p.scheme, "Both are stable for any step. backward_euler: order 1; crank_nicolson: order 2, rings after jumps in long steps.");
  s("step", p.step, "Time step; default: one a frame.").unit("time").positive();
  s("name", p.name, "Name of the new field.");
  s("tolerance", p.tolerance, "What may be left of the residual, as a share of the right side.").range(1e-14, 0.1);
  s("iterations", p.iterations, "Iterations of the solver a step, at most.").range(1, 10000000);
}

namespace pde {

namespace {

constexpr const char* mesh_heat = "heat_on_mesh";

bool says_border(const HeatOnMeshParams& p) {
  for (const std::string* e : {&p.initial, &p.held, &p.value, &p.source, &p.diffusivity}) {
    const auto names = names_in_expression(*e);
    if (std::find(names.begin(), names.end(), "border") != names.end()) return true;
  }
  return false;
}

}  // namespace

MeshHeat::MeshHeat(DatasetPtr mesh, const HeatOnMeshParams& p, const Context& context)
    : params_(p), mesh_(mesh), shown_(std::move(mesh)), simplices_(simplices_of(mesh_, mesh_heat, context)) {
  if (p.name.empty()) fail_usage("the new field has no name", "heat_on_mesh name");
  const Steps steps = steps_of_frame(p.frame, p.step, p.frame, mesh_heat);
  steps_ = steps.count, dt_ = steps.length;
  if (says_border(p) && !mesh_->fields().find("border")) {
    const std::vector<uint8_t> border = border_points(simplices_);
    DatasetParts parts = mesh_->parts();
    parts.fields.add({"border", Association::point,
                      Array::from_vector(std::vector<uint8_t>(border.begin(), border.begin() + long(simplices_.points))), "", Role::none});
    mesh_ = make_dataset(std::move(parts));
  }
  // Diffusivities of the simplices.
  std::vector<double> kappa(simplices_.size());
  if (p.diffusivity.empty()) {
    const Vec3 size = mesh_->bounds().size();
    std::fill(kappa.begin(), kappa.end(), dot(size, size) / 50);
  } else {
    kappa = simplex_numbers(simplices_, mesh_numbers(mesh_, p.diffusivity, 0, "heat_on_mesh diffusivity", context));
    for (size_t t = 0; t < kappa.size(); ++t)
      if (!(kappa[t] >= 0) || !std::isfinite(kappa[t]))
        fail_data(fmt::format("the diffusivity is {} in cell {}", exact_number(kappa[t]), simplices_.cell[t]), "heat_on_mesh diffusivity",
                  "it must be 0 or more everywhere");
  }
  stiffness_ = stiffness_of(simplices_, kappa, context);
  const size_t n = simplices_.at.size();
  // The beginning.
  std::string initial = p.initial;
  if (initial.empty()) {
    const Field* f = p.field.empty() ? mesh_->fields().active(1) : &mesh_->fields().require(p.field.name);
    if (f && (!p.field.empty() || p.held.empty())) initial = "\"" + f->name + "\"";
    else if (p.held.empty() && !depends_on_time(p.source) && p.source == "0")
      fail_usage("nothing is warm", "heat_on_mesh", "give initial=EXPRESSION, or held=border and value=EXPRESSION, or source=EXPRESSION");
    else initial = "0";
  }
  u_ = numbers_at(initial, "initial", 0, context);
  source_ = numbers_at(p.source, "source", 0, context);
  right_.resize(n);
  held_.resize(n);
  source_moves_ = depends_on_time(p.source), value_moves_ = depends_on_time(p.value);
  if (p.held.empty() && !p.value.empty())
    fail_usage("nothing says where the value is held", "heat_on_mesh value", "add held=border or the like");
  if (p.held.empty()) return;
  held_ = marked_points(simplices_, mesh_numbers(mesh_, p.held, 0, "heat_on_mesh held", context));
  if (std::none_of(held_.begin(), held_.end(), [](uint8_t h) { return h; })) {
    if (!context.parts || context.parts->size() < 2)
      fail_usage("no point is held", "heat_on_mesh held", "the expression is 0 everywhere; border holds the points on the border");
    context.warn("heat_on_mesh: no point of a part is held");
  }
  if (!p.value.empty()) hold(numbers_at(params_.value, "value", 0, context));
}

std::vector<double> MeshHeat::numbers_at(const std::string& expression, const char* word, double time, const Context& context) const {
  const std::string who = fmt::format("heat_on_mesh {}", word);
  std::vector<double> out = point_numbers(simplices_, mesh_numbers(mesh_, expression, time, who, context));
  const bool held_alone = &expression == &params_.value;
  for (size_t i = 0; i < out.size(); ++i)
    if (!std::isfinite(out[i]) && stiffness_.mass[i] > 0 && (!held_alone || held_[i])) {
      const Vec3 p = simplices_.at[i];
      fail_data(fmt::format("{} at {}, {}, {}", std::isnan(out[i]) ? "not a number" : "infinite", exact_number(p.x), exact_number(p.y),
                            exact_number(p.z)),
                who, "a finite value is needed at every point");
    }
  return out;
}

void MeshHeat::hold(const std::vector<double>& values) {
  for (size_t i = 0; i < u_.size(); ++i)
    if (held_[i]) u_[i] = values[i];
}

void MeshHeat::advance(const Context& context) {
  const double before = params_.scheme == MeshHeatScheme::crank_nicolson ? 0.5 : 0;
  const size_t n = u_.size();
  for (size_t step = 0; step < steps_; ++step) {
    context.check();
    const double next = double(frame_) * params_.frame + double(step + 1) * dt_;
    if (before > 0) apply(stiffness_, 1, -before * dt_, u_, right_, context);
    else
      for (size_t i = 0; i < n; ++i) right_[i] = stiffness_.mass[i] * u_[i];
    for (size_t i = 0; i < n; ++i) right_[i] += before * dt_ * stiffness_.mass[i] * source_[i];
    if (source_moves_) source_ = numbers_at(params_.source, "source", next, context);
    for (size_t i = 0; i < n; ++i) right_[i] += (1 - before) * dt_ * stiffness_.mass[i] * source_[i];
    if (value_moves_) hold(numbers_at(params_.value, "value", next, context));
    const FemSolve s = solve(stiffness_, 1, (1 - before) * dt_, right_, held_, params_.tolerance, params_.iterations, u_, context);
    const size_t taken = frame_ * steps_ + step + 1;
    if (!std::isfinite(s.residual))
      fail_data(fmt::format("the values grew beyond all numbers in step {} (time {:.6g})", taken, next), mesh_heat);
    if (!s.reached && s.residual > 1e-3)
      fail_data(fmt::format("step {} (time {:.6g}) is solved to {:.3g} only", taken, next, s.residual), mesh_heat,
                "a larger tolerance, more iterations or a shorter step");
    if (!s.reached && s.iterations == params_.iterations)
      context.warn(fmt::format("heat_on_mesh: the residual of step {} is {:.3g} after {} iterations", taken, s.residual, s.iterations));
  }
  ++frame_;
}

void MeshHeat::settle(const Context& context) {
  const size_t n = u_.size();
  for (size_t i = 0; i < n; ++i) right_[i] = stiffness_.mass[i] * source_[i];
  // Each piece of the mesh that nothing holds keeps its mean; its sources must balance.
  UnionFind<> pieces(n);
  for (size_t i = 0; i < n; ++i)
    for (size_t e = stiffness_.begin[i]; e < stiffness_.begin[i + 1]; ++e)
      if (stiffness_.value[e] != 0) pieces.join(uint32_t(i), stiffness_.column[e]);
  std::vector<double> flow(n), size(n), mass(n), heat(n);
  std::vector<uint8_t> fixed(n);
  for (size_t i = 0; i < n; ++i) {
    const size_t r = pieces.root(uint32_t(i));
    flow[r] += right_[i], size[r] += std::abs(right_[i]), mass[r] += stiffness_.mass[i], heat[r] += stiffness_.mass[i] * u_[i];
    fixed[r] = fixed[r] || held_[i];
  }
  for (size_t i = 0; i < n; ++i) {
    const size_t r = pieces.root(uint32_t(i));
    if (fixed[r] || !(mass[r] > 0)) continue;
    if (std::abs(flow[r]) > 0.01 * size[r])
      fail_data(fmt::format("there is no steady state: about {}, {}, {} nothing is held, yet the source has a mean of {}",
                            exact_number(simplices_.at[r].x), exact_number(simplices_.at[r].y), exact_number(simplices_.at[r].z),
                            exact_number(flow[r] / mass[r])),
                mesh_heat, "hold the value somewhere, such as held=border, or give a source of mean 0");
    right_[i] -= flow[r] / mass[r] * stiffness_.mass[i];
  }
  const FemSolve s = solve(stiffness_, 0, 1, right_, held_, params_.tolerance, params_.iterations, u_, context);
  if (!std::isfinite(s.residual)) fail_data("the values grew beyond all numbers", mesh_heat);
  if (!s.reached) context.warn(fmt::format("heat_on_mesh: the residual is {:.3g} after {} iterations", s.residual, s.iterations));
  std::vector<double> now(n);
  for (size_t i = 0; i < n; ++i) now[pieces.root(uint32_t(i))] += stiffness_.mass[i] * u_[i];
  for (size_t i = 0; i < n; ++i)
    if (const size_t r = pieces.root(uint32_t(i)); !fixed[r] && mass[r] > 0) u_[i] += (heat[r] - now[r]) / mass[r];
}

DatasetPtr MeshHeat::dataset(const Context&) const {
  DatasetParts parts = shown_->parts();
  if (!params_.steady) parts.time = double(frame_) * params_.frame;
  Field f{params_.name, Association::point, Array::from_vector(std::vector<double>(u_.begin(), u_.begin() + long(simplices_.points))), "",
          Role::scalars};
  f.look.result = f.look.one_sided = true;
  parts.fields.add(std::move(f));
  return make_dataset(std::move(parts));
}

}  // namespace pde

}  // namespace sg

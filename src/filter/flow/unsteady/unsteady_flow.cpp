// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/unsteady/unsteady_flow.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/text.h"
#include "data/cells/point_positions.h"
#include "data/trusted.h"
#include "filter/flow/flow_parts.h"
#include "filter/flow/geographic.h"
#include "filter/mesh/append.h"

namespace sg {

UnsteadyFlow::UnsteadyFlow(Series series, std::string field, TimeInterpolation interpolation, Context&, bool geographic)
    : series_(std::move(series)), field_(std::move(field)), interpolation_(interpolation), geographic_(geographic) {
  const auto& t = series_.times;
  if (t.size() < 2)
    fail_usage(fmt::format("the series has {} time step{}", t.size(), t.size() == 1 ? "" : "s"), "unsteady flow",
               "at least two are needed; streamlines trace a steady flow");
  for (size_t i = 0; i < t.size(); ++i) {
    if (!std::isfinite(t[i])) fail_data(fmt::format("step {} has the time {}", i, t[i]), "unsteady flow", "times must be finite");
    if (i > 0 && !(t[i] > t[i - 1]))
      fail_data(
          fmt::format("the times do not increase: step {} has {}, step {} has {}", i - 1, exact_number(t[i - 1]), i, exact_number(t[i])),
          "unsteady flow", "times must increase; times= selects steps");
  }
}

size_t UnsteadyFlow::interval_of(double t, int sign) const {
  const auto& all = times();
  const auto at = sign > 0 ? std::upper_bound(all.begin(), all.end(), t) : std::lower_bound(all.begin(), all.end(), t);
  return size_t(std::clamp<ptrdiff_t>(at - all.begin() - 1, 0, ptrdiff_t(intervals()) - 1));
}

namespace {

// Where the step comes from, for messages.
std::string source_of(const Data& data) {
  std::string file;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
    for (const auto& [key, text] : d->notes())
      if (key == "file" && file.empty()) file = text;
  });
  return file;
}

// The parts of a collection through which the flow goes, as one mesh; `field` becomes the name of the velocity.
DatasetPtr one_mesh(const Data& data, std::string& field, Context& context) {
  const auto take = [&] {
    const std::vector<DatasetPtr> parts = flow_meshes(data, field, "unsteady flow");
    if (parts.size() == 1) return parts.front();
    Context quiet(context, 0, 1);  // the same of each step
    quiet.on_log = nullptr, quiet.on_progress = nullptr;
    AppendParams p;
    p.part = false;
    return append(std::vector<Data>(parts.begin(), parts.end()), p, quiet);
  };
  const std::string file = source_of(data);
  return file.empty() ? take() : with_context(fmt::format("inspecting '{}'", file), take);
}

}  // namespace

FlowField UnsteadyFlow::load(size_t step, Context& context) {
  return with_context(fmt::format("loading time step {} (time {})", step, exact_number(times()[step])), [&] {
    std::string name = field_;
    DatasetPtr d = one_mesh(series_.load(step), name, context);
    if (geographic_) {
      seconds_ = seconds_of_time(*d);
      d = std::get<DatasetPtr>(geographic_flow(d, name, seconds_, "unsteady flow"));
    }
    std::shared_ptr<const CellLocator> index;
    for (const FlowField& open : steps_)
      if (!index && same_mesh(*open.dataset(), *d)) index = open.locator();
    if (!index) {  // without the fields, which would live as long as any step shares it
      DatasetParts bare;
      bare.mesh = d->mesh(), bare.point_ghost = d->point_ghost(), bare.cell_ghost = d->cell_ghost();
      index = std::make_shared<const CellLocator>(make_trusted_dataset(std::move(bare)), context);
    }
    return FlowField(d, name, context, std::move(index));
  });
}

void UnsteadyFlow::open(size_t k, Context& context) {
  if (k >= intervals()) fail_internal(fmt::format("there is no interval {} of {}", k, intervals()), "unsteady flow");
  if (k == interval_) return;
  const bool cubic = interpolation_ == TimeInterpolation::cubic;
  const size_t first = cubic && k > 0 ? k - 1 : k, last = std::min(cubic ? k + 2 : k + 1, times().size() - 1);
  interval_ = SIZE_MAX;  // should a step fail
  // What is not needed goes before anything is loaded.
  for (size_t j = steps_.size(); j-- > 0;)
    if (numbers_[j] < first || numbers_[j] > last) {
      steps_.erase(steps_.begin() + ptrdiff_t(j)), numbers_.erase(numbers_.begin() + ptrdiff_t(j));
      if (!positions_.empty()) positions_.erase(positions_.begin() + ptrdiff_t(j));
    }
  for (size_t n = first; n <= last; ++n) {
    const auto at = std::lower_bound(numbers_.begin(), numbers_.end(), n);
    if (at != numbers_.end() && *at == n) continue;
    const ptrdiff_t j = at - numbers_.begin();
    FlowField step = load(n, context);
    steps_.insert(steps_.begin() + j, std::move(step));
    numbers_.insert(numbers_.begin() + j, n);
    if (!positions_.empty()) positions_.insert(positions_.begin() + j, Array());
  }
  base_ = k - first;
  meshes_ = Meshes::same;
  for (size_t j = 1; j < steps_.size(); ++j) {
    if (steps_[j].locator() == steps_[0].locator()) continue;
    if (meshes_ != Meshes::changed) meshes_ = same_cells(*steps_[0].dataset(), *steps_[j].dataset()) ? Meshes::moving : Meshes::changed;
  }
  if (meshes_ == Meshes::moving) {
    positions_.resize(steps_.size());
    for (size_t j = 0; j < steps_.size(); ++j)
      if (positions_[j].empty()) positions_[j] = point_positions(steps_[j].dataset()->mesh()).converted(ElementType::f64);
  } else {
    positions_.clear();
  }
  interval_ = k;
}

double UnsteadyFlow::largest_speed() const {
  double most = 0;
  for (const FlowField& f : steps_) most = std::max(most, f.largest_speed());
  return most;
}

// Values v at the times around an interval from step b to step b + 1. With slopes m of the parabola through three neighbours,
// v(t) = h00 v_b + h10 d m_b + h01 v_b+1 + h11 d m_b+1.
void UnsteadyFlow::time_weights(double t, double out[4]) const {
  const size_t n = numbers_.size(), b = base_;
  auto time = [&](size_t j) { return times()[numbers_[j]]; };
  const double d = time(b + 1) - time(b), s = (t - time(b)) / d;
  for (int j = 0; j < 4; ++j) out[j] = 0;
  if (interpolation_ == TimeInterpolation::linear || n < 3) {
    out[b] = 1 - s, out[b + 1] = s;
    return;
  }
  // Adds scale times the slope, at step `at`, of the parabola through steps a, a+1, a+2.
  auto add_slope = [&](size_t a, size_t at, double scale) {
    const double t0 = time(a), t1 = time(a + 1), t2 = time(a + 2), x = time(at);
    out[a] += scale * (2 * x - t1 - t2) / ((t0 - t1) * (t0 - t2));
    out[a + 1] += scale * (2 * x - t0 - t2) / ((t1 - t0) * (t1 - t2));
    out[a + 2] += scale * (2 * x - t0 - t1) / ((t2 - t0) * (t2 - t1));
  };
  const double q = 1 - s;
  out[b] = (1 + 2 * s) * q * q, out[b + 1] = s * s * (3 - 2 * s);
  add_slope(b > 0 ? b - 1 : b, b, d * s * q * q);
  add_slope(b + 2 < n ? b : b - 1, b + 1, -d * s * s * q);
}

}  // namespace sg

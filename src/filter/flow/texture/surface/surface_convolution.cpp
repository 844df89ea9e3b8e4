// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/surface/surface_convolution.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "filter/flow/texture/brightness.h"

namespace sg {

namespace {

constexpr double most_edges_a_step = 32;
using std::numbers::pi;

/// Weights of the samples, and the standard deviation of their mean when a line has `back` and `forward` of them.
class Kernel {
 public:
  Kernel(int steps, bool hann, double steps_per_grain)
      : steps_(steps), reach_(int(std::min(std::ceil(steps_per_grain), 2.0 * steps + 1)) - 1) {  // no line is longer
    for (int k = 0; k <= steps; ++k) weight_.push_back(hann ? 0.5 + 0.5 * std::cos(pi * k / (steps + 1)) : 1.0);
    for (int d = 0; d <= reach_; ++d) correlation_.push_back(1 - d / std::max(steps_per_grain, 1.0));
  }
  double weight(int k) const { return weight_[size_t(std::abs(k))]; }
  double deviation(int back, int forward) const {
    double sum = 0, square = 0;
    for (int k = -back; k <= forward; ++k) {
      sum += weight(k), square += weight(k) * weight(k);
      for (int d = 1; d <= reach_ && k + d <= forward; ++d) square += 2 * weight(k) * weight(k + d) * correlation_[size_t(d)];
    }
    return std::sqrt(square / 12) / sum;  // the noise has variance 1/12
  }
  /// The same for whole lines, once for all.
  double whole() const { return deviation(steps_, steps_); }

 private:
  int steps_, reach_;
  std::vector<double> weight_, correlation_;
};

}  // namespace

template <class Walk>
Array convolve_surface(const RefinedSurface& r, const Walk& walk, const SurfaceConvolution& p, std::span<const float> reach,
                       const Context& context) {
  const double step = step_length(r, p.step);
  if (step > most_edges_a_step * r.edge_length)
    fail_usage(fmt::format("step={:.4g} is {:.3g} edges of the split triangles long", step, step / r.edge_length), "step",
               fmt::format("use at most {:.4g}, {:g} edges: longer steps skip what lies between", most_edges_a_step * r.edge_length,
                           most_edges_a_step));
  const Kernel kernel(p.steps, p.kernel == LineFade::hann, r.edge_length / std::max(step, 1e-300));
  const double whole = kernel.whole();

  // A triangle for each point to start from; points at one place share the number of the first. In the order of the triangles, as lines of
  // neighbours pass the same ones.
  const size_t n = r.points.size();
  std::vector<uint32_t> home(n, UINT32_MAX), order;
  order.reserve(n);
  for (size_t t = 0; t < r.triangles.size(); ++t)
    for (const uint32_t q : r.triangles[t])
      if (home[q] == UINT32_MAX) home[q] = uint32_t(t), order.push_back(q);
  std::vector<double> noises(n);  // queried often: each line passes many points
  parallel_for(n, 1 << 15, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) noises[i] = random_unit(uint64_t(p.seed), i);
  });
  const auto noise = [&](uint32_t point) { return noises[point]; };
  const auto noise_at = [&](const typename Walk::Place& at) {
    const auto& t = r.triangles[at.triangle];
    return noise(t[0]) * at.b[0] + noise(t[1]) * at.b[1] + noise(t[2]) * at.b[2];
  };
  float* lic = nullptr;
  Array result = Array::make<float>(n, 1, &lic);
  std::fill_n(lic, n, 0.5f);
  parallel_for(
      order.size(), 1024,
      [&](size_t begin, size_t end) {
        for (const uint32_t i : std::span(order).subspan(begin, end - begin)) {
          if (!reach.empty() && !(reach[i] >= 0)) continue;
          const int steps = reach.empty() ? p.steps : int(std::lround(std::min(reach[i], 1.0f) * float(p.steps)));
          double sum = kernel.weight(0) * noise(i), weights = kernel.weight(0);
          int reached[2] = {0, 0};
          bool any = !reach.empty();
          // Both ways in turn: each step waits for the one before, and so the processor has two to work on.
          typename Walk::Place ends[2] = {walk.start(home[i], i), walk.start(home[i], i)};
          bool goes[2] = {true, true};
          for (int k = 1; k <= steps && (goes[0] || goes[1]); ++k)
            for (int way = 0; way < 2; ++way) {
              if (!goes[way] || !(goes[way] = walk.advance(ends[way], step, way == 0 ? -1 : 1))) continue;
              sum += kernel.weight(k) * noise_at(ends[way]), weights += kernel.weight(k), reached[way] = k, any = true;
            }
          if (!any) continue;
          const double mean = sum / weights;
          const bool full = reached[0] == p.steps && reached[1] == p.steps;
          lic[i] = float(p.stretch ? normal_brightness((mean - 0.5) / (full ? whole : kernel.deviation(reached[0], reached[1]))) : mean);
        }
      },
      &context);
  share_same_places(r, lic);
  return result;
}

void share_same_places(const RefinedSurface& r, float* values) {
  const SurfaceMesh& made = *r.dataset->as<SurfaceMesh>();
  const View<int32_t> corners = made.polygons.connectivity.view<int32_t>();
  for (size_t t = 0; t < r.triangles.size(); ++t)
    for (size_t k = 0; k < 3; ++k) values[size_t(corners[3 * t + k])] = values[r.triangles[t][k]];
}

DatasetPtr textured_surface(const RefinedSurface& r, std::vector<Field> made) {
  DatasetParts parts = r.dataset->parts();
  FieldSet fields;
  for (Field& f : made) fields.add(std::move(f));
  for (const Field& g : parts.fields)
    if (!fields.find(g.name, g.association)) fields.add(g);
  parts.fields = std::move(fields);
  return make_dataset(std::move(parts));
}

template Array convolve_surface(const RefinedSurface&, const SurfaceWalk&, const SurfaceConvolution&, std::span<const float>,
                                const Context&);
template Array convolve_surface(const RefinedSurface&, const SurfaceAxisWalk&, const SurfaceConvolution&, std::span<const float>,
                                const Context&);

}  // namespace sg

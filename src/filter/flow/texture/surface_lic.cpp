// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/surface_lic.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "filter/flow/flow_field.h"
#include "filter/flow/texture/surface_walk.h"
#include "filter/mesh/surface.h"

namespace sg {

namespace {

constexpr size_t most_triangles = size_t(64) << 20;
constexpr double pi = 3.14159265358979323846;

std::vector<Vec3> vectors_of(const Field& f) {
  std::vector<Vec3> out(f.array.count());
  dispatch(f.array, [&](auto v) {
    parallel_for(v.count, 1 << 14, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) out[i] = {double(v(i, 0)), double(v(i, 1)), f.components() > 2 ? double(v(i, 2)) : 0.0};
    });
  });
  return out;
}

/// Weights of the samples, and the standard deviation of their mean when a line has `back` and `forward` of them.
class Kernel {
 public:
  Kernel(int steps, bool hann, double steps_per_grain) : steps_(steps), reach_(int(std::ceil(steps_per_grain)) - 1) {
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

/// About the share of the normal distribution below a value of z deviations.
double brightness(double z) {
  const double s = 0.8 * z;
  return 0.5 + 0.5 * s / std::sqrt(1 + s * s);
}

}  // namespace

DatasetPtr surface_lic(const DatasetPtr& in, const SurfaceLicParams& p, Context& context) {
  const DatasetPtr surface = surface_of(in, context);
  flow_field_of(*surface, p.field.name, "surface_lic");  // complains before work is done
  const SurfaceMesh& mesh = *surface->as<SurfaceMesh>();
  if (mesh.polygons.size() + mesh.strips.size() == 0)
    fail_usage("the data has no faces to carry a texture", "surface_lic", "take a surface first: faces, contour or slice");
  const double diagonal = in->bounds().diagonal();
  const RefinedSurface r = refine_surface(surface, p.density > 0 ? diagonal / p.density : 0, most_triangles, context);
  const Field& f = flow_field_of(*r.dataset, p.field.name, "surface_lic");
  const std::vector<Vec3> vectors = vectors_of(f);
  const SurfaceWalk walk(r, vectors, f.association == Association::cell);
  const double step = p.step > 0 ? p.step : 0.5 * r.edge_length;
  const Kernel kernel(p.steps, p.kernel == "hann", r.edge_length / std::max(step, 1e-300));
  const double whole = kernel.whole();

  // A triangle for each point to start from; points at one place share the number of the first.
  const size_t n = r.points.size();
  std::vector<uint32_t> home(n, UINT32_MAX);
  for (size_t t = r.triangles.size(); t-- > 0;)
    for (const uint32_t q : r.triangles[t]) home[q] = uint32_t(t);
  const auto noise = [&](uint32_t point) { return random_unit(uint64_t(p.seed), point); };
  const auto noise_at = [&](const SurfaceWalk::Place& at) {
    const auto& t = r.triangles[at.triangle];
    return noise(t[0]) * at.b[0] + noise(t[1]) * at.b[1] + noise(t[2]) * at.b[2];
  };
  float* lic = nullptr;
  Array result = Array::make<float>(n, 1, &lic);
  parallel_for(
      n, 1024,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          lic[i] = 0.5f;
          if (home[i] == UINT32_MAX) continue;
          double sum = kernel.weight(0) * noise(uint32_t(i)), weights = kernel.weight(0);
          int reached[2] = {0, 0};
          bool any = false;
          for (int way = 0; way < 2; ++way) {
            SurfaceWalk::Place at = walk.start(home[i], uint32_t(i));
            for (int k = 1; k <= p.steps; ++k) {
              if (!walk.advance(at, step, way == 0 ? -1 : 1)) break;
              sum += kernel.weight(k) * noise_at(at), weights += kernel.weight(k), reached[way] = k, any = true;
            }
          }
          if (!any) continue;
          const double mean = sum / weights;
          const bool full = reached[0] == p.steps && reached[1] == p.steps;
          lic[i] = float(p.stretch ? brightness((mean - 0.5) / (full ? whole : kernel.deviation(reached[0], reached[1]))) : mean);
        }
      },
      &context);
  // Points that stand for others.
  const SurfaceMesh& made = *r.dataset->as<SurfaceMesh>();
  const View<int32_t> corners = made.polygons.connectivity.view<int32_t>();
  for (size_t t = 0; t < r.triangles.size(); ++t)
    for (size_t k = 0; k < 3; ++k) lic[size_t(corners[3 * t + k])] = lic[r.triangles[t][k]];

  DatasetParts parts = r.dataset->parts();
  FieldSet fields;
  fields.add({"lic", Association::point, result, "", Role::none});
  for (const Field& g : parts.fields)
    if (!(g.name == "lic" && g.association == Association::point)) fields.add(g);
  parts.fields = std::move(fields);
  return make_dataset(std::move(parts));
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/unsteady/flat_advance.h"

#include <algorithm>

namespace sg::lattice_advance {

std::optional<Job> job_of(const UnsteadyFlow& flow, const TraceOptions& options) {
  const Dataset& mesh = *flow.steps()[0].dataset();
  const auto* g = mesh.as<UniformGrid>();
  const bool known = options.scheme == Scheme::dormand_prince || options.scheme == Scheme::rk4;
  if (!g || !known || flow.meshes() != UnsteadyFlow::Meshes::same) return std::nullopt;
  if (!(g->direction == Mat3()) || !mesh.cell_ghost().empty() || !mesh.point_ghost().empty()) return std::nullopt;
  for (const FlowField& f : flow.steps())
    if (!f.f32() || f.components() != flow.steps()[0].components()) return std::nullopt;
  Job job;
  job.components = flow.steps()[0].components();
  auto stride = size_t(job.components);
  double product = 1;
  int solid = 0;
  for (int a = 0; a < 3; ++a) {
    const size_t n = g->dims[size_t(a)];
    if (!(g->spacing[a] > 0) || n >= size_t(1) << 31) return std::nullopt;
    job.origin[a] = g->origin[a];
    if (n > 1) {
      job.inverse[a] = 1 / g->spacing[a], job.cells[a] = double(n - 1), job.stride[a] = stride;
      job.last += (n - 2) * stride;
      product *= g->spacing[a], ++solid;
    } else if (job.flat >= 0) {
      return std::nullopt;
    } else {
      job.flat = a;
    }
    stride *= n;
  }
  if (job.components == 2 && !flat_advance::takes(job)) return std::nullopt;
  job.cell = solid == 3 ? std::cbrt(product) : std::sqrt(product);
  const size_t n = flow.steps().size();
  job.steps = n > 2 ? 4 : 2;
  for (size_t j = 0; j < 4; ++j) job.step[j] = flow.steps()[std::min(j, n - 1)].f32();
  job.begin = flow.begin(), job.scale = 1 / (flow.end() - flow.begin());
  // Weights are cubic in s (or linear): from their values at four places.
  double at[4][4];
  for (int k = 0; k < 4; ++k) flow.time_weights(flow.begin() + (flow.end() - flow.begin()) * k / 3.0, at[k]);
  for (int j = 0; j < 4; ++j) {
    const double a = at[0][j], b = at[1][j], c = at[2][j], d = at[3][j];
    double* w = job.weight[j];
    w[0] = a;
    w[1] = (-11 * a + 18 * b - 9 * c + 2 * d) / 2;
    w[2] = 9 * (2 * a - 5 * b + 4 * c - d) / 2;
    w[3] = 9 * (-a + 3 * b - 3 * c + d) / 2;
    if (flow.interpolation() == TimeInterpolation::linear) w[1] = d - a, w[2] = w[3] = 0;
  }
  return job;
}

}  // namespace sg::lattice_advance

// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/lattice/runs.h"

namespace sg::volume {

namespace {

/// Mean of the corners that have a value, weighted as usual; NaN when the nearest has none. Only f32 holds NaN.
float sample_around_nan(const Voxels& voxels, float x, float y, float z) {
  const float* data = reinterpret_cast<const float*>(voxels.array.raw());
  const float place[3] = {x, y, z};
  size_t cell[3];
  float f[3];
  for (size_t a = 0; a < 3; ++a) {
    const float u = clamped(place[a], float(voxels.dims[a] - 1));
    cell[a] = std::min(size_t(u), voxels.dims[a] - 2), f[a] = u - float(cell[a]);
  }
  float sum = 0, weights = 0;
  for (int corner = 0; corner < 8; ++corner) {
    size_t at[3];
    float weight = 1;
    bool closest = true;
    for (int a = 0; a < 3; ++a) {
      const bool upper = corner >> a & 1;
      at[a] = cell[a] + upper, weight *= upper ? f[a] : 1 - f[a], closest = closest && upper == (f[a] >= 0.5f);
    }
    const float value = data[at[0] + voxels.dims[0] * (at[1] + voxels.dims[1] * at[2])];
    if (value == value) sum += weight * value, weights += weight;
    else if (closest) return value;
  }
  return weights > 0 ? sum / weights : NAN;
}

}  // namespace

void finish_values(const Volume& v, Run& run) {
  if (v.nearest)
    for (int n = 0; n < run_length; ++n)
      run.ux[n] = std::floor(run.ux[n] + 0.5f), run.uy[n] = std::floor(run.uy[n] + 0.5f), run.uz[n] = std::floor(run.uz[n] + 0.5f);
  v.kernels.sample(v.voxels, run.ux, run.uy, run.uz, run.value);
  if (v.dual)
    for (int n = 0; n < run_length; ++n)
      if (run.value[n] != run.value[n]) run.value[n] = sample_around_nan(v.voxels, run.ux[n], run.uy[n], run.uz[n]);
  if (!v.hidden().empty())
    for (int n = 0; n < run_length; ++n) {
      const auto cell = [&](float u, size_t a) { return std::min(size_t(clamped(u, float(v.voxels.dims[a] - 1))), v.voxels.dims[a] - 2); };
      const size_t id = cell(run.ux[n], 0) + (v.voxels.dims[0] - 1) * (cell(run.uy[n], 1) + (v.voxels.dims[1] - 1) * cell(run.uz[n], 2));
      if (v.hidden()[id]) run.value[n] = NAN;
    }
}

void gradients_at(const Volume& v, const float* const u[3], const double* const q[3], const float* centre, Gradients& out) {
  if (v.affine) return v.kernels.gradients(v.voxels, u, centre, out);
  alignas(64) float below[run_length], above[run_length], lo[run_length], hi[run_length], apart[run_length];
  float* result[3] = {out.x, out.y, out.z};
  std::fill(out.per_cell, out.per_cell + run_length, 0.0f);
  for (int a = 0; a < 3; ++a) {
    // One cell to each side in the world, so that differences stay centred where cells are uneven.
    const std::vector<double>& c = v.coordinates[a];
    for (int n = 0; n < run_length; ++n) {
      const double here = std::clamp(q[a][n], c.front(), c.back()), cell = v.cell_length(a, here);
      const double from = std::max(here - cell, c.front()), to = std::min(here + cell, c.back());
      below[n] = v.u(a, from), above[n] = v.u(a, to), apart[n] = float(to - from);
    }
    const float* place[3] = {u[0], u[1], u[2]};
    place[a] = below;
    v.kernels.sample(v.voxels, place[0], place[1], place[2], lo);
    place[a] = above;
    v.kernels.sample(v.voxels, place[0], place[1], place[2], hi);
    for (int n = 0; n < run_length; ++n) {
      float length = apart[n];
      if (lo[n] != lo[n]) lo[n] = centre[n], length *= 0.5f;
      if (hi[n] != hi[n]) hi[n] = centre[n], length *= 0.5f;
      const float d = hi[n] - lo[n];
      result[a][n] = length > 0 ? d / length : 0;
      out.per_cell[n] += 0.25f * d * d;
    }
  }
  for (float& p : out.per_cell) p = std::sqrt(p);
}

}  // namespace sg::volume

// SPDX-License-Identifier: Apache-2.0
// Runs of samples: their places, values, gradients and lighting.
#pragma once
#include <functional>

#include "render/volume/volume_internal.h"

namespace sg::volume {

struct Run {
  alignas(64) float ux[run_length], uy[run_length], uz[run_length];
  alignas(64) float value[run_length];
  alignas(64) int entry[run_length];
};

/// Values at the run's places: NaN where the volume has none (NaN corner, hidden cell).
void finish_values(const Volume& v, Run& run);

struct Gradients {
  alignas(64) float x[run_length], y[run_length], z[run_length];  ///< in q
  alignas(64) float per_cell[run_length];                        ///< change of the value over the length of a cell
};
/// Central differences over one cell to each side (one-sided at the border and beside NaN) of the samples `which` of the run;
/// q(axis, n) is the place of sample n. Only the first `count` entries of the result mean something.
template <class Q>
void gradients(const Volume& v, const Run& run, const int* which, int count, Q&& q, Gradients& out);

struct Shading {
  float diffuse[run_length], specular[run_length];  ///< factor of the colour; white on top of it
};
/// Phong's model on both sides, by the gradient; where the field is flat the colour stays as it is.
void shade(const Volume& v, const LitRay& lit, const Gradients& g, int count, Shading& out);

namespace detail {
/// Places of the samples to both sides along an axis, and how far they are apart in q.
void shifted(const Volume& v, int axis, const float* u, const double* q, int count, float* below, float* above, float* apart);
void differences(const Volume& v, const float* const u[3], const float* centre, int axis, const float* below, const float* above, const float* apart, int count, float* out, float* per_cell);
}  // namespace detail

template <class Q>
void gradients(const Volume& v, const Run& run, const int* which, int count, Q&& q, Gradients& out) {
  alignas(64) float u[3][run_length], centre[run_length], below[run_length], above[run_length], apart[run_length];
  const float* from[3] = {run.ux, run.uy, run.uz};
  for (int m = 0; m < run_length; ++m) {
    const int n = which[m < count ? m : 0];
    for (int a = 0; a < 3; ++a) u[a][m] = from[a][n];
    centre[m] = run.value[n], out.per_cell[m] = 0;
  }
  float* result[3] = {out.x, out.y, out.z};
  const float* all[3] = {u[0], u[1], u[2]};
  for (int a = 0; a < 3; ++a) {
    double place[run_length];
    if (!v.affine)
      for (int m = 0; m < count; ++m) place[m] = q(a, which[m]);
    detail::shifted(v, a, u[a], place, count, below, above, apart);
    detail::differences(v, all, centre, a, below, above, apart, count, result[a], out.per_cell);
  }
  for (int m = 0; m < count; ++m) out.per_cell[m] = std::sqrt(out.per_cell[m]);
}

}  // namespace sg::volume

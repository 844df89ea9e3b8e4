// SPDX-License-Identifier: Apache-2.0
// Runs of samples in any kind of volume: values with holes, gradients.
#pragma once
#include "render/volume/sources/lattice/lattice_volume.h"

namespace sg::volume {

/// Values at the run's places: NaN where the volume has none (NaN corner, hidden cell).
void finish_values(const Volume& v, Run& run);

/// Gradients at the samples `which` of the run, by central differences over one cell to each side; q(axis, n) is the place of
/// sample n. Only the first `count` entries of the result are valid.
template <class Q>
void gradients(const Volume& v, const Run& run, const int* which, int count, Q&& q, Gradients& out);
/// The same from places in u and, unless the grid is affine, in q.
void gradients_at(const Volume& v, const float* const u[3], const double* const q[3], const float* centre, Gradients& out);

template <class Q>
void gradients(const Volume& v, const Run& run, const int* which, int count, Q&& q, Gradients& out) {
  alignas(64) float u[3][run_length], centre[run_length];
  double place[3][run_length];
  for (int m = 0; m < run_length; ++m) {
    const int n = which[m < count ? m : 0];
    u[0][m] = run.ux[n], u[1][m] = run.uy[n], u[2][m] = run.uz[n], centre[m] = run.value[n];
    if (!v.affine)
      for (int a = 0; a < 3; ++a) place[a][m] = q(a, n);
  }
  const float* all_u[3] = {u[0], u[1], u[2]};
  const double* all_q[3] = {place[0], place[1], place[2]};
  gradients_at(v, all_u, all_q, centre, out);
}

}  // namespace sg::volume

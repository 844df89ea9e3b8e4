// SPDX-License-Identifier: Apache-2.0
// Samples of a lattice prepared for a reconstruction kernel (filter/field/sampling/reconstruction.h), and the sums over its support.
#pragma once
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "filter/field/sampling/reconstruction.h"
#include "render/volume/sources/lattice/lattice_volume.h"

namespace sg::volume {

/// Samples that a kernel reads instead of the volume's own.
struct Reconstruction {
  Kernel kernel = Kernel::linear;
  Array samples;                 ///< those of the volume, or f32 with holes filled and, for bspline, coefficients
  std::vector<uint8_t> missing;  ///< per sample: no value; empty when all have one
  MinMaxBricks bricks;           ///< bounds of the values inside each brick of cells: including overshoot and neighbours
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  size_t bytes() const { return samples.bytes() + missing.size() + bricks.size() * sizeof(MinMaxBricks::Range); }
};

/// Bounds: the kernel's shares sum to 1 and their absolute values to `gain` at most per axis, so the values of a brick lie within gain^3
/// half ranges of the middle of the range of all samples that have a share in it (gain 1 for kernels without negative lobes; for
/// bspline those of the coefficients).
Reconstruction reconstruct(const Volume& volume, Kernel kernel);

/// Places along a ray at which the field is read together: ends of a piece and Chebyshev-Lobatto points between them.
constexpr int places = 10, lanes = 12;

/// The shares of a kernel as polynomials of the place in the cell, so that many places are computed at once. Exact for splines; accurate to
/// 1e-6 for the others.
class TapPolynomials {
 public:
  explicit TapPolynomials(Kernel kernel);
  int taps() const { return taps_; }
  /// Shares at the places f[lanes] in [0, 1]: w[tap * lanes + place].
  void at(const float* f, float* w) const;

 private:
  int taps_ = 2, degree_ = 1;
  float c_[most_taps][10];  // rising powers of f - 1/2
};

/// A block of samples around the cell `cell`: n^3 of them, n = 2 * radius, the first is sample cell + 1 - radius of each axis; those
/// beyond the border by reflection.
void read_block(const Reconstruction& r, const std::array<size_t, 3>& dims, const long cell[3], int radius, float* block);

/// One row of weights for samples 1-(radius+1) .. radius+1 around a cell: of the derivative, and of the mean across it.
void gradient_rows(Kernel kernel, GradientKind kind, double f, double* slope, double* across);

}  // namespace sg::volume

// SPDX-License-Identifier: Apache-2.0
// Kernels that make a continuous field of samples on a grid, and what prepares samples for them.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/context.h"
#include "base/schema/enum_words.h"

namespace sg {

/// One-dimensional kernels; on a grid the product of three. t is the distance from a sample in samples.
enum class Kernel : uint8_t {
  nearest,         ///< box: each sample is a voxel
  linear,          ///< tent: trilinear
  catmull_rom,     ///< BC spline (0, 1/2): Catmull and Rom 1974, Keys 1981 (a = -1/2)
  mitchell,        ///< BC spline (1/3, 1/3): Mitchell and Netravali 1988
  bspline,         ///< cubic B-spline on filtered coefficients, so that it passes through the samples: Unser 1999
  bspline_smooth,  ///< BC spline (1, 0), the cubic B-spline on the samples themselves: smooths
  gaussian,        ///< exp(-t^2 / (2 0.6^2)) less its value at 2, where it ends; weights divided by their sum
  sinc,            ///< Lanczos window of radius 3, sinc(t) sinc(t/3): Duchon 1979; weights divided by their sum
};
constexpr auto enum_words(Kernel) {
  using enum Kernel;
  return std::array{Word{"nearest", nearest},   Word{"linear", linear},   Word{"catmull_rom", catmull_rom},
                    Word{"mitchell", mitchell}, Word{"bspline", bspline}, Word{"bspline_smooth", bspline_smooth},
                    Word{"gaussian", gaussian}, Word{"sinc", sinc}};
}
constexpr int most_taps = 6;

struct KernelTraits {
  int radius;         ///< the kernel is 0 from there on; 2 * radius samples have a share of each place
  bool interpolates;  ///< passes through the samples (bspline: after bspline_coefficients)
  bool linear;        ///< a field that rises evenly is kept
  bool prefilter;     ///< wants bspline_coefficients
  int degree;         ///< of the polynomial in each cell, per axis; -1 = none
};
const KernelTraits& traits(Kernel k);

/// The family of Mitchell and Netravali 1988 and its derivative: piecewise cubic, 0 for |t| >= 2.
double bc_spline(double b, double c, double t);
double bc_spline_slope(double b, double c, double t);
/// Any kernel (gaussian and sinc: before division by their sum) and its derivative.
double kernel_value(Kernel k, double t);
double kernel_slope(Kernel k, double t);

/// Shares at the place `f` in [0, 1] of a cell of the samples 1-radius .. radius (0 and 1 are the cell's own), and their derivatives.
/// Shares sum to 1, derivatives to 0.
void kernel_weights(Kernel k, double f, double* weights);
void kernel_slopes(Kernel k, double f, double* slopes);
/// Largest sum of |shares| over all places: values lie within `gain`^3 half ranges of the middle of the samples' range.
double kernel_gain(Kernel k);

/// Beyond the outermost samples the field is reflected at them as a point, s[-i] = 2 s[0] - s[i]: linear slopes continue.
/// Turns samples into coefficients whose cubic B-spline passes through them: a recursive filter along each axis (Unser, Aldroubi, Eden
/// 1993) for that reflection, which makes natural splines. Axes of one sample are unchanged. Samples must be finite. Along all axes, or
/// one of them.
void bspline_coefficients(float* values, std::array<size_t, 3> dims, const Context* context = nullptr);
void bspline_coefficients_along(size_t axis, float* values, std::array<size_t, 3> dims, const Context* context = nullptr);

/// Fills samples without a finite value, for the outer shares of cells next to holes: straight on from pairs of samples behind
/// each other in the 26 directions (mean of those that exist), else the mean of neighbours; layer by layer, `layers` of them, the rest
/// gets the middle of the range. Returns one byte per sample (1 = had no value), empty when all had one.
std::vector<uint8_t> fill_holes(float* values, std::array<size_t, 3> dims, int layers, const Context* context = nullptr);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Short streamlines over a grid of pixels (or voxels), 16 at a time: what line integral convolution consists of.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sg::texture {

/// A grid of directions and of what is convolved along them. Positions are in pixels, pixel (i,j,k) has its middle at (i,j,k).
struct DirectionGrid {
  int dimension = 2;                ///< 2 or 3
  int32_t n[3] = {2, 2, 1};         ///< pixels along each axis, at least 2; 1 for the third of two
  const uint32_t* codes = nullptr;  ///< see encode_direction
  const float* noise = nullptr;
  size_t size() const { return size_t(n[0]) * size_t(n[1]) * size_t(n[2]); }
};

/// A vector's direction only: two 16-bit numbers, or three of 10 bits (0.1 degrees); 0 where it is zero or NaN. One load fetches a whole
/// direction.
uint32_t encode_direction(int dimension, const float* v);
/// The same for n vectors.
void encode_directions(int dimension, const float* v, size_t n, uint32_t* codes);
/// Length of a unit vector in the numbers of the code.
constexpr float code_scale(int dimension) { return dimension == 2 ? 32767.0f : 511.0f; }
/// Lines end where the interpolated unit vectors cancel to less than this: at critical points, and where there is no flow.
constexpr float least_direction = 0.1f;

constexpr int lanes = 16;

/// 16 lines through 16 starts, `steps` steps each way: a midpoint step, then steps of Adams and Bashforth's two-step method (order 2, one
/// look at the directions per step). Directions are bilinear (trilinear) between pixels and not made unit again, so that steps shorten
/// towards critical points. A line ends at the border of the grid.
struct LineBatch {
  LineBatch(int most_steps, bool with_pixels);
  float start[3][lanes] = {};
  int steps = 0;
  float step = 1;  ///< pixels
  /// Lines end when they were outside of [box_lo, box_hi) for `tail` steps; tail 0: no box.
  int32_t box_lo[3] = {}, box_hi[3] = {};
  int tail = 0;

  // Results. Row steps + k is the place after k steps, row steps - k that after k steps back.
  std::vector<float> noise;  ///< [2 steps + 1][16], of the nearest pixel; 0 beyond the line's ends
  /// With a box, numbered in the box (x fastest), -1 outside of it.
  std::vector<int32_t> pixels;                  ///< the nearest pixel, likewise; -1 beyond the ends. Empty: not requested
  int32_t forth[lanes] = {}, back[lanes] = {};  ///< steps made
};

void trace_lines(const DirectionGrid& grid, LineBatch& batch);
/// The same, number by number: the reference.
void trace_lines_scalar(const DirectionGrid& grid, LineBatch& batch);

/// Weights of the convolution at -steps..steps, and their running sums.
struct Weights {
  int steps = 0;
  bool box = true;
  std::vector<float> w;    ///< 2 steps + 1
  std::vector<float> sum;  ///< sum[i] = w[0] + ... + w[i-1]; 2 steps + 2
  /// Of the part of the kernel from `back` before the middle to `forth` behind it.
  float total(int back, int forth) const { return sum[size_t(steps + forth + 1)] - sum[size_t(steps - back)]; }
};

/// out[m - first][lane] = sum over k of w[k] noise[m + k][lane] for rows m in [first, last] of a batch; rows outside of it count as 0. A
/// box is summed by sliding.
void convolve_lines(const LineBatch& batch, const Weights& weights, int first, int last, float* out);
void convolve_lines_scalar(const LineBatch& batch, const Weights& weights, int first, int last, float* out);

}  // namespace sg::texture

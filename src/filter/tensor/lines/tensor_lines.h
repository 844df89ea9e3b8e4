// SPDX-License-Identifier: Apache-2.0
// Lines along one eigenvector of a tensor field: what hyperstreamlines and tractography share.
#pragma once
#include <cstdint>
#include <string_view>

#include "filter/tensor/tensor_sampler.h"

namespace sg {

enum class TensorStop : uint8_t { outside, length, steps, degenerate, eigenvalue, anisotropy, angle, closed };
/// "outside", "length", ...
std::string_view tensor_stop_name(TensorStop s);

enum class LineDirection : uint8_t { both, forward, backward };
constexpr auto enum_words(LineDirection) {
  using enum LineDirection;
  return std::array{Word{"both", both}, Word{"forward", forward}, Word{"backward", backward}};
}

struct TensorLineOptions {
  int eigenvector = 0;  ///< 0 belongs to the largest eigenvalue
  LineDirection direction = LineDirection::both;
  double step = 0.25;         ///< in cell lengths
  double max_length = 1e300;  ///< of each of the two halves
  int64_t max_steps = 10000;  ///< of each half
  double min_gap = 1e-5;      ///< distance of the followed eigenvalue to the next one, of the largest absolute one
  double min_eigenvalue = 0;  ///< absolute value of the followed one
  double min_fa = 0;          ///< fractional anisotropy
  double max_angle = 180;     ///< degrees between the directions of one step and the next
};

/// Points of many lines, one after the other; each from its backward end over the seed to its forward end.
struct TensorLines {
  std::vector<size_t> begin{0};  ///< lines + 1
  std::vector<Vec3> points;
  std::vector<Vec3> tangent;  ///< unit, never against that of the neighbours: the sign is kept along the line
  std::vector<Eigen3> eigen;  ///< signs as eigen_of chooses them
  std::vector<double> arc;    ///< length from the seed, negative on the backward half
  std::vector<int64_t> seed;  ///< per line
  std::vector<TensorStop> stop_forward, stop_backward;
  size_t lines() const { return begin.size() - 1; }
};

/// Follows x' = +-v_k(x) from each seed by Runge-Kutta of order 4 in arc length; all stages take the sign nearest to the direction before
/// them. A step that leaves the mesh is halved up to ten times, so that lines end at the border. Lines that come back to their seed end
/// there. Seeds outside, at NaN, or where a stop holds at once give no line. In parallel, in the order of the seeds: the same for any
/// number of threads.
TensorLines trace_tensor_lines(const TensorSampler& sampler, std::span<const Vec3> seeds, const TensorLineOptions& options, Context& ctx);

/// About `count` places of an even lattice inside a box; axes without extent get one.
std::vector<Vec3> even_places(const Box3& box, int64_t count);
/// From a list x,y,z,... Throws Error(usage) naming `who` when it is not a multiple of three.
std::vector<Vec3> listed_places(const std::vector<double>& numbers, std::string_view who);

/// Adds `fields` of the sampler's dataset at the points of the lines (named ones; none named: all but the tensors). `repeat`: how often
/// each point's values are stored one after the other (vertices of a section).
void carry_along(FieldSet& out, const TensorSampler& sampler, const std::vector<Vec3>& points, const std::vector<std::string>& fields,
                 size_t repeat, Context& ctx);

}  // namespace sg

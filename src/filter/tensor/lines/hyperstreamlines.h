// SPDX-License-Identifier: Apache-2.0
// Hyperstreamlines: lines along one eigenvector whose section shows the other two (Delmarcelle, Hesselink 1993).
#pragma once
#include "filter/tensor/lines/tensor_lines.h"
#include "filter/tensor/tensor_field.h"
#include "filter/tensor/tensor_interpolation.h"

namespace sg {

/// What is drawn around a line.
enum class TensorSection { ellipse, cross, line };
constexpr auto enum_words(TensorSection) {
  using enum TensorSection;
  return std::array{Word{"ellipse", ellipse}, Word{"cross", cross}, Word{"line", line}};
}

struct HyperstreamlinesParams {
  TensorSource tensors;
  int eigenvector = 1;
  std::vector<double> seeds;
  int64_t count = 64;
  LineDirection direction = LineDirection::both;
  TensorSection section = TensorSection::ellipse;
  std::optional<double> factor, max_radius, min_radius;
  int sides = 16;
  double step = 0.25;
  std::optional<double> max_length;
  int64_t max_steps = 10000;
  double min_gap = 1e-5;
  double min_eigenvalue = 0;
  TensorInterpolation interpolation = TensorInterpolation::components;
  std::vector<std::string> fields;
};
void describe(Schema& s, HyperstreamlinesParams& p);

/// Lines along eigenvector 1 (largest eigenvalue), 2 or 3 from the seeds: the points of a second input, or `seeds`, or about `count` places
/// of an even lattice in the box of the data. A line has no sign of its own: both directions make one line, and the sign is kept along it.
/// Runge-Kutta of order 4 in arc length on the interpolated tensors. It ends at the border, after max_length, where the followed eigenvalue
/// comes closer to the next than min_gap (there the direction has no meaning), where its absolute value falls below min_eigenvalue, or
/// where it comes back to its seed.
///
/// A SurfaceMesh: tubes of elliptic section, crosses, or plain lines. Half axes are the absolute values of the other two eigenvalues times
/// `factor` (default: 90 % of them stay below 1.2 % of the data's diagonal; max_radius, 3 % of it, bounds singular places, and a note gives
/// the number of sections; min_radius 0.1 % keeps thin ones visible). Point fields: "eigenvalue" (the followed one, with its sign),
/// "eigenvalue 1" to "3", "length" (from the line's start), "Normals" of surfaces, and `fields` of the input (default: all but the
/// tensors). Cell fields: "line" (labels), "seed", "stop" (0 outside, 1 length, 2 steps, 3 degenerate, 4 eigenvalue, 5 anisotropy, 6 angle,
/// 7 closed; of the forward end). Seeds that give no line are counted in a note. Throws Error(usage) for bad seeds, points without cells,
/// eigenvector 3 of a surface.
DatasetPtr hyperstreamlines(const DatasetPtr& in, const DatasetPtr& seeds, const HyperstreamlinesParams& p, Context& ctx);
inline DatasetPtr hyperstreamlines(const DatasetPtr& in, const HyperstreamlinesParams& p, Context& ctx) {
  return hyperstreamlines(in, nullptr, p, ctx);
}

}  // namespace sg

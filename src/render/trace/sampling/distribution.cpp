// SPDX-License-Identifier: Apache-2.0
#include "render/trace/sampling/distribution.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "render/trace/sampling/unit_float.h"

namespace sg::trace {

namespace {

size_t cell_of(float x, size_t cells) { return std::min(size_t(std::max(0.0, double(x) * double(cells))), cells - 1); }

std::vector<double> normalised(std::vector<double> sums) {
  const double total = sums.back();
  for (size_t i = 1; i < sums.size(); ++i) sums[i] = total > 0 ? sums[i] / total : double(i) / double(sums.size() - 1);
  return sums;
}

}  // namespace

Distribution1D::Distribution1D(std::span<const float> weights) : sums_(1, 0.0) {
  if (weights.empty()) fail_usage("no weights to sample from", "distribution");
  sums_.reserve(weights.size() + 1);
  for (const float w : weights) {
    if (!(w >= 0) || std::isinf(w)) fail_usage("a weight that is negative or not finite", "distribution");
    sums_.push_back(sums_.back() + double(w));
  }
  total_ = sums_.back();
  sums_ = normalised(std::move(sums_));
}

Distribution1D::Sample Distribution1D::sample(float u) const {
  // The last cell whose sum is not above u: one without weight is never found, as the next has the same sum.
  const auto next = std::upper_bound(sums_.begin() + 1, sums_.end() - 1, double(u));
  size_t cell = size_t(next - sums_.begin()) - 1;
  while (cell > 0 && sums_[cell + 1] == sums_[cell]) --cell;  // u at or above the last weight
  const double share = sums_[cell + 1] - sums_[cell];
  const float rest = below_one(std::clamp((double(u) - sums_[cell]) / share, 0.0, 1.0));
  const float x = below_one((double(cell) + double(rest)) / double(cells()));
  return {x, float(share * double(cells())), cell, rest};
}

float Distribution1D::pdf(float x) const {
  const size_t cell = cell_of(x, cells());
  return float((sums_[cell + 1] - sums_[cell]) * double(cells()));
}

Distribution2D::Distribution2D(std::span<const float> weights, size_t width) {
  if (width == 0 || weights.empty() || weights.size() % width) fail_usage("weights that make no whole rows", "distribution");
  std::vector<float> of_rows;
  for (size_t at = 0; at < weights.size(); at += width) {
    in_row_.emplace_back(weights.subspan(at, width));
    of_rows.push_back(float(in_row_.back().total()));
  }
  rows_ = Distribution1D(of_rows);
}

Distribution2D::Sample Distribution2D::sample(Vec2f u) const {
  const Distribution1D::Sample y = rows_.sample(u.y), x = in_row_[y.cell].sample(u.x);
  return {{x.x, y.x}, x.pdf * y.pdf};
}

float Distribution2D::pdf(Vec2f point) const { return rows_.pdf(point.y) * in_row_[cell_of(point.y, in_row_.size())].pdf(point.x); }

}  // namespace sg::trace

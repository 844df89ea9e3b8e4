// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/slice/lasso_region.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "filter/tensor/sym_tensor.h"

namespace sg {

namespace {

constexpr size_t most_strips = 1024, edges_per_box = 4;

// The square of the distance from a segment.
template <class Edge>
double square_from(const Edge& e, Vec2 p) {
  const Vec2 d = p - e.from;
  const double t = std::clamp((d.x * e.along.x + d.y * e.along.y) * e.per_square, 0.0, 1.0);
  const Vec2 off = d - e.along * t;
  return off.x * off.x + off.y * off.y;
}

}  // namespace

LassoRegion::LassoRegion(std::span<const double> corners, const std::optional<Vec3>& eye, std::string_view who) : eye_(eye) {
  const std::string where = fmt::format("{} lasso", who), like = "give x,y,z of each corner, e.g. 0,0,0,1,0,0,0,1,0";
  if (corners.size() % 3 != 0) fail_usage(fmt::format("{} numbers do not make whole corners", corners.size()), where, like);
  const size_t n = corners.size() / 3;
  if (n < 3) fail_usage(fmt::format("needs three corners or more, not {}", n), where, like);
  for (const double x : corners)
    if (!std::isfinite(x)) fail_usage("a number is not finite", where, like);
  const auto corner = [&](size_t i) { return Vec3(corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]); };
  for (size_t i = 0; i < n; ++i) origin_ += corner(i) / double(n);
  double reach = 0;
  for (size_t i = 0; i < n; ++i)
    for (int a = 0; a < 3; ++a) reach = std::max(reach, std::abs(corner(i)[a] - origin_[a]));
  SymTensor spread;
  for (size_t i = 0; i < n && reach > 0; ++i) spread = spread + outer((corner(i) - origin_) / reach);
  const Eigen3 axes = eigen_of(spread);
  constexpr double flat = 1e-14;  // the square of how wide a polygon is to be, as a share of its length
  if (!std::isfinite(reach) || !(axes.value[1] > flat * axes.value[0])) fail_usage("all corners lie on one line", where, like);
  u_ = axes.vector[0], v_ = axes.vector[1], normal_ = axes.vector[2];
  if (eye_) {
    for (int a = 0; a < 3; ++a)
      if (!std::isfinite((*eye_)[a])) fail_usage("a number is not finite", fmt::format("{} lasso_eye", who));
    depth_ = dot(normal_, origin_ - *eye_);
    if (depth_ < 0) normal_ = -normal_, depth_ = -depth_;
    if (!(depth_ > 1e-9 * reach)) fail_usage("the eye lies in the plane of the corners", fmt::format("{} lasso_eye", who));
  }
  lowest_ = HUGE_VAL, highest_ = -HUGE_VAL;
  double farthest = reach;
  for (int a = 0; a < 3; ++a) farthest = std::max({farthest, std::abs(origin_[a]), eye_ ? std::abs((*eye_)[a]) : 0.0});
  snap_ = 16 * std::numeric_limits<double>::epsilon() * farthest;
  std::vector<Vec2> flat_corners;
  for (size_t i = 0; i < n; ++i) {
    // Seen from the eye, where corners do not lie in one plane.
    const Projected p = project(corner(i));
    if (!(p.scale > 0)) fail_usage("a corner lies beside or behind the eye", fmt::format("{} lasso_eye", who));
    flat_corners.push_back(p.at);
    lowest_ = std::min(lowest_, p.at.y), highest_ = std::max(highest_, p.at.y);
  }
  for (size_t i = 0; i < n; ++i) {
    const Vec2 a = flat_corners[i], along = flat_corners[(i + 1) % n] - a;
    const double square = along.x * along.x + along.y * along.y;
    edges_.push_back({a, along, square > 0 ? 1 / square : 0});
  }
  while (leaves_ * edges_per_box < n) leaves_ *= 2;
  boxes_.assign(2 * leaves_ - 1, {{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}});
  const auto grow = [](Box& b, Vec2 lo, Vec2 hi) {
    b.lo = {std::min(b.lo.x, lo.x), std::min(b.lo.y, lo.y)}, b.hi = {std::max(b.hi.x, hi.x), std::max(b.hi.y, hi.y)};
  };
  for (size_t i = 0; i < n; ++i)
    for (const Vec2 end : {edges_[i].from, edges_[i].from + edges_[i].along}) grow(boxes_[leaves_ - 1 + i / edges_per_box], end, end);
  for (size_t i = boxes_.size() - 1; i > 0; --i) grow(boxes_[(i - 1) / 2], boxes_[i].lo, boxes_[i].hi);
  begin_.assign(std::min(n, most_strips) + 1, 0);
  const auto strips = [&](const Edge& e) {
    const size_t a = row_of(e.from.y), b = row_of(std::clamp(e.from.y + e.along.y, lowest_, highest_));
    // What lies on the outline but for rounding may lie in the strip beside.
    return std::pair(std::max<size_t>(std::min(a, b), 1) - 1, std::min(std::max(a, b) + 1, begin_.size() - 2));
  };
  for (const Edge& e : edges_)
    for (auto [s, last] = strips(e); s <= last; ++s) ++begin_[s + 1];
  for (size_t s = 1; s < begin_.size(); ++s) begin_[s] += begin_[s - 1];
  edge_.resize(begin_.back());
  std::vector<uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (size_t i = 0; i < edges_.size(); ++i)
    for (auto [s, last] = strips(edges_[i]); s <= last; ++s) edge_[next[s]++] = uint32_t(i);
}

LassoRegion::Projected LassoRegion::project(Vec3 x) const {
  if (!eye_) {
    const Vec3 d = x - origin_;
    return {{dot(d, u_), dot(d, v_)}, 1};
  }
  const Vec3 d = x - *eye_;
  const double depth = dot(normal_, d);
  if (!(depth > 0)) return {{}, 0};
  const Vec3 q = *eye_ + d * (depth_ / depth) - origin_;
  return {{dot(q, u_), dot(q, v_)}, depth / depth_};
}

size_t LassoRegion::row_of(double v) const {
  const size_t count = begin_.size() - 1;
  const double t = (v - lowest_) / (highest_ - lowest_);
  return std::min(size_t(t * double(count)), count - 1);
}

// Whether a ray towards larger u crosses the outline an odd number of times; v lies in the strips.
bool LassoRegion::odd(Vec2 p) const {
  bool inside = false;
  const size_t row = row_of(p.y);
  for (uint32_t k = begin_[row]; k < begin_[row + 1]; ++k) {
    const Edge &e = edges_[edge_[k]], &next = edges_[(edge_[k] + 1) % edges_.size()];
    // Each end belongs to what lies above it, so that a corner is crossed once.
    if ((e.from.y > p.y) == (next.from.y > p.y)) continue;
    inside ^= p.x < e.from.x + e.along.x * ((p.y - e.from.y) / e.along.y);
  }
  return inside;
}

// Of the distances from all edges, the nearer box first; boxes that lie farther than what was found are left out, with room for rounding.
double LassoRegion::least_square(Vec2 p) const {
  const auto square_from_box = [&](size_t i) {
    const Box& b = boxes_[i];
    const double x = std::max({b.lo.x - p.x, 0.0, p.x - b.hi.x}), y = std::max({b.lo.y - p.y, 0.0, p.y - b.hi.y});
    return x * x + y * y;
  };
  struct Waiting {
    size_t box;
    double square;
  };
  Waiting stack[64];  // one a level
  size_t height = 0;
  stack[height++] = {0, square_from_box(0)};
  double least = HUGE_VAL;
  constexpr double room = 1 - 1e-9;
  while (height > 0) {
    const auto [box, square] = stack[--height];
    if (square * room - snap_ * snap_ > least) continue;
    if (box >= leaves_ - 1) {
      const size_t begin = (box - (leaves_ - 1)) * edges_per_box, end = std::min(begin + edges_per_box, edges_.size());
      for (size_t i = begin; i < end; ++i) least = std::min(least, square_from(edges_[i], p));
      continue;
    }
    Waiting near{2 * box + 1, square_from_box(2 * box + 1)}, far{2 * box + 2, square_from_box(2 * box + 2)};
    if (far.square < near.square) std::swap(near, far);
    stack[height++] = far, stack[height++] = near;
  }
  return least;
}

double LassoRegion::distance(Vec3 x) const {
  const Projected p = project(x);
  if (p.scale == 0) return length(x - *eye_);
  const double square = least_square(p.at);
  if (square <= snap_ * snap_) return 0;
  const bool inside = p.at.y >= lowest_ && p.at.y <= highest_ && odd(p.at);
  return (inside ? -1 : 1) * std::sqrt(square) * p.scale;
}

bool LassoRegion::holds(Vec3 x) const {
  const Projected p = project(x);
  if (p.scale == 0) return x == *eye_;
  if (!(p.at.y >= lowest_ - snap_ && p.at.y <= highest_ + snap_)) return false;
  if (p.at.y >= lowest_ && p.at.y <= highest_ && odd(p.at)) return true;
  const size_t row = row_of(std::clamp(p.at.y, lowest_, highest_));
  for (uint32_t k = begin_[row]; k < begin_[row + 1]; ++k)
    if (square_from(edges_[edge_[k]], p.at) <= snap_ * snap_) return true;
  return false;
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "render/volume/medium/preintegrated.h"
#include "render/shade/exp.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace sg::volume {

namespace {

constexpr size_t slices = 4096;
// Gauss-Legendre, four places on [0, 1].
constexpr double gauss_at[4] = {0.06943184420297371, 0.33000947820757187, 0.66999052179242813, 0.93056815579702629};
constexpr double gauss_weight[4] = {0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693};

/// A part of a segment on which tau and colour are straight lines over the share of its length.
struct Part {
  double share;  // of the segment's length
  double tau0, tau1;
  Vec3 c0, c1;
};

void parts_between(const std::vector<Medium::Straight>& lines, double a, double b, std::vector<Part>& out) {
  out.clear();
  const auto line_at = [&](double v) {
    const auto it = std::upper_bound(lines.begin(), lines.end(), v, [](double x, const Medium::Straight& l) { return x < double(l.hi); });
    return size_t(std::min(it, lines.end() - 1) - lines.begin());
  };
  const auto add = [&](const Medium::Straight& l, double from, double to, double share) {
    const auto tau = [&](double v) { return std::max(0.0, double(l.at.tau) + (v - double(l.lo)) * double(l.slope.tau)); };
    const auto color = [&](double v) { return Vec3(l.at.color) + Vec3(l.slope.color) * (v - double(l.lo)); };
    out.push_back({share, tau(from), tau(to), color(from), color(to)});
  };
  if (a == b) return add(lines[line_at(a)], a, a, 1);
  const bool up = b > a;
  const double per = 1 / std::abs(b - a);
  const double lowest = std::min(a, b), highest = std::max(a, b);
  const size_t first = line_at(lowest);
  for (size_t i = first; i < lines.size() && (i == first || double(lines[i].lo) < highest); ++i) {
    const double from = i == first ? lowest : double(lines[i].lo),
                 to = std::min(highest, i + 1 < lines.size() ? double(lines[i].hi) : highest);
    if (to > from) add(lines[i], up ? from : to, up ? to : from, (to - from) * per);
  }
  if (!up) std::reverse(out.begin(), out.end());
}

}  // namespace

Preintegrated::Preintegrated(const Medium& medium, const Plan& plan, const Context* context) : length_(std::max(plan.length, 1e-30f)) {
  const std::vector<Medium::Straight> lines = medium.straight();
  const float lo = plan.lo, hi = plan.hi > plan.lo ? plan.hi : std::nextafter(plan.lo, HUGE_VALF);
  const int even = std::max(plan.nodes, 2);
  for (int i = 0; i < even; ++i) nodes_.push_back(i + 1 == even ? hi : lo + (hi - lo) * (float(i) / float(even - 1)));
  size_t knots = 0;
  for (size_t k = 1; k < medium.lines().size() && knots < 80; ++k) {
    const Medium::Line &below = medium.lines()[k - 1], &above = medium.lines()[k];
    const float knot = above.lo;
    if (!(knot > lo && knot < hi)) continue;
    nodes_.push_back(knot), ++knots;
    const float before = std::nextafter(knot, -HUGE_VALF);
    const Vec3f change = medium.color(knot) - medium.color(before);
    if (std::abs(below(knot) - above(knot)) > 1e-3f * std::max(below(knot), above(knot)) || dot(change, change) > 1e-4f)
      nodes_.push_back(before);
  }
  std::sort(nodes_.begin(), nodes_.end());
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
  per_slice_ = float(slices) / (nodes_.back() - nodes_.front());
  for (size_t s = 0; s <= slices; ++s) {
    const float v = nodes_.front() + float(s) / per_slice_;
    const auto it = std::upper_bound(nodes_.begin(), nodes_.end(), v);
    first_.push_back(uint32_t(std::clamp<ptrdiff_t>(it - nodes_.begin() - 2, 0, ptrdiff_t(nodes_.size()) - 2)));
  }
  const size_t n = nodes_.size();
  mean_.resize(n * n), entries_.resize(n * n * lengths);
  parallel_for(
      n, 1,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
          for (size_t j = 0; j < n; ++j) integrate(lines, i, j);
      },
      context);
}

void Preintegrated::integrate(const std::vector<Medium::Straight>& lines, size_t i, size_t j) {
  thread_local std::vector<Part> parts;
  parts_between(lines, double(nodes_[i]), double(nodes_[j]), parts);
  const size_t n = nodes_.size();
  double mean = 0;
  Vec3 glow{0, 0, 0};
  for (const Part& p : parts) {
    mean += p.share * 0.5 * (p.tau0 + p.tau1);
    // c tau is a parabola: Simpson is exact.
    glow += (p.c0 * p.tau0 + (p.c0 + p.c1) * (p.tau0 + p.tau1) + p.c1 * p.tau1) * (p.share / 6);
  }
  mean_[i * n + j] = float(mean);
  Entry* out = &entries_[(i * n + j) * lengths];
  out[0] = {float(glow.x), float(glow.y), float(glow.z), float(mean)};
  for (int k = 1; k < lengths; ++k) {
    const double length = double(length_) * k / (lengths - 1);
    double pass = 1;
    Vec3 sum{0, 0, 0};
    for (const Part& p : parts) {
      const double depth = length * p.share * 0.5 * (p.tau0 + p.tau1);
      if (!(depth > 0) || pass < 1e-12) continue;
      const int cuts = int(std::clamp(std::ceil(depth), 1.0, 64.0));
      for (int c = 0; c < cuts; ++c) {
        const double f0 = double(c) / cuts, f1 = double(c + 1) / cuts;
        const double t0 = p.tau0 + (p.tau1 - p.tau0) * f0, t1 = p.tau0 + (p.tau1 - p.tau0) * f1, l = length * p.share / cuts;
        for (int q = 0; q < 4; ++q) {
          const double x = gauss_at[q], tau = t0 + (t1 - t0) * x, before = l * x * (t0 + 0.5 * (t1 - t0) * x);
          sum += (p.c0 + (p.c1 - p.c0) * (f0 + (f1 - f0) * x)) * (pass * gauss_weight[q] * l * tau * std::exp(-before));
        }
        pass *= std::exp(-l * 0.5 * (t0 + t1));
      }
    }
    out[k] = {float(sum.x), float(sum.y), float(sum.z), float(-std::expm1(-length * mean))};
  }
}

Preintegrated::Place Preintegrated::place(float v) const {
  if (!(v > nodes_.front())) return {0, 0};
  if (v >= nodes_.back()) return {nodes_.size() - 2, 1};
  size_t i = first_[std::min(size_t((v - nodes_.front()) * per_slice_), slices)];
  while (i + 2 < nodes_.size() && nodes_[i + 1] <= v) ++i;
  return {i, (v - nodes_[i]) / (nodes_[i + 1] - nodes_[i])};
}

Preintegrated::Segment Preintegrated::at(float front, float back, float length) const {
  const Place f = place(front), b = place(back);
  const size_t n = nodes_.size();
  const float w[4] = {(1 - f.share) * (1 - b.share), (1 - f.share) * b.share, f.share * (1 - b.share), f.share * b.share};
  const size_t at[4] = {f.node * n + b.node, f.node * n + b.node + 1, (f.node + 1) * n + b.node, (f.node + 1) * n + b.node + 1};
  Segment out{{0, 0, 0}, 0};
  for (int c = 0; c < 4; ++c) out.depth += w[c] * mean_[at[c]];
  out.depth *= length;
  if (!(out.depth > 0)) return {{0, 0, 0}, 0};
  const float along = std::clamp(length / length_, 0.0f, 1.0f) * float(lengths - 1);
  const int k = std::min(int(along), lengths - 2);
  const float share[2] = {1 - (along - float(k)), along - float(k)};
  for (int side = 0; side < 2; ++side) {
    Entry e{0, 0, 0, 0};
    for (int c = 0; c < 4; ++c) {
      const Entry& from = entries_[at[c] * lengths + size_t(k + side)];
      e.r += w[c] * from.r, e.g += w[c] * from.g, e.b += w[c] * from.b, e.alpha += w[c] * from.alpha;
    }
    if (e.alpha > 0) out.color += Vec3f{e.r, e.g, e.b} * (share[side] / e.alpha);
  }
  out.color *= 1 - exp_minus(out.depth);
  return out;
}

}  // namespace sg::volume

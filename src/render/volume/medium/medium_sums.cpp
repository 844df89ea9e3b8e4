// SPDX-License-Identifier: Apache-2.0
#include "render/volume/medium/medium_sums.h"

#include <algorithm>
#include <cmath>

namespace sg::volume {

namespace {

/// Lines narrower than so many nodes are spikes: steps must not pass over them unseen.
constexpr double narrow = 6;

/// The slope of what a node does not tell.
constexpr float untold = 1e30f;

/// The integral of a line's cubic from its origin on.
double integral(const Medium::Line& l, double x) {
  return x * (double(l.at) + x * (double(l.slope) / 2 + x * (double(l.curve) / 3 + x * double(l.twist) / 4)));
}

/// A tau from which on a line is opaque, and what stands for it in the sums, whose bits the rest needs; both times the faint tau. No stride
/// goes there.
constexpr float opaque = 1e5f, opaque_stands_for = 1e3f;

bool is_opaque(const Medium& medium, const Medium::Line& l) {
  return l.at > opaque * medium.faint() && std::abs(l(std::min(l.hi, medium.top())) - l.at) < 1e-4f * l.at;
}

/// The lines as the sums tell them.
std::vector<Medium::Line> told(const Medium& medium) {
  std::vector<Medium::Line> lines = medium.lines();
  for (Medium::Line& l : lines)
    if (is_opaque(medium, l)) l.at = opaque_stands_for * medium.faint(), l.slope = l.curve = l.twist = 0;
  return lines;
}

/// The derivative of the colours on a line at one of its ends, from three of its nodes, the nearest first: 16 bits tell no closer ones
/// apart.
Vec3f color_slope(const Medium& medium, size_t line, float end, float width) {
  const float far = 0.5f * width;
  const Vec3f c0 = medium.color(end, int(line)), c1 = medium.color(end + 0.5f * far, int(line)), c2 = medium.color(end + far, int(line));
  return (c0 * -3 + c1 * 4 - c2) * (1 / far);
}

double slope_at(const Medium::Line& l, double x) { return double(l.slope) + x * (2 * double(l.curve) + x * 3 * double(l.twist)); }

}  // namespace

MediumSums::MediumSums(const Medium& medium) {
  const std::vector<Medium::Line> lines = told(medium);
  lo_ = lines.front().origin;
  const float hi = medium.top();
  width_ = hi > lo_ ? (hi - lo_) / float(nodes) : 1;
  per_width_ = 1 / width_;
  const double w = double(width_);
  const auto node_of = [&](double v) { return size_t(std::clamp((v - double(lo_)) / w, 0.0, double(nodes - 1))); };

  // P at the borders of the nodes.
  std::vector<double> sum(size_t(nodes) + 1, 0.0);
  double before = 0;
  size_t node = 0;
  for (size_t i = 0; i < lines.size(); ++i) {
    const Medium::Line& l = lines[i];
    const bool last = i + 1 == lines.size();
    const double from = double(l.origin), to = last ? double(hi) : double(l.hi);
    for (; node <= size_t(nodes); ++node) {
      const double v = double(lo_) + double(node) * w;
      if (v > to && !last) break;
      sum[node] = before + integral(l, std::max(v - from, 0.0));
    }
    before += integral(l, std::max(to - from, 0.0));
  }
  const double most = std::max(sum.back(), 1e-30);
  per_sum_ = float(most * 0x1p-30);

  nodes_.resize(size_t(nodes) + 1);
  std::vector<float> steep(size_t(nodes) + 1, 0.0f);  // of each node alone
  for (size_t i = 0; i < size_t(nodes); ++i) {
    const float at = lo_ + float(i) * width_;
    const double tau = double(lines[size_t(medium.line_of(at))](at)), share = (sum[i + 1] - sum[i]) / w;
    Node& n = nodes_[i];
    n.sum = uint32_t(uint64_t(std::llround(sum[i] / double(per_sum_))));
    n.tau = float(tau), n.slope = float(2 * (share - tau) / w);
    steep[i] = std::max(std::abs(medium.line_slope(at)), std::abs(n.slope));
  }
  nodes_.back() = nodes_[size_t(nodes) - 1];
  find_kinks(medium);

  // Where a straight line does not do for a node: jumps, and spikes with their surroundings.
  for (size_t i = 0; i < lines.size(); ++i) {
    const Medium::Line& l = lines[i];
    const double to = i + 1 == lines.size() ? double(hi) : double(l.hi), length = to - double(l.origin);
    const double end = double(l.at) + length * (double(l.slope) + length * (double(l.curve) + length * double(l.twist)));
    const bool spike = !l.dark() && length < narrow * w && lines.size() > 1;
    if (is_opaque(medium, medium.lines()[i]))
      for (size_t k = node_of(double(l.origin)); k <= node_of(to); ++k) steep[k] = HUGE_VALF;
    if (spike)
      for (size_t k = node_of(double(l.origin) - w); k <= node_of(to + w); ++k) steep[k] = std::max(steep[k], untold);
    for (size_t k = node_of(double(l.origin)); k <= node_of(to); ++k)
      for (double f : {0.0, 1.0}) {
        const double x = std::clamp(double(lo_) + (double(k) + f) * w - double(l.origin), 0.0, std::max(length, 0.0));
        steep[k] = std::max(steep[k], float(std::abs(slope_at(l, x))));
      }
    if (i + 1 < lines.size()) {
      const double next = double(lines[i + 1].at), jump = std::abs(std::max(next, 0.0) - std::max(end, 0.0));
      // No colour stands for a stride that meets several; one on which the value does not bend may not pass either, as it may the others.
      if (medium.recolors(i + 1))
        for (size_t k = node_of(to - w); k <= node_of(to + w); ++k) steep[k] = HUGE_VALF;
      if (jump > 1e-4 * std::max(std::abs(next), std::abs(end)) && jump > 1e-4 * double(medium.faint()))
        for (size_t k = node_of(to - w); k <= node_of(to + w); ++k) steep[k] = std::max(steep[k], untold);
    }
  }

  // Each level: two neighbours of the one below, and the next two.
  steepest_.assign(size_t(first_of(levels)) + 1, 0.0f);
  std::vector<float>& level = steep;
  for (int l = 0; l < levels; ++l) {
    const size_t n = size_t(nodes >> l);
    for (size_t i = 0; i < n; ++i) steepest_[size_t(first_of(l)) + i] = std::max(level[i], i + 1 < n ? level[i + 1] : 0.0f);
    for (size_t i = 0; i < n / 2; ++i) level[i] = std::max(level[2 * i], level[2 * i + 1]);
  }
}

void MediumSums::find_kinks(const Medium& medium) {
  const std::vector<Medium::Line>& lines = medium.lines();
  std::vector<float> at(size_t(nodes) + 2, 0.0f);
  const float hi = medium.top(), all = hi - lo_;
  for (size_t i = 0; i + 1 < lines.size(); ++i) {
    const float knot = lines[i].hi, next = i + 2 < lines.size() ? lines[i + 1].hi : hi;
    const float before = std::min(knot - lines[i].origin, all / 64), after = std::min(next - knot, all / 64);
    if (medium.recolors(i + 1) || !(before > 6 * width_) || !(after > 6 * width_)) continue;
    // Beside the knot: its own node may be of both sides.
    const Vec3f back = color_slope(medium, i, knot - width_, width_ - before),
                on = color_slope(medium, i + 1, knot + width_, after - width_);
    const Vec3f change = on - back;
    const float kink = std::max({std::abs(change.x), std::abs(change.y), std::abs(change.z)});
    // What 16 bits and the nearest node tell wrong.
    const float unsure = 8e-5f / std::min(before, after) + 8 * width_ * medium.color_slope() / std::min(before, after);
    if (kink > unsure) at[size_t(std::clamp((knot - lo_) * per_width_, 0.0f, float(nodes)))] += kink;
  }
  float sum = 0;
  for (size_t i = 0; i <= size_t(nodes); ++i) nodes_[i].kinks = sum, sum += at[i];
}

}  // namespace sg::volume

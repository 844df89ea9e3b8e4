// SPDX-License-Identifier: Apache-2.0
#include "render/volume/medium/detail.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/volume/medium/transfer.h"

namespace sg::volume {

DetailPlace place_at(const Detail& detail, const Stretch& s, double t, RayField& walker) {
  DetailPlace p;
  SecondDerivatives h;
  p.value = s.value(t);
  switch (detail.axis) {
    case SecondAxis::none: break;
    case SecondAxis::gradient: p.second = length(walker.gradient(s, t)); break;
    case SecondAxis::field: p.second = walker.second(s, t); break;
    case SecondAxis::second_derivative: p.second = walker.bend(s, t, h) ? second_derivative_along(walker.gradient(s, t), h) : NAN; break;
    case SecondAxis::curvature: p.second = walker.bend(s, t, h) ? mean_curvature(walker.gradient(s, t), h) : NAN; break;
  }
  p.sample = detail.transfer.at(p.value, p.second);
  if (!(p.sample.opacity < 1)) p.tau = p.sample.opacity >= 1 ? detail.most_tau : 0;
  else if (p.sample.opacity > 0) p.tau = std::min(float(minus_log_one_minus(double(p.sample.opacity)) / detail.unit), detail.most_tau);
  return p;
}

namespace {

/// Samples of one axis of a transfer function at the begin, the middle and the end of a part.
struct AxisSamples {
  using Edges = std::vector<TransferFunction::Edge>;
  float a, m, b;
  const Edges& edges;
  const TransferFunction& f;
  bool (TransferFunction::*misses)(float lo, float hi, float apart) const;

  /// A parabola through them goes an eighth of its second difference beyond them at most; other curves somewhat more.
  float beyond() const { return 0.5f * std::abs(a - 2 * m + b); }
  /// Whether a line of the curve may lie between two of them, or an edge with more opacity than that beyond all of them.
  bool overlook(float opacity) const {
    const auto [lo, hi] = std::minmax({a, m, b});
    const float far = beyond();
    // Lines are looked for as far beside the samples as these lie apart: the length of a gradient turns sharply where it is small.
    const float apart = std::max(std::abs(a - m), std::abs(m - b)), reach = apart + far;
    return (f.*misses)(lo - reach, hi + reach, apart) || std::any_of(edges.begin(), edges.end(), [&](const auto& e) {
             return e.steep * far > opacity && ((e.at > lo - far && e.at <= lo) || (e.at >= hi && e.at < hi + far));
           });
  }
  bool cross_edge() const {
    const auto [lo, hi] = std::minmax({a, m, b});
    return std::any_of(edges.begin(), edges.end(), [&](const auto& e) { return e.at >= lo && e.at <= hi; });
  }
};

}  // namespace

bool overlooks(const Detail& detail, double length, const DetailPlace& a, const DetailPlace& m, const DetailPlace& b) {
  const TransferFunction& f = detail.transfer;
  const AxisSamples value{a.value, m.value, b.value, f.edges(), f, &TransferFunction::misses};
  const AxisSamples second{a.second, m.second, b.second, f.second_edges(), f, &TransferFunction::misses_second};
  const auto faint = float(overlooked_depth * detail.unit / length);
  // What begins over one axis may end over the other.
  const bool both = value.cross_edge() && second.cross_edge();
  if (!both && !value.overlook(faint) && !second.overlook(faint)) return false;
  const auto [lo, hi] = std::minmax({a.value, m.value, b.value});
  return !f.clear(lo - value.beyond(), hi + value.beyond());
}

namespace {

double depth_between(const Detail& detail, const Stretch& s, RayField& walker, double from, double to, const DetailPlace& a,
                     const DetailPlace& b, int cuts) {
  const double middle = 0.5 * (from + to), length = to - from;
  const DetailPlace m = place_at(detail, s, middle, walker);
  const double simpson = length / 6 * double(a.tau + 4 * m.tau + b.tau), rough = length / 4 * double(a.tau + 2 * m.tau + b.tau);
  const bool agree = std::abs(simpson - rough) <= 1e-3 * std::max(1.0, simpson) && !overlooks(detail, length, a, m, b);
  if (cuts >= 6 || (cuts > 0 && agree)) return simpson;
  return depth_between(detail, s, walker, from, middle, a, m, cuts + 1) + depth_between(detail, s, walker, middle, to, m, b, cuts + 1);
}

}  // namespace

double optical_depth(const Detail& detail, const Stretch& s, RayField& walker) {
  const float lo = s.lowest(), hi = s.highest();
  if (!(lo <= hi) || detail.transfer.clear(lo, hi)) return 0;
  return depth_between(detail, s, walker, s.from, s.to, place_at(detail, s, s.from, walker), place_at(detail, s, s.to, walker), 0);
}

}  // namespace sg::volume

// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/volume/boundaries.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text/text.h"

namespace sg {

namespace {

constexpr size_t bins = 256;

// Weighted mean over neighbours; bins without samples take part with no weight.
std::vector<double> smooth_mean(const std::vector<double>& sum, const std::vector<double>& count, int reach) {
  std::vector<double> r(bins);
  for (int b = 0; b < int(bins); ++b) {
    double s = 0, n = 0;
    for (int k = -reach; k <= reach; ++k) {
      const int o = b + k;
      if (o < 0 || o >= int(bins)) continue;
      const double w = 1 - std::abs(k) / double(reach + 1);
      s += w * sum[size_t(o)], n += w * count[size_t(o)];
    }
    r[size_t(b)] = n > 0 ? s / n : 0;
  }
  return r;
}

}  // namespace

std::vector<MaterialBoundary> material_boundaries(const std::vector<DerivativeSample>& samples, double lo, double hi, size_t most) {
  std::vector<MaterialBoundary> found;
  if (samples.size() < 64 || !(lo < hi)) return found;
  std::vector<double> sum(bins), count(bins);
  const double scale = double(bins) / (hi - lo);
  for (const DerivativeSample& s : samples) {
    const double at = (double(s.value) - lo) * scale;
    if (!(at >= 0 && at <= double(bins))) continue;
    const size_t b = std::min(bins - 1, size_t(at));
    sum[b] += double(s.gradient), count[b] += 1;
  }
  // Values that few places have say nothing: the mean there is noise.
  double all = 0;
  for (double n : count) all += n;
  const std::vector<double> mean = smooth_mean(sum, count, 10), density = smooth_mean(count, std::vector<double>(bins, 1), 10);
  std::vector<double> g = mean;
  for (size_t b = 0; b < bins; ++b) g[b] *= std::min(1.0, density[b] / (0.0002 * all));
  const double highest = *std::max_element(g.begin(), g.end());
  if (!(highest > 0)) return found;
  for (size_t b = 1; b + 1 < bins; ++b) {
    if (!(g[b] > g[b - 1] && g[b] >= g[b + 1])) continue;
    // Prominence: how far the curve falls on both sides before it rises above this peak.
    double left = g[b], right = g[b];
    for (size_t k = b; k-- > 0 && g[k] <= g[b];) left = std::min(left, g[k]);
    for (size_t k = b + 1; k < bins && g[k] <= g[b]; ++k) right = std::min(right, g[k]);
    const double valley = std::max(left, right);
    if (g[b] - valley < 0.15 * highest || g[b] < 0.2 * highest) continue;
    const double half = 0.5 * (g[b] + valley);
    size_t l = b, r = b;
    while (l > 0 && g[l - 1] > half) --l;
    while (r + 1 < bins && g[r + 1] > half) ++r;
    MaterialBoundary m;
    m.value = lo + (double(b) + 0.5) / scale, m.lo = lo + double(l) / scale, m.hi = lo + double(r + 1) / scale;
    m.mean_gradient = mean[b];
    m.share = 0;
    for (size_t k = l; k <= r; ++k) m.share += count[k] / std::max(all, 1.0);
    found.push_back(m);
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.mean_gradient > b.mean_gradient; });
  if (found.size() > most) found.resize(most);
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  return found;
}

std::string show_boundaries(const std::vector<MaterialBoundary>& found, double lo, double hi, OpacityCurve& opacity,
                            TransferDetail& detail) {
  if (found.empty()) return "";
  opacity.points = {{lo, 0}};
  std::string values;
  double weakest = HUGE_VAL;
  const auto add = [&](double x, double y) {
    if (x > opacity.points.back().x) opacity.points.push_back({x, y});
    else opacity.points.back().y = std::max(opacity.points.back().y, y);
  };
  for (size_t i = 0; i < found.size(); ++i) {
    const MaterialBoundary& m = found[i];
    // The innermost border hides most: what lies around it is to be seen through.
    const double most = found.size() == 1 ? 0.6 : 0.12 * std::pow(5.0, double(i) / double(found.size() - 1));
    // No wider than its distance to the next: the curves of two borders must not run together.
    double reach = std::max(m.value - m.lo, m.hi - m.value);
    for (const MaterialBoundary& other : found)
      if (other.value != m.value) reach = std::min(reach, 0.5 * std::abs(other.value - m.value));
    reach = std::min(std::max(reach, 0.01 * (hi - lo)), 0.12 * (hi - lo));
    add(std::max(lo, m.value - reach), 0), add(m.value, most), add(std::min(hi, m.value + reach), 0);
    values += (i == 0 ? "" : i + 1 == found.size() ? " and " : ", ") + short_number(m.value, 4);
    weakest = std::min(weakest, m.mean_gradient);
  }
  if (opacity.points.back().x < hi) opacity.points.push_back({hi, 0});
  detail.second = SecondAxis::gradient;
  detail.second_factor.points = {{0, 0}, {0.25 * weakest, 0}, {0.8 * weakest, 1}};
  return fmt::format("{} at {} (where the mean gradient peaks); the inside of materials is left out",
                     found.size() == 1 ? "a material boundary" : "material boundaries", values);
}

}  // namespace sg

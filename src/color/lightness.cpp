// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "color/cie.h"
#include "color/colormap.h"

namespace sg {
namespace {

/// Nearest of 256. Halves (jet is made of them) go down whatever the rounding to float did to them.
double in_8_bits(double v) { return std::ceil(v * 255 - 0.5001) / 255; }

}  // namespace

LightnessReport lightness_report(const Colormap& map, int n) {
  n = std::max(n, 2);
  LightnessReport report;
  report.flattest = std::numeric_limits<double>::infinity();
  Vec3 last_lab;
  double last_8bit = 0;
  for (int i = 0; i < n; ++i) {
    const Vec3 color(map.at(double(i) / (n - 1)));
    const Vec3 rounded{in_8_bits(color.x), in_8_bits(color.y), in_8_bits(color.z)};
    const Vec3 lab = srgb_to_lab(color);
    const double in_8bit = srgb_to_lab(rounded).x;
    report.lightness.push_back(lab.x);
    if (i > 0) {
      report.falls_float += lab.x < last_lab.x;
      report.falls_8bit += in_8bit < last_8bit;
      const double step = ciede2000(last_lab, lab) * (n - 1);
      report.steepest = std::max(report.steepest, step);
      report.flattest = std::min(report.flattest, step);
    }
    last_lab = lab, last_8bit = in_8bit;
  }
  const auto [low, high] = std::minmax_element(report.lightness.begin(), report.lightness.end());
  report.lowest = *low, report.highest = *high;
  return report;
}

}  // namespace sg

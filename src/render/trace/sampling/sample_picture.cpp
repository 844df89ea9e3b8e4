// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/context.h"
#include "base/parallel.h"
#include "render/trace/sampling/sample_study.h"

namespace sg::trace {

namespace {

constexpr int panel = 384, margin = 24;

// Draws value(x, y) in [0, 1] as greys into a panel, x and y in [0, 1) of it.
void fill_panel(Image& to, int number, auto value) {
  for (int y = 0; y < panel; ++y)
    for (int x = 0; x < panel; ++x) {
      const double v = value((x + 0.5) / panel, (y + 0.5) / panel);
      *to.at(margin + number * (panel + margin) + x, margin + y) = uint8_t(std::clamp(v, 0.0, 1.0) * 255 + 0.5);
    }
}

void draw_points(Image& to, const SampleStudyParams& p) {
  std::vector<double> paper(size_t(panel) * panel, 1);
  Sampler sampler(p.sampler, uint64_t(p.seed), p.count);
  const double radius = std::clamp(0.22 * panel / std::sqrt(double(p.count)), 0.8, 4.0);
  for (int i = 0; i < p.count; ++i) {
    sampler.start(0, 0, uint32_t(i));
    const Vec2f u = sampler.next2();
    const double cx = double(u.x) * panel - 0.5, cy = (1 - double(u.y)) * panel - 0.5;
    const int reach = int(radius) + 2;
    for (int y = int(cy) - reach; y <= int(cy) + reach; ++y)
      for (int x = int(cx) - reach; x <= int(cx) + reach; ++x)
        if (x >= 0 && y >= 0 && x < panel && y < panel)
          paper[size_t(y * panel + x)] *= 1 - std::clamp(radius + 0.5 - std::hypot(x - cx, y - cy), 0.0, 1.0);
  }
  fill_panel(to, 0, [&](double x, double y) { return paper[size_t(int(y * panel) * panel + int(x * panel))]; });
}

// Power of the points at whole frequencies up to `most` in each axis, relative to that of independent points.
std::vector<double> spectrum(const SampleStudyParams& p, int most, const Context& context) {
  const int side = 2 * most + 1, patterns = std::clamp(16384 / p.count, 1, 64);
  const size_t n = size_t(p.count);
  std::vector<double> power(size_t(side) * size_t(side));
  for (int pattern = 0; pattern < patterns; ++pattern) {
    Sampler sampler(p.sampler, uint64_t(p.seed) + uint64_t(pattern), p.count);
    // cos and sin of 2 pi k x and 2 pi k y for each point.
    std::vector<float> cx(size_t(side) * n), sx(cx), cy(cx), sy(cx);
    for (size_t i = 0; i < n; ++i) {
      sampler.start(0, 0, uint32_t(i));
      const Vec2f u = sampler.next2();
      for (int k = -most; k <= most; ++k) {
        const double a = 2 * std::numbers::pi * k * double(u.x), b = 2 * std::numbers::pi * k * double(u.y);
        const size_t at = size_t(k + most) * n + i;
        cx[at] = float(std::cos(a)), sx[at] = float(std::sin(a)), cy[at] = float(std::cos(b)), sy[at] = float(std::sin(b));
      }
    }
    parallel_for(
        size_t(side), 1,
        [&](size_t v, size_t) {
          for (size_t u = 0; u < size_t(side); ++u) {
            float re = 0, im = 0;
            for (size_t i = 0; i < n; ++i) {
              re += cx[u * n + i] * cy[v * n + i] - sx[u * n + i] * sy[v * n + i];
              im += cx[u * n + i] * sy[v * n + i] + sx[u * n + i] * cy[v * n + i];
            }
            power[v * size_t(side) + u] += (double(re) * double(re) + double(im) * double(im)) / double(n) / patterns;
          }
        },
        &context);
  }
  power[size_t(most * side + most)] = 0;
  return power;
}

void draw_errors(Image& to, const SampleStudyParams& p, const Context& context) {
  const int side = 96, count = std::min(p.count, 256);
  std::vector<double> error(side * side);
  parallel_for(
      side, 1,
      [&](size_t y, size_t) {
        Sampler sampler(p.sampler, uint64_t(p.seed), p.count);
        for (uint32_t x = 0; x < side; ++x)
          for (int i = 0; i < count; ++i) {
            sampler.start(x, uint32_t(y), uint32_t(i));
            const Vec2f u = sampler.next2();
            error[y * side + x] += std::exp(double(u.x) + double(u.y)) / count;
          }
      },
      &context);
  double mean = 0, variance = 0;
  for (const double e : error) mean += e / (side * side);
  for (const double e : error) variance += (e - mean) * (e - mean) / (side * side);
  const double scale = variance > 0 ? 0.25 / std::sqrt(variance) : 0;
  fill_panel(to, 2, [&](double x, double y) { return 0.5 + scale * (error[size_t(int(y * side) * side + int(x * side))] - mean); });
}

}  // namespace

Image sample_picture(const SampleStudyParams& p, const Context& context) {
  Image image(3 * panel + 4 * margin, panel + 2 * margin, 1);
  std::fill(image.pixels.begin(), image.pixels.end(), uint8_t(225));
  draw_points(image, p);
  const int most = std::clamp(int(4 * std::sqrt(double(p.count))), 16, 64), side = 2 * most + 1;
  const std::vector<double> power = spectrum(p, most, context);
  fill_panel(image, 1, [&](double x, double y) { return power[size_t(int((1 - y) * side) * side + int(x * side))] / 2; });
  draw_errors(image, p, context);
  return image;
}

}  // namespace sg::trace

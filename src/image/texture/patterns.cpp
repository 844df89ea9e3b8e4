// SPDX-License-Identifier: Apache-2.0
#include "image/texture/patterns.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.h"

namespace sg {

namespace {

constexpr int noise_size = 256;

// Gradient noise of n x n cells that repeats; about -0.7 to 0.7.
double gradient_noise(double x, double y, int n, uint32_t seed) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto slope = [&](int i, int j) {
    const auto cell = uint64_t((int(fx) + i) % n + n * ((int(fy) + j) % n));
    const double angle = 2 * std::numbers::pi * random_unit(seed, cell);
    return std::cos(angle) * (x - fx - i) + std::sin(angle) * (y - fy - j);
  };
  const auto fade = [](double t) { return t * t * t * (t * (6 * t - 15) + 10); };
  const double s = fade(x - fx), t = fade(y - fy);
  return std::lerp(std::lerp(slope(0, 0), slope(1, 0), s), std::lerp(slope(0, 1), slope(1, 1), s), t);
}

}  // namespace

Texture pattern_texture(TexturePattern pattern, Vec3f first, Vec3f second) {
  const Vec4f a{first.x, first.y, first.z, 1}, b{second.x, second.y, second.z, 1};
  if (pattern == TexturePattern::checker) return {2, 2, {a, b, b, a}};
  std::vector<double> cloud(size_t(noise_size) * noise_size);
  for (size_t i = 0; i < cloud.size(); ++i) {
    const double u = (double(i % noise_size) + 0.5) / noise_size, v = (double(i / noise_size) + 0.5) / noise_size;
    for (int octave = 0, n = 4; octave < 5; ++octave, n *= 2) cloud[i] += gradient_noise(u * n, v * n, n, uint32_t(octave)) * 4 / n;
  }
  const auto [lo, hi] = std::minmax_element(cloud.begin(), cloud.end());
  std::vector<Vec4f> texels;
  for (const double c : cloud) {
    const auto t = float((c - *lo) / (*hi - *lo));
    texels.push_back(a * (1 - t) + b * t);
  }
  return {noise_size, noise_size, std::move(texels)};
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/noise.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"

namespace sg::texture {

namespace {

size_t size_of(const int32_t n[3]) { return size_t(n[0]) * size_t(n[1]) * size_t(n[2]); }

}  // namespace

Plane<float> white_noise(const int32_t n[3], uint64_t seed) {
  Plane<float> v(size_of(n));
  parallel_for(v.size(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; i += 4) {
      const uint64_t bits = random_bits(seed, i / 4);
      for (size_t k = 0; k < 4 && i + k < end; ++k) v[i + k] = float(int32_t(bits >> (16 * k) & 0xffff)) * 0x1.0p-16f;
    }
  });
  return v;
}

Plane<float> sparse_noise(const int32_t n[3], uint64_t seed, double density) {
  Plane<float> v(size_of(n));
  parallel_for(v.size(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) v[i] = random_unit(seed, i) < density ? 1.0f : 0.0f;
  });
  return v;
}

Plane<float> grained_noise(const int32_t n[3], uint64_t seed, double grain, bool sparse, double density) {
  if (grain <= 1) return sparse ? sparse_noise(n, seed, density) : white_noise(n, seed);
  int32_t coarse[3];
  for (int a = 0; a < 3; ++a) coarse[a] = n[a] > 1 ? int32_t(std::ceil((n[a] - 1) / grain)) + 2 : 1;
  const Plane<float> c = sparse ? sparse_noise(coarse, seed, density) : white_noise(coarse, seed);
  Plane<float> v(size_of(n));
  // Where each pixel lies between the coarse points.
  std::vector<int32_t> at[3];
  std::vector<float> t[3];
  for (int a = 0; a < 3; ++a)
    for (int32_t i = 0; i < n[a]; ++i) {
      const double x = i / grain;
      at[a].push_back(int32_t(x)), t[a].push_back(float(x - std::floor(x)));
    }
  parallel_for(size_t(n[1]) * size_t(n[2]), 8, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const size_t j = row % size_t(n[1]), k = row / size_t(n[1]);
      auto value = [&](int32_t x, int32_t y, int32_t z) {
        return c[size_t(x) + size_t(coarse[0]) * (size_t(y) + size_t(coarse[1]) * size_t(z))];
      };
      for (size_t i = 0; i < size_t(n[0]); ++i) {
        const int32_t x = at[0][i], y = at[1][j], z = at[2][k];
        auto line = [&](int32_t yy, int32_t zz) {
          const float a = value(x, yy, zz), b = n[0] > 1 ? value(x + 1, yy, zz) : a;
          return a + t[0][i] * (b - a);
        };
        auto sheet = [&](int32_t zz) {
          const float a = line(y, zz), b = n[1] > 1 ? line(y + 1, zz) : a;
          return a + t[1][j] * (b - a);
        };
        const float a = sheet(z), b = n[2] > 1 ? sheet(z + 1) : a;
        v[row * size_t(n[0]) + i] = a + t[2][k] * (b - a);
      }
    }
  });
  return v;
}

}  // namespace sg::texture

// SPDX-License-Identifier: Apache-2.0
#include "pipeline/offline/pack/quantize.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "image/image.h"
#include "pipeline/offline/pack/json_text.h"

namespace sg::offline {

namespace {

uint64_t add_codes(const std::vector<uint32_t>& codes, int bits, uint32_t stride, ArrayStore& store) {
  if (bits <= 8) return store.add(std::vector<uint8_t>(codes.begin(), codes.end()), stride);
  if (bits <= 16) return store.add(std::vector<uint16_t>(codes.begin(), codes.end()), stride);
  return store.add(codes, stride);
}

/// Codes of values on the scale lie from `first` to `last`.
struct ScaleCodes {
  uint32_t first, last, all;
  explicit ScaleCodes(int bits) : first((1u << bits) / 16), last((1u << bits) - 1 - (1u << bits) / 16), all((1u << bits) - 1) {}
};

constexpr double farthest_below = -2, farthest_above = 3;  // positions further out look the same

}  // namespace

Json pack_positions(const std::vector<float>& xyz, Vec3 origin, int bits, ArrayStore& store) {
  double lo[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  for (size_t i = 0; i < xyz.size(); ++i) lo[i % 3] = std::min(lo[i % 3], double(xyz[i])), hi[i % 3] = std::max(hi[i % 3], double(xyz[i]));
  const double most = double((1u << bits) - 1);
  double size[3];
  for (int a = 0; a < 3; ++a) {
    if (!(lo[a] <= hi[a])) lo[a] = hi[a] = 0;
    size[a] = hi[a] - lo[a];
  }
  std::vector<uint32_t> codes(xyz.size());
  parallel_for(xyz.size(), 1 << 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const size_t a = i % 3;
      codes[i] = size[a] > 0 ? uint32_t(std::lround((double(xyz[i]) - lo[a]) / size[a] * most)) : 0;
    }
  });
  return Json(Json::Members{{"array", Json(add_codes(codes, bits, 3, store))},
                            {"bits", Json(uint64_t(bits))},
                            {"lo", numbers({lo[0], lo[1], lo[2]})},
                            {"size", numbers({size[0], size[1], size[2]})},
                            {"origin", numbers(origin)}});
}

Json pack_normals(const std::vector<float>& normals, int bits, ArrayStore& store) {
  const double most = double((1u << bits) - 1);
  std::vector<uint32_t> codes(normals.size() / 3 * 2);
  parallel_for(normals.size() / 3, 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const double x = normals[3 * i], y = normals[3 * i + 1], z = normals[3 * i + 2], sum = std::abs(x) + std::abs(y) + std::abs(z);
      double u = sum > 0 ? x / sum : 0, v = sum > 0 ? y / sum : 0;
      if (z < 0) {
        const double w = (1 - std::abs(v)) * (u < 0 ? -1 : 1);
        v = (1 - std::abs(u)) * (v < 0 ? -1 : 1), u = w;
      }
      if (!std::isfinite(u) || !std::isfinite(v)) u = v = 0;
      codes[2 * i] = uint32_t(std::lround((0.5 + 0.5 * u) * most)), codes[2 * i + 1] = uint32_t(std::lround((0.5 + 0.5 * v) * most));
    }
  });
  return Json(Json::Members{{"array", Json(add_codes(codes, bits, 2, store))}, {"bits", Json(uint64_t(bits))}});
}

Vec3f unpacked_normal(uint32_t cu, uint32_t cv, int bits) {
  const double most = double((1u << bits) - 1);
  double u = 2 * cu / most - 1, v = 2 * cv / most - 1;
  const double z = 1 - std::abs(u) - std::abs(v);
  if (z < 0) {
    const double w = (1 - std::abs(v)) * (u < 0 ? -1 : 1);
    v = (1 - std::abs(u)) * (v < 0 ? -1 : 1), u = w;
  }
  return Vec3f(normalize(Vec3{u, v, z}));
}

Json pack_scale_positions(const std::vector<double>& t, int bits, ArrayStore& store) {
  double least = 0, most = 1;
  for (const double x : t)
    if (std::isfinite(x)) least = std::min(least, x), most = std::max(most, x);
  least = std::max(least, farthest_below), most = std::min(most, farthest_above);
  const ScaleCodes c(bits);
  std::vector<uint32_t> codes(t.size());
  parallel_for(t.size(), 1 << 15, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const double x = std::clamp(t[i], least, most);
      if (t[i] != t[i]) codes[i] = 0;
      else if (x < 0) codes[i] = 1 + std::min(uint32_t(std::lround((x - least) / -least * double(c.first - 1))), c.first - 2);
      else if (x <= 1) codes[i] = c.first + uint32_t(std::lround(x * double(c.last - c.first)));
      else codes[i] = c.last + std::max(uint32_t(std::lround((x - 1) / (most - 1) * double(c.all - c.last))), 1u);
    }
  });
  return Json(Json::Members{
      {"array", Json(add_codes(codes, bits, 1, store))}, {"bits", Json(uint64_t(bits))}, {"least", Json(least)}, {"most", Json(most)}});
}

double unpacked_scale_position(uint32_t code, int bits, double least, double most) {
  const ScaleCodes c(bits);
  if (code == 0) return NAN;
  if (code < c.first) return least - least * double(code - 1) / double(c.first - 1);
  if (code <= c.last) return double(code - c.first) / double(c.last - c.first);
  return 1 + (most - 1) * double(code - c.last) / double(c.all - c.last);
}

Json pack_colors(const std::vector<float>& rgba, ArrayStore& store) {
  std::vector<uint8_t> bytes(rgba.size());
  for (size_t i = 0; i < rgba.size(); ++i) {
    const float v = i % 4 == 3 ? rgba[i] : srgb_encode(rgba[i]);
    bytes[i] = uint8_t(std::lround(255 * std::clamp(v, 0.0f, 1.0f)));
  }
  return Json(Json::Members{{"array", Json(store.add(bytes, 4))}});
}

}  // namespace sg::offline

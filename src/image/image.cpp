// SPDX-License-Identifier: Apache-2.0
#include "image/image.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace sg {

Frame::Frame(int w, int h) : width(w), height(h) {
  const size_t n = pixels();
  rgba.resize(4 * n), depth.resize(n), ids.resize(n);
  parallel_for(n, 1 << 16, [&](size_t begin, size_t end) {
    std::fill(rgba.begin() + ptrdiff_t(4 * begin), rgba.begin() + ptrdiff_t(4 * end), 0.0f);
    std::fill(depth.begin() + ptrdiff_t(begin), depth.begin() + ptrdiff_t(end), std::numeric_limits<float>::infinity());
    std::fill(ids.begin() + ptrdiff_t(begin), ids.begin() + ptrdiff_t(end), 0u);
  });
}
namespace {

/// Linear light to an 8-bit sRGB code, equal to round(255 * srgb_encode(x)) for every float x.
///
/// A bucket is the exponent and the upper 8 bits of the mantissa. Within one, x grows by less than 1/256, and the code by
/// less than 255 * 1.055 / 2.4 / 256 < 1/2: at most one threshold lies in it, and one comparison decides.
class Encoder {
 public:
  Encoder() {
    for (int code = 1; code < 256; ++code) starts_[code] = start_of(code);
    starts_[256] = std::numeric_limits<float>::infinity();
    int code = 0;
    for (uint32_t b = 0; b < buckets; ++b) {
      const float low = std::bit_cast<float>((b << shift) + first_bits);
      while (starts_[code + 1] <= low) ++code;
      base_[b] = uint8_t(code);
    }
  }

  uint8_t operator()(float x) const {
    x = x > smallest ? x : smallest;  // the code is 0 there; NaN too
    x = x < below_one ? x : below_one;
    const uint8_t code = base_[(std::bit_cast<uint32_t>(x) - first_bits) >> shift];
    return uint8_t(code + (x >= starts_[code + 1]));
  }

 private:
  static constexpr uint32_t shift = 15;
  static constexpr float smallest = 0x1p-13f, below_one = 0x1.fffffep-1f;
  static constexpr uint32_t first_bits = uint32_t(127 - 13) << 23;
  static constexpr uint32_t buckets = 13u << (23 - shift);

  static int code_of(float x) { return int(255 * srgb_encode(x) + 0.5f); }
  /// The smallest float with that code.
  static float start_of(int code) {
    float x = srgb_decode((float(code) - 0.5f) / 255);
    while (code_of(x) >= code) x = std::nextafter(x, 0.0f);
    while (code_of(x) < code) x = std::nextafter(x, 2.0f);
    return x;
  }

  float starts_[257] = {};
  uint8_t base_[buckets];
};

const Encoder& encoder() {
  static const Encoder e;
  return e;
}

uint8_t alpha_code(float a) { return a >= 1 ? 255 : a > 0 ? uint8_t(255 * a + 0.5f) : 0; }

}  // namespace

float srgb_encode(float linear) {
  const double l = linear;
  if (l <= 0.0031308) return float(12.92 * l);
  return float(1.055 * std::pow(l, 1 / 2.4) - 0.055);
}

float srgb_decode(float encoded) {
  const double e = encoded;
  if (e <= 0.04045) return float(e / 12.92);
  return float(std::pow((e + 0.055) / 1.055, 2.4));
}

Image to_image(const Frame& frame, bool transparent) {
  Image image(frame.width, frame.height, transparent ? 4 : 3);
  const Encoder& encode = encoder();
  const float* in = frame.rgba.data();
  uint8_t* out = image.pixels.data();
  parallel_for(frame.pixels(), 16384, [&](size_t begin, size_t end) {
    if (transparent) {
      for (size_t i = begin; i < end; ++i) {
        const float a = in[4 * i + 3];
        // Straight colour is unknown where nothing covers; black keeps the file small.
        for (int c = 0; c < 3; ++c) out[4 * i + c] = a > 0 ? encode(in[4 * i + c] / a) : 0;
        out[4 * i + 3] = alpha_code(a);
      }
    } else {
      for (size_t i = begin; i < end; ++i)
        for (int c = 0; c < 3; ++c) out[3 * i + c] = encode(in[4 * i + c]);
    }
  });
  return image;
}

}  // namespace sg

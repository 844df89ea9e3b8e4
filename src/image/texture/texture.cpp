// SPDX-License-Identifier: Apache-2.0
#include "image/texture/texture.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"

namespace sg {

namespace {

constexpr size_t texels_per_chunk = 1 << 14;
constexpr size_t most_texels = size_t(1) << 26;

/// Which texels of a row of n one of its half covers, and how much of it each is.
struct Cover {
  int first = 0, count = 0;
  std::array<float, 3> weights{};
};

/// The texels that texel i of m = max(1, n / 2) covers: n / m of them. An odd row gives each of its halves a part of a third one:
///
///   n = 5:  |   0   |   1   |   2   |   3   |   4   |
///   m = 2:  |         0         |         1         |
Cover cover_of(int i, int n) {
  if (n == 1) return {0, 1, {1}};
  const int m = n / 2;
  if (n % 2 == 0) return {2 * i, 2, {0.5f, 0.5f}};
  const auto part = [n](int k) { return float(double(k) / n); };
  return {2 * i, 3, {part(m - i), part(m), part(i + 1)}};
}

Texture::Level half_of(const Texture::Level& in) {
  Texture::Level out;
  out.width = std::max(1, in.width / 2), out.height = std::max(1, in.height / 2);
  out.texels.resize(size_t(out.width) * size_t(out.height));
  parallel_for(size_t(out.height), std::max<size_t>(1, texels_per_chunk / size_t(out.width)), [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) {
      const Cover down = cover_of(int(y), in.height);
      for (int x = 0; x < out.width; ++x) {
        const Cover across = cover_of(x, in.width);
        Vec4f sum;
        for (int j = 0; j < down.count; ++j)
          for (int i = 0; i < across.count; ++i) {
            const Vec4f& t = in.at(across.first + i, down.first + j);
            const float w = across.weights[size_t(i)] * down.weights[size_t(j)];
            for (int c = 0; c < 4; ++c) sum[c] += w * t[c];
          }
        out.texels[y * size_t(out.width) + size_t(x)] = sum;
      }
    }
  });
  return out;
}

void check_size(int width, int height) {
  if (width < 1 || height < 1) fail_data("the picture has no pixels", "texture");
  if (size_t(width) * size_t(height) > most_texels)
    fail_data(fmt::format("{} x {} pixels are too many for a texture", width, height), "texture", "make it smaller: 8192 x 8192 at most");
}

bool is_finite(const Vec4f& t) { return std::isfinite(t.x) && std::isfinite(t.y) && std::isfinite(t.z) && std::isfinite(t.w); }

/// texel(x, y from the top) of all pixels, rows from the bottom.
template <class F>
std::vector<Vec4f> from_below(int width, int height, F&& texel) {
  check_size(width, height);
  std::vector<Vec4f> texels(size_t(width) * size_t(height));
  parallel_for(size_t(height), std::max<size_t>(1, texels_per_chunk / size_t(width)), [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y)
      for (int x = 0; x < width; ++x) texels[y * size_t(width) + size_t(x)] = texel(x, height - 1 - int(y));
  });
  return texels;
}

}  // namespace

Texture::Texture(int width, int height, std::vector<Vec4f> texels) {
  check_size(width, height);
  if (texels.size() != size_t(width) * size_t(height)) fail_internal("a texture of another size than its texels");
  Level base;
  base.width = width, base.height = height, base.texels = std::move(texels);
  translucent_ = parallel_reduce(
      base.texels.size(), texels_per_chunk, false,
      [&](size_t begin, size_t end) {
        bool any = false;
        for (size_t i = begin; i < end; ++i) {
          if (!is_finite(base.texels[i])) base.texels[i] = {};
          any = any || base.texels[i].w < 1;
        }
        return any;
      },
      [](bool a, bool b) { return a || b; });
  levels_.push_back(std::move(base));
  while (levels_.back().width > 1 || levels_.back().height > 1) levels_.push_back(half_of(levels_.back()));
}

Texture Texture::of(const Image& picture, TexelEncoding encoding, bool alpha) {
  std::array<float, 256> decoded;
  for (size_t i = 0; i < decoded.size(); ++i) {
    const float v = float(i) / 255;
    decoded[i] = encoding == TexelEncoding::srgb ? srgb_decode(v) : v;
  }
  const bool grey = picture.channels <= 2, has_alpha = alpha && picture.channels % 2 == 0;
  return {picture.width, picture.height, from_below(picture.width, picture.height, [&](int x, int y) -> Vec4f {
            const uint8_t* p = picture.at(x, y);
            const float a = has_alpha ? float(p[picture.channels - 1]) / 255 : 1;
            return {a * decoded[p[0]], a * decoded[p[grey ? 0 : 1]], a * decoded[p[grey ? 0 : 2]], a};
          })};
}

Texture Texture::of(const LinearPicture& picture) {
  return {picture.width, picture.height, from_below(picture.width, picture.height, [&](int x, int y) -> Vec4f {
            const Vec3f& p = picture.pixels[size_t(y) * size_t(picture.width) + size_t(x)];
            return {p.x, p.y, p.z, 1};
          })};
}

size_t Texture::bytes() const {
  size_t sum = 0;
  for (const Level& l : levels_) sum += l.texels.size() * sizeof(Vec4f);
  return sum;
}

}  // namespace sg

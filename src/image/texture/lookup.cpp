// SPDX-License-Identifier: Apache-2.0
#include "image/texture/lookup.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sg {

namespace {

constexpr double most_probes = 16;

/// The number in [0, n) of texel i of a picture that goes on for ever.
int wrapped(int64_t i, int n, TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::repeat: return int((i % n + n) % n);
    case TextureWrap::mirror: {
      const int64_t two = 2 * int64_t(n), k = (i % two + two) % two;
      return int(k < n ? k : two - 1 - k);
    }
    case TextureWrap::clamp: break;
  }
  return int(std::clamp<int64_t>(i, 0, n - 1));
}

/// The same place nearer to the picture, so that its texels can be counted.
double folded(double x, TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::repeat: return x - std::floor(x);
    case TextureWrap::mirror: return x - 2 * std::floor(x / 2);
    case TextureWrap::clamp: break;
  }
  return std::clamp(x, -1.0, 2.0);
}

/// Two texels beside a place, and how much of the second there is.
struct Between {
  int a, b;
  float t;
};
Between between(double texel, int n, TextureWrap wrap) {
  const double below = std::floor(texel - 0.5);
  const auto i = int64_t(below);
  if (i >= 0 && i + 1 < n) return {int(i), int(i) + 1, float(texel - 0.5 - below)};
  return {wrapped(i, n, wrap), wrapped(i + 1, n, wrap), float(texel - 0.5 - below)};
}

void add(Vec4f& sum, const Vec4f& v, float weight) {
  for (int c = 0; c < 4; ++c) sum[c] += weight * v[c];
}

/// `edge`: over how much of a texel two of them are blended, 1 or less.
struct Sharpness {
  float u = 1, v = 1;
};
float sharpened(float t, float edge) { return edge >= 1 ? t : std::clamp((t - 0.5f) / edge + 0.5f, 0.f, 1.f); }

struct Probe {
  const Texture& texture;
  const TextureLookup& how;
  Sharpness edge;

  void bilinear(const Texture::Level& l, Vec2 at, float weight, Sharpness edge, Vec4f& sum) const {
    Between x = between(folded(at.x, how.wrap_u) * l.width, l.width, how.wrap_u);
    Between y = between(folded(at.y, how.wrap_v) * l.height, l.height, how.wrap_v);
    x.t = sharpened(x.t, edge.u), y.t = sharpened(y.t, edge.v);
    add(sum, l.at(x.a, y.a), weight * (1 - x.t) * (1 - y.t)), add(sum, l.at(x.b, y.a), weight * x.t * (1 - y.t));
    add(sum, l.at(x.a, y.b), weight * (1 - x.t) * y.t), add(sum, l.at(x.b, y.b), weight * x.t * y.t);
  }
  /// `size`: of what is averaged, in texels of the picture.
  void trilinear(Vec2 at, double size, float weight, Vec4f& sum) const {
    const auto& levels = texture.levels();
    const double lod = size > 1 ? std::min(std::log2(size), double(levels.size() - 1)) : 0;
    const auto level = size_t(lod);
    const auto t = float(lod - double(level));
    bilinear(levels[level], at, weight * (1 - t), level == 0 ? edge : Sharpness(), sum);
    if (t > 0) bilinear(levels[level + 1], at, weight * t, {}, sum);
  }
};

/// The ellipse that a round pixel sees, in texels: its axes, from end to end, and the direction of the longer one.
struct Ellipse {
  double longer = 0, shorter = 0;
  Vec2 direction{1, 0};
};
Ellipse ellipse_of(Vec2 right, Vec2 down) {
  // Singular values of the matrix with these columns, from J J^T = (a b; b c).
  const double a = right.x * right.x + down.x * down.x, b = right.x * right.y + down.x * down.y, c = right.y * right.y + down.y * down.y;
  const double mean = (a + c) / 2, apart = std::sqrt((a - c) * (a - c) / 4 + b * b);
  Ellipse e;
  e.longer = std::sqrt(mean + apart);
  const double area = std::abs(right.x * down.y - right.y * down.x);
  e.shorter = e.longer > 0 ? area / e.longer : 0;
  // The eigenvector of mean + apart, by the column that does not cancel.
  Vec2 v = a >= c ? Vec2{apart + (a - c) / 2, b} : Vec2{b, apart + (c - a) / 2};
  const double length = std::hypot(v.x, v.y);
  if (length > 0) e.direction = {v.x / length, v.y / length};
  return e;
}

}  // namespace

Vec4f TextureLookup::operator()(const Texture& texture, const TexturePlace& place) const {
  if (!std::isfinite(place.at.x + place.at.y)) return {};
  const Texture::Level& whole = texture.levels()[0];
  if (filter == TextureFilter::nearest) {
    const double x = folded(place.at.x, wrap_u) * whole.width, y = folded(place.at.y, wrap_v) * whole.height;
    return whole.at(wrapped(int64_t(std::floor(x)), whole.width, wrap_u), wrapped(int64_t(std::floor(y)), whole.height, wrap_v));
  }
  const Vec2 right{place.right.x * whole.width, place.right.y * whole.height},
      down{place.down.x * whole.width, place.down.y * whole.height};
  Vec4f sum;
  Sharpness edge;
  if (sharp) {
    // A box as wide as the footprint, over squares.
    const auto width = [](double a, double b) { return float(std::clamp(std::hypot(a, b), 1e-6, 1.0)); };
    edge = {width(right.x, down.x), width(right.y, down.y)};
  }
  const Probe probe{texture, *this, edge};
  if (filter == TextureFilter::bilinear) {
    probe.bilinear(whole, place.at, 1, edge, sum);
    return sum;
  }
  const Ellipse e = ellipse_of(right, down);
  if (!std::isfinite(e.longer)) return texture.levels().back().texels[0];  // seen edge-on: all of it
  if (filter == TextureFilter::trilinear) {
    probe.trilinear(place.at, e.longer, 1, sum);
    return sum;
  }
  // A probe is no smaller than a texel: more of them than texels along the axis would show nothing new.
  const double size = std::max({e.shorter, e.longer / most_probes, 1.0});
  const int probes = std::max(1, int(std::ceil(e.longer / size - 1e-9)));
  const Vec2 axis{e.direction.x * e.longer / whole.width, e.direction.y * e.longer / whole.height};
  for (int k = 0; k < probes; ++k) {
    const double s = (k + 0.5) / probes - 0.5;
    probe.trilinear({place.at.x + axis.x * s, place.at.y + axis.y * s}, size, 1 / float(probes), sum);
  }
  return sum;
}

}  // namespace sg

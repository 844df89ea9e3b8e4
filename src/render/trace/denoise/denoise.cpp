// SPDX-License-Identifier: Apache-2.0
#include "render/trace/denoise/denoise.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "data/memory/memory_budget.h"
#include "render/prepare/shared_progress.h"

namespace sg::trace {

namespace {

constexpr int reach = 7;                                             // of the neighbours, to each side
constexpr int patch = 2;                                             // of the pixels around both that are compared, to each side
constexpr int block = 32;                                            // pixels, along each side, that one thread does at a time
constexpr float color_bandwidth = 0.45f, feature_bandwidth = 0.75f;  // k, as Rousselle et al. 2013
// Squares of differences that are none: of colours, which are data, less than of directions and distances.
constexpr float least_color_variance = 1e-3f, least_shape_variance = 1e-2f;
constexpr float tiny = 1e-12f;

/// About exp(-d), which compilers make vectors of.
inline float falling(float d) {
  float x = 1 - std::min(d, 8.f) * 0.125f;
  x *= x, x *= x;
  return x * x;
}

struct Range {
  int begin, end;
  int size() const { return std::max(0, end - begin); }
  Range grown(int by) const { return {begin - by, end + by}; }
  /// Of places that stay within [0, size) when moved.
  Range moving(int by, int size) const { return {std::max({begin, 0, -by}), std::min({end, size, size - by})}; }
};

struct Noisy {
  int width = 0, height = 0;
  std::array<Plane<float>, 4> color;  // premultiplied RGBA
  std::array<Plane<float>, 3> variance;
  const Features& features;
  std::array<Plane<float>, Features::channels> feature_scale;  // what squares of differences are multiplied by

  Noisy(const Features& f, const Plane<float>& luminance_variance, const Frame& frame) : width(f.width), height(f.height), features(f) {
    const size_t n = frame.pixels();
    for (auto& p : color) p.resize(n);
    for (auto& p : variance) p.resize(n);
    for (auto& p : feature_scale) p.resize(n);
    parallel_for(n, size_t(width), [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const float* rgba = &frame.rgba[4 * i];
        const float y = 0.2126f * rgba[0] + 0.7152f * rgba[1] + 0.0722f * rgba[2];
        const float v = around(luminance_variance, i);
        for (size_t c = 0; c < 4; ++c) color[c][i] = rgba[c];
        // The noise of light is grey before it meets colours.
        for (size_t c = 0; c < 3; ++c) {
          const float share = y > 0 ? std::clamp(rgba[c] / y, 0.25f, 4.f) : 1;
          variance[c][i] = v * share * share;
        }
        for (size_t c = 0; c < Features::channels; ++c) {
          const float least = c >= Features::normal && c < Features::cover ? least_shape_variance : least_color_variance;
          const float v = std::max({least, features.variance[c][i], slope_squared(features.mean[c], i)});
          feature_scale[c][i] = 1 / (feature_bandwidth * feature_bandwidth * v);
        }
      }
    });
  }

  bool any_noise(Range xs, Range ys) const {
    for (int y = ys.begin; y < ys.end; ++y)
      for (int x = xs.begin; x < xs.end; ++x)
        if (variance[0][size_t(y) * size_t(width) + size_t(x)] > 0) return true;
    return false;
  }

  // The own variance, or that of neighbours which look alike where it is small by chance.
  float around(const Plane<float>& v, size_t i) const {
    if (!(v[i] > 0) && !(features.mean[Features::cover][i] > 0)) return 0;  // nothing is there
    const int x = int(i % size_t(width)), y = int(i / size_t(width));
    float sum = 0, count = 0;
    for (int b = std::max(0, y - 1); b <= std::min(height - 1, y + 1); ++b)
      for (int a = std::max(0, x - 1); a <= std::min(width - 1, x + 1); ++a) {
        const size_t k = size_t(b) * size_t(width) + size_t(a);
        if (alike(i, k)) sum += v[k], count += 1;
      }
    return std::max(v[i], sum / count);
  }
  bool alike(size_t i, size_t k) const {
    for (size_t c = 0; c < Features::channels; ++c) {
      const float d = features.mean[c][i] - features.mean[c][k];
      if (d * d > 0.01f + 4 * (features.variance[c][i] + features.variance[c][k])) return false;
    }
    return true;
  }
  // Of the smoother side along each axis: an edge is no slope.
  float slope_squared(const Plane<float>& f, size_t i) const {
    const int x = int(i % size_t(width)), y = int(i / size_t(width));
    const auto smoother = [&](bool before, bool after, ptrdiff_t step) {
      const float a = before ? f[size_t(ptrdiff_t(i) - step)] - f[i] : HUGE_VALF,
                  b = after ? f[size_t(ptrdiff_t(i) + step)] - f[i] : HUGE_VALF;
      const float d = std::min(a * a, b * b);
      return std::isfinite(d) ? d : 0;
    };
    return std::max(smoother(x > 0, x + 1 < width, 1), smoother(y > 0, y + 1 < height, width));
  }
};

class Block {
 public:
  Block(const Noisy& noisy, Range x, Range y) : noisy_(noisy), x_(x), y_(y) {
    for (auto& s : sums_) s.assign(size_t(x.size()) * size_t(y.size()), 0);
    distance_.resize(side * side), across_.resize(side * side);
  }

  void take_neighbours() {
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dx = -reach; dx <= reach; ++dx) take(dx, dy);
  }

  void put(Frame& frame) const {
    for (int y = y_.begin; y < y_.end; ++y)
      for (int x = x_.begin; x < x_.end; ++x) {
        const size_t i = size_t(y) * size_t(noisy_.width) + size_t(x), at = sum_at(x, y);
        if (!(noisy_.variance[0][i] > 0)) continue;
        for (size_t c = 0; c < 4; ++c) frame.rgba[4 * i + c] = sums_[c][at] / sums_[4][at];
      }
  }

 private:
  static constexpr size_t side = block + 2 * patch;

  size_t sum_at(int x, int y) const { return size_t(y - y_.begin) * size_t(x_.size()) + size_t(x - x_.begin); }
  size_t at(int x, int y) const { return size_t(y - y_.begin + patch) * side + size_t(x - x_.begin + patch); }

  // The neighbours at one place beside all pixels of the block.
  void take(int dx, int dy) {
    const Range xs = x_.grown(patch).moving(dx, noisy_.width), ys = y_.grown(patch).moving(dy, noisy_.height);
    if (xs.size() == 0 || ys.size() == 0) return;
    const ptrdiff_t to_q = ptrdiff_t(dy) * noisy_.width + dx;
    std::fill(distance_.begin(), distance_.end(), 0.f);
    for (int y = ys.begin; y < ys.end; ++y)
      color_distances(&distance_[at(xs.begin, y)], size_t(y) * size_t(noisy_.width) + size_t(xs.begin), to_q, xs.size());
    const Range x = x_.moving(dx, noisy_.width), y_in = y_.moving(dy, noisy_.height);
    for (int y = ys.begin; y < ys.end; ++y) {
      const float* row = &distance_[at(x.begin, y)];
      float* sum = &across_[at(x.begin, y)];
      for (int i = 0; i < x.size(); ++i) {
        float s = 0;
        for (int k = -patch; k <= patch; ++k) s += row[i + k];
        sum[i] = s;
      }
    }
    std::array<float, block> mean, weight;
    for (int y = y_in.begin; y < y_in.end; ++y) {
      const Range rows{std::max(y - patch, ys.begin), std::min(y + patch + 1, ys.end)};
      mean.fill(0);
      for (int k = rows.begin; k < rows.end; ++k) {
        const float* row = &across_[at(x.begin, k)];
        for (int i = 0; i < x.size(); ++i) mean[size_t(i)] += row[i];
      }
      for (int i = 0; i < x.size(); ++i) {
        const int columns = std::min(x.begin + i + patch + 1, xs.end) - std::max(x.begin + i - patch, xs.begin);
        mean[size_t(i)] *= 1 / float(columns * rows.size());
      }
      const size_t p = size_t(y) * size_t(noisy_.width) + size_t(x.begin);
      weights(mean.data(), weight.data(), p, to_q, x.size());
      const size_t s = sum_at(x.begin, y);
      for (size_t c = 0; c < 4; ++c) {
        const float* q = &noisy_.color[c][size_t(ptrdiff_t(p) + to_q)];
        float* sum = &sums_[c][s];
        for (int i = 0; i < x.size(); ++i) sum[i] += weight[size_t(i)] * q[i];
      }
      for (int i = 0; i < x.size(); ++i) sums_[4][s + size_t(i)] += weight[size_t(i)];
    }
  }

  void color_distances(float* out, size_t p, ptrdiff_t to_q, int n) const {
    for (size_t c = 0; c < 3; ++c) {
      const float *up = &noisy_.color[c][p], *uq = up + to_q, *vp = &noisy_.variance[c][p], *vq = vp + to_q;
      for (int i = 0; i < n; ++i) {
        const float d = up[i] - uq[i];
        out[i] += (d * d - vp[i] - std::min(vp[i], vq[i])) / (3 * (tiny + color_bandwidth * color_bandwidth * (vp[i] + vq[i])));
      }
    }
  }

  void weights(const float* distance, float* weight, size_t p, ptrdiff_t to_q, int n) const {
    for (int i = 0; i < n; ++i) weight[i] = std::max(distance[i], 0.f);
    for (size_t c = 0; c < Features::channels; ++c) {
      const float *fp = &noisy_.features.mean[c][p], *fq = fp + to_q, *vp = &noisy_.features.variance[c][p], *vq = vp + to_q;
      const float* scale = &noisy_.feature_scale[c][p];
      for (int i = 0; i < n; ++i) {
        const float d = fp[i] - fq[i];
        weight[i] = std::max(weight[i], (d * d - vp[i] - std::min(vp[i], vq[i])) * scale[i]);
      }
    }
    for (int i = 0; i < n; ++i) weight[i] = falling(weight[i]);
  }

  const Noisy& noisy_;
  Range x_, y_;
  std::array<std::vector<float>, 5> sums_;  // colours by weights, weights
  std::vector<float> distance_, across_;    // of the block and a border
};

}  // namespace

void denoise(const Features& features, const Plane<float>& variance, Frame& frame, Context& context) {
  constexpr double planes = 4 + 3 + Features::channels;
  need_memory(double(frame.pixels()) * planes * sizeof(float), fmt::format("{}x{} pixels to denoise", frame.width, frame.height), "denoise",
              "make a smaller picture: --size");
  const Noisy noisy(features, variance, frame);
  const auto across = size_t(frame.width + block - 1) / block, down = size_t(frame.height + block - 1) / block;
  SharedProgress progress(context, across * down, "denoising");
  parallel_for(
      across * down, 1,
      [&](size_t i, size_t) {
        const int x = int(i % across) * block, y = int(i / across) * block;
        const Range xs{x, std::min(x + block, frame.width)}, ys{y, std::min(y + block, frame.height)};
        if (noisy.any_noise(xs, ys)) {
          Block part(noisy, xs, ys);
          part.take_neighbours();
          part.put(frame);
        }
        progress.step();
      },
      &context);
}

}  // namespace sg::trace

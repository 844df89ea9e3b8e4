// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/convolution.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/parallel.h"

namespace sg::texture {

namespace {

constexpr float nothing = std::numeric_limits<float>::quiet_NaN();

struct Tile {
  int32_t lo[3], hi[3], n[3];
  size_t size() const { return size_t(n[0]) * size_t(n[1]) * size_t(n[2]); }
};

struct Tiles {
  const DirectionGrid& grid;
  int32_t edge[3], count[3];
  Tiles(const DirectionGrid& g, int32_t x, int32_t y, int32_t z) : grid(g), edge{x, y, z} {
    for (int a = 0; a < 3; ++a) count[a] = (g.n[a] + edge[a] - 1) / edge[a];
  }
  size_t size() const { return size_t(count[0]) * size_t(count[1]) * size_t(count[2]); }
  Tile at(size_t i) const {
    Tile t;
    const size_t at[3] = {i % size_t(count[0]), i / size_t(count[0]) % size_t(count[1]), i / (size_t(count[0]) * size_t(count[1]))};
    for (int a = 0; a < 3; ++a) {
      t.lo[a] = int32_t(at[a]) * edge[a];
      t.hi[a] = std::min(t.lo[a] + edge[a], grid.n[a]);
      t.n[a] = t.hi[a] - t.lo[a];
    }
    return t;
  }
  size_t pixel(int32_t x, int32_t y, int32_t z) const {
    return size_t(x) + size_t(grid.n[0]) * (size_t(y) + size_t(grid.n[1]) * size_t(z));
  }
};

// Values of up to 16 pixels by lines of their own.
class OwnLines {
 public:
  OwnLines(const DirectionGrid& g, const Weights& w, float step) : grid_(g), weights_(w), batch_(w.steps, false) { batch_.step = step; }

  void add(size_t pixel, int32_t x, int32_t y, int32_t z, float* out) {
    const float p[3] = {float(x), float(y), float(z)};
    for (int a = 0; a < 3; ++a) batch_.start[a][count_] = p[a];
    pixel_[count_++] = pixel;
    if (count_ == lanes) flush(out);
  }
  void flush(float* out) {
    if (count_ == 0) return;
    for (int lane = count_; lane < lanes; ++lane)
      for (int a = 0; a < 3; ++a) batch_.start[a][lane] = batch_.start[a][0];
    trace_lines(grid_, batch_);
    float sum[lanes];
    convolve_lines(batch_, weights_, weights_.steps, weights_.steps, sum);
    for (int lane = 0; lane < count_; ++lane) {
      const float total = weights_.total(batch_.back[lane], batch_.forth[lane]);
      out[pixel_[lane]] = total > 0 ? sum[lane] / total : grid_.noise[pixel_[lane]];
    }
    count_ = 0;
  }

 private:
  const DirectionGrid& grid_;
  const Weights& weights_;
  LineBatch batch_;
  size_t pixel_[lanes] = {};
  int count_ = 0;
};

// What lines give to the pixels of one tile.
class SharedLines {
 public:
  SharedLines(const Tiles& tiles, const Weights& w, float step, int reach)
      : tiles_(tiles), weights_(w), reach_(reach), batch_(reach + w.steps, true), sums_(size_t(2 * reach + 1) * lanes) {
    batch_.step = step, batch_.tail = w.steps + 1;
  }

  void run(size_t index, float* out) {
    const Tile t = tiles_.at(index);
    for (int a = 0; a < 3; ++a) batch_.box_lo[a] = t.lo[a], batch_.box_hi[a] = t.hi[a];
    sum_.assign(t.size(), 0.0f), weight_.assign(t.size(), 0.0f);
    // One pixel of each block of 8 x 8 after the other, blocks in an order in which consecutive ones lie far apart and not on a common
    // line, so that the lines of a batch meet different pixels.
    const int32_t edge = 8, deep = t.n[2] > 1 ? edge : 1;
    const int32_t blocks[3] = {(t.n[0] + edge - 1) / edge, (t.n[1] + edge - 1) / edge, (t.n[2] + deep - 1) / deep};
    const int32_t all = blocks[0] * blocks[1] * blocks[2];
    int32_t jump = std::max(1, int32_t(0.387 * all));
    while (std::gcd(jump, all) != 1) ++jump;
    static constexpr uint8_t order[edge] = {0, 4, 2, 6, 1, 5, 3, 7};
    int seeds = 0;
    for (int32_t i = 0; i < edge * edge * deep; ++i) {
      const int32_t ox = order[i % edge], oy = order[(i / edge + i) % edge], oz = deep > 1 ? order[(i / (edge * edge) + i) % edge] : 0;
      for (int32_t b = 0, block = 0; b < all; ++b, block = (block + jump) % all) {
        const int32_t x = t.lo[0] + block % blocks[0] * edge + ox, y = t.lo[1] + block / blocks[0] % blocks[1] * edge + oy,
                      z = t.lo[2] + block / (blocks[0] * blocks[1]) * deep + oz;
        if (x >= t.hi[0] || y >= t.hi[1] || z >= t.hi[2]) continue;
        if (weight_[local(t, x, y, z)] > 0 || tiles_.grid.codes[tiles_.pixel(x, y, z)] == 0) continue;
        batch_.start[0][seeds] = float(x), batch_.start[1][seeds] = float(y), batch_.start[2][seeds] = float(z);
        if (++seeds == lanes) deposit(seeds), seeds = 0;
      }
    }
    if (seeds > 0) deposit(seeds);
    for (int32_t z = t.lo[2]; z < t.hi[2]; ++z)
      for (int32_t y = t.lo[1]; y < t.hi[1]; ++y)
        for (int32_t x = t.lo[0]; x < t.hi[0]; ++x) {
          const size_t here = local(t, x, y, z), to = tiles_.pixel(x, y, z);
          if (tiles_.grid.codes[to] == 0) out[to] = nothing;
          else out[to] = weight_[here] > 0 ? sum_[here] / weight_[here] : tiles_.grid.noise[to];
        }
  }

 private:
  static size_t local(const Tile& t, int32_t x, int32_t y, int32_t z) {
    return size_t(x - t.lo[0]) + size_t(t.n[0]) * (size_t(y - t.lo[1]) + size_t(t.n[1]) * size_t(z - t.lo[2]));
  }

  void deposit(int count) {
    for (int lane = count; lane < lanes; ++lane)
      for (int a = 0; a < 3; ++a) batch_.start[a][lane] = batch_.start[a][0];
    trace_lines(tiles_.grid, batch_);
    const int middle = batch_.steps;
    const auto longest = [&](const int32_t* made) { return std::min(reach_, *std::max_element(made, made + count)); };
    const int first = middle - longest(batch_.back), last = middle + longest(batch_.forth);
    convolve_lines(batch_, weights_, first, last, sums_.data());
    for (int m = first; m <= last; ++m)
      for (int lane = 0; lane < count; ++lane) {
        const size_t at = size_t(m) * lanes + size_t(lane);
        const int32_t to = batch_.pixels[at];
        if (to < 0) continue;
        const int k = m - middle;
        sum_[size_t(to)] += sums_[at - size_t(first) * lanes];
        weight_[size_t(to)] +=
            weights_.total(std::min(weights_.steps, batch_.back[lane] + k), std::min(weights_.steps, batch_.forth[lane] - k));
      }
  }

  const Tiles& tiles_;
  const Weights& weights_;
  int reach_;
  LineBatch batch_;
  std::vector<float> sums_, sum_, weight_;
};

}  // namespace

Weights kernel_weights(LineWeights kernel, int steps, double phase, int ripples) {
  Weights r;
  r.steps = steps, r.box = kernel == LineWeights::box;
  const double turn = 2 * std::numbers::pi;
  double sum = 0;
  r.sum.push_back(0);
  for (int k = -steps; k <= steps; ++k) {
    double w = 1;
    if (!r.box) w = 0.5 + 0.5 * std::cos(turn * k / (2 * steps + 2));
    if (kernel == LineWeights::ripple)
      w *= 0.5 + 0.5 * std::cos(turn * (double(ripples) * k / (2 * steps + 1) + (phase - std::floor(phase))));
    r.w.push_back(float(w));
    r.sum.push_back(float(sum += double(float(w))));
  }
  return r;
}

void convolve_plain(const DirectionGrid& grid, const Weights& weights, float step, float* out, const Context& context) {
  const Tiles tiles(grid, 128, 32, grid.dimension == 3 ? 8 : 1);
  parallel_for(
      tiles.size(), 1,
      [&](size_t begin, size_t end) {
        OwnLines lines(grid, weights, step);
        for (size_t i = begin; i < end; ++i) {
          const Tile t = tiles.at(i);
          for (int32_t z = t.lo[2]; z < t.hi[2]; ++z)
            for (int32_t y = t.lo[1]; y < t.hi[1]; ++y)
              for (int32_t x = t.lo[0]; x < t.hi[0]; ++x) {
                const size_t pixel = tiles.pixel(x, y, z);
                if (grid.codes[pixel] == 0) out[pixel] = nothing;
                else lines.add(pixel, x, y, z, out);
              }
          lines.flush(out);
        }
      },
      &context);
}

void convolve_fast(const DirectionGrid& grid, const Weights& weights, float step, float* out, const Context& context) {
  const int32_t edge = grid.dimension == 3 ? 32 : 128;
  const Tiles tiles(grid, edge, edge, grid.dimension == 3 ? edge : 1);
  const int reach = int(std::ceil(double(edge) / 2 / double(step)));
  parallel_for(
      tiles.size(), 1,
      [&](size_t begin, size_t end) {
        SharedLines lines(tiles, weights, step, reach);
        for (size_t i = begin; i < end; ++i) lines.run(i, out);
      },
      &context);
}

}  // namespace sg::texture

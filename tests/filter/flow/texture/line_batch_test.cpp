// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/texture/line_batch.h"

#include <hwy/highway.h>
#include <hwy/targets.h>

#include "base/random.h"
#include "filter/flow/texture/back_trace.h"
#include "filter/flow/texture/convolution.h"
#include "filter/flow/texture/noise.h"
#include "texture_support.h"

using namespace sg;
using namespace sg::texture;

namespace {

struct Swirl {
  int32_t n[3];
  std::vector<uint32_t> codes;
  Plane<float> noise;
  DirectionGrid grid;
  Swirl(int dimension, int32_t x, int32_t y, int32_t z) : n{x, y, z}, noise(white_noise(n, 3)) {
    for (int32_t k = 0; k < z; ++k)
      for (int32_t j = 0; j < y; ++j)
        for (int32_t i = 0; i < x; ++i) {
          float v[3] = {float(std::sin(j / 9.0)), float(std::cos(i / 7.0 + k / 5.0)), float(std::sin(i / 11.0))};
          if (i > 20 && i < 24 && j > 10) v[0] = v[1] = v[2] = 0;
          codes.push_back(encode_direction(dimension, v));
        }
    grid.dimension = dimension;
    std::copy_n(n, 3, grid.n);
    grid.codes = codes.data(), grid.noise = noise.data();
  }
};

LineBatch batch_of(const Swirl& s, int steps, bool box) {
  LineBatch b(steps, true);
  b.step = 0.9f;
  for (int lane = 0; lane < lanes; ++lane)
    for (int a = 0; a < s.grid.dimension; ++a) b.start[a][lane] = float(random_unit(7, uint64_t(3 * lane + a)) * (s.n[a] - 1));
  if (box) {
    b.tail = 5;
    for (int a = 0; a < 3; ++a) b.box_lo[a] = s.n[a] / 4, b.box_hi[a] = s.n[a] / 4 + s.n[a] / 2 + 1;
  }
  return b;
}

template <class F>
void on_all_targets(F&& f) {
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    CAPTURE(target);
    f();
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace

TEST_CASE("lines of a batch: every kind of processor walks as the reference does, to the bit") {
  for (const int dimension : {2, 3}) {
    const Swirl s(dimension, 61, 47, dimension == 3 ? 30 : 1);
    for (const bool box : {false, true}) {
      LineBatch reference = batch_of(s, 40, box);
      trace_lines_scalar(s.grid, reference);
      for (const char* kernel : {"box", "ripple"}) {
        const Weights w = kernel_weights(*value_of_word<LineWeights>(kernel), 12, 0.2, 2);
        std::vector<float> sums(lanes * 81);
        convolve_lines_scalar(reference, w, 0, 80, sums.data());
        on_all_targets([&] {
          LineBatch b = batch_of(s, 40, box);
          trace_lines(s.grid, b);
          CHECK(test::same_bytes(b.noise, reference.noise));
          CHECK(b.pixels == reference.pixels);
          CHECK(std::equal(b.forth, b.forth + lanes, reference.forth));
          CHECK(std::equal(b.back, b.back + lanes, reference.back));
          std::vector<float> mine(sums.size());
          convolve_lines(b, w, 0, 80, mine.data());
          CHECK(test::same_bytes(mine, sums));
        });
      }
    }
  }
}

TEST_CASE("lines of a batch: a rotation is walked in circles, a step of one pixel at a time") {
  const int32_t n[3] = {201, 201, 1};
  std::vector<uint32_t> codes;
  for (int j = 0; j < 201; ++j)
    for (int i = 0; i < 201; ++i) {
      const float v[2] = {float(100 - j), float(i - 100)};
      codes.push_back(encode_direction(2, v));
    }
  const Plane<float> noise = white_noise(n, 1);
  DirectionGrid g;
  std::copy_n(n, 3, g.n);
  g.codes = codes.data(), g.noise = noise.data();
  LineBatch b(250, true);
  for (int lane = 0; lane < lanes; ++lane) b.start[0][lane] = float(106 + 5 * lane), b.start[1][lane] = 100;
  trace_lines(g, b);
  for (int lane = 0; lane < lanes; ++lane) {
    const double r = 6 + 5 * lane;
    CHECK(b.forth[lane] == 250);
    CHECK(b.back[lane] == 250);
    for (int k = 1; k <= 250; ++k)
      for (const int way : {-1, 1}) {
        const int32_t pixel = b.pixels[size_t(250 + way * k) * lanes + size_t(lane)];
        const double x = pixel % 201 - 100, y = pixel / 201 - 100;
        CHECK(std::abs(std::hypot(x, y) - r) < 0.75 + 0.02);  // half a pixel's diagonal, and a little
        // Steps of one pixel along the arc: the method's phase error is 5/12 (h/r)^2 of the way, and interpolated unit vectors are shorter
        // by up to 1/(4 r^2).
        const double angle = std::atan2(y, x), wanted = way * k / r;
        CHECK(std::abs(std::remainder(angle - wanted, 2 * M_PI)) * r < 0.75 + k * ((5.0 / 12 + 0.25) / (r * r)));
      }
  }
}

TEST_CASE("directions: codes keep the angle and nothing else") {
  const float v[3] = {3e-20f, -4e-20f, 0}, w[3] = {NAN, 1, 1}, zero[3] = {0, 0, 0};
  const uint32_t c = encode_direction(2, v);
  CHECK(int16_t(c & 0xffff) == 19660);
  CHECK(int16_t(c >> 16) == -26214);
  CHECK(encode_direction(2, w) == 0);
  CHECK(encode_direction(3, w) == 0);
  CHECK(encode_direction(3, zero) == 0);
}

TEST_CASE("noise: even in [0, 1), the density asked for, and coarse grains keep the mean") {
  const int32_t n[3] = {256, 200, 1};
  for (const double grain : {1.0, 2.5}) {
    double mean = 0, square = 0;
    const Plane<float> v = grained_noise(n, 5, grain, false, 0);
    for (const float x : v) mean += double(x), square += double(x) * double(x);
    mean /= double(v.size()), square /= double(v.size());
    CHECK(mean == doctest::Approx(0.5).epsilon(0.02));
    if (grain == 1) CHECK(square - mean * mean == doctest::Approx(1.0 / 12).epsilon(0.02));
  }
  double ones = 0;
  for (const float x : sparse_noise(n, 5, 0.03)) ones += double(x);
  CHECK(ones / (256 * 200) == doctest::Approx(0.03).epsilon(0.08));
}

TEST_CASE("paths back: every kind of processor walks as the reference does, to the bit, around holes and over borders") {
  const DatasetPtr d = test::flow_2d(70, 50, [](double x, double y, float* u) {
    u[0] = float(std::sin(y / 6) + 0.2), u[1] = float(std::cos(x / 9));
    if (std::hypot(x - 40, y - 25) < 6) u[0] = NAN;
    if (x < 9 && y < 9) u[0] = u[1] = 0;
  });
  Context c;
  const Frame f = make_frame(d, "", 70, "test", c);
  const PixelFlow flow(f, c);
  BackTrace how;
  how.h = -0.7, how.steps = 40, how.dye = {{20, 30, 0}, {60, 10, 0}}, how.pitch[1] = 2;
  auto paths = [] {
    std::vector<BackPath> p(70 * 50 - 3);
    for (size_t i = 0; i < p.size(); ++i) p[i].x[0] = double(i % 70), p[i].x[1] = double(i / 70);
    return p;
  };
  std::vector<BackPath> reference = paths();
  trace_back_scalar(flow, how, reference.data(), reference.size());
  on_all_targets([&] {
    std::vector<BackPath> mine = paths();
    trace_back(flow, how, mine.data(), mine.size());
    size_t different = 0, left = 0;
    for (size_t i = 0; i < mine.size(); ++i) {
      different += mine[i].x[0] != reference[i].x[0] || mine[i].x[1] != reference[i].x[1] || mine[i].nearest != reference[i].nearest ||
                   mine[i].left != reference[i].left;
      left += mine[i].left;
    }
    CHECK(different == 0);
    CHECK(left > 100);
  });
}

// SPDX-License-Identifier: Apache-2.0
#include "render/trace/sampling/sampler.h"

#include <algorithm>
#include <complex>
#include <numbers>
#include <vector>

#include "support/statistics.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;

namespace {

// A smooth function of two numbers with mean (e - 1)^2.
double smooth(Vec2f u) { return std::exp(double(u.x)) * std::exp(double(u.y)); }
const double smooth_mean = (std::numbers::e - 1) * (std::numbers::e - 1);

double estimate(Sampler& s, uint32_t x, uint32_t y, uint32_t n, uint32_t dimension = 0) {
  double sum = 0;
  for (uint32_t i = 0; i < n; ++i) s.start(x, y, i, dimension), sum += smooth(s.next2());
  return sum / n;
}

// Power of the error of pixels at frequencies below 1/8 of a pixel, as a share of what white noise of the same variance has there.
double low_frequencies(SamplerKind kind, uint32_t samples) {
  const int n = 64;
  Sampler s(kind, 1, int(samples));
  std::vector<double> error(n * n);
  test::Moments all;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) all.add(error[size_t(y * n + x)] = estimate(s, uint32_t(x), uint32_t(y), samples, 4));
  double power = 0;
  int count = 0;
  for (int v = -7; v <= 7; ++v)
    for (int u = 0; u <= 7; ++u) {
      if (u * u + v * v >= 64 || (u == 0 && v <= 0)) continue;
      std::complex<double> sum = 0;
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x)
          sum += (error[size_t(y * n + x)] - all.mean) * std::polar(1.0, -2 * std::numbers::pi * (u * x + v * y) / n);
      power += std::norm(sum), ++count;
    }
  return power / count / (all.variance() * n * n);
}

}  // namespace

TEST_CASE("sampler: a value depends on its own pixel, sample and dimension, whatever was asked for before") {
  for (const auto& kind : enum_words(SamplerKind{})) {
    CAPTURE(kind.word);
    Sampler forward(kind.value, 7, 16), backward(kind.value, 7, 16);
    std::vector<float> one, other;
    for (uint32_t x = 0; x < 3; ++x)
      for (uint32_t i = 0; i < 40; ++i) {
        forward.start(x, 2, i);
        for (int d = 0; d < 3; ++d) {
          const Vec2f u = forward.next2();
          one.insert(one.end(), {u.x, u.y, forward.next()});
        }
      }
    other.resize(one.size());
    for (uint32_t x = 3; x-- > 0;)
      for (uint32_t i = 40; i-- > 0;)
        for (uint32_t d = 3; d-- > 0;) {
          backward.start(x, 2, i, 3 * d);
          CHECK(backward.dimension() == 3 * d);
          float* const to = &other[(x * 40 + i) * 9 + 3 * d];
          const Vec2f u = backward.next2();
          to[0] = u.x, to[1] = u.y, to[2] = backward.next();
        }
    CHECK(one == other);
    for (const float v : one) CHECK((v >= 0 && v < 1));
    std::sort(one.begin(), one.end());
    CHECK(std::unique(one.begin(), one.end()) - one.begin() > int(one.size()) - 4);  // no dimension or pixel repeats another
    Sampler seeded(kind.value, 8, 16);
    seeded.start(0, 2, 0);
    CHECK(seeded.next2().x != other[0]);
  }
}

TEST_CASE("sampler: each value alone is uniform over pixels, and pairs over the square (chi-square, 64 boxes)") {
  for (const auto& kind : enum_words(SamplerKind{})) {
    CAPTURE(kind.word);
    for (const int count : {1, 5, 16}) {
      Sampler s(kind.value, 3, count);
      for (const uint32_t i : {0u, uint32_t(count - 1)}) {
        std::vector<double> alone(64), pairs(64), mixed(64);
        const uint32_t side = 80;
        // Pixels far from each other: along the curve of blue noise those beside each other are not independent.
        for (uint32_t y = 0; y < side; ++y)
          for (uint32_t x = 0; x < side; ++x) {
            Sampler own(kind.value, 1000 * y + x, count);
            own.start(x, y, i, 6);
            const Vec2f u = own.next2(), v = own.next2();
            const float w = own.next();
            ++pairs[size_t(int(u.x * 8) + 8 * int(u.y * 8))], ++alone[size_t(w * 64)], ++mixed[size_t(int(v.y * 8) + 8 * int(u.x * 8))];
          }
        const std::vector<double> expected(64, side * side / 64.);
        CHECK(test::chi_square_chance(alone, expected) > 1e-4);
        CHECK(test::chi_square_chance(pairs, expected) > 1e-4);
        CHECK(test::chi_square_chance(mixed, expected) > 1e-4);
      }
    }
  }
}

TEST_CASE("sampler: the estimates are unbiased (4 standard errors), and the variance of a smooth function falls as it should") {
  struct Law {
    SamplerKind kind;
    double steepest, flattest;  // log-log slope of the variance against the number of samples
  };
  // 1/N; strata of both axes and the cells of a grid: 1/N^2; nets with scrambled digits: up to 1/N^3.
  for (const Law& law :
       {Law{SamplerKind::independent, -1.1, -.9}, Law{SamplerKind::stratified, -2.3, -1.7}, Law{SamplerKind::halton, -3.3, -1.6},
        Law{SamplerKind::hammersley, -3.3, -1.7}, Law{SamplerKind::sobol, -3.3, -2.3}, Law{SamplerKind::blue_noise, -3.3, -2.3}}) {
    CAPTURE(word_of(law.kind));
    std::vector<double> counts, variances;
    for (const uint32_t n : {16u, 64u, 256u, 1024u}) {
      test::Moments m;
      for (uint32_t pixel = 0; pixel < 400; ++pixel) {
        Sampler s(law.kind, pixel, int(n));
        m.add(estimate(s, pixel, pixel * 31 % 97, n, 4));
      }
      CHECK(std::abs(m.mean - smooth_mean) < 4 * m.standard_error());
      counts.push_back(double(n)), variances.push_back(m.variance());
    }
    const double slope = test::observed_order(counts.data(), variances.data(), 4);
    CAPTURE(slope);
    CHECK(slope > law.steepest);
    CHECK(slope < law.flattest);
  }
}

TEST_CASE("sampler: pairs of dimensions do not go together: products over two or three of them err no more than with random numbers") {
  const uint32_t n = 64, pixels = 2000;
  for (const auto& kind : enum_words(SamplerKind{})) {
    CAPTURE(kind.word);
    test::Moments two, three;
    for (uint32_t pixel = 0; pixel < pixels; ++pixel) {
      Sampler s(kind.value, 7 + pixel, int(n));
      double sum2 = 0, sum3 = 0;
      for (uint32_t i = 0; i < n; ++i) {
        s.start(pixel, 3, i);
        const Vec2f u = s.next2(), v = s.next2();
        const double a = 2 * double(u.x) - 1, b = 2 * double(v.x) - 1, c = 2 * double(s.next()) - 1;
        sum2 += 3 * a * b / n, sum3 += std::sqrt(27) * a * b * c / n;
      }
      two.add(sum2), three.add(sum3);
    }
    // Of independent numbers the mean of n products of unit variance has variance 1 / n; 2000 pixels tell it to 3.2 %; of random
    // orders of 16 it has 16 / 15 of that.
    CAPTURE(two.variance() * n);
    CAPTURE(three.variance() * n);
    CHECK(two.variance() * n < 1.13);
    CHECK(three.variance() * n < 1.13);
    CHECK(std::abs(two.mean) < 4 * two.standard_error());
  }
}

TEST_CASE("sampler: an interrupted pattern of Sobol and Halton is good as well, and samples beyond the count are new") {
  for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::halton}) {
    test::Moments some, same;
    for (uint32_t pixel = 0; pixel < 400; ++pixel) {
      Sampler s(kind, 5, 1024), random(SamplerKind::independent, 5, 1024);
      some.add(estimate(s, pixel, 0, 64)), same.add(estimate(random, pixel, 0, 64));
    }
    CHECK(some.variance() < same.variance() / 20);
  }
  for (const auto& kind : enum_words(SamplerKind{})) {
    Sampler s(kind.value, 5, 8);
    s.start(0, 0, 0);
    const Vec2f first = s.next2();
    s.start(0, 0, 8);
    CHECK(s.next2().x != first.x);
  }
}

TEST_CASE("sampler: errors of neighbouring pixels cancel with blue noise: less than half of the power of white noise at low frequencies") {
  for (const uint32_t n : {1u, 2u, 4u, 16u}) {
    CAPTURE(n);
    const double independent = low_frequencies(SamplerKind::independent, n), blue = low_frequencies(SamplerKind::blue_noise, n);
    CAPTURE(independent);
    CAPTURE(blue);
    CHECK(independent > .7);
    CHECK(independent < 1.3);
    CHECK(blue < .5);
  }
}

TEST_CASE("sampler: a count that is none is refused") {
  CHECK(test::contains(test::error_of([] { Sampler(SamplerKind::sobol, 0, 0); }), "samples per pixel"));
  CHECK(test::contains(test::error_of([] { Sampler(SamplerKind::sobol, 0, 1 << 25); }), "16777216"));
}

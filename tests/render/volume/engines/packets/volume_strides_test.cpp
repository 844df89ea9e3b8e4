// SPDX-License-Identifier: Apache-2.0
// What strides rest on: bounds on how a lattice's field bends, and the extinction summed up over the value.
#include "render/volume/sources/lattice/bends.h"

#include "render/volume/engines/packets/passages.h"
#include "render/volume/medium/medium_sums.h"
#include "render/volume/sources/lattice/kernels.h"
#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;

TEST_CASE("strides: no field leaves its chord by more than its bend allows") {
  for (const bool noise : {false, true}) {
    const std::array<size_t, 3> n{21, 17, 26};
    std::vector<float> f;
    for (size_t i = 0; i < n[0] * n[1] * n[2]; ++i) {
      const double x = double(i % n[0]), y = double(i / n[0] % n[1]), z = double(i / n[0] / n[1]);
      f.push_back(noise ? float(random_unit(3, i)) : float(std::sin(0.4 * x + 0.1 * y) * std::cos(0.3 * z) + 0.02 * y * z));
    }
    const auto [lo, hi] = std::minmax_element(f.begin(), f.end());
    const volume::Bends bends = volume::find_bends(Array::from_vector(f), n, *hi - *lo, false);
    const auto at = [&](Vec3 p) {
      double sum = 0;
      size_t c[3];
      double w[3];
      for (int a = 0; a < 3; ++a) c[a] = std::min(size_t(p[a]), n[size_t(a)] - 2), w[a] = p[a] - double(c[a]);
      for (size_t k = 0; k < 8; ++k)
        sum += (k & 1 ? w[0] : 1 - w[0]) * (k & 2 ? w[1] : 1 - w[1]) * (k & 4 ? w[2] : 1 - w[2]) *
               double(f[c[0] + (k & 1) + n[0] * (c[1] + (k >> 1 & 1) + n[1] * (c[2] + (k >> 2)))]);
      return sum;
    };
    double closest = 0;
    for (uint64_t ray = 0; ray < 20000; ++ray) {
      Vec3 from, to;
      for (int a = 0; a < 3; ++a) {
        const double most = double(n[size_t(a)] - 1);
        from[a] = most * random_unit(7, 6 * ray + uint64_t(a));
        const double reach = ray % 2 ? 4.6 : 2.3;
        to[a] = std::clamp(from[a] + reach * (2 * random_unit(7, 6 * ray + 3 + uint64_t(a)) - 1), 0.0, most);
      }
      const double s = length(to - from);
      if (s < 1 || s > 8) continue;
      // What is said of a brick holds around it: from its begin on over a brick's length, from its middle on over one to both sides.
      const Vec3 known = s > 4 ? (from + to) * 0.5 : from;
      size_t brick = 0, step = 1;
      for (size_t a = 0; a < 3; ++a) {
        const size_t bricks = (n[a] - 2) / volume::FineBricks::edge + 1;
        brick += step * std::min(size_t(known[int(a)]) / volume::FineBricks::edge, bricks - 1), step *= bricks;
      }
      const double bend = double(volume::Bends::decoded(bends.codes[brick]) * bends.range);
      double off = 0;
      for (int i = 1; i < 20; ++i) {
        const double t = i / 20.0;
        off = std::max(off, std::abs(at(from + (to - from) * t) - ((1 - t) * at(from) + t * at(to))));
      }
      // A piece shorter than a cell may meet a face of each axis, so one cell more.
      CHECK(off <= bend * (s + 1) * s / 4);
      closest = std::max(closest, off / (bend * (s + 1) * s / 4));
    }
    CHECK(closest > 0.05);  // the bound says something
  }
}

TEST_CASE("strides: sums over the value are the integrals of the medium, across knots too") {
  ColorScale colors = grey(0, 1);
  OpacityCurve curve;
  curve.points = {{0, 0}, {0.2, 0}, {0.3, 0.6}, {0.45, 0.1}, {0.7, 0.95}, {1, 0.3}};
  volume::Medium::Plan plan;
  plan.unit = 0.1, plan.accuracy = 1e-5;
  const volume::Medium medium(colors, curve, plan);
  const volume::MediumSums sums(medium);
  const auto integral = [&](float v) {
    const int i = std::clamp(int((v - sums.lo()) * sums.per_width()), 0, volume::MediumSums::nodes - 1);
    const volume::MediumSums::Node& n = sums.table()[i];
    const double x = double(v) - double(sums.lo()) - double(i) * double(sums.width());
    return double(n.sum) * double(sums.per_sum()) + x * (double(n.tau) + x * double(n.slope) / 2);
  };
  for (int k = 0; k < 200; ++k) {
    const auto a = float(random_unit(11, uint64_t(2 * k))), b = float(random_unit(11, uint64_t(2 * k + 1)));
    double want = 0;
    for (int i = 0; i < 20000; ++i) want += double(medium.tau(a + (b - a) * ((float(i) + 0.5f) / 20000))) / 20000;
    CHECK((integral(b) - integral(a)) / double(b - a) == doctest::Approx(want).epsilon(2e-4));
  }
  // Steepest of a range holds its slopes.
  for (int level = 0; level < 6; ++level)
    for (int node = 0; node < volume::MediumSums::nodes; node += 97) {
      const float most = sums.steepest()[volume::MediumSums::first_of(level) + (node >> level)];
      for (int i = node >> level << level; i < std::min(node + (1 << level), volume::MediumSums::nodes); ++i)
        CHECK(std::abs(sums.table()[i].slope) <= most * 1.0001f);
    }
}

TEST_CASE("strides: bricks that draw nothing are leapt over, the others tell how they bend") {
  const auto bends = std::make_shared<volume::Bends>();
  bends->range = 3;
  bends->codes.assign({0, 15, 16, 200, volume::Bends::unbounded, 40, 40, volume::Bends::unbounded});
  volume::Distances drawn;
  drawn.assign({0, 0, 0, 0, 1, 0, 0, 0});  // and three bytes more
  const volume::SpaceAhead up(drawn, {5, 1, 1}, {{false, true, true}, {true, false, false}});
  const std::vector<int> leaping{16, 16, 16, 200, 15}, none{16, 16, 16, 200, 255, 40, 40, 255};
  const volume::Passages with(bends, up), without(bends);
  CHECK(std::vector<int>(with.codes.begin(), with.codes.begin() + 5) == leaping);
  CHECK(std::vector<int>(without.codes.begin(), without.codes.end()) == none);
  bends->codes.pop_back();
  CHECK_THROWS_AS(volume::Passages(bends, up), Error);
}

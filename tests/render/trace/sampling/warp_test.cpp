// SPDX-License-Identifier: Apache-2.0
#include "render/trace/sampling/warp.h"

#include <vector>

#include "render/trace/sampling/cosine_strata.h"
#include "render/trace/sampling/distribution.h"
#include "render/trace/sampling/sampler.h"
#include "support/statistics.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using doctest::Approx;

namespace {

// Chance of the bins of 40000 samples over nx * ny boxes of equal area of (a, b) in [0, 1)^2; density(a, b) is relative to that area.
double chance(auto to_unit, auto density) {
  const int n = 40'000, nx = 16, ny = 16, fine = 16;
  std::vector<double> observed(nx * ny), expected(nx * ny);
  Sampler s(SamplerKind::independent, 11, 1);
  for (int i = 0; i < n; ++i) {
    s.start(uint32_t(i), 0, 0);
    const Vec2 p = to_unit(s.next2());
    if (!(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1)) return 0;
    ++observed[size_t(std::min(int(p.x * nx), nx - 1) + nx * std::min(int(p.y * ny), ny - 1))];
  }
  double total = 0;
  for (int y = 0; y < ny * fine; ++y)
    for (int x = 0; x < nx * fine; ++x) {
      const double share = density((x + .5) / (nx * fine), (y + .5) / (ny * fine)) / (nx * ny * fine * fine);
      expected[size_t(x / fine + nx * (y / fine))] += n * share;
      total += share;
    }
  if (std::abs(total - 1) > 2e-3) return 0;
  return test::chi_square_chance(observed, expected);
}

// Directions as (angle, height), on which solid angle is uniform: 4 pi over the square.
Vec2 on_map(Vec3f d) {
  if (std::abs(length(d) - 1) > 3e-7f) return {-1, -1};
  return {std::atan2(double(d.y), double(d.x)) / (2 * M_PI) + .5, (double(d.z) + 1) / 2};
}

}  // namespace

TEST_CASE("warp: every map has its density (chi-square)") {
  CHECK(chance([](Vec2f u) { return on_map(cosine_hemisphere(u)); },
               [](double, double h) { return 4 * M_PI * double(cosine_hemisphere_pdf(float(2 * h - 1))); }) > 1e-3);
  CHECK(chance([](Vec2f u) { return on_map(uniform_sphere(u)); }, [](double, double) { return 4 * M_PI * double(uniform_sphere_pdf()); }) >
        1e-3);
  CHECK(chance([](Vec2f u) { return on_map(uniform_hemisphere(u)); },
               [](double, double h) { return h > .5 ? 4 * M_PI * double(uniform_hemisphere_pdf()) : 0; }) > 1e-3);
  for (const float rise : {.25f, 1.5f})
    CHECK(chance([&](Vec2f u) { return on_map(uniform_cone(u, rise)); },
                 [&](double, double h) { return 1 - (2 * h - 1) < double(rise) ? 4 * M_PI * double(uniform_cone_pdf(rise)) : 0; }) > 1e-3);
  CHECK(chance(
            [](Vec2f u) {
              const Vec2f d = concentric_disc(u);
              return Vec2{double(d.x * d.x + d.y * d.y), std::atan2(double(d.y), double(d.x)) / (2 * M_PI) + .5};
            },
            [](double, double) { return M_PI * double(concentric_disc_pdf()); }) > 1e-3);
  // A point of a triangle with barycentric coordinates (a, b, c): (1 - a)^2 and b / (1 - a) are uniform.
  CHECK(chance(
            [](Vec2f u) {
              const Vec3f b = uniform_triangle(u);
              const double rest = 1 - double(b.x);
              return Vec2{rest * rest, double(b.y) / rest};
            },
            [](double, double) { return 1.; }) > 1e-3);
}

TEST_CASE("warp: corners of the square stay inside, narrow cones stay exact") {
  const float last = 0x1.fffffep-1f;
  for (const Vec2f u : {Vec2f{0, 0}, {last, 0}, {0, last}, {last, last}, {.5f, .5f}}) {
    CHECK(length(uniform_sphere(u)) == Approx(1).epsilon(1e-6));
    CHECK(cosine_hemisphere(u).z >= 0);
    const Vec3f b = uniform_triangle(u);
    CHECK((b.x >= 0 && b.y >= 0 && b.z >= 0));
    CHECK(b.x + b.y + b.z == Approx(1).epsilon(1e-6));
    // A cone of a hundred-thousandth: its cosine is 1 in float, its sine is not lost.
    const Vec3f d = uniform_cone(u, 5e-11f);
    CHECK(std::hypot(d.x, d.y) < 1.0001e-5f);
  }
  CHECK(uniform_cone({0, 0}, 5e-11f).x == Approx(-7.07e-6).epsilon(1e-3));
}

TEST_CASE("warp: discs are exact to a few roundings") {
  for (int i = 0; i < 10'000; ++i) {
    const Vec2f u{float(i % 100) / 100 + 0.003f, float(i / 100) / 100 + 0.004f}, d = concentric_disc(u);
    const double x = 2 * double(u.x) - 1, y = 2 * double(u.y) - 1;
    const bool wide = std::abs(x) > std::abs(y);
    const double r = wide ? x : y, angle = wide ? M_PI / 4 * (y / x) : M_PI / 2 - M_PI / 4 * (x / y);
    CHECK(std::hypot(double(d.x) - r * std::cos(angle), double(d.y) - r * std::sin(angle)) < 3e-7);
  }
}

TEST_CASE("warp: strata side by side are the same bytes as one by one") {
  Sampler s(SamplerKind::independent, 5, 1);
  for (int i = 0; i < 1000; ++i) {
    s.start(uint32_t(i), 0, 0);
    const Vec3f normal = uniform_sphere(s.next2()), above = normalize(normal + uniform_sphere(s.next2()) * 0.5f);
    const Vec2f in = i == 0 ? Vec2f{} : s.next2();
    const LocalFrame frame = LocalFrame::about(normal);
    Vec3f directions[cosine_strata_count];
    const uint32_t bits = cosine_strata(in, frame, above, directions);
    for (int k = 0; k < cosine_strata_count; ++k) {
      const Vec2f u{(float(k % 4) + in.x) / 4, (float(k / 4) + in.y) / 4};
      const Vec3f one = normalize(frame.to_world(cosine_hemisphere(u)));
      CHECK(directions[k] == one);
      CHECK(bool(bits >> k & 1) == (dot(one, above) > 0));
    }
  }
}

TEST_CASE("distribution: what is sampled is in proportion, a cell without weight is never met, and rest is uniform") {
  const std::vector<float> weights{0, 3, 0, 1, 4, 0};
  const Distribution1D d(weights);
  CHECK(d.total() == 8);
  CHECK(d.probability(1) == .375f);
  CHECK(d.pdf(.25f) == Approx(3. / 8 * 6));
  std::vector<double> observed(6), expected, rest(16);
  for (const float w : weights) expected.push_back(double(w) / 8 * 20'000);
  Sampler s(SamplerKind::independent, 2, 1);
  for (int i = 0; i < 20'000; ++i) {
    s.start(uint32_t(i), 0, 0);
    const Distribution1D::Sample at = d.sample(s.next());
    ++observed[at.cell], ++rest[size_t(at.rest * 16)];
    CHECK(at.pdf == Approx(double(weights[at.cell]) / 8 * 6));
    CHECK(size_t(at.x * 6) == at.cell);
  }
  CHECK(test::chi_square_chance(observed, expected) > 1e-3);
  CHECK(test::chi_square_chance(rest, std::vector<double>(16, 20'000 / 16.)) > 1e-3);
  CHECK(d.sample(0).cell == 1);
  CHECK(d.sample(0x1.fffffep-1f).cell == 4);
  CHECK(d.sample(0x1.fffffep-1f).x < 1);
}

TEST_CASE("distribution: a picture's cells are met in proportion; none bright is uniform; wrong weights are refused") {
  std::vector<float> weights(6 * 4);
  for (size_t i = 0; i < weights.size(); ++i) weights[i] = float(i % 5 * (i % 3));
  const Distribution2D d(weights, 6);
  std::vector<double> observed(24), expected;
  for (const float w : weights) expected.push_back(double(w) / d.total() * 30'000);
  Sampler s(SamplerKind::independent, 4, 1);
  for (int i = 0; i < 30'000; ++i) {
    s.start(uint32_t(i), 0, 0);
    const Distribution2D::Sample at = d.sample(s.next2());
    ++observed[size_t(at.point.x * 6) + 6 * size_t(at.point.y * 4)];
    CHECK(at.pdf == Approx(double(d.pdf(at.point))));
  }
  CHECK(test::chi_square_chance(observed, expected) > 1e-3);
  const Distribution2D dark(std::vector<float>(8), 4);
  CHECK(dark.total() == 0);
  CHECK(dark.sample({.3f, .7f}).point == Vec2f{.3f, .7f});
  CHECK(dark.pdf({.1f, .2f}) == 1);
  for (const std::vector<float>& wrong : {std::vector<float>{}, {-1, 2}, {NAN}, {INFINITY}})
    CHECK_FALSE(test::error_of([&] { Distribution1D{wrong}; }).empty());
  CHECK(test::contains(test::error_of([] { Distribution2D(std::vector<float>(5), 2); }), "rows"));
}

TEST_CASE("distribution: a million weights lose nothing: the last cell keeps its share") {
  std::vector<float> weights(1 << 20, 1.f);
  const Distribution1D d(weights);
  CHECK(d.total() == 1 << 20);
  CHECK(d.probability((1 << 20) - 1) == Approx(0x1p-20).epsilon(1e-9));
}

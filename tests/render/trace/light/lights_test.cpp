// SPDX-License-Identifier: Apache-2.0
#include "render/trace/light/lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/error.h"
#include "base/random.h"
#include "render/trace/sampling/local_frame.h"
#include "render/trace/sampling/sampler.h"
#include "render/trace/sampling/warp.h"
#include "support/statistics.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using doctest::Approx;

namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();
constexpr double pi_d = 3.14159265358979323846;

/// Mean and standard error of what falls on a surface at `from`, by asking for lights n times.
struct Irradiance {
  double mean, error;
};
Irradiance irradiance(const Lights& lights, Vec3f from, Vec3f normal, int n) {
  double sum = 0, square = 0;
  Sampler sampler(SamplerKind::independent, 4, n);
  for (int i = 0; i < n; ++i) {
    sampler.start(0, 0, uint32_t(i));
    const float choice = sampler.next();
    const auto s = lights.sample(from, choice, sampler.next2());
    const double e = s ? double(s->radiance.x) * std::max(0.f, dot(s->direction, normal)) / double(s->pdf) : 0;
    sum += e, square += e * e;
  }
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, square / n - mean * mean) / n)};
}

/// Lambert's formula: the irradiance of a polygon of radiance 1 that lies above the surface.
double lambert(const std::vector<Vec3>& polygon, Vec3 from, Vec3 normal) {
  double sum = 0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 a = normalize(polygon[i] - from), b = normalize(polygon[(i + 1) % polygon.size()] - from), across = cross(a, b);
    sum += std::atan2(length(across), dot(a, b)) * dot(across / length(across), normal);
  }
  return std::abs(sum) / 2;
}

void check_irradiance(const AnyLight& light, Vec3f from, Vec3f normal, double exact) {
  const Irradiance found = irradiance(Lights({light}, {}, 1), from, normal, 20'000);
  CAPTURE(found.mean);
  CHECK(std::abs(found.mean - exact) <= 4 * found.error + 1e-6 * exact);
  CHECK(found.error < 0.02 * exact);
}

const std::vector<AnyLight> each_kind{PointLight{{0, 0, 2}, {3, 3, 3}},
                                      SpotLight{{0, 0, 2}, {0, 0.6f, -0.8f}, {3, 3, 3}, 0.1f, 0.4f},
                                      DistantLight{{0, 0.6f, 0.8f}, {2, 2, 2}, 0.05f},
                                      SphereLight{{0.3f, 0, 1.5f}, 0.7f, {2, 2, 2}},
                                      DiscLight{{0, 0, 1}, {0, 0, -1}, 0.5f, {4, 4, 4}},
                                      RectangleLight{{-0.5f, -0.25f, 1}, {0, 0.5f, 0}, {1, 0, 0}, {4, 4, 4}},
                                      TriangleLight{{-0.5f, -0.25f, 1}, {0.5f, -0.25f, 1}, {0, 0.5f, 1.2f}, {4, 4, 4}}};

}  // namespace

TEST_CASE("lights: the irradiance of every kind is that of its closed form") {
  const Vec3f up{0, 0, 1}, tilted = normalize(Vec3f{0.3f, -0.2f, 1});
  check_irradiance(PointLight{{0, 0, 2}, {3, 3, 3}}, {0, 0, 0}, up, 3.0 / 4);
  // A spot: its axis as a point; between its angles the square of what the cosine has left; beyond them nothing.
  check_irradiance(SpotLight{{0, 0, 2}, {0, 0, -1}, {3, 3, 3}, 0.1f, 0.4f}, {0, 0, 0}, up, 3.0 / 4);
  check_irradiance(SpotLight{{0, 0, 2}, {0, 0.6f, -0.8f}, {3, 3, 3}, 0.1f, 0.4f}, {0, 0, 0}, up, 3.0 / 4 * 4 / 9);
  CHECK(irradiance(Lights({SpotLight{{0, 0, 2}, {0, 0.6f, -0.8f}, {3, 3, 3}, 0.1f, 0.15f}}, {}, 1), {0, 0, 0}, up, 100).mean == 0);
  // A disc in the sky, seen straight on and tilted: its irradiance times the cosine of its middle.
  check_irradiance(DistantLight{{0, 0, 1}, {2, 2, 2}, 0.1f}, {0, 0, 0}, up, 2);
  check_irradiance(DistantLight{{0, 0.6f, 0.8f}, {2, 2, 2}, 0.1f}, {0, 0, 0}, up, 1.6);
  // A sphere all of which is above: L pi (r / d)^2 cos.
  const Vec3f middle{0.3f, 0, 1.5f};
  const double d2 = double(dot(middle, middle));
  check_irradiance(SphereLight{middle, 0.7f, {2, 2, 2}}, {0, 0, 0}, up, 2 * pi_d * 0.49 / d2 * 1.5 / std::sqrt(d2));
  // From inside of it all around is bright.
  check_irradiance(SphereLight{{0, 0, 0}, 1, {2, 2, 2}}, {0.5f, 0, 0.2f}, up, 2 * pi_d);
  // A disc over the point, parallel to the surface: L pi r^2 / (r^2 + h^2).
  check_irradiance(DiscLight{{0, 0, 1}, {0, 0, -1}, 0.5f, {4, 4, 4}}, {0, 0, 0}, up, 4 * pi_d * 0.25 / 1.25);
  const std::vector<Vec3> square{{-0.5, -0.25, 1}, {-0.5, 0.25, 1}, {0.5, 0.25, 1}, {0.5, -0.25, 1}};
  for (const Vec3f n : {up, tilted})
    check_irradiance(RectangleLight{{-0.5f, -0.25f, 1}, {0, 0.5f, 0}, {1, 0, 0}, {4, 4, 4}}, {0.1f, 0.2f, 0}, n,
                     4 * lambert(square, {0.1f, 0.2f, 0}, Vec3(n)));
  const std::vector<Vec3> triangle{{-0.5, -0.25, 1}, {0.5, -0.25, 1}, {0, 0.5, 1.2}};
  check_irradiance(TriangleLight{{-0.5f, -0.25f, 1}, {0.5f, -0.25f, 1}, {0, 0.5f, 1.2f}, {4, 4, 4}}, {0, 0, 0}, tilted,
                   4 * lambert(triangle, {0, 0, 0}, Vec3(tilted)));
}

TEST_CASE("lights: those with one side are dark from the other") {
  const Lights below({DiscLight{{0, 0, 1}, {0, 0, 1}, 0.5f, {4, 4, 4}}}, {}, 1);
  CHECK(irradiance(below, {0, 0, 0}, {0, 0, 1}, 100).mean == 0);
  CHECK(below.seen({{0, 0, 0}, {0, 0, 1}}, 0, infinite) == Vec3f());
  CHECK(below.seen({{0, 0, 2}, {0, 0, -1}}, 0, infinite) == Vec3f{4, 4, 4});
}

TEST_CASE("lights: what a ray meets by chance is what is asked for, between its ends") {
  for (const AnyLight& light : each_kind) {
    const Lights lights({light}, {}, 1);
    const bool is_met = !std::holds_alternative<PointLight>(light) && !std::holds_alternative<SpotLight>(light) &&
                        !std::holds_alternative<TriangleLight>(light);
    CAPTURE(light.index());
    for (uint64_t i = 0; i < 200; ++i) {
      const Vec2f u{float(random_unit(1, i)) * 0.98f + 0.01f, float(random_unit(2, i)) * 0.98f + 0.01f};
      const auto s = lights.sample({0, 0, 0}, 0.5f, u);
      REQUIRE(s);
      const Vec3f seen = lights.seen({{0, 0, 0}, s->direction}, 0, infinite);
      CHECK(seen == (is_met ? s->radiance : Vec3f()));
      if (!is_met) continue;
      // The two ways share what is seen: with the density of the other a half each.
      CHECK(lights.seen({{0, 0, 0}, s->direction}, 0, s->pdf).x == Approx(s->radiance.x / 2).epsilon(1e-3));
      if (s->distance == infinite) {
        CHECK(lights.seen({{0, 0, 0}, s->direction, 100}, 0, infinite) == Vec3f());
        continue;
      }
      CHECK(lights.seen({{0, 0, 0}, s->direction, s->distance * 0.999f}, 0, infinite) == Vec3f());
      CHECK(lights.seen({{0, 0, 0}, s->direction, s->distance * 1.001f}, s->distance * 0.999f, infinite) == s->radiance);
      CHECK(lights.seen({{0, 0, 0}, s->direction, 100}, s->distance * 1.001f, infinite) == Vec3f());
    }
  }
}

TEST_CASE("lights: several give the sum of each, whatever their brightness") {
  double sum = 0, errors = 0;
  for (const AnyLight& light : each_kind) {
    const Irradiance one = irradiance(Lights({light}, {}, 1), {0, 0, 0}, {0, 0, 1}, 20'000);
    sum += one.mean, errors += one.error;
  }
  const Irradiance sky = irradiance(Lights({}, Environment(Vec3f{0.5f, 0.5f, 0.5f}), 1), {0, 0, 0}, {0, 0, 1}, 20'000);
  CHECK(std::abs(sky.mean - 0.5 * pi_d) <= 4 * sky.error);
  const Irradiance all = irradiance(Lights(each_kind, Environment(Vec3f{0.5f, 0.5f, 0.5f}), 1), {0, 0, 0}, {0, 0, 1}, 200'000);
  CHECK(std::abs(all.mean - sum - 0.5 * pi_d) <= 4 * (all.error + errors));
}

TEST_CASE("lights: a triangle that is an item has the density with which it is drawn") {
  std::vector<AnyLight> two{TriangleLight{{-0.5f, -0.25f, 1}, {0.5f, -0.25f, 1}, {0, 0.5f, 1.2f}, {4, 4, 4}, 3, 7},
                            TriangleLight{{2, 0, 1}, {3, 0, 1}, {2, 1, 1}, {1, 1, 1}, 3, 8}};
  const Lights lights(two, {}, 1);
  for (uint64_t i = 0; i < 50; ++i) {
    const auto s = lights.sample({0, 0, 0}, float(random_unit(1, i)), {float(random_unit(2, i)), float(random_unit(3, i))});
    REQUIRE(s);
    const bool first = s->radiance.x == 4;
    const TriangleLight& t = std::get<TriangleLight>(two[first ? 0 : 1]);
    const float cosine = dot(normalize(cross(t.b - t.a, t.c - t.a)), s->direction);
    CHECK(lights.triangle_pdf(3, first ? 7 : 8, s->distance, cosine) == Approx(s->pdf).epsilon(1e-4));
  }
  CHECK(lights.triangle_pdf(3, 9, 1, 1) == 0);
  CHECK(lights.triangle_pdf(2, 7, 1, 1) == 0);
}

TEST_CASE("lights: without size or power they are refused") {
  for (const AnyLight& bad :
       {AnyLight(SphereLight{{0, 0, 0}, 0, {1, 1, 1}}), AnyLight(DiscLight{{0, 0, 0}, {0, 0, 1}, 1, {0, 0, 0}}),
        AnyLight(RectangleLight{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 1}}), AnyLight(PointLight{{0, 0, 0}, {NAN, 1, 1}})})
    CHECK_THROWS_AS(Lights({bad}, {}, 1), Error);
  CHECK_FALSE(Lights({}, {}, 1).any());
  CHECK_FALSE(Lights({}, {}, 1).sample({0, 0, 0}, 0.5f, {0.5f, 0.5f}));
}

TEST_CASE("environment: directions of a picture come as often as their density says, and light a surface as the picture does") {
  // A bright window in a dim sky, with columns and rows that differ.
  constexpr size_t w = 16, h = 8;
  std::vector<Vec3f> pixels;
  for (size_t i = 0; i < w * h; ++i) {
    const float v = 0.1f + 0.05f * float(i % w) + (i / w == 2 && i % w == 5 ? 20.f : 0.f);
    pixels.push_back({v, v, v});
  }
  const Environment e(pixels, w, {0, 0, 1}, {0, -1, 0}, 2);
  // The middle column is in front; the window is to its left (-front x ... : +x is left of -y seen from inside with z up).
  // Between the middles of columns and rows it is even: here half way between columns 7 and 8.
  CHECK(e.radiance(normalize(Vec3f{0, -1, 0.2f})).x == Approx(2 * (0.1 + 0.05 * 7.5)));
  constexpr int bins_z = 8, bins_a = 16, n = 40'000;
  int off = 0;
  std::vector<double> observed(bins_z * bins_a), expected(bins_z * bins_a);
  double irradiance = 0, square = 0, exact = 0;
  const Vec3f normal = normalize(Vec3f{0.2f, -0.3f, 1});
  for (int i = 0; i < n; ++i) {
    const auto s = e.sample({float(random_unit(5, uint64_t(i))), float(random_unit(6, uint64_t(i)))});
    off += !(std::abs(s.pdf - e.pdf(s.direction)) <= 1e-3f * s.pdf);  // but for those on the border of a pixel, by rounding
    const double a = std::atan2(double(s.direction.y), double(s.direction.x)) + pi_d;
    observed[size_t(std::min(int((double(s.direction.z) + 1) / 2 * bins_z), bins_z - 1) * bins_a +
                    std::min(int(a / (2 * pi_d) * bins_a), bins_a - 1))] += 1;
    const double v = double(s.radiance.x) * std::max(0.f, dot(s.direction, normal)) / double(s.pdf);
    irradiance += v / n, square += v * v / n;
  }
  constexpr int fine = 40;
  for (int z = 0; z < bins_z * fine; ++z)
    for (int a = 0; a < bins_a * fine; ++a) {
      const double cz = (z + 0.5) / (bins_z * fine) * 2 - 1, angle = (a + 0.5) / (bins_a * fine) * 2 * pi_d - pi_d,
                   sz = std::sqrt(1 - cz * cz);
      const Vec3f d{float(sz * std::cos(angle)), float(sz * std::sin(angle)), float(cz)};
      const double cell = 4 * pi_d / (bins_z * fine * bins_a * fine);
      expected[size_t((z / fine) * bins_a + a / fine)] += n * double(e.pdf(d)) * cell;
      exact += double(e.radiance(d).x) * std::max(0.f, dot(d, normal)) * cell;
    }
  CHECK(off < n / 2000);
  CHECK(test::chi_square_chance(observed, expected) > 1e-4);
  CHECK(std::abs(irradiance - exact) <= 4 * std::sqrt((square - irradiance * irradiance) / n) + 2e-3 * exact);
  pixels[3].y = NAN;
  CHECK_THROWS_AS(Environment(pixels, w, {0, 0, 1}, {0, -1, 0}, 1), Error);
  CHECK_THROWS_AS(Environment({}, 4, {0, 0, 1}, {0, -1, 0}, 1), Error);
}

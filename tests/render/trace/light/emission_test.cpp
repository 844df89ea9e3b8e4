// SPDX-License-Identifier: Apache-2.0
// Light that leaves its source: as much as the source has, into the directions that it should, and as bright where it arrives as lights are
// that are asked for.
#include "render/trace/light/emission.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "base/random.h"
#include "render/trace/sampling/local_frame.h"
#include "support/statistics.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using doctest::Approx;

namespace {

constexpr double pi_e = 3.14159265358979323846;

Box3f small_box() { return {{-0.2f, -0.2f, -0.2f}, {0.2f, 0.2f, 0.2f}}; }

std::optional<EmittedRay> drawn(const Emission& e, uint64_t i) {
  return e.sample(float(random_unit(1, i)), {float(random_unit(2, i)), float(random_unit(3, i))},
                  {float(random_unit(4, i)), float(random_unit(5, i))});
}

struct KindOfLight {
  AnyLight light;
  double power;  // all that leaves it, or at infinity that which meets the disc about the scene
};

/// Each with a radiance, intensity or irradiance of 2.
std::vector<KindOfLight> kinds_of_light() {
  const double reach2 = 3 * 0.2 * 0.2 * 1.0001 * 1.0001;
  const Vec3f two{2, 2, 2};
  return {{PointLight{{0, 0, 2}, two}, 8 * pi_e},
          {SpotLight{{0, 0, 2}, {0, 0.6f, -0.8f}, two, 0.1f, 0.4f}, 2 * 2 * pi_e * (0.1 + 0.3 / 3)},
          {DistantLight{{0, 0.6f, 0.8f}, two, 0}, 2 * pi_e * reach2},
          {SphereLight{{0.3f, 0, 1.5f}, 0.7f, two}, 2 * pi_e * 4 * pi_e * 0.49},
          {DiscLight{{0, 0, 1}, {0, 0, -1}, 0.5f, two}, 2 * pi_e * pi_e * 0.25},
          {RectangleLight{{-0.5f, -0.25f, 1}, {0, 0.5f, 0}, {1, 0, 0}, two}, 2 * pi_e * 0.5},
          {TriangleLight{{-0.5f, -0.25f, 1}, {0.5f, -0.25f, 1}, {0, 0.5f, 1}, two}, 2 * 2 * pi_e * 0.375}};
}

}  // namespace

TEST_CASE("emission: every ray has the densities that are told of it, and together they carry the light's power") {
  for (const KindOfLight& k : kinds_of_light()) {
    const Lights lights({k.light}, {}, 1);
    const Emission emission(lights, small_box());
    CAPTURE(k.light.index());
    test::Moments carried;
    for (uint64_t i = 0; i < 2000; ++i) {
      const auto r = drawn(emission, i);
      REQUIRE(r);
      carried.add(double(r->weight.x));
      const Emission::Densities d = emission.pdf(r->light, r->normal, r->direction);
      CHECK(d.first == Approx(r->first).epsilon(1e-4));
      CHECK(d.second == Approx(r->second).epsilon(1e-3));
      if (!r->at_infinity) CHECK(length(emission.normal(r->light, r->position) - r->normal) < 1e-5f);
      // Two-sided ones apart light leaves to the side of the normal.
      if (!(r->normal == Vec3f()) && !std::holds_alternative<TriangleLight>(k.light)) CHECK(dot(r->direction, r->normal) >= 0);
    }
    CHECK(std::abs(carried.mean - k.power) <= 4 * carried.standard_error() + 1e-4 * k.power);
  }
}

TEST_CASE("emission: a small plate gets as much light from rays as from lights that it asks") {
  // A square of 0.2 at the origin that faces up, and its irradiance at 400 points of it.
  const Vec3f up = normalize(Vec3f{0.1f, 0.2f, 1});
  const LocalFrame plate = LocalFrame::about(up);
  std::vector<std::pair<std::vector<AnyLight>, Environment>> cases;
  for (const KindOfLight& k : kinds_of_light()) cases.push_back({{k.light}, {}});
  cases.push_back({{DistantLight{{0, 0.6f, 0.8f}, {2, 2, 2}, 0.1f}}, {}});
  cases.push_back({{}, Environment(Vec3f{2, 2, 2})});
  std::vector<Vec3f> sky(16 * 8, Vec3f{0.1f, 0.1f, 0.1f});
  sky[2 * 16 + 5] = {20, 20, 20};
  cases.push_back({{}, Environment(sky, 16, {0, 0, 1}, {0, -1, 0}, 1)});
  cases.push_back({{SphereLight{{0, 0, 0}, 0.8f, {2, 2, 2}}}, {}});  // the plate inside of it
  for (size_t which = 0; which < cases.size(); ++which) {
    CAPTURE(which);
    const Lights lights(cases[which].first, cases[which].second, 1);
    const Emission emission(lights, small_box());
    test::Moments by_rays, by_asking;
    constexpr uint64_t n = 200'000;
    for (uint64_t i = 0; i < n; ++i) {
      const auto r = drawn(emission, i);
      if (!r) continue;
      double carried = 0;
      const float towards = -dot(r->direction, up);
      if (towards > 0) {
        const float t = dot(r->leaves, up) / towards;
        const Vec3f at = plate.to_local(r->leaves + r->direction * t);
        if (t > 0 && t < r->t_max && std::abs(at.x) < 0.1f && std::abs(at.y) < 0.1f) carried = double(r->weight.x) / 0.04;
      }
      by_rays.add(carried);
    }
    for (uint64_t i = 0; i < n / 4; ++i) {
      const Vec3f at = plate.x * float(random_unit(6, i) * 0.2 - 0.1) + plate.y * float(random_unit(7, i) * 0.2 - 0.1);
      const auto s = lights.sample(at, float(random_unit(8, i)), {float(random_unit(9, i)), float(random_unit(10, i))});
      by_asking.add(s ? double(s->radiance.x) * std::max(0.f, dot(s->direction, up)) / double(s->pdf) : 0);
    }
    CHECK(by_rays.standard_error() < 0.12 * by_asking.mean);
    CHECK(std::abs(by_rays.mean - by_asking.mean) <= 4 * std::hypot(by_rays.standard_error(), by_asking.standard_error()));
  }
}

TEST_CASE("emission: directions from a surface are as often as their density says") {
  const Lights lights({DiscLight{{0, 0, 1}, {0, 0, -1}, 0.5f, {4, 4, 4}}}, {}, 1);
  const Emission emission(lights, small_box());
  constexpr int bins = 20, n = 20'000;
  std::vector<double> observed(bins, 0.0), expected(bins, 0.0);
  for (uint64_t i = 0; i < n; ++i) {
    const double c2 = std::pow(double(drawn(emission, i)->direction.z), 2);  // uniform where the density is cos / pi
    observed[size_t(std::min(int(c2 * bins), bins - 1))] += 1;
  }
  for (double& e : expected) e = double(n) / bins;
  CHECK(test::chi_square_chance(observed, expected) > 1e-4);
}

TEST_CASE("emission: the chance of a light is part of its density, and without lights there are no rays") {
  const Lights two({PointLight{{0, 0, 2}, {3, 3, 3}}, PointLight{{0, 0, 1}, {1, 1, 1}}}, {}, 1);
  const Emission emission(two, small_box());
  int first = 0;
  for (uint64_t i = 0; i < 4000; ++i) {
    const auto r = drawn(emission, i);
    REQUIRE(r);
    first += r->light == 0;
    CHECK(r->first == Approx(r->light == 0 ? 0.75 : 0.25));
  }
  CHECK(std::abs(first / 4000.0 - 0.75) < 4 * std::sqrt(0.75 * 0.25 / 4000));
  const Lights none;
  CHECK_FALSE(Emission(none, {}).sample(0.5f, {0.5f, 0.5f}, {0.5f, 0.5f}));
}

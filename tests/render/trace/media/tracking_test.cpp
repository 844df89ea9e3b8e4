// SPDX-License-Identifier: Apache-2.0
// Free paths and transmittances in media: against integrals, each way of tracking against the others.
#include <algorithm>

#include "media_support.h"

#include "render/volume/sources/cells/volume_cells_support.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;
using doctest::Approx;

namespace {

double wavy(Vec3 p) { return 0.85 + 0.5 * std::sin(4 * p.x) * std::cos(3 * p.y) + 0.3 * std::sin(5 * p.z + p.x); }

struct Estimated {
  double mean = 0, error = 0;
};
Estimated passes(const Media& media, const Ray& ray, int n) {
  const auto walk = media.borrow();
  Estimated e;
  double square = 0;
  for (int i = 0; i < n; ++i) {
    RandomStream random{uint64_t(i)};
    const auto share = double(walk->passes(ray, random));
    e.mean += share / n, square += share * share / n;
  }
  e.error = std::sqrt(std::max(0.0, square - e.mean * e.mean) / n);
  return e;
}

}  // namespace

TEST_CASE("media: light fades by exp(-tau length) in an even medium, however it is tracked") {
  const Scene scene = scene_of({even(grid(cube(9, -1, 1), one), 1.3)});
  for (const Tracking t : {Tracking::exact, Tracking::mixed, Tracking::delta}) {
    CAPTURE(int(t));
    const auto media = media_of(scene, t);
    const Ray ray{{0.2f, 0.1f, -3}, {0, 0, 1}};
    const Estimated got = passes(*media, ray, 4000);
    CHECK(std::abs(got.mean - std::exp(-2.6)) <= 4 * got.error + 1e-5);
    Ray half = ray;
    half.t_max = 3;  // to the middle
    const Estimated to_middle = passes(*media, half, 4000);
    CHECK(std::abs(to_middle.mean - std::exp(-1.3)) <= 4 * to_middle.error + 1e-5);
  }
}

TEST_CASE("media: all ways of tracking let the same light pass through a field, and textbook steps come near it by their square") {
  VolumeItem v = item(grid(cube(33, -1, 1), wavy), grey(0, 2), density_is_value(0, 2));
  for (const double factor : {1.0, 12.0}) {  // thin bricks, and dense ones
    v.unit_distance = 1 / factor;
    const auto exact = media_of(scene_of({v}), Tracking::exact);
    for (const Ray& ray : {Ray{{0.2f, 0.1f, -3}, {0, 0, 1}}, Ray{{-0.9f, -2, -0.7f}, normalize(Vec3f{0.4f, 2, 0.5f})}}) {
      const double truth = passes(*exact, ray, 1).mean;
      for (const Tracking t : {Tracking::mixed, Tracking::delta}) {
        const Estimated got = passes(*media_of(scene_of({v}), t), ray, 20000);
        CAPTURE(factor);
        CAPTURE(int(t));
        CHECK(std::abs(got.mean - truth) <= 4 * got.error + 1e-5);
      }
    }
  }
}

TEST_CASE("media: one factor a step, as textbooks show, is of second order in the step") {
  VolumeItem v = item(grid(cube(33, -1, 1), wavy), grey(0, 2), density_is_value(0, 2));
  const auto exact = media_of(scene_of({v}), Tracking::exact);
  double square[2] = {};
  for (int r = 0; r < 20; ++r) {
    const Ray ray{{-0.9f + 0.09f * float(r), 0.05f * float(r) - 0.4f, -3}, normalize(Vec3f{0.01f * float(r), 0.02f, 1})};
    const double truth = passes(*exact, ray, 1).mean;
    for (int k = 0; k < 2; ++k) {
      VolumeItem stepped = v;
      stepped.sampling.step = 0.2 / (1 << (2 * k));
      const double off = passes(*media_of(scene_of({stepped}), Tracking::march), ray, 1).mean - truth;
      square[k] += off * off;
    }
  }
  CHECK(std::sqrt(square[0] / square[1]) == Approx(16).epsilon(0.4));
}

TEST_CASE("media: optical depths at which light is met are those of exp(-depth)") {
  VolumeItem v = item(grid(cube(33, -1, 1), wavy), grey(0, 2), density_is_value(0, 2));
  v.unit_distance = 0.5;
  const Ray ray{{-0.3f, 0.15f, -3}, {0, 0, 1}};
  const auto exact = media_of(scene_of({v}), Tracking::exact);
  const auto meter = exact->borrow();
  RandomStream unused(0);
  const auto all = double(meter->passes(ray, unused));
  for (const Tracking t : {Tracking::exact, Tracking::mixed, Tracking::delta}) {
    const auto media = media_of(scene_of({v}), t);
    const auto walk = media->borrow();
    constexpr int n = 8000, bins = 16;
    int count[bins] = {}, through = 0;
    for (int i = 0; i < n; ++i) {
      RandomStream random{uint64_t(i)};
      const auto c = walk->collide(ray, random.next(), random);
      if (!c) {
        ++through;
        continue;
      }
      Ray part = ray;
      part.t_max = c->t;
      // The share of the light that is met before that place is even over what is met at all.
      const double u = (1 - double(meter->passes(part, unused))) / (1 - all);
      ++count[std::clamp(int(u * bins), 0, bins - 1)];
    }
    const double met = n - through;
    CHECK(std::abs(through - n * all) <= 4 * std::sqrt(n * all * (1 - all)) + 1);
    double chi = 0;
    for (const int c : count) chi += (c - met / bins) * (c - met / bins) / (met / bins);
    CAPTURE(int(t));
    CHECK(chi < 37.7);  // 15 degrees of freedom: one in a thousand
  }
}

TEST_CASE("media: the same field lets the same light pass as a grid, a curvilinear grid and tetrahedra") {
  const auto linear = [](Vec3 p) { return 1 + 0.5 * p.x - 0.3 * p.y + 0.2 * p.z; };
  const DatasetPtr boxes = grid(cube(7, -1, 1), linear);
  const DatasetPtr tets = tets_of(linear), bends = curvilinear_of(linear);
  const auto media = [&](const DatasetPtr& d, Tracking t) { return media_of(scene_of({item(d, grey(0, 2), density_is_value(0, 2))}), t); };
  for (const TestRay& r : {TestRay{{0.21, 0.13, -3}, {0, 0, 1}}, TestRay{{-0.9, -2, -0.7}, normalize(Vec3{0.4, 2, 0.5})}}) {
    const Ray ray = ray_of(Placement::of(boxes->bounds()), r.o, r.d);
    // The field along the ray is linear: its integral is the chord times the field in its middle.
    const auto [from, to] = chord((r.o + Vec3{1, 1, 1}) * 0.5, r.d * 0.5);
    const double truth = std::exp(-(to - from) * linear(r.o + r.d * (0.5 * (from + to))));
    for (const DatasetPtr& d : {boxes, bends, tets}) {
      CHECK(passes(*media(d, Tracking::exact), ray, 1).mean == Approx(truth).epsilon(1e-4));
      for (const Tracking t : {Tracking::mixed, Tracking::delta}) {
        const Estimated got = passes(*media(d, t), ray, 20000);
        CHECK(std::abs(got.mean - truth) <= 4 * got.error + 1e-5);
      }
    }
  }
}

TEST_CASE("media: what is opaque, holes and clipped parts") {
  // Opaque from the middle on.
  VolumeItem v = item(grid(cube(9, -1, 1), [](Vec3 p) { return p.z; }), grey(-1, 1), {});
  v.opacity.points = {{-1, 0}, {0, 0}, {0, 1}, {1, 1}};
  const auto media = media_of(scene_of({v}));
  const auto walk = media->borrow();
  RandomStream random(1);
  const auto hit = walk->collide({{0.1f, 0.2f, -3}, {0, 0, 1}}, 0.5f, random);
  REQUIRE(hit);
  CHECK(hit->t == Approx(3).epsilon(1e-4));
  CHECK(walk->passes({{0.1f, 0.2f, -3}, {0, 0, 1}}, random) == 0);
  // NaN is no matter.
  const auto hollow = media_of(scene_of({even(grid(cube(9, -1, 1), [](Vec3) { return NAN; }), 1)}));
  if (const auto nothing = hollow->borrow()) CHECK(nothing->passes({{0.1f, 0.2f, -3}, {0, 0, 1}}, random) == 1);
  // Half of a medium.
  VolumeItem half = even(grid(cube(9, -1, 1), one), 1);
  half.clip = {{{0, 0, 1}, 0}};
  const auto clipped = media_of(scene_of({half}), Tracking::exact);
  CHECK(clipped->borrow()->passes({{0.1f, 0.2f, -3}, {0, 0, 1}}, random) == Approx(std::exp(-1.0)).epsilon(1e-5));
}

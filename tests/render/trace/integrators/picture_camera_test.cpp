// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/picture_camera.h"

#include <cmath>
#include <vector>

#include "base/random.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using doctest::Approx;

namespace {

std::vector<Projection> each_projection() {
  Camera c;
  c.position = {30, -50, 20}, c.target = {1, 2, 3}, c.up = {0, 0, 1}, c.view_angle = 40, c.near_plane = 1, c.far_plane = 500;
  const Projection perspective = make_projection(c, 60, 40);
  c.parallel = true, c.parallel_height = 25;
  const Projection parallel = make_projection(c, 60, 40);
  return {perspective, parallel, window_of(perspective, 10, 5, 20, 15, 2)};
}

}  // namespace

TEST_CASE("picture camera: a point on a pixel's ray is seen there, from as far as the ray came") {
  const Placement placement{{1, 2, 3}, 0.125};
  for (const Projection& p : each_projection()) {
    const PictureCamera camera(p, placement);
    for (uint64_t i = 0; i < 200; ++i) {
      const Vec2f pixel{float(random_unit(1, i) * p.width), float(random_unit(2, i) * p.height)};
      const Ray ray = camera.ray(pixel);
      const float t = 0.1f + 3 * float(random_unit(3, i));
      const Vec3f point = ray.origin + ray.direction * t;
      const auto sight = camera.sees(point);
      REQUIRE(sight);
      CHECK(sight->pixel.x == Approx(pixel.x).epsilon(1e-3));
      CHECK(sight->pixel.y == Approx(pixel.y).epsilon(1e-3));
      CHECK(sight->distance == Approx(t).epsilon(1e-4));
      CHECK(dot(sight->direction, ray.direction) == Approx(-1));
      CHECK(camera.depth(pixel, t) == Approx(p.to_eye(placement.world(point)).z).epsilon(1e-5));
    }
  }
}

TEST_CASE("picture camera: through any place on a lens a point is seen in the pixel whose ray meets it") {
  const Placement placement{{1, 2, 3}, 0.125};
  for (Projection p : each_projection()) {
    p.lens = 3, p.focus = 40;
    const PictureCamera camera(p, placement);
    for (uint64_t i = 0; i < 200; ++i) {
      const Vec2f pixel{float(random_unit(1, i) * p.width), float(random_unit(2, i) * p.height)};
      const Vec2f on_lens{float(random_unit(4, i)) - 0.5f, float(random_unit(5, i)) - 0.5f};
      const Ray ray = camera.ray(pixel, on_lens);
      const float t = 0.1f + 3 * float(random_unit(3, i));
      const auto sight = camera.sees(ray.origin + ray.direction * t, on_lens);
      REQUIRE(sight);
      CHECK(sight->pixel.x == Approx(pixel.x).epsilon(1e-3));
      CHECK(sight->pixel.y == Approx(pixel.y).epsilon(1e-3));
      CHECK(sight->distance == Approx(t).epsilon(1e-4));
      CHECK(dot(sight->direction, ray.direction) == Approx(-1));
    }
  }
}

TEST_CASE("picture camera: importance over a plane that fills the picture adds up to its pixels") {
  // A plane across the view, and one that is tilted: the integral of importance |cos|, by a fine grid over a part that is more than seen.
  const Placement placement{{1, 2, 3}, 0.125};
  const Vec2f on_lens{0.6f, -0.3f};
  std::vector<Projection> all = each_projection();
  for (const Projection& without : each_projection()) all.push_back(without), all.back().lens = 6, all.back().focus = 40;
  for (const Projection& p : all)
    for (const double tilt : {0.0, 0.4}) {
      const PictureCamera camera(p, placement);
      const Vec3 middle = p.eye + p.forward * 60;
      const Vec3 across = p.right * std::cos(tilt) + p.forward * std::sin(tilt),
                 normal = p.forward * std::cos(tilt) - p.right * std::sin(tilt);
      constexpr int n = 700;
      constexpr double half = 60;  // world
      double sum = 0;
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const Vec3 world = middle + across * ((2 * (i + 0.5) / n - 1) * half) + p.up * ((2 * (j + 0.5) / n - 1) * half);
          if (const auto sight = camera.sees(placement.traced(world), on_lens))
            sum += double(sight->importance) * std::abs(double(dot(sight->direction, Vec3f(normal))));
        }
      const double cell = 2 * half / n * placement.scale;
      CHECK(sum * cell * cell == Approx(camera.pixels()).epsilon(0.02));
    }
}

TEST_CASE("picture camera: nothing is seen behind the eye, beside the picture and before the near plane") {
  const Placement placement{{0, 0, 0}, 1};
  Camera c;
  c.position = {0, 0, 1}, c.target = {0, 0, 0}, c.up = {0, 1, 0}, c.near_plane = 0.5, c.far_plane = 10;
  const PictureCamera camera(make_projection(c, 10, 10), placement);
  CHECK(camera.sees({0, 0, 0}));
  CHECK_FALSE(camera.sees({0, 0, 0.6f}));
  CHECK_FALSE(camera.sees({0, 0, 1.5f}));
  CHECK_FALSE(camera.sees({0.9f, 0, 0}));
}

// SPDX-License-Identifier: Apache-2.0
// What chains are made of: the space of random numbers, the film that they splat on, and how bright the picture is.
#include <cmath>
#include <vector>

#include "base/random.h"
#include "light_scenes.h"
#include "render/trace/integrators/bidirectional/path_of_point.h"
#include "render/trace/integrators/bidirectional/picture_integrator.h"
#include "render/trace/integrators/bidirectional/splat_film.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;
using doctest::Approx;

namespace {

std::vector<float> numbers_of(PrimarySpace& space, PrimarySpace::Part part, int n) {
  space.begin(part);
  std::vector<float> v;
  for (int i = 0; i < n; ++i) v.push_back(space.next());
  return v;
}

}  // namespace

TEST_CASE("primary space: what is rejected leaves no trace, what is accepted stays") {
  using Part = PrimarySpace::Part;
  PrimarySpace space(1, 2), same(1, 3), other(4, 2);
  const auto camera = numbers_of(space, Part::camera, 6), light = numbers_of(space, Part::light, 3);
  CHECK(camera == numbers_of(same, Part::camera, 6));  // of the first key alone
  CHECK_FALSE(camera == numbers_of(other, Part::camera, 6));
  for (const bool large : {false, true, false}) {
    space.propose(large);
    const auto moved = numbers_of(space, Part::camera, 8);  // more than were asked for before
    CHECK_FALSE(std::vector<float>(moved.begin(), moved.begin() + 6) == camera);
    CHECK(moved == numbers_of(space, Part::camera, 8));
    space.reject();
    CHECK(numbers_of(space, Part::camera, 6) == camera);
    CHECK(numbers_of(space, Part::light, 3) == light);
  }
  space.propose(false);
  const auto moved = numbers_of(space, Part::camera, 6);
  space.accept();
  CHECK(numbers_of(space, Part::camera, 6) == moved);
  for (size_t i = 0; i < 6; ++i) {
    const float d = std::abs(moved[i] - camera[i]);
    CHECK(std::min(d, 1 - d) < 0.06f);  // six standard deviations, around the ends
  }
  space.propose(true), space.accept();  // nobody asked
  CHECK_FALSE(numbers_of(space, Part::camera, 6) == moved);
}

TEST_CASE("primary space: steps of which nobody asked are made up for, and numbers stay uniform") {
  constexpr int n = 4000, bins = 10;
  std::vector<double> observed(bins, 0.0), expected(bins, double(n) / bins);
  sg::test::Moments moved;
  for (int i = 0; i < n; ++i) {
    PrimarySpace space(random_bits(7, uint64_t(i)), random_bits(8, uint64_t(i)));
    const float before = numbers_of(space, PrimarySpace::Part::camera, 1)[0];
    for (int k = 0; k < 16; ++k) space.propose(false), space.accept();
    const float after = numbers_of(space, PrimarySpace::Part::camera, 1)[0];
    observed[size_t(std::min(int(after * bins), bins - 1))] += 1;
    const double d = std::remainder(double(after) - double(before), 1.0);
    moved.add(d * d);
  }
  CHECK(sg::test::chi_square_chance(observed, expected) > 1e-4);
  // Sixteen steps of 0.01.
  CHECK(std::abs(moved.mean - 16 * 0.01 * 0.01) <= 4 * moved.standard_error());
}

TEST_CASE("film of splats: the same sums in any order, to 2^-33 each") {
  constexpr size_t n = 1000;
  SplatFilm a(4, 3), b(4, 3);
  std::vector<double> sums(12, 0.0);
  const auto splat = [&](size_t i, SplatFilm& film) {
    const Vec2f at{float(random_unit(1, i)) * 4, float(random_unit(2, i)) * 3};
    const double v = std::pow(10.0, 6 * random_unit(3, i) - 5);
    film.add(at, {v, 2 * v, 0});
    if (&film == &a) sums[size_t(at.y) * 4 + size_t(at.x)] += v;
  };
  for (size_t i = 0; i < n; ++i) splat(i, a), splat(n - 1 - i, b);
  for (size_t p = 0; p < 12; ++p) {
    CHECK(a.sum(p) == b.sum(p));
    CHECK(a.sum(p).x == Approx(sums[p]).epsilon(1e-7));
    CHECK(a.sum(p).y == Approx(2 * sums[p]).epsilon(1e-7));
  }
  a.add({4, 3}, {1, NAN, INFINITY});  // the corner counts to the last pixel; what is no number to none
  CHECK(a.sum(11).x == Approx(sums[11] + 1));
  CHECK(a.sum(11).z == 0);
  a.clear(11);
  CHECK(a.sum(11) == Vec3());
}

TEST_CASE("metropolis: its b is the mean brightness of the picture by paths, and its picture has it") {
  LightScene s;
  add_room(s);
  s.camera = look({0, -2.6, 0}, {0, 0, 0}, 40);
  s.scene.items.emplace_back(ball({0.2f, 0, -0.5f}, 0.35f, 12, preset_material(MaterialPreset::glass), 1));
  s.lights = {SphereLight{{-0.3f, 0.1f, 0.4f}, 0.2f, {4, 4, 4}}};
  s.bounces = 5;
  const LitWorld w(s);
  const Means path = pictures_by(w, IntegratorKind::path, 16, 128);
  Context context;
  const PictureCamera camera(w.projection, w.world.geometry().placement());
  const Emission emission(w.world.lights(), w.world.geometry().bounds());
  const PathScene scene{w.world, emission, camera, s.bounces, true};
  const auto integrator = metropolis_integrator(scene, options_of(w, IntegratorKind::metropolis, 768, 3));
  PassFilm film(w.projection.width, w.projection.height);
  double before = 0;
  for (uint32_t n = 0; n < 768; n += 16) {
    integrator->pass(n, n + 16, film, context);
    if (n == 0) before = integrator->factor_error();
  }
  const double b = integrator->factor(), error = b * integrator->factor_error();
  CAPTURE(b);
  CAPTURE(path.back().mean);
  CHECK(integrator->factor_error() < 0.03);
  CHECK(integrator->factor_error() < 0.7 * before);  // large steps tell more of it
  CHECK(std::abs(b - path.back().mean) <= 4 * std::hypot(error, path.back().standard_error()));
  // Splats of one unit of brightness a step.
  double sum = 0;
  for (size_t p = 0; p < size_t(LitWorld::side) * LitWorld::side; ++p) {
    const Vec3 v = film.splats.sum(p);
    sum += 0.2126 * v.x + 0.7152 * v.y + 0.0722 * v.z;
  }
  CHECK(sum / (768.0 * LitWorld::side * LitWorld::side) == Approx(1).epsilon(0.05));
}

TEST_CASE("metropolis: the brightness of points, by number of turns, is that of paths cut after as many") {
  LightScene s;
  add_room(s);
  s.camera = look({0, -2.6, 0}, {0, 0, 0}, 40);
  s.lights = {RectangleLight{{-0.4f, -0.4f, 0.85f}, {0, 0.8f, 0}, {0.8f, 0, 0}, {3, 3, 3}}};
  double before = 0, error_before = 0;
  for (int turns = 1; turns <= 3; ++turns) {
    s.bounces = turns;
    const LitWorld w(s);
    const Means path = pictures_by(w, IntegratorKind::path, 24, 64);
    const PictureCamera camera(w.projection, w.world.geometry().placement());
    const Emission emission(w.world.lights(), w.world.geometry().bounds());
    const PathScene scene{w.world, emission, camera, turns, false};
    PathOfPoint tracer(scene);
    sg::test::Moments brightness;
    Lit lit;
    for (uint64_t i = 0; i < 15'000; ++i) {
      PrimarySpace point(random_bits(9, i), 0);
      tracer.trace(point, turns, lit);
      brightness.add(lit.brightness);
    }
    const double all = path.back().mean, error = path.back().standard_error();
    CHECK(brightness.standard_error() < 0.06 * brightness.mean);
    CHECK(std::abs(brightness.mean - (all - before)) <= 4 * std::hypot(brightness.standard_error(), std::hypot(error, error_before)));
    before = all, error_before = error;
  }
}

// SPDX-License-Identifier: Apache-2.0
// The shares of all ways to make a path: they add up to one, and are those of densities that are evaluated afresh from the path's points.
#include <cmath>
#include <vector>

#include "light_scenes.h"
#include "render/trace/integrators/bidirectional/densities.h"
#include "render/trace/integrators/bidirectional/strategies.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;
using doctest::Approx;

namespace {

// p_s of every way, written out (densities.h); 0 for those that cannot be.
std::vector<double> products(const PathDensities& d) {
  std::vector<double> p(d.count(), 0.0);
  for (size_t s = 0; s < d.count(); ++s) {
    if (!d.possible(s)) continue;
    p[s] = 1;
    for (size_t i = 0; i < d.count(); ++i) p[s] *= i >= s ? d.from_camera[i] : i == 0 && s == 1 ? d.asked : d.from_light[i];
  }
  return p;
}

void check_shares(const PathDensities& d, size_t own) {
  const std::vector<double> p = products(d);
  REQUIRE(p[own] > 0);
  for (const Heuristic heuristic : {Heuristic::balance, Heuristic::power}) {
    const double power = heuristic == Heuristic::power ? 2 : 1;
    double of_squares = 0, sum = 0;
    for (const double v : p) of_squares += std::pow(v / p[own], power);
    for (size_t s = 0; s < p.size(); ++s)
      if (p[s] > 0) {
        const double weight = strategy_weight(d, s, heuristic);
        CHECK(weight == Approx(std::pow(p[s] / p[own], power) / of_squares).epsilon(1e-6));
        sum += weight;
      }
    CHECK(sum == Approx(1).epsilon(1e-6));
  }
}

/// A room with rough and smooth things in it.
LightScene furnished(bool smooth) {
  LightScene s;
  add_room(s);
  s.camera = look({0, -2.6, 0}, {0, 0, 0}, 40);
  s.scene.items.emplace_back(ball({-0.4f, 0.1f, -0.5f}, 0.35f, 12, preset_material(MaterialPreset::satin)));
  const MaterialPreset other = smooth ? MaterialPreset::glass : MaterialPreset::frosted_glass;
  s.scene.items.emplace_back(ball({0.4f, 0, -0.5f}, 0.35f, 12, preset_material(other), 1));
  s.lights = {RectangleLight{{-0.4f, -0.4f, 0.85f}, {0, 0.8f, 0}, {0.8f, 0, 0}, {3, 3, 3}}, PointLight{{0, -0.5f, 0.2f}, {1, 1, 1}},
              SphereLight{{-0.5f, 0, 0.3f}, 0.2f, {2, 2, 2}}, DistantLight{normalize(Vec3f{0, -1, 0.4f}), {1, 1, 1}, 0.02f}};
  s.environment = Environment(Vec3f{0.3f, 0.3f, 0.3f});
  return s;
}

/// The points of a joined path from the light to the camera, without these two.
std::vector<const PathVertex*> points_of(const SubPath& light, int i, const SubPath& camera, int j) {
  std::vector<const PathVertex*> points;
  for (; i >= 0; i = light.vertex(i).parent) points.insert(points.begin(), &light.vertex(i));
  for (; j >= 0; j = camera.vertex(j).parent) points.push_back(&camera.vertex(j));
  return points;
}

Vec3f place_of(const PathVertex& v) { return v.at.point.position; }

// By the density of a direction at `at` that comes from `before`: that of `to` per area.
double onward(const PathVertex& at, Vec3f before, const PathVertex& to) {
  const Vec3f way = place_of(to) - place_of(at), direction = normalize(way);
  const double pdf = double(at.at.bsdf.pdf(at.at.frame.to_local(normalize(before - place_of(at))), at.at.frame.to_local(direction)));
  return pdf * std::abs(double(dot(direction, to.at.point.face_normal))) / double(dot(way, way));
}

}  // namespace

TEST_CASE("strategies: the shares of all ways to make a path add up to one") {
  for (int kind = 0; kind < 3; ++kind) {
    const bool smooth = kind == 1, foggy = kind == 2;
    LightScene s = furnished(smooth);
    if (foggy) s.scene.items.emplace_back(matter(0.8f, 1, [](Vec3) { return 1.0; }));
    const LitWorld w(s);
    const PictureCamera camera(w.projection, w.world.geometry().placement());
    const Emission emission(w.world.lights(), w.world.bounds());
    const PathScene scene{w.world, emission, camera, 6, true, foggy ? 20 : 6};
    Strategies strategies(scene);
    SubPath a, b;
    Sampler sampler(SamplerKind::independent, 5, 4096);
    SamplerNumbers numbers(sampler);
    int of[4] = {0, 0, 0, 0}, with_delta = 0;
    const auto check = [&](const std::optional<Contribution>& c, int way) {
      if (!c || !(strategies.weight(*c) > 1e-12)) return;
      check_shares(strategies.densities(), size_t(c->from_light));
      ++of[way];
      for (const uint8_t delta : strategies.densities().delta) with_delta += delta != 0;
    };
    for (uint32_t k = 0; k < 300; ++k) {
      sampler.start(0, 0, k);
      walk_from_camera(scene, strategies.media(), {float(k % 12) + 0.5f, float(k / 12 % 12) + 0.5f}, 7, numbers, a);
      walk_from_light(scene, strategies.media(), 6, numbers, b);
      for (const Stretch& stretch : a.stretches)
        for (const MetLight& m : std::vector<MetLight>(strategies.met_in(stretch))) check(strategies.met(a, stretch, m), 0);
      for (int i = 0; i < int(b.vertices.size()); ++i) check(strategies.onto_picture(b, i, numbers), 1);
      for (int j = 0; j < int(a.vertices.size()); ++j) {
        check(strategies.asked(a, j, numbers), 2);
        for (int i = 0; i < int(b.vertices.size()); ++i) check(strategies.joined(b, i, a, j, numbers), 3);
      }
    }
    for (const int count : of) CHECK(count > 20);
    CHECK((with_delta > 100) == smooth);
  }
}

TEST_CASE("strategies: the densities that walks leave are those of the path's points") {
  LightScene s = furnished(false);
  s.lights.resize(1), s.environment = {};
  const LitWorld w(s);
  const PictureCamera camera(w.projection, w.world.geometry().placement());
  const Emission emission(w.world.lights(), w.world.geometry().bounds());
  const PathScene scene{w.world, emission, camera, 6, true};
  Strategies strategies(scene);
  SubPath a, b;
  Sampler sampler(SamplerKind::independent, 6, 4096);
  SamplerNumbers numbers(sampler);
  int paths = 0;
  for (uint32_t k = 0; k < 200; ++k) {
    sampler.start(0, 0, k);
    walk_from_camera(scene, strategies.media(), {float(k % 12) + 0.5f, float(k / 12 % 12) + 0.5f}, 7, numbers, a);
    walk_from_light(scene, strategies.media(), 6, numbers, b);
    for (int i = 0; i < int(b.vertices.size()); ++i)
      for (int j = 0; j < int(a.vertices.size()); ++j) {
        if (!strategies.joined(b, i, a, j, numbers)) continue;
        const PathDensities& d = strategies.densities();
        const std::vector<const PathVertex*> x = points_of(b, i, a, j);
        // In corners points lie so close that rounding decides their direction.
        bool close = false;
        for (size_t n = 1; n < x.size(); ++n) close = close || length(place_of(*x[n]) - place_of(*x[n - 1])) < 1e-3f;
        if (close) continue;
        ++paths;
        REQUIRE(d.count() == x.size() + 2);
        const Vec3f lamp = b.emitted->position, eye = Vec3f(w.projection.eye);
        const auto place = [&](size_t n) { return n == 0 ? lamp : n == x.size() + 1 ? eye : place_of(*x[n - 1]); };
        // Of the lamp, of radiance 3 and area 0.64, alone: evenly over it, cos / pi from it.
        CHECK(d.from_light[0] == Approx(1 / 0.64));
        CHECK(d.asked == Approx(1 / 0.64).epsilon(1e-3));
        const Vec3f first = place(1) - lamp;
        const double d2 = double(dot(first, first)), cosine = -double(normalize(first).z),
                     there = std::abs(double(dot(normalize(first), x[0]->at.point.face_normal)));
        CHECK(d.from_light[1] == Approx(cosine / 3.14159265 * there / d2).epsilon(2e-3));
        // What the camera sees: pixels by area, of 144.
        const Vec3f last = place(x.size()) - eye;
        const double from_axis = double(dot(normalize(last), Vec3f(w.projection.forward))),
                     facing = std::abs(double(dot(normalize(last), x.back()->at.point.face_normal)));
        CHECK(d.from_camera[x.size()] ==
              Approx(w.projection.scale * w.projection.scale / std::pow(from_axis, 3) * facing / double(dot(last, last)) / 144)
                  .epsilon(2e-3));
        for (size_t n = 2; n <= x.size(); ++n) CHECK(d.from_light[n] == Approx(onward(*x[n - 2], place(n - 2), *x[n - 1])).epsilon(0.01));
        for (size_t n = 1; n < x.size(); ++n) CHECK(d.from_camera[n] == Approx(onward(*x[n], place(n + 2), *x[n - 1])).epsilon(0.01));
      }
  }
  CHECK(paths > 200);
}

TEST_CASE("strategies: shares where densities are zero, or a light is no surface") {
  PathDensities d;
  d.reset(3);
  d.from_light = {0, 0, 0}, d.from_camera = {2, 3, 1};
  CHECK(strategy_weight(d, 0) == 1);  // met by chance alone
  d.from_light = {0.5, 4, 0}, d.asked = 0.25, d.light_can_be_met = false;
  // p_1 = asked * from_camera[1], p_2 = from_light[0] from_light[1]: 0.75 and 2.
  CHECK(strategy_weight(d, 0) == 0);
  CHECK(strategy_weight(d, 1) == Approx(0.75 * 0.75 / (0.75 * 0.75 + 4)));
  CHECK(strategy_weight(d, 2) == Approx(4 / (0.75 * 0.75 + 4)));
  CHECK(strategy_weight(d, 2, Heuristic::balance) == Approx(2 / 2.75));
  d.delta[1] = 1;
  CHECK(strategy_weight(d, 1) == 0);
  CHECK(strategy_weight(d, 2) == 0);
}

// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/particle_run.h"

#include <cmath>
#include <cstring>

#include "base/parallel.h"
#include "filter/mesh/to_unstructured.h"
#include "simulate/particles/meshes.h"
#include "support/property.h"
#include "support/test.h"

using namespace sg;
using namespace sg::swarm;

namespace {

// `count` particles at a place, no others.
ParticlesInParams at_once(int count, std::vector<double> emitter) {
  ParticlesInParams p;
  p.count = count, p.rate = 0, p.emitter = std::move(emitter), p.use = FieldUse::none;
  return p;
}

ParticleRun run_of(const ParticlesInParams& p, std::vector<DatasetPtr> surfaces = {}, DatasetPtr data = nullptr) {
  Context context;
  return ParticleRun(p, "particle_system_in", std::move(data), std::move(surfaces), context);
}

}  // namespace

TEST_CASE("particles: the speed of a fall under drag is its closed form") {
  Context context;
  for (const bool quadratic : {false, true}) {
    ParticlesInParams p = at_once(1, {0, 0, 0, 0});
    (quadratic ? p.quadratic_drag : p.drag) = 2;
    p.integrator = Integrator::rk4, p.frame = 0.1, p.step = 0.005;
    ParticleRun run = run_of(p);
    for (int frame = 1; frame <= 50; ++frame) {
      run.advance(context);
      const double t = 0.1 * frame;
      const double want = quadratic ? std::sqrt(9.81 / 2) * std::tanh(std::sqrt(9.81 * 2) * t) : 9.81 / 2 * (1 - std::exp(-2 * t));
      CHECK(run.velocities()[0].z == doctest::Approx(-want).epsilon(1e-8));
    }
    CHECK(run.velocities()[0].z == doctest::Approx(quadratic ? -std::sqrt(9.81 / 2) : -9.81 / 2).epsilon(1e-4));
  }
}

TEST_CASE("particles: a ball that bounces with restitution e rises to e^2n of its height") {
  Context context;
  for (const double e : {1.0, 0.8, 0.5}) {
    ParticlesInParams p = at_once(1, {0.3, 0.4, 1, 0});
    p.bounds = {0, 1, 0, 1, 0, 3}, p.restitution = e;
    p.frame = p.step = 1e-3;
    ParticleRun run = run_of(p);
    std::vector<double> tops;
    double last = 0;
    for (int i = 0; i < 6000 && tops.size() < 4; ++i) {
      run.advance(context);
      const double vz = run.velocities()[0].z;
      if (last > 0 && vz <= 0) tops.push_back(run.places()[0].z);
      last = vz;
    }
    REQUIRE(tops.size() == 4);
    // The moment of a bounce is found to second order in the step, which a bounce turns into height.
    for (size_t n = 0; n < 4; ++n) CHECK(std::abs(tops[n] - std::pow(e, 2 * double(n + 1))) < 2e-5);
  }
}

TEST_CASE("particles: friction brings a sliding particle to rest after v^2 / (2 mu g), and it stays") {
  Context context;
  ParticlesInParams p = at_once(1, {1, 0.5, 0, 0});
  p.bounds = {0, 10, 0, 1, 0, 1}, p.restitution = 0, p.friction = 0.3, p.velocity = {4, 0, 0}, p.frame = 0.1, p.step = 1e-3;
  ParticleRun run = run_of(p);
  for (int i = 0; i < 20; ++i) run.advance(context);
  CHECK(run.places()[0].x == doctest::Approx(1 + 16 / (2 * 0.3 * 9.81)).epsilon(2e-3));
  CHECK(length(run.velocities()[0]) < 1e-9);
  CHECK(run.places()[0].z >= 0);
  CHECK(run.places()[0].z < 1e-5);
}

TEST_CASE("particles: none passes a closed surface, however fast, inside or outside") {
  Context context;
  for (const double restitution : {1.0, 0.6, 0.0}) {
    ParticlesInParams p = at_once(2000, {0, 0, 0, 0.5});
    p.spread = 40, p.restitution = restitution, p.friction = 0.1, p.frame = p.step = 0.05;
    ParticleRun inside = run_of(p, {test::ball(2)});
    for (int i = 0; i < 60; ++i) inside.advance(context);
    int escaped = 0;
    for (const Vec3& x : inside.places()) escaped += length(x) > 1;
    CHECK(escaped == 0);
    // A box within walls: particles start between the two.
    p.emitter = {2, 2, 2, 0.4}, p.bounds = {-3, 3, -3, 3, -3, 3};
    ParticleRun outside = run_of(p, {test::box({-1, -1, -1}, {1, 1, 1})});
    for (int i = 0; i < 60; ++i) outside.advance(context);
    int entered = 0, lost = 0;
    for (const Vec3& x : outside.places()) {
      const double r = std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)});
      entered += r<1, lost += r> 3;
    }
    CHECK(entered == 0);
    CHECK(lost == 0);
  }
}

TEST_CASE("particles: elastic bounces in a ball keep the energy") {
  Context context;
  ParticlesInParams p = at_once(500, {0, 0, 0, 0.5});
  p.spread = 3, p.restitution = 1, p.gravity = Vec3(0, 0, 0), p.frame = p.step = 0.02;
  ParticleRun run = run_of(p, {test::ball(2)});
  std::vector<double> before;
  for (const Vec3& v : run.velocities()) before.push_back(length(v));
  for (int i = 0; i < 100; ++i) run.advance(context);
  for (size_t i = 0; i < before.size(); ++i) CHECK(length(run.velocities()[i]) == doctest::Approx(before[i]).epsilon(1e-12));
}

TEST_CASE("particles: wind of a grid and of a mesh of the same values, against the closed form") {
  // In the wind u = c + A x, A = diag(-1, 0.5, 0), without gravity: x'' = k (u(x) - x').
  const auto u = [](Vec3 x) { return Vec3(0.2 - x.x, 0.5 * x.y, 0.3); };
  const DatasetPtr grid = test::wind(5, u);
  Context context;
  const DatasetPtr mesh = to_unstructured(grid, {}, context);
  for (const DatasetPtr& data : {grid, mesh}) {
    ParticlesInParams p = at_once(1, {0.5, 0.2, -0.5, 0});
    p.use = FieldUse::wind, p.drag = 3, p.gravity = Vec3(0, 0, 0), p.integrator = Integrator::rk4, p.frame = 0.5, p.step = 0.01;
    ParticleRun run = run_of(p, {}, data);
    run.advance(context), run.advance(context);
    // Roots of s^2 + k s - k a = 0 along each axis.
    const auto along = [](double a, double c, double x0) {
      const double k = 3, root = std::sqrt(k * k / 4 + k * a), s1 = -k / 2 + root, s2 = -k / 2 - root, rest = -c / a, d = x0 - rest;
      return rest + d * (s2 * std::exp(s1) - s1 * std::exp(s2)) / (s2 - s1);
    };
    const Vec3 x = run.places()[0];
    CHECK(x.y == doctest::Approx(along(0.5, 0, 0.2)).epsilon(1e-6));
    CHECK(x.z == doctest::Approx(-0.5 + 0.3 * (1 - (1 - std::exp(-3.0)) / 3)).epsilon(1e-6));
    const double w = std::sqrt(0.75), d = 0.3;  // complex roots -3/2 +- i sqrt(3 - 9/4)
    CHECK(x.x == doctest::Approx(0.2 + d * std::exp(-1.5) * (std::cos(w) + 1.5 / w * std::sin(w))).epsilon(1e-6));
  }
  // As a force, divided by mass.
  ParticlesInParams p = at_once(1, {0, 0, 0, 0});
  p.use = FieldUse::force, p.mass = 2, p.gravity = Vec3(0, 0, 0), p.frame = 0.5;
  ParticleRun run = run_of(p, {}, test::wind(3, [](Vec3) { return Vec3(1, 0, 0); }));
  run.advance(context);
  CHECK(run.places()[0].x == doctest::Approx(0.5 * 0.5 * 0.25).epsilon(1e-12));
}

TEST_CASE("particles: wind is trilinear everywhere in a grid, up to its corners, in f32 and f64, and nothing outside") {
  Context context;
  const auto u = [](Vec3 x) { return Vec3(1 + x.x * x.y, x.y * x.z - 2, x.x * x.y * x.z); };
  const DatasetPtr data = test::wind(2, u);  // one cell, in which u is trilinear
  FieldSet wide;
  wide.add({"velocity", Association::point, data->fields().require("velocity").array.converted(ElementType::f64), "", Role::vectors});
  for (const DatasetPtr& d :
       {data, make_dataset(*data->as<UniformGrid>(), wide), test::wind(9, [&](Vec3 x) { return Vec3(x.x, 2 * x.y, -x.z); })}) {
    const Wind wind(d, "", "test", context);
    test::Random random(3);
    for (int i = 0; i < 500; ++i) {
      const auto coordinate = [&] { return random.chance(0.3) ? (random.chance(0.5) ? 1.0 : -1.0) : random.in(-1, 1); };
      const Vec3 x{coordinate(), coordinate(), coordinate()}, out = x + Vec3(0, random.chance(0.5) ? 2.1 : -2.1, 0);
      Vec3 got, none(1, 1, 1);
      wind.sample(std::span(&x, 1), std::span(&got, 1)), wind.sample(std::span(&out, 1), std::span(&none, 1));
      const Vec3 want = d->point_count() == 8 ? u(x) : Vec3(x.x, 2 * x.y, -x.z);
      CHECK(length(got - want) < 1e-5);
      CHECK(none == Vec3(0, 0, 0));
    }
  }
}

TEST_CASE("particles: a tether swings with sqrt(k/m)") {
  Context context;
  ParticlesInParams p = at_once(1, {0, 0, 0, 0});
  p.tether = 8, p.mass = 2, p.velocity = {1, 0, 0}, p.gravity = Vec3(0, 0, 0), p.frame = 0.1, p.step = 1e-3;
  ParticleRun run = run_of(p);
  for (int i = 0; i < 7; ++i) run.advance(context);
  CHECK(run.places()[0].x == doctest::Approx(std::sin(2 * 0.7) / 2).epsilon(1e-5));
}

TEST_CASE("particles: the same bytes for any number of threads, and in any order of times; lives end") {
  ParticlesInParams p;
  p.rate = 20000, p.life = 0.3, p.spread = 1, p.drag = 1, p.frame = 0.1;
  const std::vector<Data> inputs{test::wind(9, [](Vec3 x) { return Vec3(-x.y, x.x, 0.5); }), test::ball(1)};
  p.emitter = {0, 0, 0, 0.3};
  Context context;
  const auto at = [&](double time) {
    p.time = time;
    return particle_system_in(inputs, p, context);
  };
  const auto same = [](const DatasetPtr& a, const DatasetPtr& b) {
    if (a->point_count() != b->point_count()) return false;
    for (const char* name : {"velocity", "age", "id"}) {
      const Array &u = a->fields().require(name).array, &v = b->fields().require(name).array;
      if (std::memcmp(u.raw(), v.raw(), u.bytes()) != 0) return false;
    }
    const Array &u = a->as<PointCloud>()->points.xyz, &v = b->as<PointCloud>()->points.xyz;
    return std::memcmp(u.raw(), v.raw(), u.bytes()) == 0;
  };
  set_thread_count(1);
  const DatasetPtr late = at(1), early = at(0.5);
  set_thread_count(2);
  CHECK(same(late, at(1)));
  CHECK(same(early, at(0.5)));
  CHECK(same(late, at(1)));
  set_thread_count(0);
  CHECK(late->point_count() == 6000);
  CHECK(late->stats(late->fields().require("age")).range[0].hi <= 0.3 + 1e-9);
}

TEST_CASE("particles: what cannot be is said") {
  Context context;
  const auto refused = [&](const ParticlesInParams& p, std::vector<Data> inputs = {test::wind(3, [](Vec3) { return Vec3(1, 0, 0); })}) {
    return test::error_of([&] { particle_system_in(inputs, p, context); });
  };
  const auto not_set = [](const char* name, const char* text) {
    ParticlesInParams p;
    Schema s = schema_of(p);
    return test::error_of([&] { set_param(s, name, text, "particle_system_in"); });
  };
  CHECK(test::contains(not_set("step", "0"), "above 0"));
  CHECK(test::contains(not_set("mass", "-1"), "above 0"));
  CHECK(test::contains(not_set("drag", "-1"), "drag"));
  CHECK(test::contains(not_set("restitution", "1.5"), "restitution"));
  ParticlesInParams p;
  p.step = HUGE_VAL;
  CHECK(test::contains(refused(p), "step: inf is not finite"));
  p.step = 0.01, p.frame = HUGE_VAL;
  CHECK(test::contains(refused(p), "frame: inf is not finite"));
  p.frame = 1, p.step = 1e-8;
  CHECK(test::contains(refused(p), "a million steps"));
  p = {};
  p.emitter = {5, 0, 0, 0.1};
  CHECK(test::contains(refused(p), "reaches outside"));
  p.emitter = {0, 0, 0};
  CHECK(test::contains(refused(p), "3 numbers are no balls"));
  p.emitter = {0, 0, 0, NAN};
  CHECK(test::contains(refused(p), "finite"));
  p.emitter = {}, p.bounds = {0, 1, 0, 1, 2, 1};
  CHECK(test::contains(refused(p), "from 2 to 1 along z"));
  p.bounds = {0, 1};
  CHECK(test::contains(refused(p), "no box"));
  p = {};
  CHECK(test::contains(refused(p, {test::wind(3, [](Vec3) { return Vec3(NAN, 0, 0); })}), "27 values that are no numbers"));
  CHECK(test::contains(refused(p, {test::ball(0)}), "vector"));
  p.rate = 1e12, p.time = 1;
  CHECK(test::contains(refused(p), "more than 2e+08 particles"));
  p = {};
  p.count = 10, p.rate = 0, p.quadratic_drag = 1e6, p.velocity = {1, 0, 0}, p.integrator = Integrator::forward_euler, p.time = 2;
  const std::string why = refused(p);
  CHECK(test::contains(why, "grew beyond all numbers in frame 2 "));
  CHECK(test::contains(why, "backward_euler"));
}

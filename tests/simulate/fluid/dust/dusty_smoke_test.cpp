// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "base/error.h"
#include "simulate/fluid/smoke.h"
#include "simulate/run/stored.h"
#include "support/test.h"

using namespace sg;
using namespace sg::fluid;

namespace {

// Cold, empty air in which nothing moves by itself.
DustySmokeParams calm() {
  DustySmokeParams p;
  p.size = 24, p.bounds = {0, 1, 0, 1, 0, 2}, p.type = FieldType::f64, p.density = p.temperature = 0, p.frame = 0.05;
  p.dust = 3000, p.dust_box = {0.35, 0.65, 0.35, 0.65, 1.3, 1.6};
  return p;
}

Smoke<double> run_of(const DustySmokeParams& p) {
  SmokeInput given;
  given.dust = static_cast<const DustParams&>(p);
  return Smoke<double>(p, given, Context());
}

struct Mean {
  Vec3 at, v;
};
Mean mean_of(const Smoke<double>& s) {
  Mean m;
  for (const DustParticle& q : s.dust()->particles()) m.at += s.grid().h * q.x, m.v += q.v;
  const double n = 1.0 / double(s.dust()->particles().size());
  return {n * m.at, n * m.v};
}

}  // namespace

TEST_CASE("dusty smoke: light dust falls at m g / k and leaves the air at rest; a heavy cloud drags it along and falls faster") {
  Context context;
  DustySmokeParams p = calm();
  p.dust_gravity = 2;
  const double lag = 0.05;  // m / k
  double fallen[3], air[3];
  for (int i = 0; i < 3; ++i) {
    p.dust_mass = std::array{1e-12, 1e-5, 1e-4}[size_t(i)], p.dust_drag = *p.dust_mass / lag;
    Smoke<double> s = run_of(p);
    const double begin = mean_of(s).at.z;
    for (int f = 0; f < 12; ++f) s.advance(context);
    fallen[i] = begin - mean_of(s).at.z;
    air[i] = 0;
    for (const double v : s.velocity()[2].values) air[i] = std::min(air[i], v);
    CHECK(s.dust()->particles().size() == 3000);
    if (i > 0) continue;
    CHECK(mean_of(s).v.z == doctest::Approx(-2 * lag).epsilon(1e-3));
    // From rest: v = -g lag (1 - exp(-t/lag)), its way after t = 0.6 g lag (t - lag).
    CHECK(fallen[0] == doctest::Approx(2 * lag * (0.6 - lag)).epsilon(0.06));
    CHECK(std::abs(air[0]) < 1e-6);
  }
  MESSAGE("fallen by " << fallen[0] << ", " << fallen[1] << ", " << fallen[2] << "; air falls at " << -air[1] << ", " << -air[2]);
  CHECK(fallen[1] > 1.1 * fallen[0]);
  CHECK(fallen[2] > 1.5 * fallen[1]);
  CHECK(air[2] < 1.5 * air[1]);
  CHECK(air[1] < -0.01);
}

TEST_CASE("dusty smoke: hot air lifts light dust, cold air does not") {
  Context context;
  DustySmokeParams p = calm();
  p.dust_gravity = 0.2, p.dust_mass = 1e-9, p.dust_drag = 1e-7, p.box = {0.3, 0.7, 0.3, 0.7, 0.2, 0.5}, p.dust_box.clear();
  for (const double heat : {0.0, 1.0}) {
    p.temperature = heat, p.density = heat;
    Smoke<double> s = run_of(p);
    const double begin = mean_of(s).at.z;
    CHECK(begin == doctest::Approx(0.35).epsilon(0.03));
    for (int f = 0; f < 20; ++f) s.advance(context);
    if (heat > 0) CHECK(mean_of(s).at.z > begin + 0.1);
    else CHECK(mean_of(s).at.z < begin);
  }
}

TEST_CASE("dusty smoke: stiff, heavy dust that fills a box rests on its pressure and does not sink") {
  Context context;
  DustySmokeParams p = calm();
  p.size = 8, p.bounds = {0, 1, 0, 1, 0, 1}, p.open = BoxSide::none, p.dust_box = {0, 1, 0, 1, 0, 1}, p.dust = 40000;
  p.dust_mass = 3.0 / 40000, p.dust_drag = 1e6, p.viscosity = 0.05, p.dust_gravity = 1;  // three times the air's weight
  Smoke<double> s = run_of(p);
  const double begin = mean_of(s).at.z;
  for (int f = 0; f < 10; ++f) s.advance(context);
  // Without the second look at the air it would have sunk at 3 g dt > 0.03: here it follows what unevenness there is.
  CHECK(std::abs(mean_of(s).at.z - begin) < 0.003);
  CHECK(std::abs(mean_of(s).v.z) < 0.005);
  for (const DustParticle& q : s.dust()->particles()) CHECK_FALSE(length(q.v) > 0.5);
}

TEST_CASE("dusty smoke: dust stays on floors and balls, leaves through open sides, and appears at its rate") {
  Context context;
  DustySmokeParams p = calm();
  p.dust_gravity = 10, p.dust_mass = 1e-9, p.dust_drag = 5e-9, p.obstacle = {0.5, 0.5, 0.8, 0.2}, p.dust = 500;
  Smoke<double> s = run_of(p);
  for (int f = 0; f < 30; ++f) s.advance(context);
  size_t on_floor = 0, on_ball = 0;
  CHECK(s.dust()->particles().size() == 500);
  for (const DustParticle& q : s.dust()->particles()) {
    const Vec3 at = s.grid().h * q.x;
    on_floor += at.z < 1e-6, on_ball += std::abs(length(at - Vec3(0.5, 0.5, 0.8)) - 0.2) < 1e-9;
    CHECK(length(at - Vec3(0.5, 0.5, 0.8)) > 0.2 - 1e-9);
    CHECK(at.z > 0);
  }
  CHECK(on_floor + on_ball == 500);
  CHECK(on_floor > 50);
  p.obstacle.clear(), p.dust_gravity = -10, p.dust = 0, p.dust_rate = 100;  // falls upwards, through the open side
  Smoke<double> up = run_of(p);
  size_t most = 0;
  for (int f = 0; f < 40; ++f) {
    up.advance(context);
    most = std::max(most, up.dust()->particles().size());
    if (f == 3) CHECK(up.dust()->particles().size() == 20);
  }
  CHECK(most < 120);
}

TEST_CASE("dusty smoke: shown as mass per volume, whose sum is the dust's, or as particles; flat, in f32, and stored") {
  Context context;
  DustySmokeParams p, other;
  p.size = 20, p.frame = 0.05, p.dust = 2000, p.dust_rate = 300, p.dust_mass = 1e-5, p.time = 0.2, p.lift = 3, other.size = 8,
  other.dust = 10;
  for (const bool flat : {false, true}) {
    if (flat) p.bounds = {0, 1, 0, 2, 0, 0}, p.type = FieldType::f64;
    const DatasetPtr d = dusty_smoke(p, context);
    const UniformGrid& g = *d->as<UniformGrid>();
    double sum = 0;
    const Array& dust = d->fields().require("dust").array;
    for (size_t i = 0; i < dust.count(); ++i) sum += dust.get(i) * std::pow(g.spacing.x, flat ? 2 : 3);
    CHECK(sum == doctest::Approx(1e-5 * 2060).epsilon(1e-5));
    DustySmokeParams cloud = p;
    cloud.show = DustShow::particles;
    const DatasetPtr c = dusty_smoke(cloud, context);
    CHECK(c->as<PointCloud>());
    CHECK(c->point_count() == 2060);
    CHECK(c->fields().require("id").array.get(2059) == 2059);
    test::goes_on(flat ? "flat_dust" : "dust", p, other, [&](const DustySmokeParams& q) { return dusty_smoke(q, context); });
  }
}

TEST_CASE("dusty smoke: what makes no sense is refused") {
  Context context;
  const auto error = [&](auto&& change) {
    DustySmokeParams p = calm();
    p.size = 8;
    change(p);
    return test::error_of([&] { dusty_smoke(p, context); });
  };
  CHECK(test::contains(error([](DustySmokeParams& p) { p.dust = 0; }), "there is no dust"));
  CHECK(test::contains(error([](DustySmokeParams& p) { p.dust_mass = -1; }), "dust_mass"));
  CHECK(test::contains(error([](DustySmokeParams& p) { p.dust_drag = HUGE_VAL; }), "dust_drag"));
  CHECK(test::contains(error([](DustySmokeParams& p) { p.dust_gravity = NAN; }), "finite"));
  CHECK(test::contains(error([](DustySmokeParams& p) { p.dust_box = {5, 6, 5, 6, 5, 6}; }), "outside"));
  CHECK(test::contains(error([](DustySmokeParams& p) { p.reflect = true; }), "mirrored"));
}

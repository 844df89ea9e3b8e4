// SPDX-License-Identifier: Apache-2.0
// What is noise in a measured flow, and that lines and textures keep out of it.
#include "filter/flow/seeds/noise_speed.h"

#include "base/random.h"
#include "filter/flow/flow_support.h"
#include "filter/flow/streamlines.h"
#include "filter/flow/texture/lic.h"
#include "support/test.h"

using namespace sg;

namespace {

constexpr size_t n = 32;

// A vessel along x with a speed of 1 in its middle; around it noise of up to 0.01, or a slow swirl about the vessel.
DatasetPtr vessel(bool noise) {
  uint64_t at = 0;
  return test::cube_flow(n, -1, 1, [&](Vec3 x) {
    ++at;
    const double r = (x.y * x.y + x.z * x.z) / 0.06;
    if (r < 1) return Vec3(1 - r + 0.03, 0, 0);
    if (!noise) return Vec3(0.001, -0.01 * x.z, 0.01 * x.y);
    return Vec3(random_unit(1, at) - 0.5, random_unit(2, at) - 0.5, random_unit(3, at) - 0.5) * 0.02;
  });
}

double of(const DatasetPtr& d) { return noise_speed(*d, *d->fields().with_role(Role::vectors)); }

}  // namespace

TEST_CASE("noise_speed: 2 % of the largest around a measured vessel; a slow but smooth flow, still air and flat data are no noise") {
  CHECK(of(vessel(true)) == doctest::Approx(0.02 * vessel(true)->range(*vessel(true)->fields().with_role(Role::vectors), -1).hi));
  CHECK(of(vessel(false)) == 0);
  CHECK(of(test::cube_flow(n, -1, 1, [](Vec3 x) { return x.y * x.y + x.z * x.z < 0.06 ? Vec3(1, 0, 0) : Vec3(); })) == 0);
  CHECK(of(test::cube_flow(n, -1, 1, [](Vec3) { return Vec3(); })) == 0);
  CHECK(of(test::cube_flow(n, -1, 1, [](Vec3 x) { return Vec3(-x.y, x.x, 0.1); })) == 0);
}

TEST_CASE("streamlines: around a measured vessel lines begin and end where it flows, min_speed=0 lets them go on") {
  Context context;
  std::string log;
  context.on_log = [&](LogLevel, std::string_view text) { log += text; };
  StreamlinesParams p;
  p.seeds.count = 40;
  const auto slowest = [&](const StreamlinesParams& q, bool noise) {
    const DatasetPtr lines = std::get<DatasetPtr>(streamlines({vessel(noise)}, q, context));
    return lines->range(lines->fields().require("speed")).lo;
  };
  CHECK(slowest(p, true) > 0.01);
  CHECK(log.find("min_speed=0") != std::string::npos);
  log.clear();
  p.seeds.seeds = SeedKind::random;
  p.stop.min_speed = 0;
  CHECK(slowest(p, true) < 0.01);
  p.stop.min_speed = StopParams().min_speed;
  CHECK(slowest(p, false) < 0.015);  // a swirl is a flow
  CHECK(log.find("noise") == std::string::npos);
}

TEST_CASE("lic: there is no texture in the noise around a vessel, unless still=0 asks for it") {
  Context context;
  LicParams p;
  p.resolution = int64_t(n), p.noise = LicNoise::white;
  const auto plain = [&] {
    const DatasetPtr d = lic(vessel(true), nullptr, p, context);
    const Array& v = d->fields().require("lic").array;
    size_t grey = 0;
    for (size_t i = 0; i < v.count(); ++i) grey += v.get(i) == 0.5;
    return double(grey) / double(v.count());
  };
  CHECK(plain() > 0.8);
  p.still = 0;
  CHECK(plain() < 0.1);
}

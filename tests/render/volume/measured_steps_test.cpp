// SPDX-License-Identifier: Apache-2.0
// Fixed steps that are measured in place of a tolerance: for rough data in light alone, and as near as they say.
#include "render/volume/measured_steps.h"

#include "render/render.h"
#include "volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

/// Waves of some cells with white noise on them: `noise` of their height.
Scene scene(double noise, double scale = 1) {
  constexpr size_t n = 64;
  UniformGrid g = cube(n, -scale, scale);
  const auto value = [&](Vec3 p) {
    const Vec3 q = p / scale;
    const auto at = uint64_t(std::llround((q.x + 1) * 1e4)) << 40 ^ uint64_t(std::llround((q.y + 1) * 1e4)) << 20 ^
                    uint64_t(std::llround((q.z + 1) * 1e4));
    return 0.5 + 0.3 * std::sin(4 * q.x) * std::cos(3 * q.y + q.z) + noise * (random_unit(5, at) - 0.5);
  };
  VolumeItem v = item(grid(g, value), grey(0, 1), {});
  v.opacity.points = {{0.3, 0}, {0.5, 0.02}, {0.9, 0.2}};
  v.unit_distance = 0, v.shaded = true;
  Scene s;
  s.items.emplace_back(v);
  return s;
}
VolumeItem& volume_of(Scene& s) { return std::get<VolumeItem>(s.items[0]); }

}  // namespace

TEST_CASE("measured steps: noise in light gets them, smooth data keeps the tolerance") {
  Context context;
  const auto rough = measure_steps(scene(0.5), context);
  REQUIRE(rough);
  CHECK(rough->turns > 60);
  CHECK(rough->rays > 3000);
  CHECK(rough->rays <= 6400);
  REQUIRE(rough->step > 0);
  CHECK(rough->step == doctest::Approx(2.0 / 63 / rough->parts));
  CHECK(rough->usual <= 8.0 / 512);
  CHECK(rough->usual <= rough->largest);
  CHECK_FALSE(measure_steps(scene(0), context));
  CHECK(rough->text().find("of the distance of samples") != std::string::npos);
  const auto larger = measure_steps(scene(0.5, 4096), context);  // the same in other units
  REQUIRE(larger);
  CHECK(larger->parts == rough->parts);
}

TEST_CASE("measured steps: what is stated is kept, and so is what is not lit or not alone") {
  Context context;
  const auto measured = [&](auto&& change) {
    Scene s = scene(0.5);
    change(s);
    return steps_may_be_measured(s, context) && measure_steps(s, context).has_value();
  };
  CHECK(measured([](Scene&) {}));
  CHECK_FALSE(measured([](Scene& s) { volume_of(s).sampling.tolerance = 1.0 / 512; }));
  CHECK_FALSE(measured([](Scene& s) { volume_of(s).sampling.step = 0.01; }));
  CHECK_FALSE(measured([](Scene& s) { volume_of(s).shaded = false; }));
  CHECK_FALSE(measured([](Scene& s) { volume_of(s).mode = RayFunction::maximum; }));
  CHECK_FALSE(measured([](Scene& s) { volume_of(s).sampling.kernel = Kernel::bspline; }));
  CHECK_FALSE(measured([](Scene& s) { s.items.push_back(s.items[0]); }));
  CHECK_FALSE(measured([](Scene& s) { s.items.clear(); }));
}

TEST_CASE("measured steps: other views are as near to the truth as was told, the same for any number of threads") {
  const Scene exact = scene(0.5);
  Context context;
  const auto measured = measure_steps(exact, context);
  REQUIRE(measured);
  Scene steps = in_steps(exact, *measured);
  CHECK(volume_of(steps).sampling.step == measured->step);
  const int all = thread_count();
  set_thread_count(1);
  Context alone;
  const auto again = measure_steps(exact, alone);
  set_thread_count(all);
  REQUIRE(again);
  CHECK(again->turns == measured->turns);
  CHECK(again->usual == measured->usual);
  CHECK(again->largest == measured->largest);

  RenderOptions options;
  options.width = options.height = 90;
  const Camera camera = fit_camera(scene_bounds(exact), {-2, 1, 0.5}, {0, 0, 1}, 1);
  const Frame truth = render(exact, camera, options, context), frame = render(steps, camera, options, context);
  size_t seen = 0, off = 0;
  for (size_t i = 0; i < truth.pixels(); ++i) {
    float most = 0;
    for (size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(truth.rgba[4 * i + c] - frame.rgba[4 * i + c]));
    seen += truth.ids[i] != 0 || truth.rgba[4 * i] > 0, off += double(most) > measured->usual;
  }
  CHECK(seen > 3000);
  CHECK(double(off) < 0.03 * double(seen));
}

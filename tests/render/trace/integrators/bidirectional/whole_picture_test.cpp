// SPDX-License-Identifier: Apache-2.0
// Pictures that are lit as a whole: what only paths from lights find, the same bytes, what they say of themselves, bad input.
#include "render/trace/integrators/bidirectional/whole_picture.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"
#include "light_scenes.h"
#include "render/trace/trace.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;
using doctest::Approx;

namespace {

constexpr IntegratorKind whole[] = {IntegratorKind::light, IntegratorKind::bdpt, IntegratorKind::metropolis};

/// A glass ball over a floor, with a lamp without a size, of which no path from the camera ever meets.
LightScene sharp_caustic() {
  LightScene s;
  add_floor(s);
  s.scene.items.emplace_back(ball({0, 0.1f, -0.35f}, 0.4f, 24, preset_material(MaterialPreset::glass), 1));
  s.camera = look({0, -1.2, -0.74}, {0, 0, -0.9}, 10);
  s.lights = {PointLight{{0.1f, 0, 0.75f}, {1, 1, 1}}};
  s.bounces = 6;
  return s;
}

}  // namespace

TEST_CASE("whole picture: the caustic of a lamp without a size is the same by all that find it, and path does not") {
  const LitWorld w(sharp_caustic());
  const Means light = pictures_by(w, IntegratorKind::light, 24, 128), bdpt = pictures_by(w, IntegratorKind::bdpt, 24, 32),
              metropolis = pictures_by(w, IntegratorKind::metropolis, 24, 128), path = pictures_by(w, IntegratorKind::path, 8, 64);
  for (const Means* m : {&light, &bdpt, &metropolis}) CHECK(m->back().standard_error() < 0.08 * m->back().mean);
  check_same(light, bdpt);
  check_same(light, metropolis);
  check_same(bdpt, metropolis);
  CHECK(path.back().mean < 0.6 * light.back().mean);
}

TEST_CASE("whole picture: as light as the formula of a lamp over a floor says") {
  // One turn: albedo / pi I cos / d^2 = albedo / pi I h / d^3, of the pixel in the middle.
  LightScene s;
  add_floor(s, 0.5);
  s.camera = look({0, 0, 2}, {0, 0, 0}, 20), s.camera.up = {0, 1, 0};
  s.lights = {PointLight{{0, 0, 0.1f}, {2, 2, 2}}};
  s.bounces = 1;
  const LitWorld w(s, 3, 3);
  Context context;
  for (const IntegratorKind kind : whole) {
    CAPTURE(kind);
    sg::test::Moments middle;
    for (uint64_t seed = 0; seed < 16; ++seed)
      middle.add(double(draw_whole_picture(w.world, w.projection, options_of(w, kind, 128, seed), context).frame.rgba[4 * 4]));
    // Over the pixel, a square of side 2 h tan(10 deg) / 3 at a distance of 2.9 from the eye and 1 from the lamp.
    const double a = 2.9 * std::tan(10 * 3.14159265358979 / 180) / 3;
    double sum = 0;
    constexpr int n = 200;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double x = ((i + 0.5) / n * 2 - 1) * a, y = ((j + 0.5) / n * 2 - 1) * a;
        sum += 0.5 / 3.14159265358979 * 2 / std::pow(1 + x * x + y * y, 1.5) / (n * n);
      }
    CHECK(std::abs(middle.mean - sum) <= 4 * middle.standard_error() + 1e-3 * sum);
  }
}

TEST_CASE("whole picture: a lamp is seen, and shines, through sheets of glass, as bright as these let it pass") {
  // A sheet of index 1.5 passes (1 - r) / (1 + r) of what meets it straight on, r = 0.04: of the lamp's light and of what the camera sees.
  // Path too asks for the lamp through the sheet.
  SurfaceMaterial glass;
  glass.specular_roughness = 0, glass.transmission_weight = 1, glass.thin_walled = true;
  LightScene s;
  add_floor(s, 0.5);
  s.camera = look({0, 0, 2}, {0, 0, 0}, 3), s.camera.up = {0, 1, 0};
  s.lights = {PointLight{{0, 0, 0.1f}, {2, 2, 2}}};
  s.bounces = 1;
  const double open = pictures_by(LitWorld(s), IntegratorKind::path, 8, 16).back().mean, passed = 0.96 / 1.04;
  s.scene.items.emplace_back(sheet({-0.5f, -0.5f, -0.5f}, {1, 0, 0}, {0, 1, 0}, glass, 1));
  const LitWorld w(s);
  for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::light, IntegratorKind::bdpt, IntegratorKind::metropolis}) {
    CAPTURE(kind);
    const auto through = pictures_by(w, kind, 16, 64).back();
    CHECK(through.standard_error() < 0.1 * open);
    CHECK(std::abs(through.mean - open * passed * passed) <= 4 * through.standard_error() + 2e-3 * open);
  }
}

TEST_CASE("whole picture: the same bytes for one, two and three threads, with depth, numbers and what is empty") {
  Scene scene;
  scene.items.emplace_back(sg::test::item(sg::test::sphere(20, 1)));
  const Camera camera = fit_camera(scene_bounds(scene), {1, -2, 1}, {0, 0, 1}, 4.0 / 3);
  Context context;
  const PreparedScenePtr prepared = prepare_scene(scene, context);
  const Projection p = make_projection(camera, 28, 21);
  const int before = thread_count();
  for (const IntegratorKind kind : whole) {
    CAPTURE(kind);
    LightOptions options;
    options.integrator = kind, options.paths = 16, options.noise = 0.001;
    std::vector<Frame> frames;
    TraceReport report[3];
    for (int threads = 1; threads <= 3; ++threads) {
      set_thread_count(threads);
      frames.push_back(trace_scene(scene, prepared, p, options, report[threads - 1], context));
    }
    set_thread_count(before);
    for (size_t i = 1; i < 3; ++i) {
      CHECK(std::equal(frames[0].rgba.begin(), frames[0].rgba.end(), frames[i].rgba.begin()));
      CHECK(std::equal(frames[0].ids.begin(), frames[0].ids.end(), frames[i].ids.begin()));
      CHECK(report[0].noise == report[i].noise);
    }
    CHECK(report[0].paths == 16);
    CHECK(report[0].noise > 0);
    CHECK_FALSE(report[0].reached);
    const Frame& a = frames[0];
    const size_t middle = 10 * 28 + 14;
    CHECK(a.rgba[3] == 0);
    CHECK(a.rgba[4 * middle + 3] == Approx(1));
    CHECK(a.rgba[4 * middle] > 0);
    CHECK(a.ids[middle] == 1);
    CHECK(a.depth[middle] == Approx(length(camera.position) - 1).epsilon(0.01));
    CHECK(std::isinf(a.depth[0]));
  }
}

TEST_CASE("whole picture: the noise that it tells is the spread of pictures with other seeds") {
  LightScene s;
  add_room(s);
  s.camera = look({0, -2.6, 0}, {0, 0, 0}, 40);
  s.lights = {RectangleLight{{-0.4f, -0.4f, 0.85f}, {0, 0.8f, 0}, {0.8f, 0, 0}, {3, 3, 3}}};
  const LitWorld w(s);
  Context context;
  for (const IntegratorKind kind : whole) {
    CAPTURE(kind);
    constexpr int seeds = 12;
    std::vector<sg::test::Moments> pixels(LitWorld::side * LitWorld::side);
    double told = 0;
    for (uint64_t seed = 0; seed < seeds; ++seed) {
      const WholePicture p = draw_whole_picture(w.world, w.projection, options_of(w, kind, 32, seed), context);
      told += p.noise * p.noise / seeds;
      for (size_t i = 0; i < pixels.size(); ++i) {
        const float* c = &p.frame.rgba[4 * i];
        pixels[i].add(0.2126 * double(c[0]) + 0.7152 * double(c[1]) + 0.0722 * double(c[2]));
      }
    }
    double found = 0;
    for (const sg::test::Moments& m : pixels) {
      const auto y = std::clamp(float(m.mean), 0.02f, 1.f);
      const double slope = double(srgb_encode(y + 0.01f) - srgb_encode(y - 0.01f)) / 0.02;
      found += m.variance() * slope * slope / double(pixels.size());
    }
    CHECK(std::sqrt(told) == Approx(std::sqrt(found)).epsilon(0.2));
  }
  // And it stops there.
  LightOptions easy = options_of(w, IntegratorKind::bdpt, 4096, 1);
  easy.noise = 0.05;
  const WholePicture p = draw_whole_picture(w.world, w.projection, easy, context);
  CHECK(p.reached);
  CHECK(p.noise <= 0.05);
  CHECK(p.paths < 4096);
}

TEST_CASE("whole picture: dark scenes are dark, and bad input is refused") {
  LightScene s;
  add_floor(s);
  s.camera = look({0, -2.2, 1}, {0, 0, -0.6}, 40);
  Context context;
  for (const IntegratorKind kind : whole) {
    CAPTURE(kind);
    for (const int bounces : {0, 3}) {
      s.bounces = bounces;
      const LitWorld w(s);
      const WholePicture p = draw_whole_picture(w.world, w.projection, options_of(w, kind, 8, 1), context);
      CHECK(p.frame.rgba[4 * 100] == 0);
      CHECK(p.frame.rgba[4 * 100 + 3] == Approx(1));
      CHECK(p.noise == 0);
    }
    Scene scene = s.scene;
    TraceReport report;
    LightOptions options;
    options.integrator = kind, options.paths = 0;
    const PreparedScenePtr prepared = prepare_scene(scene, context);
    const Projection projection = make_projection(s.camera, 8, 8);
    CHECK_THROWS_AS(trace_scene(scene, prepared, projection, options, report, context), Error);
    options.paths = 1, options.bounces = 2;
    CHECK(trace_scene(scene, prepared, projection, options, report, context).rgba[4 * 36 + 3] == Approx(1));
    CHECK_FALSE(report.reached);
    // Nothing to meet.
    Scene empty;
    const Frame frame = trace_scene(empty, prepare_scene(empty, context), projection, options, report, context);
    CHECK(frame.rgba[3] == 0);
  }
}

TEST_CASE("whole picture: smoke through a lens is the same bytes for any number of threads, and what dense smoke hides is not picked") {
  LightScene s;
  add_floor(s);
  VolumeItem smoke = matter(0.6f, 30, [](Vec3 p) { return std::max(0.0, 1 - length(p) / 0.6); }, {0.6f, 0.6f, 0.6f});
  smoke.shaded = true, smoke.scattering.glow = 0.1;
  s.scene.items.emplace_back(smoke);
  s.camera = look({0, -2.2, 0.6}, {0, 0, 0}, 40);
  s.camera.lens = 0.2, s.camera.focus = 2;
  const Projection p = make_projection(s.camera, 20, 15);
  std::string said;
  Context context;
  context.on_log = [&](LogLevel, std::string_view text) { said += text; };
  const PreparedScenePtr prepared = prepare_scene(s.scene, context);
  const int before = thread_count();
  for (const IntegratorKind kind : whole) {
    CAPTURE(kind);
    LightOptions options;
    options.integrator = kind, options.paths = 8, options.noise = 0.001, options.bounces = 3;
    said.clear();
    std::vector<Frame> frames;
    TraceReport report;
    for (int threads = 1; threads <= 3; ++threads) {
      set_thread_count(threads);
      frames.push_back(trace_scene(s.scene, prepared, p, options, report, context));
    }
    set_thread_count(before);
    for (size_t i = 1; i < 3; ++i) {
      CHECK(std::equal(frames[0].rgba.begin(), frames[0].rgba.end(), frames[i].rgba.begin()));
      CHECK(frames[0].ids == frames[i].ids);
    }
    CHECK(frames[0].ids[7 * 20 + 10] == 3);  // the third item
    CHECK(sg::test::contains(said, "surfaces within volumes are left out") == (kind == IntegratorKind::light));
    CHECK(sg::test::contains(said, "what glows in volumes is seen and lights nothing") == (kind == IntegratorKind::light));
  }
}

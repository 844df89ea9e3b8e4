// SPDX-License-Identifier: Apache-2.0
// Light scattered in media, where its amount is known.
#include "media_support.h"
#include "scene/light/light_text.h"

#include "base/error.h"
#include "render/render.h"
#include "render/trace/trace.h"
#include "render/volume/sources/cells/volume_cells_support.h"
#include "support/statistics.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;
using doctest::Approx;

namespace {

const Environment white{Vec3f{1, 1, 1}};

/// A layer of optical depth `depth` between z = -1 and 1, so wide that its sides do not count.
VolumeItem layer(double depth, double albedo) {
  UniformGrid g;
  g.dims = {3, 3, 3}, g.origin = {-4000, -4000, -1}, g.spacing = {4000, 4000, 1};
  VolumeItem v = even(grid(g, one), depth / 200);
  v.unit_distance = 0.01;
  v.scattering.albedo = albedo;
  return v;
}

}  // namespace

TEST_CASE("media: white matter of any shape, mesh and phase function is invisible in even light") {
  const auto lumpy = [](Vec3 p) { return 1.2 - length(p); };
  const DatasetPtr boxes = grid(cube(9, -1, 1), lumpy), tets = tets_of(lumpy);
  for (const DatasetPtr& d : {boxes, tets})
    for (const PhaseKind phase : {PhaseKind::isotropic, PhaseKind::rayleigh, PhaseKind::henyey_greenstein, PhaseKind::two_lobe}) {
      VolumeItem v = item(d, one_color({1, 1, 1}), density_is_value(0, 2, 100));
      v.unit_distance = 0.4, v.scattering.phase = phase;
      CAPTURE(int(phase));
      const Mean got = seen(world_of(scene_of({v}), {}, white), {0.1, 0.2, 3}, {0, 0, -1}, 2000);
      CHECK(std::abs(got.value + got.passed - 1) <= 4 * got.error + 2e-3);
    }
}

TEST_CASE("media: white surfaces of volumes are invisible in even light, too") {
  VolumeItem v = item(grid(cube(17, -1, 1), [](Vec3 p) { return 0.8 - length(p); }), one_color({1, 1, 1}), {});
  v.opacity.points = {{-1, 0}, {-0.05, 0}, {0.05, 0.999}, {1, 0.999}};
  v.unit_distance = 0.02, v.shaded = true;
  const Mean got = seen(world_of(scene_of({v}), {}, white), {0.1, 0.2, 3}, {0, 0, -1}, 2000);
  CHECK(std::abs(got.value + got.passed - 1) <= 4 * got.error + 2e-3);
}

TEST_CASE("media: a half space reflects 1 - H(mu) sqrt(1 - albedo) of even light (Chandrasekhar 1950)") {
  struct Row {
    double mu, albedo, reflected;
  };
  for (const Row& row : {Row{1, 0.2, 0.0352305}, Row{1, 0.5, 0.1152259}, Row{1, 0.8, 0.2852545}, Row{1, 0.9, 0.4149475},
                         Row{1, 0.99, 0.7527207}, Row{0.5, 0.2, 0.0508548}, Row{0.5, 0.5, 0.1601444}, Row{0.5, 0.8, 0.3679698},
                         Row{0.5, 0.9, 0.5079389}, Row{0.5, 0.99, 0.8151399}}) {
    CAPTURE(row.mu);
    CAPTURE(row.albedo);
    const World world = world_of(scene_of({layer(row.albedo > 0.95 ? 120 : 40, row.albedo)}), {}, white);
    const Vec3 down{std::sqrt(1 - row.mu * row.mu), 0, -row.mu};
    const Mean got = seen(world, Vec3{0, 0, 1} - down * 2.0, down, row.albedo < 0.4 ? 40000 : 4000);
    CHECK(std::abs(got.value - row.reflected) <= 4 * got.error + (row.albedo < 0.4 ? 1e-4 : 1e-3));
  }
}

TEST_CASE("media: single scattering of a layer in closed form, and path stays above it") {
  // L = albedo p E mu0 / (mu + mu0) (1 - exp(-depth (1/mu + 1/mu0))).
  const double depth = 0.7, mu0 = 0.8, mu = 0.6, albedo = 0.9;
  const Vec3 to_light{0.6, 0, 0.8}, down{0, -0.8, -0.6};
  VolumeItem v = layer(depth, albedo);
  v.scattering.phase = PhaseKind::henyey_greenstein, v.scattering.anisotropy = 0.4, v.scattering.light = VolumeLighting::single;
  const DistantLight sun{Vec3f(to_light), {2, 2, 2}, 0};
  const double p = double(henyey_greenstein(float(dot(to_light, down)), 0.4f));
  const double truth = albedo * p * 2 * mu0 / (mu + mu0) * (1 - std::exp(-depth * (1 / mu + 1 / mu0)));
  const Mean got = seen(world_of(scene_of({v}), {sun}, {}), Vec3{0, 0, 1} - down * 2.0, down, 20000);
  CHECK(std::abs(got.value - truth) <= 4 * got.error + 1e-6);
  v.scattering.light = VolumeLighting::path;
  const Mean more = seen(world_of(scene_of({v}), {sun}, {}), Vec3{0, 0, 1} - down * 2.0, down, 20000);
  CHECK(more.value > truth + 4 * more.error);
}

TEST_CASE("media: light that is asked for and light that is met by chance add up to the same") {
  // Where matter is thin, light that it scatters a second time is the smaller part by its optical depth.
  VolumeItem v = even(grid(cube(5, -1, 1), one), 0.002);
  v.scattering.phase = PhaseKind::henyey_greenstein, v.scattering.anisotropy = 0.9, v.scattering.albedo = 0.7;
  std::vector<Vec3f> sky(16 * 8, Vec3f{0.2f, 0.2f, 0.2f});
  for (int i = 5; i < 10; ++i) sky[16 * 4 + size_t(i)] = {4, 4, 4};
  const Environment bright(sky, 16, {0, 0, 1}, {0, 1, 0}, 1);
  const World both = world_of(scene_of({v}), {}, bright);
  v.scattering.light = VolumeLighting::single;
  const World asked = world_of(scene_of({v}), {}, bright);
  const Mean a = seen(both, {0.1, -3, 0.2}, {0, 1, 0}, 400000), b = seen(asked, {0.1, -3, 0.2}, {0, 1, 0}, 400000);
  CHECK(std::abs(a.value - b.value) <= 4 * std::hypot(a.error, b.error) + 0.004 * b.value);
  CHECK(b.value > 10 * b.error);
}

TEST_CASE("media: what shines by itself alone is the picture of the ray caster") {
  VolumeItem v = item(grid(cube(17, -1, 1), [](Vec3 p) { return 1.1 - length(p); }), grey(0, 1), density_is_value(0, 2));
  v.unit_distance = 0.5, v.scattering.light = VolumeLighting::emission;
  const Scene scene = scene_of({v});
  const Projection view = parallel_view(6, 6, 3);
  const Frame cast = draw(scene, view);
  // A traced pixel is a mean over its square: of 16 x 16 in a finer picture.
  const Frame fine = draw(scene, parallel_view(96, 96, 48));
  std::vector<double> truth(4 * 36);
  for (size_t y = 0; y < 96; ++y)
    for (size_t x = 0; x < 96; ++x)
      for (size_t k = 0; k < 4; ++k) truth[4 * (y / 16 * 6 + x / 16) + k] += double(fine.rgba[4 * (96 * y + x) + k]) / 256;
  // 16 pictures of 64 paths a pixel, and the mean of their red.
  std::vector<Moments> traced(4 * 36);
  Moments red;
  double red_truth = 0;
  Context context;
  const PreparedScenePtr prepared = prepare_scene(scene, context);
  LightOptions options;
  options.noise = 1e-6, options.paths = 64;
  for (options.seed = 0; options.seed < 16; ++options.seed) {
    TraceReport report;
    const Frame f = trace_scene(scene, prepared, view, options, report, context);
    double sum = 0;
    for (size_t i = 0; i < traced.size(); ++i) traced[i].add(double(f.rgba[i])), sum += i % 4 ? 0 : double(f.rgba[i]);
    red.add(sum / 36);
  }
  for (size_t i = 0; i < traced.size(); ++i) {
    CAPTURE(i);
    CHECK(std::abs(traced[i].mean - truth[i]) <= v.sampling.within() + 4 * traced[i].standard_error());
    CHECK(traced[i].standard_error() < 0.01);
    red_truth += i % 4 ? 0 : truth[i] / 36;
  }
  CHECK(std::abs(red.mean - red_truth) <= 4 * red.standard_error() + 2e-4);
  CHECK(red.standard_error() < 2e-3);
  CHECK(cast.rgba[4 * 14 + 3] > 0.1f);
}

TEST_CASE("media: light maps give the light of single scattering") {
  VolumeItem v = item(grid(cube(33, -1, 1), [](Vec3 p) { return 1.1 - length(p); }), one_color({0.9f, 0.9f, 0.9f}), density_is_value(0, 2));
  v.unit_distance = 0.3;
  v.scattering.phase = PhaseKind::henyey_greenstein, v.scattering.anisotropy = 0.3;
  v.scattering.light = VolumeLighting::map;
  Scene scene = scene_of({v});
  Light lamp;
  lamp.direction = {1, 0.5, 0.8}, lamp.follows_camera = false, lamp.intensity = 1;
  scene.lights = {lamp};
  std::get<VolumeItem>(scene.items[0]).scattering.light = VolumeLighting::single;
  const float e = 0.75f * 3.14159265f;
  const World world = world_of(scene, {DistantLight{Vec3f(normalize(lamp.direction)), {e, e, e}, 0}}, {});
  std::get<VolumeItem>(scene.items[0]).scattering.light = VolumeLighting::map;
  for (const Vec2 at : {Vec2{0.013, 0.017}, Vec2{0.4, -0.3}, Vec2{-0.6, 0.2}}) {
    const Frame map = look(scene, at.x, at.y);
    const Mean single = seen(world, {at.x, at.y, 3}, {0, 0, -1}, 20000);
    CAPTURE(at.x);
    CHECK(std::abs(double(map.rgba[0]) - single.value) <= 4 * single.error + 2e-3);
  }
}

TEST_CASE("media: a stated lamp is as bright by light maps as by paths") {
  VolumeItem v = item(grid(cube(33, -1, 1), [](Vec3 p) { return 1.1 - length(p); }), one_color({0.9f, 0.9f, 0.9f}), density_is_value(0, 2));
  v.unit_distance = 0.3;
  v.scattering.light = VolumeLighting::single;
  Scene scene = scene_of({v});
  scene.lighting.lights = parse_lights("directional angle=0 direction=1,0.5,0.8 brightness=0.7");
  const float e = 0.7f * 3.14159265f;
  const World world = world_of(scene, {DistantLight{Vec3f(normalize(Vec3(1, 0.5, 0.8))), {e, e, e}, 0}}, {});
  std::get<VolumeItem>(scene.items[0]).scattering.light = VolumeLighting::map;
  const Frame map = look(scene, 0.2, -0.1);
  const Mean single = seen(world, {0.2, -0.1, 3}, {0, 0, -1}, 20000);
  CHECK(std::abs(double(map.rgba[0]) - single.value) <= 4 * single.error + 2e-3);
}

TEST_CASE("media: smoke shadows surfaces, and surfaces stand in smoke") {
  // A white floor under an absorbing layer: albedo / pi E cos, with the light that comes through.
  SurfaceMesh mesh;
  mesh.points.xyz = Array::from_vector(std::vector<float>{-9, -9, -2, 9, -9, -2, 9, 9, -2, -9, 9, -2}, 3);
  mesh.polygons.fixed = 4;
  mesh.polygons.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2, 3});
  SurfaceItem floor;
  floor.data = make_dataset(mesh), floor.color = {1, 1, 1};
  VolumeItem v = even(grid(cube(5, -1, 1), one), 0.6);
  v.scattering.albedo = 0;
  const float e = 3.14159265f;
  const World world = world_of(scene_of({floor, v}), {DistantLight{{0, 0, 1}, {e, e, e}, 0}}, {});
  // Under the cube, seen from the side: the way to the light is 2 long in it.
  const Mean under = seen(world, {0.2, -4, -1.5}, Vec3{0, 4, -0.5}, 4000, 1),
             beside = seen(world, {0.2, -8, -1.5}, Vec3{0, 4, -0.5}, 4000, 1);
  CHECK(std::abs(beside.value - 1) <= 4 * beside.error + 1e-3);
  CHECK(std::abs(under.value - std::exp(-1.2)) <= 4 * under.error + 1e-3);
}

TEST_CASE("media: turns in matter take nothing from those at surfaces") {
  // A half white ball deep in white matter: what eight bounces cut off is 0.5^8 of the light at it, however often matter turned it.
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0}, 3);
  PointsItem ball;
  ball.data = make_dataset(Mesh(cloud)), ball.color = {0.735f, 0.735f, 0.735f}, ball.size = 800;  // a radius of 0.4
  VolumeItem v = even(grid(cube(5, -1, 1), one), 3);
  const World world = world_of(scene_of({ball, v}), {}, white);
  const Mean few = seen(world, {0.05, 0.02, 3}, {0, 0, -1}, 20000, 8), many = seen(world, {0.05, 0.02, 3}, {0, 0, -1}, 20000, 100, 2);
  CHECK(std::abs(few.value - many.value) <= 4 * std::hypot(few.error, many.error) + 0.004);
  CHECK(few.value < 0.99);
}

TEST_CASE("media: pictures of smoke and floors are the same bytes for any number of threads") {
  VolumeItem v = item(grid(cube(17, -1, 1), [](Vec3 p) { return 1.1 - length(p); }), one_color({0.9f, 0.9f, 0.9f}), density_is_value(0, 2));
  v.unit_distance = 0.3;
  const Scene scene = scene_of({v});
  LightOptions options;
  options.paths = 8;
  const auto picture = [&](int threads) {
    set_thread_count(threads);
    Context context;
    TraceReport report;
    return trace_scene(scene, prepare_scene(scene, context), parallel_view(24, 24, 10), options, report, context);
  };
  const int before = thread_count();
  const Frame one_thread = picture(1);
  CHECK(same_bytes(one_thread, picture(2)));
  CHECK(same_bytes(one_thread, picture(3)));
  set_thread_count(before);
}

TEST_CASE("media: volumes that are no matter, and coefficients out of range, are refused") {
  Context context;
  const auto refused = [&](const VolumeItem& v) { return error_of([&] { Media::make(scene_of({v}), parallel_view(8, 8, 1), context); }); };
  VolumeItem v = even(grid(cube(5, -1, 1), one), 1);
  v.mode = RayFunction::maximum;
  CHECK(refused(v).find("mode=composite") != std::string::npos);
  v.mode = RayFunction::composite, v.scattering.albedo = 1.2;
  CHECK(refused(v).find("albedo 1.2") != std::string::npos);
  v.scattering.albedo = 1, v.scattering.anisotropy = 1;
  CHECK(refused(v).find("mean cosine") != std::string::npos);
  v.scattering.anisotropy = 0, v.scattering.light = VolumeLighting::map;
  CHECK(refused(v).find("light=map") != std::string::npos);
}

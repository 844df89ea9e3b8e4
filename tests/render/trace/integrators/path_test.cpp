// SPDX-License-Identifier: Apache-2.0
// Light whose amount is known: inside of spheres, about white ones, through sheets, from mirrors.
#include <cmath>
#include <limits>
#include <vector>

#include "render/raster/raster_support.h"
#include "render/trace/integrators/integrator.h"
#include "render/trace/sampling/mis.h"
#include "render/trace/sampling/warp.h"
#include "render/trace/trace.h"
#include "support/statistics.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using doctest::Approx;

namespace {

/// Diffuse; of the item's colour.
SurfaceMaterial diffuse() {
  SurfaceMaterial m;
  m.specular_weight = 0;
  return m;
}

/// One ball of radius 1 about the origin, of a colour with this albedo.
Scene ball(double albedo, double opacity = 1) {
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0}, 3);
  PointsItem item;
  item.data = make_dataset(Mesh(cloud));
  const auto srgb = srgb_encode(float(albedo));
  item.color = {srgb, srgb, srgb}, item.opacity = opacity;
  Scene scene;
  scene.items.emplace_back(item);
  return scene;
}

World world_of(const Scene& scene, const SurfaceMaterial& material, std::vector<AnyLight> lights, Environment environment) {
  Context context;
  GeometryOptions options;
  options.point_radius = 1;
  const PreparedScenePtr prepared = prepare_scene(scene, context);
  return {prepared, Geometry::make(*prepared, options, context),
          std::vector(prepared->items.size(), std::make_shared<const trace::Material>(material)), std::move(lights),
          std::move(environment)};
}

struct Mean {
  double value = 0, error = 0, passed = 0;
};
Mean mean(const World& world, const Integrator& integrator, const Ray& ray, int n, uint64_t seed = 1) {
  Mean m;
  double square = 0;
  Sampler sampler(SamplerKind::independent, seed, n);
  for (int i = 0; i < n; ++i) {
    sampler.start(0, 0, uint32_t(i));
    const Estimate e = integrator.along(world, ray, sampler);
    m.value += double(e.radiance.x) / n, square += double(e.radiance.x) * double(e.radiance.x) / n, m.passed += double(e.passed) / n;
  }
  m.error = std::sqrt(std::max(0.0, square - m.value * m.value) / n);
  return m;
}

const Ray from_inside{{0.1f, 0.05f, -0.1f}, normalize(Vec3f{1, 2, 3})};

}  // namespace

TEST_CASE("path: inside of a diffuse sphere that shines, light is Le / (1 - albedo), and cut short after n turns") {
  SurfaceMaterial m = diffuse();
  m.emission = {0.5, 0.5, 0.5};
  const World world = world_of(ball(0.5), m, {}, {});
  for (const int turns : {0, 1, 2, 5}) {
    const Mean got = mean(world, *path_integrator(turns), from_inside, 2000);
    CHECK(std::abs(got.value - (1 - std::pow(0.5, turns + 1))) <= 4 * got.error + 2e-3);
  }
  const Mean all = mean(world, *path_integrator(60), from_inside, 4000);
  CHECK(std::abs(all.value - 1) <= 4 * all.error + 2e-3);
}

TEST_CASE("path: a point light in the middle of a diffuse sphere lights it evenly") {
  // (albedo I / (pi R^2)) / (1 - albedo), in traced lengths.
  const World dark = world_of(ball(0.5), diffuse(), {}, {});
  const float radius = float(dark.geometry().placement().scale), i = 3.14159265f * radius * radius;
  const World world = world_of(ball(0.5), diffuse(), {PointLight{{0, 0, 0}, {i, i, i}}}, {});
  const Mean got = mean(world, *path_integrator(60), from_inside, 4000);
  CHECK(std::abs(got.value - 1) <= 4 * got.error + 2e-3);
}

TEST_CASE("path: white bodies in even light cannot be seen") {
  const Vec3f one{1, 1, 1};
  const Ray rays[] = {{{0, 0, 2}, {0, 0, -1}}, {{0.45f, 0, 2}, {0, 0, -1}}, {{0, -2, 0.3f}, {0, 1, 0}}};
  for (const MaterialPreset preset :
       {MaterialPreset::matte, MaterialPreset::mirror, MaterialPreset::glass, MaterialPreset::thin_glass, MaterialPreset::plastic}) {
    SurfaceMaterial m = preset_material(preset);
    m.base_color = {1, 1, 1};
    CAPTURE(preset);
    const World world = world_of(ball(1), m, {}, Environment(one));
    for (const Ray& ray : rays) {
      const Mean got = mean(world, *path_integrator(200), ray, 3000);
      CHECK(std::abs(got.value + got.passed - 1) <= 4 * got.error + 0.006);
    }
  }
}

TEST_CASE("path: lights that are met by chance and asked for add up to the same") {
  // A glossy ball under a large disc, so that both ways matter: with one of them alone the picture would be the same, but for noise.
  SurfaceMaterial m = diffuse();
  m.specular_weight = 1, m.specular_roughness = 0.3;
  const Vec3f radiance{3, 3, 3};
  const DiscLight disc{{0, 0, 1.5f}, {0, 0, -1}, 0.8f, radiance};
  const World world = world_of(ball(0.6), m, {disc}, {});
  const Ray ray{{0, -2, 1.2f}, normalize(Vec3f{0, 2, -0.9f})};
  Hit hit;
  REQUIRE(world.geometry().nearest(ray, hit));
  // By quadrature over the disc.
  const Vertex v = world.at(ray, hit);
  const Vec3f wo = v.frame.to_local(-ray.direction);
  double exact = 0;
  constexpr int rings = 200, spokes = 400;
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < spokes; ++s) {
      const float radius = 0.8f * (float(r) + 0.5f) / rings, angle = 2 * pi * (float(s) + 0.5f) / spokes;
      const Vec3f way = Vec3f{radius * std::cos(angle), radius * std::sin(angle), 1.5f} - v.point.position;
      const float d2 = dot(way, way);
      const Vec3f direction = way / std::sqrt(d2), wi = v.frame.to_local(direction);
      if (wi.z <= 0 || direction.z <= 0) continue;
      const double area = double(radius) * 0.8 / rings * 2 * 3.14159265358979 / spokes;
      exact += double(v.bsdf.evaluate(wo, wi).x) * double(wi.z) * double(direction.z) / double(d2) * area * 3;
    }
  const Mean got = mean(world, *path_integrator(1), ray, 40'000);
  CAPTURE(got.value);
  CHECK(std::abs(got.value - exact) <= 4 * got.error + 2e-3 * exact);
}

TEST_CASE("path: light asked for alone, light met alone, both of them weighed, and paths find the same on a glossy surface") {
  constexpr int n = 40'000;
  const Ray ray{{0, -2, 1.2f}, normalize(Vec3f{0, 2, -0.9f})};
  const Vec3f radiance{3, 3, 3};
  for (const AnyLight& lamp :
       {AnyLight(DiscLight{{0, 0, 1.5f}, {0, 0, -1}, 0.8f, radiance}), AnyLight(SphereLight{{0.3f, -0.5f, 1.7f}, 0.5f, radiance})})
    for (const double roughness : {0.2, 0.5}) {
      CAPTURE(lamp.index());
      CAPTURE(roughness);
      SurfaceMaterial m = diffuse();
      m.specular_weight = 1, m.specular_roughness = roughness;
      const World world = world_of(ball(0.6), m, {lamp}, {});
      const Lights& lights = world.lights();
      Hit hit;
      REQUIRE(world.geometry().nearest(ray, hit));
      const Vertex v = world.at(ray, hit);
      const Vec3f wo = v.frame.to_local(-ray.direction), at = v.point.position;
      test::Moments asked, met, weighed;
      Sampler s(SamplerKind::independent, 7, n);
      for (int i = 0; i < n; ++i) {
        s.start(0, 0, uint32_t(i));
        float share = 0;
        const float which = s.next();
        if (const auto light = lights.sample(at, which, s.next2())) {
          const Vec3f wi = v.frame.to_local(light->direction);
          const float sent = wi.z > 0 ? v.bsdf.evaluate(wo, wi).x * wi.z * light->radiance.x / light->pdf : 0;
          asked.add(double(sent)), share += sent * power_weight(light->pdf, v.bsdf.pdf(wo, wi));
        } else {
          asked.add(0);
        }
        const float choice = s.next();
        if (const auto turn = v.bsdf.sample(wo, choice, s.next2()); turn && turn->direction.z > 0) {
          const Ray on{at, normalize(v.frame.to_world(turn->direction))};
          met.add(double(turn->weight.x * lights.seen(on, 0, std::numeric_limits<float>::infinity()).x));
          share += turn->weight.x * lights.seen(on, 0, turn->pdf).x;
        } else {
          met.add(0);
        }
        weighed.add(double(share));
      }
      const Mean paths = mean(world, *path_integrator(1), ray, n, 8);
      CAPTURE(asked.mean);
      CAPTURE(met.mean);
      CAPTURE(weighed.mean);
      CAPTURE(paths.value);
      const auto same = [](const test::Moments& a, const test::Moments& b) {
        return std::abs(a.mean - b.mean) <= 4 * std::hypot(a.standard_error(), b.standard_error());
      };
      CHECK(same(asked, met));
      CHECK(same(asked, weighed));
      CHECK(same(met, weighed));
      for (const auto& way : {asked, met, weighed})
        CHECK(std::abs(way.mean - paths.value) <= 4 * std::hypot(way.standard_error(), paths.error));
      CHECK(weighed.standard_error() < 0.01 * weighed.mean);
      CHECK(weighed.standard_error() < std::max(asked.standard_error(), met.standard_error()));
    }
}

TEST_CASE("path: what passes translucent sheets is not light, and shadows have shades") {
  const World world = world_of(ball(0.5, 0.5), diffuse(), {}, {});
  const Mean through = mean(world, *path_integrator(8), {{0, 0, 2}, {0, 0, -1}}, 4000);
  CHECK(through.value == 0);
  CHECK(through.passed == Approx(0.25).epsilon(0.1));
  CHECK(mean(world, *path_integrator(0), {{0, 0, 2}, {0, 0, -1}}, 4000).passed == Approx(0.25).epsilon(0.1));
  CHECK(world.passes({{0, 0, 2}, {0, 0, -1}}).x == Approx(0.25));
  CHECK(world.passes({{0, 0, 2}, {0, 0, -1}, 2}).x == Approx(0.5));
  CHECK(world.passes({{0, 0, 2}, {0, 0, -1}, 1}).x == 1);
  const World opaque = world_of(ball(0.5), diffuse(), {}, {});
  CHECK(opaque.passes({{0, 0, 2}, {0, 0, -1}}) == Vec3f());
}

TEST_CASE("path: a mirror shows what it faces, and direct light alone is whitted's") {
  SurfaceMaterial m = preset_material(MaterialPreset::mirror);
  m.base_color = {1, 1, 1};
  const DiscLight disc{{0, 0, 1.5f}, {0, 0, -1}, 0.8f, {3, 3, 3}};
  const World world = world_of(ball(1), m, {disc}, {});
  for (const auto& integrator : {path_integrator(4), whitted_integrator(4)}) {
    const Mean up = mean(world, *integrator, {{0, 0, 1.2f}, {0, 0, -1}}, 200),
               down = mean(world, *integrator, {{0, 0, -1.2f}, {0, 0, 1}}, 200);
    CHECK(up.value == Approx(3).epsilon(0.01));
    CHECK(down.value == 0);
  }
}

TEST_CASE("occlusion: an open ball is as bright as its colour, the inside of one dark") {
  const World world = world_of(ball(0.6), diffuse(), {}, {});
  const Mean open = mean(world, *occlusion_integrator(0.1f), {{0, 0, 2}, {0, 0, -1}}, 500);
  CHECK(open.value == Approx(0.6).epsilon(0.01));
  CHECK(mean(world, *occlusion_integrator(10), from_inside, 500).value == 0);
}

TEST_CASE("integrators: paths that are followed together see what each sees by itself, through veils and in front of others") {
  Scene opaque, veiled;
  opaque.items.emplace_back(test::item(test::torus(60, 40)));
  opaque.items.emplace_back(test::item(test::sphere(20, 0.4)));
  veiled = opaque;
  SurfaceItem veil = test::item(test::sphere(20, 0.6));
  veil.opacity = 0.4;
  veiled.items.emplace_back(veil);
  const std::vector<AnyLight> lights = {PointLight{{0.5f, 0.3f, 2}, {2, 2, 2}}, DiscLight{{-0.5f, 0, 1.5f}, {0, 0, -1}, 0.4f, {3, 2, 1}}};
  SurfaceMaterial skin = preset_material(MaterialPreset::skin);
  skin.coat_weight = 0.5;
  size_t lit = 0, parts = 0;
  for (const Scene* scene : {&opaque, &veiled})
    for (const SurfaceMaterial& material : {diffuse(), preset_material(MaterialPreset::glass), skin}) {
      const World world = world_of(*scene, material, lights, Environment(Vec3f{0.1f, 0.2f, 0.3f}));
      for (const auto& integrator : {occlusion_integrator(0.5f), path_integrator(4), whitted_integrator(4)}) {
        Sampler sampler(SamplerKind::blue_noise, 3, 4);
        size_t seen = 0, wrong = 0, part = 0;
        for (int square = 0; square < 40; ++square) {
          std::vector<CameraPath> paths;
          for (int i = 0; i < 1 + square * 13 % 64; ++i) {
            const auto x = uint32_t(8 * square % 40 + i % 8), y = uint32_t(square / 5 * 8 + i / 8);
            const Vec3f from{float(x) / 20 - 1, float(y) / 32 - 1, 3};
            paths.push_back({{from, normalize(Vec3f{0.02f, -0.03f, -1})}, {}, x, y, uint32_t(square % 4), 2});
          }
          std::vector<Estimate> together(paths.size());
          integrator->along_all(world, paths, sampler, together.data());
          for (size_t i = 0; i < paths.size(); ++i) {
            const Integrator& one = *integrator;
            const Estimate alone = one.along(world, paths[i], sampler);
            seen += alone.passed<1, part += alone.passed> 0 && alone.passed < 1, lit += !(alone.radiance == Vec3f());
            wrong += !(alone.radiance == together[i].radiance) || alone.passed != together[i].passed;
          }
        }
        CHECK(seen > 300);
        CHECK(wrong == 0);
        parts += part;
      }
    }
  CHECK(lit > 3000);
  CHECK(parts > 100);
}

TEST_CASE("trace: pictures are the same bytes for any number of threads, and say how exact they are") {
  Scene scene;
  scene.items.emplace_back(test::item(test::sphere(20, 1)));
  Camera camera = fit_camera(scene_bounds(scene), {1, -2, 1}, {0, 0, 1}, 4.0 / 3);
  Context context;
  const PreparedScenePtr prepared = prepare_scene(scene, context);
  const Projection p = make_projection(camera, 60, 45);
  LightOptions options;
  options.noise = 0.05;
  const int before = thread_count();
  TraceReport one, many;
  set_thread_count(1);
  const Frame a = trace_scene(scene, prepared, p, options, one, context);
  set_thread_count(4);
  const Frame b = trace_scene(scene, prepared, p, options, many, context);
  set_thread_count(before);
  CHECK(std::equal(a.rgba.begin(), a.rgba.end(), b.rgba.begin()));
  CHECK(std::equal(a.ids.begin(), a.ids.end(), b.ids.begin()));
  CHECK(one.noise == many.noise);
  CHECK(one.reached);
  CHECK(one.noise <= 0.05);
  // The corner sees the background, the middle the ball where the rasterizer draws it.
  CHECK(a.rgba[3] == 0);
  const size_t middle = (22 * 60 + 30);
  CHECK(a.rgba[4 * middle + 3] == Approx(1));
  CHECK(a.ids[middle] == 1);
  CHECK(a.depth[middle] == Approx(length(camera.position) - 1).epsilon(0.01));
  options.noise = 1e-4, options.paths = 32;
  trace_scene(scene, prepared, p, options, one, context);
  CHECK_FALSE(one.reached);
  options.paths = 0;
  CHECK_THROWS_AS(trace_scene(scene, prepared, p, options, one, context), Error);
}

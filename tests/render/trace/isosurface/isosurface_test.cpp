// SPDX-License-Identifier: Apache-2.0
// Level sets that rays meet: where they are known, closed, of every kind of mesh, and as contours look.
#include "render/trace/isosurface/isosurface.h"

#include "base/random.h"
#include "filter/scalar/contour/contour.h"
#include "render/trace/integrators/integrator.h"
#include "render/trace/media/media_support.h"
#include "render/trace/trace.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;
using doctest::Approx;

namespace {

VolumeItem levels_of(DatasetPtr data, std::vector<double> levels, double opacity = 1, Vec3f color = {1, 1, 1}) {
  VolumeItem v = item(std::move(data), one_color(color), {});
  v.mode = RayFunction::isosurface, v.levels = std::move(levels);
  v.opacity.points = {{-100, opacity}, {100, opacity}};
  v.shaded = true;
  return v;
}

World isosurface_world(const Scene& scene, const SurfaceMaterial& material, Environment environment) {
  Context context;
  const PreparedScenePtr prepared = prepare_scene(scene, context);
  Isosurfaces isosurfaces = isosurfaces_of(scene, parallel_view(8, 8, 1), context);
  GeometryOptions options;
  options.more = isosurfaces.objects;
  return {prepared,
          Geometry::make(*prepared, options, context),
          std::vector(isosurfaces.looks.size(), std::make_shared<const trace::Material>(material)),
          {},
          std::move(environment),
          nullptr,
          isosurfaces.looks};
}

SurfaceMaterial matte() {
  SurfaceMaterial m;
  m.specular_weight = 0;
  return m;
}

double slanted(Vec3 p) { return 0.3 * p.x - 0.4 * p.y + 1.2 * p.z; }
double to_middle(Vec3 p) { return 0.8 - length(p); }

}  // namespace

TEST_CASE("isosurface: a plane is met where it is, faces smaller values, and is left without meeting it again") {
  for (const DatasetPtr& data : {grid(cube(9, -1, 1), slanted), tets_of(slanted)}) {
    const World world = isosurface_world(scene_of({levels_of(data, {0.25})}), matte(), {});
    const Vec3 normal = normalize(Vec3{0.3, -0.4, 1.2});
    const double offset = 0.25 / 1.3;
    size_t met = 0;
    for (uint64_t i = 0; i < 2000; ++i) {
      const Vec3 to{random_unit(1, 3 * i) - 0.5, random_unit(1, 3 * i + 1) - 0.5, random_unit(1, 3 * i + 2) - 0.5};
      const double turn = 6.28 * random_unit(2, i), z = 2 * random_unit(3, i) - 1, r = std::sqrt(1 - z * z);
      const Vec3 direction{r * std::cos(turn), r * std::sin(turn), z}, from = to - direction * 3.0;
      const Ray ray = ray_of(world.geometry().placement(), from, direction);
      Hit hit;
      if (!world.geometry().nearest(ray, hit)) continue;
      ++met;
      const SurfacePoint p = world.geometry().at(ray, hit);
      CHECK(std::abs(dot(world.geometry().placement().world(p.position), normal) - offset) < 2e-6);
      CHECK(dot(Vec3(p.face_normal), normal) == Approx(-1).epsilon(1e-4));
      for (const Vec3f away : {p.face_normal, -p.face_normal, normalize(p.face_normal + p.tangent * 50.f)}) {
        Hit again;
        CHECK(!world.geometry().nearest({leave(p, away), away}, again));
      }
    }
    CHECK(met > 500);
  }
}

TEST_CASE("isosurface: no ray gets out of a closed one, and the nearest level is the one that is met") {
  for (const DatasetPtr& data : {grid(cube(24, -1, 1), to_middle), tets_of(to_middle)}) {
    const World world = isosurface_world(scene_of({levels_of(data, {0.1, 0.3})}), matte(), {});
    for (uint64_t i = 0; i < 3000; ++i) {
      const double turn = 6.28 * random_unit(2, i), z = 2 * random_unit(3, i) - 1, r = std::sqrt(1 - z * z);
      const Vec3 direction{r * std::cos(turn), r * std::sin(turn), z};
      Hit inner, outer;
      REQUIRE(world.geometry().nearest(ray_of(world.geometry().placement(), {0.05, -0.04, 0.02}, direction), inner));
      CHECK(inner.primitive == 1);
      REQUIRE(world.geometry().nearest(ray_of(world.geometry().placement(), direction * 2.0, -direction), outer));
      CHECK(outer.primitive == 0);
    }
  }
}

TEST_CASE("isosurface: the inside of a body is within it, whether values grow inwards or outwards") {
  for (const double sign : {1.0, -1.0}) {
    const auto f = [&](Vec3 p) { return sign * to_middle(p); };
    for (const DatasetPtr& data : {grid(cube(24, -1, 1), f), tets_of(f)}) {
      const World world = isosurface_world(scene_of({levels_of(data, {0})}), matte(), {});
      const Ray ray = ray_of(world.geometry().placement(), {0.1, -0.2, 3}, {0, 0, -1});
      Hit hit;
      REQUIRE(world.geometry().nearest(ray, hit));
      const SurfacePoint p = world.geometry().at(ray, hit);
      CHECK(p.face_normal.z > 0.9f);
      CHECK(p.shading_normal.z > 0.9f);
    }
  }
}

TEST_CASE("isosurface: of two volumes the nearer one is met, whichever comes first") {
  const DatasetPtr data = grid(cube(24, -1, 1), to_middle);
  for (const double first : {0.1, 0.4}) {
    const World world = isosurface_world(scene_of({levels_of(data, {first}), levels_of(data, {0.5 - first})}), matte(), {});
    Hit hit;
    REQUIRE(world.geometry().nearest(ray_of(world.geometry().placement(), {0.1, 0.05, 2}, {0, 0, -1}), hit));
    CHECK(world.id(hit) == (first == 0.1 ? 1 : 2));
    hit = Hit();
    REQUIRE(world.geometry().nearest(ray_of(world.geometry().placement(), {0.1, 0.05, 0}, {0, 0, -1}), hit));
    CHECK(world.id(hit) == (first == 0.1 ? 2 : 1));
  }
}

TEST_CASE("isosurface: levels are surfaces of their own, each one surface all over") {
  const World world = isosurface_world(scene_of({levels_of(grid(cube(24, -1, 1), to_middle), {0.1, 0.3})}), matte(), {});
  const Placement& p = world.geometry().placement();
  const auto hit_from = [&](Vec3 from, Vec3 direction) {
    Hit hit;
    REQUIRE(world.geometry().nearest(ray_of(p, from, direction), hit));
    return hit;
  };
  const Hit outer = hit_from({0.1, 0, 2}, {0, 0, -1}), there = hit_from({-2, 0, 0.1}, {1, 0, 0}), inner = hit_from({0, 0, 0.1}, {0, 0, 1});
  const SurfacePoint at = world.geometry().at(ray_of(p, {0.1, 0, 2}, {0, 0, -1}), outer);
  CHECK(world.same_surface(at, there));
  CHECK(!world.same_surface(at, inner));
}

TEST_CASE("isosurface: white ones are invisible in even light, whatever they are made of") {
  for (const DatasetPtr& data : {grid(cube(17, -1, 1), to_middle), tets_of(to_middle)})
    for (const MaterialPreset preset : {MaterialPreset::matte, MaterialPreset::glass, MaterialPreset::plastic}) {
      SurfaceMaterial made_of = preset_material(preset);
      made_of.base_color = {1, 1, 1};
      CAPTURE(int(preset));
      VolumeItem level = levels_of(data, {0.2});
      level.shaded = false;  // rounded normals reflect a few per cent into the surface where cells are as coarse as here
      const World world = isosurface_world(scene_of({level}), made_of, Environment(Vec3f{1, 1, 1}));
      for (const double x : {0.0, 0.3, 0.5}) {
        const Mean got = seen(world, {x, 0.1, 3}, {0, 0, -1}, 2000);
        CHECK(std::abs(got.value + got.passed - 1) <= 4 * got.error + 0.006);
      }
    }
}

TEST_CASE("isosurface: what is translucent lets (1 - opacity)^n pass at n levels") {
  const World world = isosurface_world(scene_of({levels_of(grid(cube(24, -1, 1), to_middle), {0.1, 0.3, 0.5}, 0.25)}), matte(), {});
  const Ray ray = ray_of(world.geometry().placement(), {0.02, 0.03, 3}, {0, 0, -1});
  CHECK(world.passes(ray).x == Approx(std::pow(0.75, 6)).epsilon(1e-5));
}

TEST_CASE("isosurface: lit as the contour of the same field is, by every number of threads") {
  const DatasetPtr data = grid(cube(32, -1, 1), to_middle);
  Scene level = scene_of({levels_of(data, {0.2}, 1, {0.5f, 0.5f, 0.5f})}), mesh;
  SurfaceMaterial made_of = matte();
  std::get<VolumeItem>(level.items[0]).made_of = made_of;
  Context context;
  SurfaceItem s;
  ContourParams at;
  at.values = {0.2};
  s.data = contour(data, at, context);
  s.made_of = made_of;
  const float grey = srgb_encode(0.5f);
  s.color = {grey, grey, grey};
  mesh.items.emplace_back(s);
  const Projection view = perspective_view(40, 40, 60, {0, -3, 1}, {0, 0, 0}, {0, 0, 1});
  LightOptions options;
  options.paths = 64, options.noise = 1e-9;
  const int before = thread_count();
  const auto picture = [&](const Scene& scene, int threads) {
    set_thread_count(threads);
    Context c;
    TraceReport report;
    return trace_scene(scene, prepare_scene(scene, c), view, options, report, c);
  };
  const Frame a = picture(level, 1), b = picture(mesh, 1);
  double sum = 0;
  for (size_t i = 0; i < a.rgba.size(); ++i) sum += double(a.rgba[i] - b.rgba[i]) * double(a.rgba[i] - b.rgba[i]);
  CHECK(std::sqrt(sum / double(a.rgba.size())) < 0.03);  // silhouettes and noise
  CHECK(a.ids == b.ids);
  CHECK(same_bytes(a, picture(level, 3)));
  set_thread_count(before);
}

// SPDX-License-Identifier: Apache-2.0
// Level sets whose colour and matter follow fields of the data, and pictures that fields place: as on any other surface.
#include "render/trace/isosurface/level_patches.h"

#include "base/random.h"
#include "filter/field/calc/calc.h"
#include "filter/scalar/contour/contour.h"
#include "render/trace/integrators/integrator.h"
#include "render/trace/integrators/surface_color.h"
#include "render/trace/isosurface/isosurface.h"
#include "render/trace/media/media_support.h"
#include "render/trace/trace.h"
#include "scene/show/surface.h"
#include "scene/show/volume.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;
using doctest::Approx;

namespace {

double into_ball(Vec3 p) { return 0.8 - length(p); }

DatasetPtr with(DatasetPtr data, const char* name, const char* expr) {
  Context context;
  CalcParams p;
  p.expr = expr, p.name = name;
  return calc(data, p, context);
}

/// All kinds of mesh over [-1, 1]^3 with the distance into a ball, `rise` from 0 to 1 along x, `along` everywhere the same direction, and
/// `place` (x, y, 0).
std::vector<DatasetPtr> meshes() {
  std::vector<DatasetPtr> all{grid(cube(33, -1, 1), into_ball), tets_of(into_ball), curvilinear_of(into_ball)};
  for (DatasetPtr& d : all) {
    const std::string first = d->fields()[0].name;
    d = with(with(with(d, "rise", "(x+1)/2"), "along", "vec(0,1,2)"), "place", "vec(x,y,0)");
    REQUIRE(d->fields()[0].name == first);
  }
  return all;
}

VolumeShow shown_level(const DatasetPtr& d) {
  VolumeShow p;
  p.mode = RayFunction::isosurface, p.levels = {0.2}, p.coloring.field = {d->fields()[0].name};
  return p;
}

World world_of(const DatasetPtr& data, const VolumeShow& p) {
  Context context;
  Scene scene;
  add(scene, data, p, context);
  const PreparedScenePtr prepared = prepare_scene(scene, context);
  Isosurfaces isosurfaces = isosurfaces_of(scene, parallel_view(8, 8, 1), context);
  GeometryOptions options;
  options.more = isosurfaces.objects;
  std::vector<std::shared_ptr<const trace::Material>> materials;
  for (const Isosurfaces::Look& l : isosurfaces.looks)
    materials.push_back(std::make_shared<const trace::Material>(l.made_of.value_or(data_material()), 1, 1, true));
  return {prepared, Geometry::make(*prepared, options, context), std::move(materials), {}, {}, nullptr, isosurfaces.looks};
}

/// Calls f(place, vertex) where rays from around meet it.
template <class F>
void each_vertex(const World& world, F&& f) {
  int met = 0;
  for (uint64_t i = 0; i < 300; ++i) {
    const double turn = 6.28 * random_unit(2, i), z = 2 * random_unit(3, i) - 1, r = std::sqrt(1 - z * z);
    const Vec3 out{r * std::cos(turn), r * std::sin(turn), z};
    const Ray ray = ray_of(world.geometry().placement(), out * 0.95 + Vec3(0.01, 0.02, 0.03), -out);
    Hit hit;
    if (!world.geometry().nearest(ray, hit)) continue;
    ++met;
    const Vertex v = world.at(ray, hit);
    f(world.geometry().placement().world(v.point.position), v);
  }
  CHECK(met > 250);
}

}  // namespace

TEST_CASE("isosurface: colours follow another field, with paths and without, on every kind of mesh") {
  for (const DatasetPtr& data : meshes()) {
    VolumeItem v = item(data, one_color({1, 1, 1}), {{{-100, 1}, {100, 1}}});
    v.field = data->fields()[0].name, v.shaded = false;
    v.mode = RayFunction::isosurface, v.levels = {0.2};
    v.detail.second = SecondAxis::field, v.detail.second_field = "rise", v.detail.color_by_second = true,
    v.detail.second_color = grey(0, 1);
    const Scene scene = scene_of({v});
    Context context;
    const PreparedScenePtr prepared = prepare_scene(scene, context);
    Isosurfaces isosurfaces = isosurfaces_of(scene, parallel_view(8, 8, 1), context);
    GeometryOptions options;
    options.more = isosurfaces.objects;
    const World world{prepared,
                      Geometry::make(*prepared, options, context),
                      {std::make_shared<const trace::Material>(data_material())},
                      {},
                      {},
                      nullptr,
                      isosurfaces.looks};
    const Frame seen = look(scene, 0.3, 0.2);
    CHECK(double(seen.rgba[0]) == Approx(0.65).epsilon(2e-3));
    for (const double x : {-0.5, 0.0, 0.4}) {
      const Ray ray = ray_of(world.geometry().placement(), {x, 0.1, 2}, {0, 0, -1});
      Hit hit;
      REQUIRE(world.geometry().nearest(ray, hit));
      CHECK(double(world.color(ray, hit).x) == Approx((x + 1) / 2).epsilon(2e-3));
    }
  }
}

TEST_CASE("isosurface: numbers of its material, its light and its stretch are those of fields at the place") {
  for (const DatasetPtr& data : meshes()) {
    VolumeShow p = shown_level(data);
    p.material.coat_weight = 1;
    p.varying.by[size_t(MaterialFactor::coat)] = {"rise"}, p.varying.by[size_t(MaterialFactor::roughness)] = {"rise"};
    p.varying.emission_by = {"rise"}, p.varying.specular_direction = {"along"};
    each_vertex(world_of(data, p), [&](Vec3 at, const Vertex& v) {
      const double rise = (at.x + 1) / 2;
      CHECK(double(v.bsdf.material_shares().coat) == Approx(rise).epsilon(0.002));
      CHECK(double(v.emission.x) == Approx(rise).epsilon(0.002));
      const Vec3 n(v.frame.z), along = normalize(Vec3(0, 1, 2) - n * dot(n, Vec3(0, 1, 2)));
      CHECK(dot(Vec3(v.frame.x), along) > 0.9999);
      // Kept in steps of 1/32.
      const Vec3f off = normalize(Vec3f{0.3f, 0.1f, 1});
      const double seen = double(v.material->ggx.normals(off)), below = double(Ggx::of_roughness(float(rise - 0.04)).normals(off)),
                   above = double(Ggx::of_roughness(float(std::min(rise + 0.04, 1.0))).normals(off));
      if (rise > 0.1 && v.material->ggx.isotropic()) CHECK((seen - below) * (seen - above) <= 0);
    });
  }
}

TEST_CASE("isosurface: pictures lie where the coordinates say, and bend its normal") {
  for (const DatasetPtr& data : meshes()) {
    VolumeShow p = shown_level(data);
    p.picture.pattern = TexturePattern::checker, p.picture.picture_coordinates = {"place"}, p.picture.picture_repeats = {2};
    const auto square = [](double x) { return std::floor(4 * x); };
    int light = 0, dark = 0;
    each_vertex(world_of(data, p), [&](Vec3 at, const Vertex& v) {
      for (const double x : {at.x, at.y})
        if (std::abs(4 * x - std::round(4 * x)) < 0.02) return;
      const bool even = std::fmod(std::abs(square(at.x) + square(at.y)), 2) == 0;
      ++(even ? light : dark);
      CHECK(double(v.bsdf.base_color().x) == Approx(even ? 1 : 0.12));
    });
    CHECK(light > 50), CHECK(dark > 50);
  }
  // A picture of normals that are turned by an angle, along which the coordinates rise: on a plane.
  const double turn = 0.3;
  const DatasetPtr plane = with(grid(cube(9, -1, 1), [](Vec3 p) { return p.z; }), "place", "vec(2*x+y,y,0)");
  Context context;
  Scene scene;
  VolumeShow p = shown_level(plane);
  p.material.material = MaterialPreset::matte;
  add(scene, plane, p, context);
  auto pictures = std::make_shared<SurfacePictures>();
  SurfacePicture normal;
  normal.coordinates = "place";
  normal.texture = std::make_shared<const Texture>(
      1, 1, std::vector<Vec4f>{{float(0.5 + 0.5 * std::sin(turn)), 0.5f, float(0.5 + 0.5 * std::cos(turn)), 1}});
  pictures->normal = normal;
  const LevelPatches patches(*pictures, *std::get<VolumeItem>(scene.items[0]).made_of, plane, 0.01, context);
  // x of the picture rises fastest where y of it does not: along (1, 0, 0).
  const auto patch = patches.at({0.1, 0.2, 0.2}, {0, 0, 1}, {1, 1, 1, 1});
  REQUIRE(patch);
  const Vec3f bent = surface_normal(*patch, {{0.1f, 0.2f, 1}, {0, 0, -1}}, {}, {}, 1, {0, 0, 1});
  CHECK(double(bent.x) == Approx(std::sin(turn)).epsilon(1e-3));
  CHECK(std::abs(bent.y) < 1e-3f);
  CHECK(patches.at({0.1, 0.2, 3}, {0, 0, 1}, {1, 1, 1, 1}) == nullptr);
  // At the border of the data, where a corner would be beyond it.
  const auto border = patches.at({1, 1, 0.2}, {0, 0, 1}, {1, 1, 1, 1});
  REQUIRE(border);
  CHECK(double(surface_normal(*border, {{1, 1, 1}, {0, 0, -1}}, {}, {}, 1, {0, 0, 1}).x) == Approx(std::sin(turn)).epsilon(1e-3));
}

TEST_CASE("isosurface: with fields and pictures it looks as the contour with them, by every number of threads") {
  const DatasetPtr data = meshes()[0];
  Context context;
  Scene level, mesh;
  VolumeShow v = shown_level(data);
  SurfaceShow s;
  s.coloring.field = {"none"};
  const auto both = [&](auto&& f) { f(v), f(s); };
  both([](auto& p) {
    p.picture.pattern = TexturePattern::noise, p.picture.picture_coordinates = {"place"};
    p.varying.by[size_t(MaterialFactor::roughness)] = {"rise"}, p.varying.by[size_t(MaterialFactor::metalness)] = {"rise"};
    p.material.base_metalness = 1;
  });
  add(level, data, v, context);
  ContourParams at;
  at.values = {0.2};
  add(mesh, contour(data, at, context), s, context);
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
  double sum = 0, mean = 0;
  for (size_t i = 0; i < a.rgba.size(); ++i) sum += std::pow(double(a.rgba[i] - b.rgba[i]), 2), mean += double(a.rgba[i] - b.rgba[i]);
  CHECK(std::sqrt(sum / double(a.rgba.size())) < 0.04);  // silhouettes and noise
  CHECK(std::abs(mean / double(a.rgba.size())) < 0.002);
  CHECK(same_bytes(a, picture(level, 3)));
  set_thread_count(before);
}

TEST_CASE("isosurface: fields and pictures that it cannot have are refused by name") {
  const DatasetPtr data = meshes()[0];
  Context context;
  const auto error = [&](auto&& change) {
    VolumeShow p = shown_level(data);
    change(p);
    return sg::test::error_of([&] {
      check(p);
      Scene scene;
      add(scene, data, p, context);
    });
  };
  using sg::test::contains;
  CHECK(contains(error([](VolumeShow& p) { p.picture.pattern = TexturePattern::checker; }), "texture coordinates"));
  CHECK(contains(error([](VolumeShow& p) { p.varying.emission_by = {"nothing"}; }), "nothing"));
  CHECK(contains(error([](VolumeShow& p) { p.varying.emission_by = {"rise"}, p.mode = RayFunction::composite; }), "mode=isosurface"));
  CHECK(
      contains(error([](VolumeShow& p) { p.picture.pattern = TexturePattern::noise, p.mode = RayFunction::maximum; }), "mode=isosurface"));
  CHECK(contains(error([](VolumeShow& p) { p.color_by = {"rise"}, p.mode = RayFunction::average; }), "color_by"));
}

// SPDX-License-Identifier: Apache-2.0
// Every integrator shows the same picture, of all that it can find: means of nine regions and of the whole within four standard errors, of
// independent pictures with seeds from 100 on, Metropolis' as all others' (their spread is its batch error).
#include <cmath>

#include "light_scenes.h"
#include "scene/show/surface.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;

namespace {

constexpr int seeds = 20;

/// `light` where nothing is seen by mirrors or glass, `path` where nothing is focused from a point.
void check_all(const LightScene& s, bool with_light = true, double precise = 0.03, int more = 1) {
  const LitWorld w(s);
  const Means path = pictures_by(w, IntegratorKind::path, seeds, 64 * more);
  CAPTURE(path.back().mean);
  CHECK(path.back().standard_error() < precise * path.back().mean);  // the check means something
  struct Way {
    IntegratorKind kind;
    int paths;
  };
  for (const Way way : {Way{IntegratorKind::bdpt, 8}, Way{IntegratorKind::light, 32}, Way{IntegratorKind::metropolis, 32}}) {
    if (way.kind == IntegratorKind::light && !with_light) continue;
    CAPTURE(way.kind);
    const Means other = pictures_by(w, way.kind, seeds, way.paths * more);
    CHECK(other.back().standard_error() < precise * path.back().mean);
    check_same(path, other);
  }
}

const Vec3f white{1, 1, 1};
const RectangleLight on_ceiling{{-0.4f, -0.4f, 0.85f}, {0, 0.8f, 0}, {0.8f, 0, 0}, white * 3};

LightScene room() {
  LightScene s;
  add_room(s);
  s.camera = look({0, -2.6, 0}, {0, 0, 0}, 40);
  return s;
}

LightScene on_floor() {
  LightScene s;
  add_floor(s);
  s.camera = look({0, -2.2, 1}, {0, 0, -0.6}, 40);
  return s;
}

}  // namespace

TEST_CASE("all the same: a diffuse room under a rectangle that shines") {
  LightScene s = room();
  s.lights = {on_ceiling};
  check_all(s);
}

TEST_CASE("all the same: a diffuse room with a lamp that is a disc, and one that is a ball") {
  LightScene s = room();
  s.lights = {DiscLight{{0, 0, 0.8f}, normalize(Vec3f{0.2f, 0, -1}), 0.3f, white * 4}, SphereLight{{0.2f, 0.1f, 0.4f}, 0.3f, white * 2}};
  check_all(s);
}

TEST_CASE("all the same: inside of a diffuse ball with a lamp without a size in its middle, which is known") {
  LightScene s;
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0}, 3);
  PointsItem item;
  item.data = make_dataset(Mesh(cloud));
  const float grey = srgb_encode(0.5f);
  item.color = {grey, grey, grey};
  s.scene.items.emplace_back(item);
  s.point_radius = 0.9, s.bounces = 6;
  s.camera = look({0.1, 0.05, -0.1}, {1, 2, 3}, 60);
  const float i = 3.14159265f * 0.9f * 0.9f;
  s.lights = {PointLight{{0, 0, 0}, {i, i, i}}};
  check_all(s);
  // albedo I / (pi R^2) (1 + albedo + ... albedo^(turns - 1))
  const Means bdpt = pictures_by(LitWorld(s), IntegratorKind::bdpt, 8, 8);
  CHECK(std::abs(bdpt.back().mean - (1 - std::pow(0.5, 6))) <= 4 * bdpt.back().standard_error() + 2e-3);
}

TEST_CASE("all the same: light that a mirror throws on the floor") {
  LightScene s = on_floor();
  SurfaceMaterial mirror = preset_material(MaterialPreset::mirror);
  mirror.base_color = {1, 1, 1};
  s.scene.items.emplace_back(sheet({-0.6f, 0.85f, -0.8f}, {1.2f, 0, 0}, {0, 0, 1.2f}, mirror, 1));
  s.lights = {DiscLight{{0, -0.6f, 0.5f}, normalize(Vec3f{0, 1, -0.5f}), 0.3f, white * 5}};
  check_all(s, false);
  // Beside the mirror, where paths from lights see all of it.
  s.camera = look({0, -1.5, 0.6}, {0, -0.1, -0.9}, 18);
  check_all(s);
}

TEST_CASE("all the same: a glass ball's caustic under a lamp with a size") {
  LightScene s = on_floor();
  s.scene.items.emplace_back(ball({0, 0.1f, -0.35f}, 0.4f, 24, preset_material(MaterialPreset::glass), 1));
  s.lights = {SphereLight{{0.1f, 0, 0.75f}, 0.25f, white * 12}};
  s.bounces = 6;
  check_all(s, false, 0.06, 2);
  s.camera = look({0, -1.2, -0.74}, {0, 0, -0.9}, 10);  // under the ball
  check_all(s, true, 0.06, 2);
}

TEST_CASE("all the same: rough glass that absorbs, with something in it") {
  LightScene s = on_floor();
  SurfaceMaterial glass = preset_material(MaterialPreset::frosted_glass);
  glass.transmission_color = {0.9, 0.5, 0.3}, glass.transmission_depth = 0.4;
  s.scene.items.emplace_back(ball({0, 0.1f, -0.45f}, 0.4f, 24, glass, 1));
  s.scene.items.emplace_back(ball({0.05f, 0.1f, -0.4f}, 0.15f, 12, diffuse(), 0.7));
  s.lights = {DiscLight{{0, -0.5f, 0.8f}, normalize(Vec3f{0, 0.4f, -1}), 0.4f, white * 6}};
  s.bounces = 6;
  check_all(s, true, 0.06);
}

TEST_CASE("all the same: rough glass that stands in rough water, both of which absorb") {
  LightScene s = on_floor();
  SurfaceMaterial glass = preset_material(MaterialPreset::frosted_glass), water = glass;
  glass.dielectric_priority = 2, glass.transmission_color = {0.9, 0.5, 0.3}, glass.transmission_depth = 0.4;
  water.dielectric_priority = 1, water.transmission_color = {0.3, 0.6, 0.9}, water.transmission_depth = 0.4, water.specular_ior = 1.33;
  s.scene.items.emplace_back(ball({-0.1f, 0.1f, -0.4f}, 0.4f, 24, water, 1));
  s.scene.items.emplace_back(ball({0.2f, 0.1f, -0.4f}, 0.3f, 24, glass, 1));
  s.scene.items.emplace_back(ball({0.05f, 0.1f, -0.4f}, 0.1f, 12, diffuse(), 0.7));
  s.lights = {DiscLight{{0, -0.5f, 0.8f}, normalize(Vec3f{0, 0.4f, -1}), 0.4f, white * 6}};
  s.bounces = 6;
  check_all(s, true, 0.06);
}

TEST_CASE("all the same: lamps in matter that absorbs, which are met and asked for") {
  LightScene s = on_floor();
  SurfaceMaterial matter = preset_material(MaterialPreset::glass);
  matter.specular_ior = 1, matter.transmission_color = {0.3, 0.5, 0.7}, matter.transmission_depth = 0.5;
  s.scene.items.emplace_back(ball({0, 0, 0}, 0.85f, 24, matter, 1));
  s.scene.items.emplace_back(ball({0, 0.1f, -0.3f}, 0.3f, 12, diffuse(), 0.7));
  s.lights = {SphereLight{{0.2f, -0.2f, 0.3f}, 0.25f, white * 6},
              DiscLight{{-0.9f, -0.5f, 0.6f}, normalize(Vec3f{1, 0.5f, -0.8f}), 0.3f, white * 6}};
  check_all(s, true, 0.06);
}

TEST_CASE("all the same: rough metal, and a coarse ball with rounded normals") {
  LightScene s = on_floor();
  SurfaceMaterial metal = preset_material(MaterialPreset::copper);
  metal.specular_roughness = 0.35;
  s.scene.items.emplace_back(ball({-0.4f, 0.1f, -0.45f}, 0.4f, 24, metal));
  s.scene.items.emplace_back(ball({0.45f, 0.1f, -0.45f}, 0.4f, 4, preset_material(MaterialPreset::plastic)));
  s.lights = {DiscLight{{0, -0.5f, 0.8f}, normalize(Vec3f{0, 0.4f, -1}), 0.4f, white * 4}};
  check_all(s);
}

TEST_CASE("all the same: an even sky, and a picture of a sky") {
  LightScene s = on_floor();
  s.scene.items.emplace_back(ball({0, 0.1f, -0.45f}, 0.4f, 24, diffuse(), 0.5));
  s.environment = Environment(white * 0.8f);
  check_all(s);
  std::vector<Vec3f> sky(16 * 8, white * 0.1f);
  sky[2 * 16 + 5] = white * 8;
  s.environment = Environment(sky, 16, {0, 0, 1}, {0, -1, 0}, 1);
  check_all(s);
}

TEST_CASE("all the same: a sun with a size, and one without") {
  for (const float rise : {0.01f, 0.f}) {
    LightScene s = on_floor();
    s.scene.items.emplace_back(ball({0, 0.1f, -0.45f}, 0.4f, 24, diffuse(), 0.5));
    s.lights = {DistantLight{normalize(Vec3f{0.3f, -0.5f, 1}), white * 3, rise}};
    check_all(s);
  }
}

TEST_CASE("all the same: meshes that shine, and are seen") {
  LightScene s = on_floor();
  SurfaceMaterial shines = diffuse();
  shines.emission = {1.5, 1, 0.7};
  s.scene.items.emplace_back(ball({0.1f, 0, -0.2f}, 0.3f, 6, shines, 0.4));
  s.scene.items.emplace_back(sheet({-0.8f, 0.7f, -0.8f}, {0, -0.6f, 0}, {0, 0, 0.8f}, shines, 0.4));
  check_all(s);
}

TEST_CASE("all the same: through what lets some light pass, and through sheets of glass") {
  LightScene s = on_floor();
  s.scene.items.emplace_back(sheet({-0.7f, -0.4f, 0.2f}, {0.7f, 0, 0}, {0, 0.9f, 0}, diffuse(), 0.5, 0.5));
  s.scene.items.emplace_back(sheet({0.05f, -0.4f, 0.2f}, {0.7f, 0, 0}, {0, 0.9f, 0}, preset_material(MaterialPreset::thin_glass), 0.9));
  s.lights = {DiscLight{{0, 0, 0.8f}, {0, 0, -1}, 0.3f, white * 6}};
  check_all(s);
}

TEST_CASE("all the same: seen without perspective, under several lamps") {
  LightScene s = room();
  s.camera.parallel = true, s.camera.parallel_height = 1.6;
  s.camera.position = {0.3, -2.6, 0.4};
  s.scene.items.emplace_back(ball({0.2f, 0, -0.5f}, 0.35f, 12, preset_material(MaterialPreset::satin), 0.6));
  s.lights = {on_ceiling, PointLight{{-0.5f, -0.5f, 0.3f}, white * 0.4f}};
  s.environment = Environment(white * 0.2f);
  check_all(s);
}

TEST_CASE("all the same: fog in a room") {
  for (const PhaseKind phase : {PhaseKind::isotropic, PhaseKind::henyey_greenstein}) {
    LightScene s = room();
    s.lights = {on_ceiling};
    VolumeItem fog = matter(0.8f, 0.8, [](Vec3) { return 1.0; }, {0.9f, 0.9f, 0.9f});
    fog.scattering.phase = phase, fog.scattering.anisotropy = 0.7;
    s.scene.items.emplace_back(fog);
    check_all(s, true, 0.04);
  }
}

TEST_CASE("all the same: a cloud that is uneven, over a floor, under a sky and a sun") {
  LightScene s = on_floor();
  s.scene.items.emplace_back(matter(0.6f, 6, [](Vec3 p) { return std::max(0.0, 1 - length(p) / 0.6); }));
  s.lights = {DistantLight{normalize(Vec3f{0.3f, -0.5f, 1}), white * 2, 0.01f}};
  s.environment = Environment(white * 0.3f);
  check_all(s, true, 0.04);
}

TEST_CASE("all the same: matter that scatters once, and matter that glows, lit by a lamp that may be met in it") {
  for (const double glow : {0.0, 0.5}) {
    LightScene s = on_floor();
    VolumeItem cloud = matter(0.6f, 4, [](Vec3 p) { return std::max(0.0, 1 - length(p) / 0.6); });
    cloud.scattering.light = glow > 0 ? VolumeLighting::path : VolumeLighting::single;
    cloud.scattering.glow = glow;
    s.scene.items.emplace_back(cloud);
    s.lights = {SphereLight{{0.3f, -0.3f, 0.3f}, 0.2f, white * 4}};
    check_all(s, glow == 0, 0.04);  // what glows is no lamp that paths begin at
  }
}

TEST_CASE("all the same: surfaces within a volume") {
  LightScene s = on_floor();
  VolumeItem body = matter(0.6f, 20, [](Vec3 p) { return length(p) < 0.4 ? 1.0 : 0.0; }, {0.3f, 0.3f, 0.3f});
  body.shaded = true;
  s.scene.items.emplace_back(body);
  s.lights = {DiscLight{{0, -0.5f, 0.8f}, normalize(Vec3f{0, 0.4f, -1}), 0.3f, white * 4}};
  check_all(s, false, 0.04);
}

TEST_CASE("all the same: smoke in a ball of rough glass") {
  LightScene s = on_floor();
  s.scene.items.emplace_back(ball({0, 0, -0.2f}, 0.6f, 24, preset_material(MaterialPreset::frosted_glass), 1));
  s.scene.items.emplace_back(matter(0.3f, 5, [](Vec3) { return 1.0; }, {0.8f, 0.8f, 0.8f}));
  s.lights = {DiscLight{{0, -0.5f, 0.8f}, normalize(Vec3f{0, 0.4f, -1}), 0.4f, white * 6}};
  s.bounces = 6;
  check_all(s, true, 0.06, 3);
}

TEST_CASE("all the same: through a lens, with perspective and without") {
  for (const bool parallel : {false, true}) {
    LightScene s = room();
    s.scene.items.emplace_back(ball({0.2f, -0.3f, -0.3f}, 0.25f, 12, diffuse(), 0.6));
    s.lights = {on_ceiling};
    s.camera.lens = 0.5, s.camera.focus = 2.8;
    if (parallel) s.camera.parallel = true, s.camera.parallel_height = 1.6;
    check_all(s);
  }
}

TEST_CASE("all the same: numbers of a material that differ over a ball, and stretched highlights") {
  LightScene s = on_floor();
  SurfaceMesh mesh = std::get<SurfaceMesh>(ball({0, 0.1f, -0.4f}, 0.45f, 16, diffuse()).data->mesh());
  std::vector<float> share, index, along;
  for (size_t i = 0; i < mesh.points.count(); ++i) {
    const Vec3 p = mesh.points.at(i) - mesh.points.origin;
    share.push_back(float(0.5 + p.z / 0.9)), index.push_back(float(1.6 - p.x / 0.9)), along.insert(along.end(), {0.2f, 0, 1});
  }
  FieldSet fields;
  fields.add({"share", Association::point, Array::from_vector(std::move(share)), "", Role::none});
  fields.add({"index", Association::point, Array::from_vector(std::move(index)), "", Role::none});
  fields.add({"along", Association::point, Array::from_vector(std::move(along), 3), "", Role::none});
  SurfaceShow show;
  using enum MaterialFactor;
  for (const MaterialFactor f : {roughness, metalness, coat}) show.varying.by[size_t(f)] = {"share"};
  show.varying.by[size_t(ior)] = {"index"}, show.varying.specular_direction = {"along"};
  show.material.specular_weight = 1, show.material.specular_roughness = 0.7, show.material.coat_roughness = 0.4;
  show.coloring.color = "#e0b060";
  Context context;
  add(s.scene, make_dataset(Mesh(std::move(mesh)), std::move(fields)), show, context);
  s.lights = {DiscLight{{0, -0.5f, 0.8f}, normalize(Vec3f{0, 0.4f, -1}), 0.4f, white * 4}};
  s.environment = Environment(white * 0.2f);  // so that no region is all but black
  check_all(s);
}

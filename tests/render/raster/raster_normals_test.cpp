// SPDX-License-Identifier: Apache-2.0
// Normals: bent by pictures, by the rasterizer and along paths, and smooth across the border of two parts.
#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "raster_support.h"
#include "render/prepare/prepared.h"
#include "render/shade/blinn_phong.h"
#include "render/trace/trace.h"
#include "scene/items/surface_pictures.h"
#include "scene/light/light_params.h"

using namespace sg;
using namespace sg::test;
using doctest::Approx;

namespace {

constexpr double degree = std::numbers::pi / 180;

/// The square that front_parallel() sees, by coordinates of its corners from the lower left on, counter-clockwise.
SurfaceItem bent(std::vector<float> uv, Vec3 normal, float scale = 1) {
  FieldSet f;
  f.add({"uv", Association::point, Array::from_vector(std::move(uv), 2), "", Role::tcoords});
  SurfaceItem s = item(quad(1, 0, f), {0.5f, 0.5f, 0.5f});
  auto all = std::make_shared<SurfacePictures>();
  const auto texel = [](double v) { return float((v + 1) / 2); };
  SurfacePicture p;
  p.texture = std::make_shared<const Texture>(1, 1, std::vector<Vec4f>{{texel(normal.x), texel(normal.y), texel(normal.z), 1}});
  p.coordinates = "uv";
  all->normal = std::move(p), all->normal_scale = scale;
  s.pictures = all;
  return s;
}

const std::vector<float> straight{0, 0, 1, 0, 1, 1, 0, 1}, mirrored{1, 0, 0, 0, 0, 1, 1, 1}, turned{0, 1, 0, 0, 1, 0, 1, 1};

Scene lit(SurfaceItem s, Vec3 towards) {
  Scene scene;
  SurfaceMaterial m;
  m.specular_weight = 0;
  s.made_of = m, s.material.specular = 0;
  scene.items.emplace_back(std::move(s));
  scene.lighting.lights = parse_lights(fmt::format("directional angle=0 direction={},{},{}", towards.x, towards.y, towards.z));
  scene.lighting.environment = parse_environment("none");
  scene.background = {0, 0, 0};
  return scene;
}

float by_rasterizer(const Scene& s) { return draw(s, front_parallel(2), 9, 9).rgba(6, 3)[0]; }
float by_paths(const Scene& s) {
  Context context;
  LightOptions options;
  options.integrator = trace::IntegratorKind::path, options.paths = 4;
  TraceReport report;
  const Frame f = trace_scene(s, prepare_scene(s, context), make_projection(front_parallel(2), 9, 9), options, report, context);
  return f.rgba[4 * (3 * 9 + 6)];
}

/// In the picture to the right, up and towards the viewer, along the square's axes.
Vec3 seen_axes(Vec3 v) {
  const Camera c = front_parallel(2);
  const Vec3 forward = normalize(c.target - c.position), right = normalize(cross(forward, c.up)), up = cross(right, forward);
  return right * v.x + up * v.y - forward * v.z;
}

}  // namespace

TEST_CASE("normals by a picture: light is that of the bent normal, whichever way the picture lies on the surface") {
  const Vec3 n{std::sin(25 * degree), 0, std::cos(25 * degree)}, light{std::sin(50 * degree), 0, std::cos(50 * degree)};
  const Vec3 towards = seen_axes(light), flat{0, 0, 1};
  const float even = by_paths(lit(bent(straight, flat), towards));
  CHECK(even > 0.05f);
  const auto ratio = [&](Vec3 normal) { return dot(normal, light) / dot(flat, light); };
  const Vec3 left{-n.x, 0, n.z}, up{0, n.x, n.z};
  struct Case {
    const std::vector<float>& uv;
    Vec3 texel, normal;
    float scale;
  };
  const double twice = 2 * std::tan(25 * degree);
  for (const Case& c : {Case{straight, flat, flat, 1}, Case{straight, n, n, 1}, Case{straight, left, left, 1}, Case{straight, up, up, 1},
                        Case{mirrored, n, left, 1}, Case{straight, n, normalize(Vec3{twice, 0, 1}), 2}, Case{straight, n, left, -1},
                        // The picture's x runs up the surface, its y to the left.
                        Case{turned, up, left, 1}, Case{turned, n, up, 1}}) {
    const Scene s = lit(bent(c.uv, c.texel, c.scale), towards);
    CHECK(double(by_paths(s)) == Approx(double(even) * std::max(0.0, ratio(c.normal))).epsilon(1e-3));
    Material m = std::get<SurfaceItem>(s.items[0]).material;
    float want = 0, gloss = 0;
    const std::vector<Lamp> lamps = lamps_of(lights_of(s), make_projection(front_parallel(2), 9, 9));
    light_point(m, lamps, Vec3f(seen_axes(c.normal)), Vec3f(seen_axes(flat)), want, gloss);
    CHECK(double(by_rasterizer(s)) == Approx(double(raster::linear_light({0.5f, 0.5f, 0.5f}).x * want)).epsilon(1e-3));
  }
}

TEST_CASE("normals by a picture: from below the surface no light comes, and what has no coordinates is as it was") {
  const Vec3 towards = seen_axes({std::sin(50 * degree), 0, std::cos(50 * degree)});
  const float plain = by_rasterizer(lit(item(quad(1, 0), {0.5f, 0.5f, 0.5f}), towards));
  CHECK(by_rasterizer(lit(bent({0, 0, 0, 0, 0, 0, 0, 0}, {1, 0, 0}), towards)) == Approx(plain));
  CHECK(by_rasterizer(lit(bent({NAN, 0, 1, 0, 1, NAN, 0, 1}, {1, 0, 0}), towards)) == Approx(plain));
  CHECK(std::isfinite(by_paths(lit(bent(straight, {0, 0, -1}), towards))));
  CHECK(std::isfinite(by_paths(lit(bent(straight, {0, 0, 0}), towards))));
}

TEST_CASE("occlusion by a picture: it takes from the even light, and no other") {
  SurfaceItem s = bent(straight, {0, 0, 1});
  auto all = std::make_shared<SurfacePictures>(*s.pictures);
  all->occlusion = all->normal, all->normal.reset();
  all->occlusion->texture = std::make_shared<const Texture>(1, 1, std::vector<Vec4f>{{0.25f, 1, 1, 1}});
  all->occlusion_strength = 0.5f;
  SurfaceItem plain = s;
  plain.pictures = nullptr, s.pictures = all;
  const Vec3 towards = seen_axes({0.5, 0, 1});
  const float less = by_rasterizer(lit(plain, towards)) - by_rasterizer(lit(s, towards));
  CHECK(double(less) == Approx(double(raster::linear_light({0.5f, 0.5f, 0.5f}).x * s.material.ambient) * 0.375).epsilon(1e-3));
}

TEST_CASE("smooth normals: a border of two parts of one surface is as smooth as its inside, and as sharp") {
  // A roof of two slopes over a ridge, and a wall under one of them.
  SurfaceMesh m;
  m.points.xyz =
      Array::from_vector(std::vector<float>{-1, 0, 0, -1, 1, 0, 0, 0, 0.2f, 0, 1, 0.2f, 1, 0, 0, 1, 1, 0, 1, 0, -1, 1, 1, -1}, 3);
  m.polygons = {Array::from_vector(std::vector<int32_t>{0, 2, 3, 1, 2, 4, 5, 3, 4, 6, 7, 5}), {}, 4};
  const DatasetPtr whole = make_dataset(Mesh(m));
  const auto part_of = [&](std::vector<int32_t> ids) {
    SurfaceMesh p;
    p.points = m.points, p.polygons = {Array::from_vector(std::move(ids)), {}, 4};
    return make_dataset(Mesh(std::move(p)));
  };
  bool any = false;
  const raster::TriangleSet all = raster::triangulate(whole, any), left = raster::triangulate(part_of({0, 2, 3, 1}), any),
                            right = raster::triangulate(part_of({2, 4, 5, 3}), any);
  const auto normal = [](const raster::NormalSet& n, const raster::TriangleSet& t, size_t corner) {
    const uint32_t at = n.corners.empty() ? t.indices()[corner] : reinterpret_cast<const uint32_t*>(n.corners.raw())[corner];
    const float* v = reinterpret_cast<const float*>(n.normals.raw()) + 3 * size_t(at);
    return Vec3f{v[0], v[1], v[2]};
  };
  const raster::NormalSet together = raster::smooth_normals(all, 40), of_left = raster::smooth_normals(left, 40, &all),
                          of_right = raster::smooth_normals(right, 40, &all);
  for (size_t i = 0; i < 6; ++i) {
    CHECK(length(normal(of_left, left, i) - normal(together, all, i)) < 1e-6f);
    CHECK(length(normal(of_right, right, i) - normal(together, all, 6 + i)) < 1e-6f);
  }
  // By itself it has a crease there.
  CHECK(length(normal(raster::smooth_normals(left, 40), left, 1) - normal(together, all, 1)) > 0.1f);
}

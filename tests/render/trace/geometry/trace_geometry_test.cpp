// SPDX-License-Identifier: Apache-2.0
// A scene as rays see it is the scene as the rasterizer draws it.
#include "filter/glyph/geometry.h"
#include "filter/glyph/shapes.h"
#include "render/raster/raster_support.h"
#include "trace_scene.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;
using sg::test::line;

namespace {

/// n points with vectors, some of which have no length or are no numbers.
DatasetPtr places(size_t n) {
  std::vector<float> xyz, v;
  for (size_t i = 0; i < n; ++i) {
    const Vec3f p = any_place(1, i, 1), d = any_direction(2, i) * (i % 17 == 3 ? 0.0f : i % 19 == 5 ? NAN : uniform(3, i, 0.5, 1.5));
    xyz.insert(xyz.end(), {p.x, p.y, p.z}), v.insert(v.end(), {d.x, d.y, d.z});
  }
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(std::move(v), 3), "", Role::vectors});
  return make_dataset(Mesh(PointCloud{{Array::from_vector(std::move(xyz), 3), {100, 20, 3}}}), std::move(f));
}

}  // namespace

TEST_CASE("trace: an empty scene and one of items without anything are never met") {
  const Geometry none = geometry_of(Scene{});
  CHECK(none.bounds().empty());
  CHECK_FALSE(none.blocked({{0, 0, 1}, {0, 0, -1}}));
  Hit h;
  CHECK_FALSE(none.nearest({{0, 0, 1}, {0, 0, -1}}, h));
  SurfaceItem nothing;
  nothing.data = sg::test::surface({NAN, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2});
  CHECK(geometry_of(nothing).bounds().empty());
}

TEST_CASE("trace: rays through pixels meet the primitives that the rasterizer draws there, as deep") {
  Scene scene;
  scene.items.emplace_back(sg::test::item(sg::test::torus(90, 60, false, {5, 0, 0})));
  scene.items.emplace_back(sg::test::item(sg::test::sphere(30, 1.2f)));
  Camera camera;
  camera.position = {2, -9, 4}, camera.target = {2.5, 0, 0}, camera.up = {0, 0, 1}, camera.view_angle = 40, camera.near_plane = 0.1,
  camera.far_plane = 100;
  const int w = 200, h = 120;
  const auto picture = sg::test::draw(scene, camera, w, h);
  const Projection p = make_projection(camera, w, h);
  Context context;
  const PreparedScenePtr prepared = prepare_scene(scene, context);
  const Geometry g = Geometry::make(*prepared, {}, context);
  const Vec3 forward = normalize(camera.target - camera.position), right = normalize(cross(forward, camera.up)), up = cross(right, forward);
  size_t covered = 0, different = 0, other_depth = 0;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const Vec3 d = normalize(forward + right * ((x + 0.5 - p.middle_x()) / p.scale) + up * ((p.middle_y() - y - 0.5) / p.scale));
      const Ray ray{g.placement().traced(camera.position), Vec3f(d)};
      Hit hit;
      const bool met = g.nearest(ray, hit);
      const uint32_t id = picture.id(x, y);
      covered += met;
      different += met != (id != 0);
      if (!met || id == 0) continue;
      const double depth = double(hit.t) / g.placement().scale * dot(d, forward);
      const SurfacePoint at = g.at(ray, hit);
      const Vec3 world = g.placement().world(at.position);
      CHECK(std::abs(length(world - camera.position) * dot(d, forward) - depth) < 1e-5 * depth);
      other_depth += std::abs(depth - double(picture.depth(x, y))) > 0.02 * depth;
    }
  CHECK(covered > 2000);
  CHECK(different <= covered / 200);  // the rasterizer's 1/256 grid at outlines
  CHECK(other_depth <= covered / 200);
}

TEST_CASE("trace: hidden cells are not met, cells are numbered as drawn") {
  std::vector<uint8_t> ghost{0, ghost_hidden_cell};
  auto d = sg::test::surface({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0}, {0, 1, 2, 0, 2, 3});
  SurfaceMesh m = *d->as<SurfaceMesh>();
  SurfaceItem item;
  DatasetParts parts;
  parts.mesh = std::move(m), parts.cell_ghost = Array::from_vector(std::move(ghost));
  item.data = make_dataset(std::move(parts));
  const Geometry g = geometry_of(item);
  CHECK(g.blocked({{0.3f, -0.3f, 1}, {0, 0, -1}}));
  CHECK_FALSE(g.blocked({{-0.3f, 0.3f, 1}, {0, 0, -1}}));
}

TEST_CASE("trace: normals are those of the faces and the smooth ones, tangents lie across them") {
  SurfaceItem s;
  s.data = sg::test::sphere(60, 2);
  const Geometry g = geometry_of(s);
  CHECK(g.placement().scale == 0.25);
  for (size_t i = 0; i < 500; ++i) {
    const Ray r = any_line(3, i, 0.4);
    Hit h;
    REQUIRE(g.nearest(r, h));
    const SurfacePoint p = g.at(r, h);
    const Vec3f out = normalize(p.position);
    CHECK(std::abs(dot(p.face_normal, out)) > 0.998f);
    CHECK(std::abs(dot(p.shading_normal, out)) > 0.9995f);
    CHECK(dot(p.shading_normal, p.face_normal) > 0);
    CHECK(std::abs(dot(p.tangent, p.shading_normal)) < 1e-6f);
    CHECK(std::abs(length(p.tangent) - 1) < 1e-6f);
    CHECK(std::abs(length(p.position) - 0.5f) < 2e-3f);
  }
}

TEST_CASE("trace: glyphs are met where their geometry is") {
  GlyphShapeParams shape;
  shape.shape = "arrow", shape.sides = 8;
  Context context;
  GlyphsItem glyphs;
  glyphs.data = places(200), glyphs.shapes = {glyph_shape_mesh(shape, context)};
  glyphs.rule.vectors = "v", glyphs.rule.size = GlyphRule::Size::length, glyphs.rule.scale = 0.3;
  SurfaceItem explicit_mesh;
  explicit_mesh.data = glyph_geometry(glyphs.data, glyphs.rule, glyphs.shapes, context);
  const Geometry instances = geometry_of(glyphs), mesh = geometry_of(explicit_mesh);
  size_t both = 0, different = 0;
  for (size_t i = 0; i < 20000; ++i) {
    const Ray world = any_line(4, i, 1.5);
    const auto ray = [&](const Geometry& g) { return Ray{g.placement().traced(Vec3(world.origin) + Vec3(100, 20, 3)), world.direction}; };
    const Ray a = ray(instances), b = ray(mesh);
    Hit p, q;
    const bool met = instances.nearest(a, p), met_mesh = mesh.nearest(b, q);
    CHECK(instances.blocked(a) == met);
    different += met != met_mesh;
    if (!met || !met_mesh) continue;
    ++both;
    const SurfacePoint x = instances.at(a, p), y = mesh.at(b, q);
    const bool near = length(instances.placement().world(x.position) - mesh.placement().world(y.position)) < 1e-5;
    different += !near || (dot(x.face_normal, y.face_normal) < 0.999f);
  }
  CHECK(both > 3000);
  CHECK(different <= 10);  // at outlines
}

TEST_CASE("trace: points are balls and lines tubes, of half their pixels or of a world radius") {
  PointsItem points;
  points.data = make_dataset(Mesh(PointCloud{{Array::from_vector(std::vector<float>{0, 0, 0, 4, 0, 0, NAN, 0, 0}, 3), {}}}), {});
  points.size = 4;
  const Geometry balls = geometry_of(points, {.pixel = 0.25});
  const auto depth = [](const Geometry& g, Vec3 from, Vec3 to) {
    const Ray r{g.placement().traced(from), Vec3f(normalize(to - from))};
    Hit h;
    return g.nearest(r, h) ? double(h.t) / g.placement().scale : -1.0;
  };
  CHECK(depth(balls, {0, 0, 5}, {0, 0, 0}) == doctest::Approx(4.5));
  CHECK(depth(balls, {4, 0.3, 5}, {4, 0.3, 0}) == doctest::Approx(5 - 0.4));
  CHECK(depth(balls, {2, 0, 5}, {2, 0, 0}) == -1);
  CHECK(depth(geometry_of(points, {.pixel = 0.25, .point_radius = 1}), {0, 0, 5}, {0, 0, 0}) == doctest::Approx(4));
  const Geometry tube = geometry_of(line({0, 0, 0, 4, 0, 0, 4, 4, 0}, 2), {.pixel = 0.5});
  CHECK(depth(tube, {2, 0, 5}, {2, 0, 0}) == doctest::Approx(4.5));
  CHECK(depth(tube, {4.3, -0.2, 5}, {4.3, -0.2, 0}) == doctest::Approx(5 - std::sqrt(0.25 - 0.13)));  // the joint
  CHECK(depth(tube, {-0.4, 0, 5}, {-0.4, 0, 0}) == doctest::Approx(5 - 0.3));                         // the end
  Hit h;
  const Ray r{tube.placement().traced({1, 0, 5}), {0, 0, -1}};
  REQUIRE(tube.nearest(r, h));
  CHECK(h.u == doctest::Approx(0.25));
  CHECK(std::abs(std::abs(tube.at(r, h).tangent.x) - 1) < 1e-6f);
}

TEST_CASE("trace: sixteen rays at once find what each finds, in scenes of several objects") {
  Scene scene;
  scene.items.emplace_back(sg::test::item(sg::test::torus(60, 40, false, {3, 0, 0})));
  scene.items.emplace_back(line({-3, 0, 0, 4, 1, 0, 4, -2, 1}, 4));
  scene.items.emplace_back(sg::test::item(sg::test::sphere(30, 1)));
  const Geometry g = geometry_of(scene, {.pixel = 0.05});
  size_t found = 0, wrong = 0;
  for (size_t i = 0; i < 2000; ++i) {
    Ray rays[16];
    Hit at_once[16];
    const int n = 1 + int(i % 16);
    for (int k = 0; k < n; ++k) {
      rays[k] = {{0.1f, 0.2f, 3},
                 normalize(Vec3f(uniform(1, i, -0.4, 0.4) + 0.003f * float(k % 4), uniform(2, i, -0.2, 0.2) + 0.003f * float(k / 4), -1))};
      if (i % 3 == 0) rays[k].t_max = 2.9f;
    }
    const uint64_t bits = g.nearest(rays, n, at_once);
    for (int k = 0; k < n; ++k) {
      Hit one;
      const bool met = g.nearest(rays[k], one);
      found += met;
      wrong += met != bool(bits >> k & 1) || (met && std::memcmp(&one, &at_once[k], sizeof one) != 0) || met != g.blocked(rays[k]);
    }
  }
  CHECK(found > 2000);
  CHECK(wrong == 0);
}

TEST_CASE("trace: rays of a stream are blocked as each is by itself, wherever they go") {
  Scene one, several;
  one.items.emplace_back(sg::test::item(sg::test::torus(60, 40, false, {3, 0, 0})));
  several = one;
  several.items.emplace_back(line({-3, 0, 0, 4, 1, 0, 4, -2, 1}, 4));
  several.items.emplace_back(sg::test::item(sg::test::sphere(30, 1)));
  for (const Scene* scene : {&one, &several}) {
    const Geometry g = geometry_of(*scene, {.pixel = 0.05});
    size_t blocked = 0, wrong = 0;
    for (size_t i = 0; i < 2000; ++i) {
      Ray rays[64];
      const int n = i % 3 == 0 ? int(i % 9) : int(i % 65);
      for (int k = 0; k < n; ++k) {
        const size_t draw = 64 * i + size_t(k);
        rays[k] = {any_place(4, draw, 1), any_direction(5, draw), uniform(6, draw, 0.1, 2)};
        if (i % 4 == 1)  // alike
          rays[k].origin = rays[0].origin + rays[k].origin * 0.05f,
          rays[k].direction = normalize(rays[0].direction * 2.f + rays[k].direction);
        if (i % 50 == 7 && k == 1) rays[k].direction.x = NAN;
      }
      const uint64_t bits = g.blocked(rays, n);
      for (int k = 0; k < n; ++k) blocked += bits >> k & 1, wrong += bool(bits >> k & 1) != g.blocked(rays[k]);
      wrong += n < 64 && bits >> n != 0;
    }
    CHECK(blocked > 2000);
    CHECK(wrong == 0);
  }
}

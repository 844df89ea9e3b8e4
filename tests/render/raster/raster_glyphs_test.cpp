// SPDX-License-Identifier: Apache-2.0
// Instanced glyphs draw what their geometry draws.
#include <hwy/targets.h>

#include "filter/glyph/geometry.h"
#include "filter/glyph/shapes.h"
#include "raster_support.h"
#include "render/raster/glyphs/glyphs.h"

using namespace sg;
using namespace sg::test;

namespace {

DatasetPtr shape(const std::string& name, int sides = 8) {
  Context context;
  GlyphShapeParams p;
  p.shape = name, p.sides = sides;
  return glyph_shape_mesh(p, context);
}

/// n points in a box about the origin with vectors of lengths up to about 2, some of them zero or NaN.
DatasetPtr places(size_t n, Vec3 origin = {}) {
  std::vector<float> xyz, v, s;
  std::vector<int32_t> choice;
  for (size_t i = 0; i < n; ++i) {
    for (uint64_t c = 0; c < 3; ++c) xyz.push_back(float(2 * random_unit(1, 3 * i + c) - 1));
    for (uint64_t c = 0; c < 3; ++c) v.push_back(i % 17 == 3 ? 0.0f : i % 19 == 5 ? NAN : float(2 * random_unit(2, 3 * i + c) - 1));
    s.push_back(float(random_unit(3, i)));
    choice.push_back(int32_t(i % 3));
  }
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(std::move(v), 3), "", Role::vectors});
  f.add({"s", Association::point, Array::from_vector(std::move(s)), "", Role::scalars});
  f.add({"choice", Association::point, Array::from_vector(std::move(choice)), "", Role::none});
  return make_dataset(Mesh(PointCloud{{Array::from_vector(std::move(xyz), 3), origin}}), std::move(f));
}

GlyphsItem glyphs(DatasetPtr data, std::vector<DatasetPtr> shapes, double scale) {
  GlyphsItem g;
  g.data = std::move(data), g.shapes = std::move(shapes);
  g.rule.vectors = "v", g.rule.size = GlyphRule::Size::length, g.rule.scale = scale;
  return g;
}

/// The same picture from explicit geometry.
Scene explicit_scene(const GlyphsItem& g) {
  Context context;
  SurfaceItem s;
  s.data = glyph_geometry(g.data, g.rule, g.shapes, context);
  s.color = g.color, s.color_by = g.color_by, s.opacity = g.opacity, s.flat = g.flat, s.material = g.material;
  Scene scene;
  scene.items.emplace_back(std::move(s));
  return scene;
}

Camera view(bool parallel, double distance = 6) {
  Camera c;
  c.position = {0.3 * distance, -0.9 * distance, 0.4 * distance}, c.up = {0, 0, 1}, c.view_angle = 30;
  c.parallel = parallel, c.parallel_height = 3, c.near_plane = 0.05;
  return c;
}

Picture picture(const GlyphsItem& g, const Camera& c, double pixel_scale = 1) {
  Scene scene;
  scene.items.emplace_back(g);
  return draw(scene, c, 300, 240, pixel_scale);
}

size_t different_ids(const Picture& a, const Picture& b) {
  size_t n = 0;
  for (size_t p = 0; p < a.frame.pixels(); ++p) n += a.frame.ids[p] != b.frame.ids[p];
  return n;
}
double mean_depth_difference(const Picture& a, const Picture& b) {
  double sum = 0;
  for (size_t p = 0; p < a.frame.pixels(); ++p)
    if (a.frame.ids[p] && b.frame.ids[p]) sum += std::abs(double(a.frame.depth[p]) - double(b.frame.depth[p]));
  return sum / double(std::max<size_t>(a.covered(), 1));
}
/// Pixels whose colours differ by more than a step of an 8-bit picture.
size_t different_colors(const Picture& a, const Picture& b, double step = 4e-3) {
  size_t n = 0;
  for (size_t p = 0; p < a.frame.pixels(); ++p) {
    double d = 0;
    for (size_t k = 0; k < 3; ++k) d = std::max(d, std::abs(double(a.frame.rgba[4 * p + k]) - double(b.frame.rgba[4 * p + k])));
    n += d > step;
  }
  return n;
}

}  // namespace

TEST_CASE("glyphs: instances draw the picture of their geometry, from near and far, of every shape") {
  for (const char* name : {"arrow", "cone", "needle", "sphere", "cube", "cylinder", "superquadric", "disc", "arrow2d"})
    for (const bool parallel : {false, true})
      for (const double distance : {0.9, 6.0, 40.0}) {
        CAPTURE(name);
        CAPTURE(parallel);
        CAPTURE(distance);
        GlyphsItem g = glyphs(places(600), {shape(name)}, 0.2);
        g.color_by = grey_by("s", 0, 1);
        const Picture a = picture(g, view(parallel, distance)), b = draw(explicit_scene(g), view(parallel, distance), 300, 240);
        CHECK(a.covered() > (distance > 10 && !parallel ? 50u : 1000u));
        CHECK(different_ids(a, b) == 0);
        CHECK(mean_depth_difference(a, b) < 2e-4);  // by the visibility buffer here, by the plane of the triangle there
        // Where two faces of a glyph meet at the same depth either may be shown.
        CHECK(double(different_colors(a, b)) < 0.004 * double(a.covered()));
      }
}

TEST_CASE("glyphs: vectors that are zero or not finite, hidden points and sizes of zero have no glyph") {
  std::vector<float> xyz{-1, 0, 0, 0, 0, 0, 1, 0, 0}, v{1, 0, 0, 0, 0, 0, NAN, 0, 0};
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(v, 3), "", Role::vectors});
  f.add({"s", Association::point, Array::from_vector(std::vector<float>{0, 2, NAN}), "", Role::scalars});
  DatasetParts parts;
  parts.mesh = PointCloud{{Array::from_vector(xyz, 3), {}}}, parts.fields = f;
  const DatasetPtr d = make_dataset(parts);
  GlyphRule rule;
  rule.vectors = "v";
  CHECK(glyph_instances(d, rule, 1)->standing == 1);
  CHECK(glyph_instances(d, rule, 1)->stands(0));
  rule.vectors = "", rule.size = GlyphRule::Size::field, rule.size_field = "s";
  CHECK(glyph_instances(d, rule, 1)->standing == 1);
  CHECK(glyph_instances(d, rule, 1)->stands(1));
  parts.point_ghost = Array::from_vector(std::vector<uint8_t>{ghost_hidden_point, 0, 0});
  rule = {};
  CHECK(glyph_instances(make_dataset(parts), rule, 1)->standing == 2);
  Scene scene;
  GlyphsItem none = glyphs(d, {shape("arrow")}, 0);
  scene.items.emplace_back(none);
  CHECK(draw(scene, front(), 50, 50).covered() == 0);
}

TEST_CASE("glyphs: several shapes by a field, translucent ones and matrices draw what their geometry draws") {
  GlyphsItem g = glyphs(places(500), {shape("arrow"), shape("cube"), shape("sphere", 12)}, 0.25);
  g.rule.choice = "choice";
  g.color = {0.2f, 0.5f, 0.9f};
  Picture a = picture(g, view(false)), b = draw(explicit_scene(g), view(false), 300, 240);
  CHECK(different_ids(a, b) == 0);
  CHECK(double(different_colors(a, b)) < 0.004 * double(a.covered()));
  g.opacity = 0.4;
  a = picture(g, view(false)), b = draw(explicit_scene(g), view(false), 300, 240);
  REQUIRE(a.fragments.fragments.size() == b.fragments.fragments.size());
  CHECK(a.fragments.fragments.size() > 5000);
  double most = 0, sum = 0;
  for (size_t i = 0; i < a.fragments.fragments.size(); ++i) {
    const Fragment &p = a.fragments.fragments[i], &q = b.fragments.fragments[i];
    most = std::max(most, std::abs(double(p.depth) - double(q.depth)));
    sum += std::abs(double(p.rgba[0]) - double(q.rgba[0]));
  }
  CHECK(most < 2e-2);  // depths of spans are held within a triangle's own
  CHECK(sum / double(a.fragments.fragments.size()) < 1e-3);

  // Any matrix: stretched, sheared and mirrored.
  FieldSet f;
  std::vector<double> frames;
  for (int i = 0; i < 40; ++i)
    for (int k = 0; k < 9; ++k) frames.push_back(2 * random_unit(9, uint64_t(9 * i + k)) - 1);
  f.add({"m", Association::point, Array::from_vector(std::move(frames), 9), "", Role::none});
  std::vector<float> xyz;
  for (int i = 0; i < 120; ++i) xyz.push_back(float(2 * random_unit(8, uint64_t(i)) - 1));
  GlyphsItem m = glyphs(make_dataset(Mesh(PointCloud{{Array::from_vector(std::move(xyz), 3), {}}}), f), {shape("sphere", 64)}, 0.5);
  m.rule = {}, m.feature_angle = 180;
  m.rule.frames = "m", m.rule.scale = 0.5;
  Scene whole = explicit_scene(m);
  std::get<SurfaceItem>(whole.items[0]).feature_angle = 180;
  a = picture(m, view(true)), b = draw(whole, view(true), 300, 240);
  CHECK(a.covered() > 10000);
  CHECK(different_ids(a, b) == 0);
  CHECK(double(different_colors(a, b, 0.02)) < 0.03 * double(a.covered()));  // means of normals there are of the stretched faces
}

TEST_CASE("glyphs: far from zero and of every size they look the same") {
  GlyphsItem g = glyphs(places(300), {shape("arrow")}, 0.3), moved = g;
  moved.data = places(300, {1e7, -2e7, 3e6});
  Camera c = view(false), there = c;
  for (Vec3* p : {&there.position, &there.target}) *p += Vec3{1e7, -2e7, 3e6};
  const Picture a = picture(g, c), b = picture(moved, there);
  CHECK(different_ids(a, b) < 20);
  CHECK(double(different_colors(a, b)) < 0.02 * double(a.covered()));
}

TEST_CASE("glyphs: 1 and 8 threads, every vector target and the plain code draw the same bytes") {
  Scene scene;
  GlyphsItem g = glyphs(places(3000), {shape("arrow", 6), shape("line"), shape("sphere", 40)}, 0.25);
  g.rule.choice = "choice", g.color_by = grey_by("s", 0, 1);
  GlyphsItem t = glyphs(places(50), {shape("cone")}, 0.9);
  t.opacity = 0.5;
  scene.items = {g, t};
  set_thread_count(1);
  const Picture one = draw(scene, view(false), 333, 222, 2);
  set_thread_count(8);
  const Picture eight = draw(scene, view(false), 333, 222, 2);
  set_thread_count(0);
  CHECK(one.covered() > 10000);
  CHECK_FALSE(one.fragments.empty());
  CHECK(same_bytes(one, eight));
  for (int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    CAPTURE(target);
    CHECK(same_bytes(one, draw(scene, view(false), 333, 222, 2)));
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();

  // The triangles alone: vector code without culling, and the reference.
  Context context;
  const PreparedScenePtr prepared = prepare_scene(scene, context);
  const raster::PreparedItem& item = prepared->items[0];
  const raster::EyeView eye = raster::eye_view(make_projection(view(false, 2), 300, 240), item.origin);
  const uint64_t empty = raster::empty_key(1000);
  std::vector<uint64_t> fast(300 * 240, empty), plain = fast;
  std::vector<raster::TriangleRecord> large, large_plain;
  raster::GlyphJob job{eye, item.glyphs.get(), item.first_primitive, 16, false, 1, fast.data()};
  raster::draw_glyphs(job, 0, 3000, large);
  job.keys = plain.data();
  raster::draw_glyphs_reference(job, 0, 3000, large_plain);
  CHECK(fast == plain);
  CHECK(size_t(std::count(fast.begin(), fast.end(), empty)) < fast.size() - 3000);
  CHECK(large.size() == large_plain.size());
  CHECK(large.size() > 10);
}

TEST_CASE("glyphs: sizes in pixels are the same at any distance and supersampling; lines have their width") {
  std::vector<float> xyz{0, 0, 0}, v{1, 0, 0};
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(v, 3), "", Role::vectors});
  GlyphsItem g = glyphs(make_dataset(Mesh(PointCloud{{Array::from_vector(xyz, 3), {}}}), f), {shape("arrow2d")}, 45);
  g.in_pixels = true;
  for (const bool parallel : {false, true})
    for (const double distance : {2.0, 900.0})
      for (const int scale : {1, 2}) {
        Scene scene;
        scene.items.emplace_back(g);
        Camera c = parallel ? front_parallel(10, distance) : front(distance);
        c.far_plane = 1e4;
        const Picture p = draw(scene, c, 100 * scale, 100 * scale, scale);
        CHECK(double(p.covered()) == doctest::Approx((0.65 * 0.1 + 0.35 * 0.14) * 45 * 45 * scale * scale).epsilon(0.1));
      }
  g.shapes = {shape("line")}, g.line_width = 4, g.rule.scale = 40;
  Scene scene;
  scene.items.emplace_back(g);
  const Picture p = draw(scene, front_parallel(10), 100, 100);
  double covered = 0;
  for (const Fragment& q : p.fragments.fragments) covered += double(q.rgba[3]);
  for (size_t i = 0; i < p.frame.pixels(); ++i) covered += p.frame.ids[i] ? 1 : 0;
  CHECK(covered == doctest::Approx(40 * 4 + 2 * 4).epsilon(0.08));  // 40 pixels long, 4 wide, and its round ends
}

TEST_CASE("glyphs: the bounds of a scene hold the glyphs, and a million of them stand in little memory") {
  GlyphsItem g = glyphs(places(400), {shape("arrow")}, 0.7);
  Context context;
  const DatasetPtr geometry = glyph_geometry(g.data, g.rule, g.shapes, context);
  Scene scene;
  scene.items.emplace_back(g);
  const Box3 box = scene_bounds(scene), tight = geometry->bounds();
  for (int a = 0; a < 3; ++a) {
    CHECK(box.lo[a] <= tight.lo[a] + 1e-6);
    CHECK(box.hi[a] >= tight.hi[a] - 1e-6);
    CHECK(box.size()[a] < tight.size()[a] * 1.2);
  }
  const auto many = glyph_instances(places(1'000'000), g.rule, 1);
  CHECK(many->matrices.bytes() == 48'000'000);
  CHECK(many->standing > 890'000);
}

TEST_CASE("glyphs: mistakes are named") {
  auto message = [](const GlyphsItem& g) {
    Scene scene;
    scene.items.emplace_back(g);
    return error_of([&] { draw(scene, front(), 8, 8); });
  };
  const GlyphsItem good = glyphs(places(4), {shape("cone")}, 1);
  GlyphsItem g = good;
  g.data = nullptr;
  CHECK(message(g).find("no data") != std::string::npos);
  g = good, g.shapes.clear();
  CHECK(message(g).find("0 shapes") != std::string::npos);
  g = good, g.rule.vectors = "s";
  CHECK(message(g).find("field 's' has 1 component") != std::string::npos);
  g = good, g.rule.frames = "v";
  CHECK(message(g).find("needs 9") != std::string::npos);
  g = good, g.rule.vectors = "";
  CHECK(message(g).find("name a field with vectors=") != std::string::npos);
  g = good, g.shapes = {places(3)};
  CHECK(message(g).find("must be a surface mesh") != std::string::npos);
  g = good, g.rule.vectors = "w";
  CHECK(message(g).find("'w'") != std::string::npos);
}

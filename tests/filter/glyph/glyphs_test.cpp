// SPDX-License-Identifier: Apache-2.0
// Shapes of glyphs, how they are turned, wind barbs, and what is chosen when little is said.
#include "filter/glyph/choose.h"
#include "filter/surface/mass_properties.h"
#include "support/test.h"

#include <cmath>
#include <cstring>
#include <numbers>

#include "base/parallel.h"
#include "base/random.h"

using namespace sg;
using sg::test::error_of;

namespace {

using std::numbers::pi;

DatasetPtr shape(const std::string& name, int sides = 64, double alpha = 1, double beta = 1) {
  Context context;
  GlyphShapeParams p;
  p.shape = name, p.sides = sides, p.alpha = alpha, p.beta = beta;
  return glyph_shape_mesh(p, context);
}

// Volume by the divergence theorem; an open or inward shape gives another number.
double volume(const DatasetPtr& d) {
  const auto& m = *d->as<SurfaceMesh>();
  const CellsView c = cells_view(m.polygons);
  double sum = 0;
  for (size_t i = 0; i < c.count; ++i)
    sum += dot(m.points.at(size_t(c.point(i, 0))), cross(m.points.at(size_t(c.point(i, 1))), m.points.at(size_t(c.point(i, 2))))) / 6;
  return sum;
}

DatasetPtr cloud(std::vector<float> xyz, std::vector<float> vectors, int components = 3, const char* unit = "") {
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(std::move(vectors), components), unit, Role::vectors});
  return make_dataset(Mesh(PointCloud{{Array::from_vector(std::move(xyz), 3), {}}}), std::move(f));
}

/// A flat grid of n x n points over [-1,1]^2 with the rotation (-y, x).
DatasetPtr rotation(size_t n, bool two = false) {
  UniformGrid g;
  g.dims = {n, n, 1}, g.origin = {-1, -1, 0}, g.spacing = Vec3{1, 1, 1} * (2.0 / double(n - 1));
  std::vector<float> v;
  for (size_t j = 0; j < n; ++j)
    for (size_t i = 0; i < n; ++i) {
      v.push_back(float(1 - 2 * double(j) / double(n - 1))), v.push_back(float(2 * double(i) / double(n - 1) - 1));
      if (!two) v.push_back(0);
    }
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(std::move(v), two ? 2 : 3), "", Role::vectors});
  return make_dataset(Mesh(g), std::move(f));
}

}  // namespace

TEST_CASE("glyph shapes: solids are closed, look outward and have the volume of what they are") {
  CHECK(volume(shape("cube")) == doctest::Approx(1));
  CHECK(volume(shape("sphere", 128)) == doctest::Approx(pi / 6).epsilon(3e-3));
  CHECK(volume(shape("cylinder", 128)) == doctest::Approx(pi / 4).epsilon(3e-3));
  CHECK(volume(shape("cone", 128)) == doctest::Approx(pi * 0.16 * 0.16 / 3).epsilon(3e-3));
  CHECK(volume(shape("arrow", 128)) == doctest::Approx(pi * (0.05 * 0.05 * 0.65 + 0.14 * 0.14 * 0.35 / 3)).epsilon(3e-3));
  CHECK(volume(shape("arrow2d")) == doctest::Approx(0.024 * (0.65 * 0.1 + 0.35 * 0.14)).epsilon(1e-5));
  CHECK(volume(shape("needle")) > 0);
  CHECK(volume(shape("superquadric", 96)) == doctest::Approx(pi / 6).epsilon(5e-3));
  CHECK(volume(shape("superquadric", 96, 0.05, 0.05)) > 0.9);                                // nearly a cube
  CHECK(volume(shape("superquadric", 96, 2, 2)) == doctest::Approx(1.0 / 6).epsilon(5e-3));  // an octahedron
  CHECK(volume(shape("superquadric", 96, 1, 0.02)) > 0.95 * pi / 4);                         // nearly a cylinder about x
  for (const char* name : {"arrow", "cone", "needle", "line", "arrow2d"}) {
    CHECK(shape(name)->bounds().lo.x == doctest::Approx(0));
    CHECK(shape(name)->bounds().hi.x == doctest::Approx(1));
  }
  Context context;
  GlyphShapeParams p;
  p.anchor = GlyphAnchor::tip;
  CHECK(glyph_shape_mesh(p, context)->bounds().hi.x == doctest::Approx(0));
  p.shape = "arow";
  CHECK(error_of([&] { glyph_shape_mesh(p, context); }).find("did you mean 'arrow'") != std::string::npos);
}

TEST_CASE("glyphs: +x turns to the vector exactly, whatever its length; a normal keeps flat shapes in their plane") {
  for (uint64_t i = 0; i < 200; ++i) {
    Vec3 v;
    for (uint64_t c = 0; c < 3; ++c) v[int(c)] = 2 * random_unit(1, 3 * i + c) - 1;
    if (i == 0) v = {-1, 0, 0};
    if (i == 1) v = {-1, 1e-9, 0};
    const double size = std::pow(10, double(i % 60) * 5 - 150);
    const Mat3 m = turn_to(v * size, {});
    CHECK(length(m.column(0) - normalize(v)) < 1e-12);
    CHECK(std::abs(determinant(m) - 1) < 1e-6);
    const Mat3 flat = turn_to({v.x, v.y, 0}, Vec3{0, 0, 2});
    CHECK(length(flat.column(2) - Vec3{0, 0, 1}) < 1e-12);
  }
  CHECK(turn_to({0, 0, 0}, {}).m[0][0] == 0);
  CHECK(turn_to({0, 0, 3}, Vec3{0, 0, 1}).m[2][0] == 0);

  // An arrow of a known vector ends where the vector does.
  Context context;
  GlyphRule rule;
  rule.vectors = "v", rule.size = GlyphRule::Size::length, rule.scale = 0.5;
  const DatasetPtr g = glyph_geometry(cloud({1, 2, 3}, {0, -4, 3}), rule, {shape("line")}, context);
  const auto& points = g->as<SurfaceMesh>()->points;
  CHECK(length(points.at(0) - Vec3{1, 2, 3}) < 1e-6);
  CHECK(length(points.at(1) - Vec3{1, 0, 4.5}) < 1e-6);
  rule.largest = 1;
  const DatasetPtr cut = glyph_geometry(cloud({1, 2, 3}, {0, -4, 3}), rule, {shape("line")}, context);
  CHECK(length(cut->as<SurfaceMesh>()->points.at(1) - Vec3{1, 1.2, 3.6}) < 1e-6);
}

TEST_CASE("glyphs: geometry has a copy at each point with a vector, fields of the points, and the same bytes for 1 and 8 threads") {
  std::vector<float> xyz, v;
  for (uint64_t i = 0; i < 9000; ++i) {
    xyz.push_back(float(random_unit(1, i)));
    v.push_back(i % 30 < 3 ? 0.0f : float(random_unit(2, i)) - 0.5f);
  }
  const DatasetPtr d = cloud(xyz, v);
  GlyphsParams p;
  p.place = GlyphPlaces::all, p.shape.shape = "cube";
  Context context;
  set_thread_count(1);
  const DatasetPtr one = glyphs(d, p, context);
  set_thread_count(8);
  const DatasetPtr eight = glyphs(make_dataset(d->parts()), p, context);
  set_thread_count(0);
  CHECK(one->point_count() == 8 * 2700);
  CHECK(one->cell_count() == 12 * 2700);
  CHECK(one->fields().require("v", Association::point).array.count() == one->point_count());
  const auto &a = one->as<SurfaceMesh>()->points.xyz, &b = eight->as<SurfaceMesh>()->points.xyz;
  CHECK(std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
}

TEST_CASE("barbs: pennants of 50, barbs of 10 and a half of 5 knots; speeds are rounded to 5") {
  auto strokes = [](int knots) {
    const BarbStrokes s = barb_strokes(knots);
    return std::array{s.pennants, s.barbs, s.half};
  };
  CHECK(strokes(45) == std::array{0, 4, 1});
  CHECK(strokes(50) == std::array{1, 0, 0});
  CHECK(strokes(65) == std::array{1, 1, 1});
  CHECK(strokes(5) == std::array{0, 0, 1});
  CHECK(strokes(115) == std::array{2, 1, 1});
  CHECK(barb_shape(2.4, false) == 0);
  CHECK(barb_shape(2.5, false) == 1);
  CHECK(barb_shape(47.4, false) == 9);
  CHECK(barb_shape(1e9, false) == 100);
  CHECK(barb_shape(47.4, true) == 109);
  CHECK(barb_shape(0, true) == 0);
  const auto shapes = barb_shapes();
  REQUIRE(shapes.size() == 201);
  // Lines: the staff and a stroke each; a pennant has two sides and is filled before and behind.
  CHECK(shapes[9]->as<SurfaceMesh>()->lines.size() == 1 + 4 + 1);
  CHECK(shapes[10]->as<SurfaceMesh>()->lines.size() == 1 + 2);
  CHECK(shapes[10]->as<SurfaceMesh>()->polygons.size() == 2);
  CHECK(shapes[0]->as<SurfaceMesh>()->lines.size() == 24);
  // Strokes on the side of low pressure: to the left of the wind in the north, to its right in the south.
  CHECK(shapes[9]->bounds().hi.y > 0.4);
  CHECK(shapes[9]->bounds().lo.y == doctest::Approx(0));
  CHECK(shapes[109]->bounds().lo.y < -0.4);
  CHECK(shapes[9]->bounds().lo.x < -1);  // the staff points to where the wind comes from
  CHECK(shapes[9]->bounds().hi.x == doctest::Approx(0));
  for (const auto& s : shapes) CHECK(s->bounds().lo.x > -1.2);  // many strokes stand closer
}

TEST_CASE("barbs: units become knots, the hemisphere follows latitude, no wind is calm and NaN is nothing") {
  CHECK(knots_per("m/s") == doctest::Approx(1.943844));
  CHECK(knots_per(" KM/H ") == doctest::Approx(0.539957));
  CHECK(knots_per("kt") == 1);
  CHECK(error_of([] { knots_per("furlong"); }).find("not a unit of speed") != std::string::npos);
  Context context;
  auto numbers = [&](const DatasetPtr& d, BarbParams p = {}) {
    const DatasetPtr r = barb_places(d, "v", p, context);
    std::vector<int> n;
    for (size_t i = 0; i < r->point_count(); ++i) n.push_back(int(r->fields().require("barb").array.get(i)));
    return n;
  };
  // 25 m/s = 48.6 kn; at 45 degrees north and south, no wind, NaN.
  const DatasetPtr earth = cloud({0, 45, 0, 30, -45, 0, 60, 0, 0, 90, 10, 0}, {15, -20, 15, -20, 0, 0, NAN, 1}, 2, "m/s");
  CHECK(numbers(earth) == std::vector{10, 110, 0, -1});
  CHECK(numbers(earth, {.unit = "kn"}) == std::vector{5, 105, 0, -1});
  CHECK(numbers(earth, {.hemisphere = BarbHemisphere::north}) == std::vector{10, 10, 0, -1});
  CHECK(numbers(earth, {.hemisphere = BarbHemisphere::south}) == std::vector{110, 110, 0, -1});
  CHECK(numbers(cloud({0, 1, 0, 1, -1, 0}, {15, -20, 15, -20}, 2, "kn")) == std::vector{5, 5});  // no degrees
  const DatasetPtr placed = barb_places(earth, "v", {}, context);
  GlyphRule rule;
  rule.frames = "barb frame", rule.choice = "barb";
  CHECK(glyph_instances(placed, rule, 201)->standing == 3);
  CHECK(error_of([&] { barb_places(earth, "v", {.latitude = {"v"}}, context); }).find("2 components") != std::string::npos);
}

TEST_CASE("glyphs: what is chosen: flat arrows in a plane, arrows in space, sizes like the distance of places") {
  Context context;
  GlyphParams p;
  ChosenGlyphs c = choose_glyphs(rotation(21), p, false, context);
  CHECK(c.flat);
  CHECK(c.data->point_count() == 441);
  CHECK(c.rule.normal == Vec3{0, 0, 1});
  CHECK(c.longest == doctest::Approx(0.1).epsilon(0.1));  // the distance of the places
  CHECK(c.of == doctest::Approx(std::sqrt(2.0)));
  CHECK(c.note.find("'v'") != std::string::npos);
  c = choose_glyphs(rotation(201, true), p, false, context);  // two components
  CHECK(c.flat);
  CHECK(c.data->point_count() > 700);
  CHECK(c.data->point_count() < 1100);
  p.count = 100, p.size = 0.5;
  c = choose_glyphs(rotation(201), p, false, context);
  CHECK(c.data->point_count() == 100);
  CHECK(c.longest == doctest::Approx(0.5));
  p = {}, p.factor = 2;
  CHECK(choose_glyphs(rotation(21), p, false, context).rule.scale == 2);
  p = {}, p.shape.shape = "barbs";
  c = choose_glyphs(rotation(21), p, true, context);
  CHECK(c.barbs);
  CHECK(c.rule.scale == 34);
  CHECK(c.rule.choice == "barb");
}

TEST_CASE("glyphs: mistakes are named") {
  Context context;
  const DatasetPtr d = rotation(5);
  auto message = [&](auto&& change, const DatasetPtr& data) {
    GlyphParams p;
    change(p);
    return error_of([&] { choose_glyphs(data, p, false, context); });
  };
  FieldSet scalar;
  scalar.add({"t", Association::point, Array::from_vector(std::vector<float>(25, 1.0f)), "", Role::scalars});
  const DatasetPtr plain = make_dataset(d->mesh(), scalar);
  CHECK(message([](GlyphParams&) {}, plain).find("no vector field") != std::string::npos);
  CHECK(message([](GlyphParams& p) { p.vectors.name = "t"; }, plain).find("has 1 component") != std::string::npos);
  CHECK(message([](GlyphParams& p) { p.vectors.name = "w"; }, d).find("'w'") != std::string::npos);
  CHECK(message([](GlyphParams& p) { p.size_by = "lenght"; }, d).find("did you mean 'length'") != std::string::npos);
  CHECK(message([](GlyphParams& p) { p.size = 1, p.factor = 1; }, d).find("give one of them") != std::string::npos);
  CHECK(message([](GlyphParams& p) { p.shape.shape = "barbs", p.vectors.name = "none"; }, d).find("barbs need a wind") !=
        std::string::npos);
  CHECK(message([](GlyphParams& p) { p.size_by = "length", p.shape.shape = "cube"; }, plain).find("no vectors") != std::string::npos);
  // A field of zeros and NaN is a picture without glyphs, and says so.
  const ChosenGlyphs none = choose_glyphs(cloud({0, 0, 0, 1, 0, 0}, {0, 0, 0, NAN, 0, 0}), {}, false, context);
  CHECK(none.note.find("no glyphs") != std::string::npos);
  GlyphsParams p;
  CHECK(glyphs(cloud({0, 0, 0, 1, 0, 0}, {0, 0, 0, NAN, 0, 0}), p, context)->point_count() == 0);
}

// SPDX-License-Identifier: Apache-2.0
// Opaque surfaces: where, how far, which value, how bright.
#include "raster_support.h"

using namespace sg;
using namespace sg::test;

namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

FieldSet point_field(const char* name, std::vector<float> v, int components = 1) {
  FieldSet f;
  f.add({name, Association::point, Array::from_vector(std::move(v), components), "", Role::none});
  return f;
}

/// A camera that sees the plane z = 0 at a slant.
Camera slanted() {
  Camera c;
  c.position = {0.5, -6, 2}, c.target = {0, 0, 0}, c.up = {0, 0, 1}, c.view_angle = 40;
  return c;
}

}  // namespace

TEST_CASE("raster: an empty scene leaves the frame as it was") {
  const Picture p = draw({}, front(), 40, 30);
  CHECK(p.covered() == 0);
  CHECK(p.fragments.empty());
  for (float d : p.frame.depth) CHECK(d == infinite);
}

TEST_CASE("raster: values and depth on a slanted quad are those of the ray's hit, in perspective") {
  Scene s;
  SurfaceItem q = item(quad(2, 0, point_field("x", {-2, 2, 2, -2})), {}, false);
  q.color_by = grey_by("x", -2, 2);
  s.items.push_back(q);
  const Camera c = slanted();
  const Projection projection = make_projection(c, 300, 200);
  const Picture p = draw(s, c, 300, 200);
  CHECK(p.covered() > 5000);
  double worst_value = 0, worst_depth = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 300; ++x) {
      if (!p.id(x, y)) continue;
      const Projection::Ray r = projection.ray(x + 0.5, y + 0.5);
      const double t = -r.origin.z / r.direction.z, hit = r.origin.x + t * r.direction.x;
      if (std::abs(hit) > 1.99) continue;
      worst_value = std::max(worst_value, std::abs(double(p.rgba(x, y)[0]) - (hit + 2) / 4));
      worst_depth = std::max(worst_depth, std::abs(double(p.depth(x, y)) * r.per_depth - t) / t);
    }
  CHECK(worst_value < 2e-4);  // half a step of the table is 1.2e-4
  CHECK(worst_depth < 1e-6);
}

TEST_CASE("raster: small doubles keep their places on a logarithmic scale, whatever the largest are") {
  // The value is 10^e(x), from 1e-6 on the left to 1e6 on the right; the triangles are so narrow that it is as good as that in each.
  constexpr int n = 400;
  std::vector<float> xyz;
  std::vector<double> values;
  std::vector<int32_t> ids;
  for (int i = 0; i <= n; ++i)
    for (const float y : {-1.0f, 1.0f})
      xyz.insert(xyz.end(), {-1 + 2.0f * float(i) / n, y, 0}), values.push_back(std::pow(10.0, 12.0 * i / n - 6));
  for (int i = 0; i < n; ++i) ids.insert(ids.end(), {2 * i, 2 * i + 2, 2 * i + 3, 2 * i, 2 * i + 3, 2 * i + 1});
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(std::move(values)), "", Role::none});
  Scene s;
  SurfaceItem strip = item(surface(std::move(xyz), std::move(ids), std::move(f)), {}, false);
  strip.color_by = grey_by("v", 1e-6, 1e6);
  strip.color_by->scale.kind = ScaleKind::log;
  s.items.push_back(strip);
  const Picture p = draw(s, front_parallel(2), 100, 100);
  for (int x = 2; x < 98; ++x) CHECK(double(p.rgba(x, 50)[0]) == doctest::Approx((x + 0.5) / 100).epsilon(0.01));
}

TEST_CASE("raster: the silhouette of a sphere has the area of its cone") {
  // Sphere of radius 1 at distance 5: the silhouette's angle is asin(1/5).
  Scene s;
  s.items.push_back(item(sphere(200, 1)));
  Camera c = front(5, 40);
  double errors[3], sizes[3];
  for (int k = 0; k < 3; ++k) {
    const int n = 100 << k;
    const double scale = make_projection(c, n, n).scale, r = scale * std::tan(std::asin(0.2));
    errors[k] = std::abs(double(draw(s, c, n, n).covered()) / (pi * r * r) - 1), sizes[k] = 1.0 / n;
  }
  (void)sizes;
  CHECK(errors[0] < 4e-3);
  CHECK(errors[2] < 1e-3);
}

TEST_CASE("raster: a facing quad has the colour of the lighting formula") {
  Scene s;
  SurfaceItem q = item(quad(1, 0), {0.5f, 0.6f, 0.7f});
  q.material.specular = 0.3f, q.material.power = 7.5f;
  s.items.push_back(q);
  s.lights = {{{0.3, 0.4, 1.2}, true, 0.7f}, {{-1, 0, 0.1}, true, 0.3f}, {{0, 0, -1}, true, 5.0f}};  // the last shines from behind
  const Camera c = front_parallel(4);
  const Picture p = draw(s, c, 64, 64);
  double diffuse = 0, specular = 0;
  for (const Light& l : {s.lights[0], s.lights[1]}) {
    const Vec3 to = normalize(l.direction), half = normalize(to + Vec3(0, 0, 1));  // normal and viewer are both z
    diffuse += double(l.intensity) * to.z, specular += double(l.intensity) * std::pow(half.z, 7.5);
  }
  const float srgb[3] = {0.5f, 0.6f, 0.7f};
  for (int k = 0; k < 3; ++k)
    CHECK(p.rgba(32, 32)[k] ==
          doctest::Approx(double(srgb_decode(srgb[k])) * (0.12 + 0.88 * diffuse) + double(0.3f) * specular).epsilon(2e-6));
  CHECK(p.rgba(32, 32)[3] == 1);
  // The other side of the quad is lit alike.
  Camera back = c;
  back.position = {0, 0, -10};
  const Picture b = draw(s, back, 64, 64);
  for (int k = 0; k < 3; ++k) CHECK(b.rgba(32, 32)[k] == p.rgba(32, 32)[k]);
}

TEST_CASE("raster: a light fixed in the world does not turn with the camera") {
  Scene s;
  SurfaceItem q = item(quad(1, 0));
  q.material.specular = 0;
  s.items.push_back(q);
  s.lights = {{{0, 0, 1}, false, 0.5f}};
  const float head_on = draw(s, front_parallel(4), 32, 32).rgba(16, 16)[0];
  Camera c = front_parallel(4);
  c.position = {5, 0, 5};
  CHECK(draw(s, c, 32, 32).rgba(16, 16)[0] == doctest::Approx(double(head_on)));
}

TEST_CASE("raster: computed normals are smooth on a sphere and split at a cube's edges") {
  Scene s;
  SurfaceItem ball = item(sphere(60, 1));
  ball.material.specular = 0, ball.material.ambient = 0, ball.material.diffuse = 1, ball.color = {1, 1, 1};
  s.items = {ball}, s.lights = {{{0, 0, 1}, true, 1}};
  const Picture p = draw(s, front_parallel(2.5), 250, 250);
  double worst = 0;
  for (int y = 0; y < 250; ++y)
    for (int x = 0; x < 250; ++x) {
      const double u = (x + 0.5 - 125) / 100, v = (y + 0.5 - 125) / 100, r2 = u * u + v * v;
      if (r2 < 0.9) worst = std::max(worst, std::abs(double(p.rgba(x, y)[0]) - std::sqrt(1 - r2)));
    }
  CHECK(worst < 4e-3);  // the largest facets are 0.05 wide

  std::vector<float> xyz;
  for (int i = 0; i < 8; ++i)
    for (int k = 0; k < 3; ++k) xyz.push_back(i >> k & 1 ? 1.0f : -1.0f);
  const std::vector<int32_t> t = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                  2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  SurfaceItem cube = ball;
  cube.data = surface(xyz, t);
  Camera c = front_parallel(5);
  c.position = {4, 0, 10};  // sees the faces +z and +x
  s.items = {cube};
  const Picture smooth = draw(s, c, 100, 100);
  cube.flat = true, s.items = {cube};
  const Picture flat = draw(s, c, 100, 100);
  double differ = 0;
  for (size_t i = 0; i < smooth.frame.rgba.size(); ++i)
    differ = std::max(differ, std::abs(double(smooth.frame.rgba[i]) - double(flat.frame.rgba[i])));
  CHECK(differ < 1e-6);  // edges of 90 degrees are all split
  cube.flat = false, cube.feature_angle = 100, s.items = {cube};
  CHECK_FALSE(same_bytes(draw(s, c, 100, 100).frame.rgba, flat.frame.rgba));
}

TEST_CASE("raster: cell colours are flat, direct colours exact, NaN and out-of-range values take their own") {
  FieldSet f;
  f.add({"cell", Association::cell, Array::from_vector<float>({0.25f, NAN}), "", Role::none});
  f.add({"rgb", Association::point, Array::from_vector<uint8_t>({255, 0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0}, 3), "", Role::colors});
  f.add({"wide", Association::point, Array::from_vector<double>({5, 5, -5, -5}), "", Role::none});
  SurfaceItem q = item(quad(1, 0, f), {}, false);
  q.color_by = grey_by("cell", 0, 1), q.color_by->association = Association::cell, q.color_by->scale.nan = {1, 0, 1};
  Scene s;
  s.items = {q};
  Picture p = draw(s, front_parallel(2), 64, 64);
  CHECK(p.rgba(48, 40)[0] == doctest::Approx(0.25).epsilon(1e-3));  // lower right triangle
  CHECK(p.rgba(10, 20)[0] == 1);
  CHECK(p.rgba(10, 20)[1] == 0);
  q.color_by = FieldColor{}, q.color_by->field = "rgb", q.color_by->direct = true, s.items = {q};
  p = draw(s, front_parallel(2), 64, 64);
  CHECK(p.rgba(20, 20)[0] == 1);
  CHECK(p.rgba(20, 20)[1] == 0);
  q.color_by = grey_by("wide", -1, 1), q.color_by->scale.below = Vec3f{0, 1, 0}, q.color_by->scale.above = Vec3f{0, 0, 1}, s.items = {q};
  p = draw(s, front_parallel(2), 64, 64);
  CHECK(p.rgba(32, 60)[2] == 1);  // bottom: 5, above
  CHECK(p.rgba(32, 3)[1] == 1);   // top: -5, below
  q.color_by->scale.clamp = false, s.items = {q};
  p = draw(s, front_parallel(2), 64, 64);
  CHECK(p.id(32, 60) == 0);  // out of range and not clamped: not there
  CHECK(p.id(32, 32) == 1);
  CHECK(p.id(32, 3) == 0);
  CHECK(p.fragments.empty());
}

TEST_CASE("raster: values that are an end of the scale are on it, whatever interpolation and storing round") {
  const DatasetPtr shape = torus(40, 20);
  const size_t n = shape->point_count();
  for (const auto& [lo, hi] : {std::pair{293.15, 913.15}, {0.1, 0.7}, {1.0, 3.0}})
    for (const ScaleKind kind : {ScaleKind::linear, ScaleKind::log, ScaleKind::symlog})
      for (const ElementType type : {ElementType::f32, ElementType::f64}) {
        std::vector<double> ends(n);
        for (size_t i = 0; i < n; ++i) ends[i] = i / 200 % 2 ? lo : hi;
        size_t drawn = 0, beyond = 0;
        for (const std::vector<double>& v : {ends, std::vector<double>(n, lo), std::vector<double>(n, hi)}) {
          FieldSet f;
          f.add({"v", Association::point, Array::from_vector(v).converted(type), "", Role::none});
          SurfaceItem q = item(make_dataset(*shape->as<SurfaceMesh>(), f), {}, false);
          q.color_by = grey_by("v", lo, hi), q.color_by->scale.kind = kind;
          q.color_by->scale.below = Vec3f{1, 0, 1}, q.color_by->scale.above = Vec3f{1, 0, 1};
          Scene s;
          s.items = {q};
          const Picture p = draw(s, slanted(), 97, 97);
          for (int y = 0; y < 97; ++y)
            for (int x = 0; x < 97; ++x) drawn += p.id(x, y) > 0, beyond += p.id(x, y) > 0 && p.rgba(x, y)[0] != p.rgba(x, y)[1];
        }
        CAPTURE(lo);
        CAPTURE(int(kind));
        CAPTURE(element_name(type));
        CHECK(drawn > 3000);
        CHECK(beyond == 0);
      }
}

TEST_CASE("raster: a logarithmic scale colours by value, not by blended colours") {
  SurfaceItem q = item(quad(1, 0, point_field("v", {1, 100, 100, 1})), {}, false);
  q.color_by = grey_by("v", 1, 100), q.color_by->scale.kind = ScaleKind::log;
  Scene s;
  s.items = {q};
  const Picture p = draw(s, front_parallel(2), 64, 64);
  for (int x = 1; x < 63; ++x) CHECK(p.rgba(x, 30)[0] == doctest::Approx(std::log10(1 + 99 * (x + 0.5) / 64) / 2).epsilon(1e-3));
}

TEST_CASE("raster: clipping at the near plane leaves what lies beyond it") {
  // A floor that runs from far in front to behind the viewer.
  Scene s;
  s.items.push_back(item(surface({-3, -1, -50, 3, -1, -50, 3, -1, 50, -3, -1, 50}, {0, 1, 2, 0, 2, 3})));
  Camera c = front(0, 60);
  c.target = {0, 0, -1}, c.near_plane = 2;
  const int n = 200;
  const Projection projection = make_projection(c, n, n);
  const Picture p = draw(s, c, n, n);
  size_t wrong = 0, inside = 0;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const Projection::Ray r = projection.ray(x + 0.5, y + 0.5);
      const double t = (-1 - r.origin.y) / r.direction.y, depth = t / r.per_depth, px = r.origin.x + t * r.direction.x;
      if (std::abs(depth - 2) < 0.02 || std::abs(std::abs(px) - 3) < 0.05 || std::abs(depth - 50) > 49.5) continue;
      const bool there = t > 0 && depth > 2 && depth < 50 && std::abs(px) < 3;
      inside += there, wrong += there != (p.id(x, y) > 0);
      if (there && p.id(x, y)) CHECK(p.depth(x, y) == doctest::Approx(depth).epsilon(1e-5));
    }
  CHECK(inside > 1000);
  CHECK(wrong == 0);
}

TEST_CASE("raster: data at 1e7 looks like data at zero") {
  const Vec3 shift{1e7, -2e7, 3e7};
  Scene a, b;
  a.items = {item(torus(80, 40))}, b.items = {item(torus(80, 40, false, shift))};
  Camera c = fit_camera(scene_bounds(a), {1, 2, 3}, {0, 0, 1}, 1.5), d = c;
  // The camera's own numbers must survive the shift for the pictures to be equal.
  for (int k = 0; k < 3; ++k) c.position[k] = std::round(c.position[k] * 1024) / 1024, c.target[k] = std::round(c.target[k] * 1024) / 1024;
  d = c;
  d.position += shift, d.target += shift;
  const Picture p = draw(a, c, 300, 200), q = draw(b, d, 300, 200);
  CHECK(p.covered() > 8000);
  CHECK(same_bytes(p, q));
}

TEST_CASE("raster: f64 positions at 1e7 do not jitter") {
  const DatasetPtr small = torus(80, 40);
  const Points& from = small->as<SurfaceMesh>()->points;
  SurfaceMesh m = *small->as<SurfaceMesh>();
  std::vector<double> xyz;
  for (size_t i = 0; i < from.count(); ++i)
    for (int k = 0; k < 3; ++k) xyz.push_back(1e7 + from.xyz.get(i, k));
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  Scene a, b;
  a.items = {item(small)}, b.items = {item(make_dataset(m))};
  Camera c = fit_camera(scene_bounds(a), {1, 2, 3}, {0, 0, 1}, 1.5), d = c;
  d.position += Vec3{1e7, 1e7, 1e7}, d.target += Vec3{1e7, 1e7, 1e7};
  const Picture p = draw(a, c, 300, 200), q = draw(b, d, 300, 200);
  double sum = 0;
  for (size_t i = 0; i < p.frame.rgba.size(); ++i) sum += std::abs(double(p.frame.rgba[i]) - double(q.frame.rgba[i]));
  CHECK(sum / double(p.frame.rgba.size()) < 1e-4);
}

TEST_CASE("raster: degenerate, huge and not-a-number triangles do no harm") {
  const float big = 1e30f, nan = NAN, inf = INFINITY;
  Scene s;
  s.items.push_back(item(surface({0,    0,    0, 1,   0,    0, 2, 0,   0,  // a line
                                  0,    0,    0, 0,   0,    0, 0, 0,   0,  // a point
                                  nan,  0,    0, 1,   0,    0, 0, 1,   0,  // no number
                                  inf,  0,    0, 0,   inf,  0, 0, 0,   0,  // no end
                                  -big, -big, 0, big, -big, 0, 0, big, 0, -1e6f, -1e6f, -1, 1e6f, -1e6f, -1, 0, 1e6f, -1},
                                 {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17})));
  const Picture p = draw(s, front(), 64, 64);
  CHECK(p.covered() == 64 * 64);  // the last one covers all
  CHECK(p.depth(32, 32) == doctest::Approx(11).epsilon(1e-5));
  // Seen edge-on and from within its plane.
  Camera c = front();
  c.position = {3, 0, 0}, c.target = {0, 0, 0};
  const Picture edge = draw(s, c, 64, 64);
  for (float v : edge.frame.rgba) CHECK(std::isfinite(v));
}

TEST_CASE("raster: of two surfaces at the same place the first is seen; ids tell the items") {
  Scene s;
  s.items = {item(quad(1, 0)), item(quad(1, 0)), item(quad(0.5, 1))};
  const Picture p = draw(s, front_parallel(4), 64, 64);
  CHECK(p.id(20, 20) == 1);
  CHECK(p.id(32, 32) == 3);
  CHECK(p.id(2, 2) == 0);
  CHECK(p.depth(32, 32) == doctest::Approx(9));
  CHECK(p.depth(20, 20) == doctest::Approx(10));
}

TEST_CASE("raster: polygons, strips, 64-bit ids, strided positions and ghosts draw the same quad") {
  Scene s;
  s.items = {item(quad(1, 0))};
  const Picture p = draw(s, front_parallel(4), 64, 64);
  const std::vector<float> corners = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
  SurfaceMesh polygon = triangle_mesh(corners, {});
  polygon.polygons = {Array::from_vector<int64_t>({0, 1, 2, 3}), Array::from_vector<int64_t>({0, 4}), 0};
  SurfaceMesh strip = triangle_mesh(corners, {});
  strip.polygons = {};
  strip.strips = {Array::from_vector<int64_t>({0, 1, 3, 2}), Array::from_vector<int64_t>({0, 4}), 0};
  for (const SurfaceMesh& m : {polygon, strip}) {
    s.items = {item(make_dataset(m))};
    const Picture q = draw(s, front_parallel(4), 64, 64);
    CHECK(q.frame.ids == p.frame.ids);
    CHECK(q.frame.rgba == p.frame.rgba);
  }
  DatasetParts parts;
  parts.mesh = triangle_mesh(corners, {0, 1, 2, 0, 2, 3});
  parts.cell_ghost = Array::from_vector<uint8_t>({0, ghost_hidden_cell});
  s.items = {item(make_dataset(parts))};
  const Picture half = draw(s, front_parallel(4), 64, 64);
  CHECK(half.covered() < p.covered() * 6 / 10);
  CHECK(half.covered() > p.covered() * 4 / 10);
}

TEST_CASE("raster: other meshes show their outer faces, concave polygons their own shape") {
  UniformGrid g;
  g.dims = {3, 3, 3}, g.origin = {-1, -1, -1};
  FieldSet f;
  f.add({"cell", Association::cell, Array::from_vector<float>({0, 0, 0, 0, 0.5f, 0.5f, 0.5f, 0.5f}), "", Role::none});
  SurfaceItem q = item(make_dataset(g, f), {}, false);
  q.color_by = grey_by("cell", 0, 1), q.color_by->association = Association::cell;
  Scene s;
  s.items = {q};
  const Picture p = draw(s, front_parallel(4), 64, 64);
  CHECK(p.covered() == 32 * 32);
  CHECK(p.depth(32, 32) == doctest::Approx(9));
  CHECK(p.rgba(20, 40)[0] == doctest::Approx(0.5).epsilon(1e-3));
  SurfaceMesh m = triangle_mesh({0, 0, 0, 1.5f, 1.5f, 0, 0, 0.5f, 0, -1.5f, 1.5f, 0}, {});  // an arrow head
  m.polygons = {Array::from_vector<int32_t>({0, 1, 2, 3}), {}, 4};
  for (int turn = 0; turn < 4; ++turn) {
    std::vector<int32_t> ids;
    for (int k = 0; k < 4; ++k) ids.push_back((k + turn) % 4);
    m.polygons.connectivity = Array::from_vector(ids), s.items = {item(make_dataset(m))};
    const Picture a = draw(s, front_parallel(4), 64, 64);
    CHECK(double(a.covered()) == doctest::Approx(0.75 * 256).epsilon(0.1));
    CHECK(a.id(32, 10) == 0);  // the notch
  }
}

TEST_CASE("raster: mistakes are told") {
  Scene s;
  SurfaceItem q = item(quad(1, 0, point_field("temperature", {1, 2, 3, 4})));
  q.color_by = grey_by("tempe", 0, 1), s.items = {q};
  auto error = [&] { return error_of([&] { draw(s, front(), 8, 8); }); };
  CHECK(error().find("temperature") != std::string::npos);
  q.color_by = grey_by("temperature", 0, 1), q.color_by->component = 2, s.items = {q};
  CHECK(error().find("component") != std::string::npos);
  q.color_by.reset(), q.normals = "temperature", s.items = {q};
  CHECK(error().find("normals") != std::string::npos);
  q = {}, s.items = {q};
  CHECK(error().find("no data") != std::string::npos);
  Frame f(4, 4);
  Context context;
  CHECK(error_of([&] { rasterize({}, make_projection(front(), 8, 8), 1, f, context); }).find("4x4") != std::string::npos);
  CHECK(error_of([&] { rasterize({}, make_projection(front(), 4, 4), 0, f, context); }).find("pixel scale") != std::string::npos);
  context.cancel();
  s.items = {item(quad(1, 0))};
  CHECK(error_of([&] { rasterize(s, make_projection(front(), 4, 4), 1, f, context); }) != "");
}

// SPDX-License-Identifier: Apache-2.0
// Lines and dots: covered area, joints, depth, colour.
#include "raster_support.h"

using namespace sg;
using namespace sg::test;

namespace {

/// Sum of the alpha of everything in the picture, in pixels.
double ink(const Picture& p) {
  double sum = 0;
  for (size_t i = 0; i < p.frame.pixels(); ++i) {
    double rest = 1;
    if (!p.fragments.empty())
      for (uint32_t k = p.fragments.start[i]; k < p.fragments.start[i + 1]; ++k) rest *= 1 - double(p.fragments.fragments[k].rgba[3]);
    sum += 1 - rest * (1 - double(p.frame.rgba[4 * i + 3]));
  }
  return sum;
}

/// What shows through black fragments of the opaque picture's red.
double red_behind(const Picture& p, int x, int y) {
  double red = double(p.rgba(x, y)[0]);
  const size_t i = size_t(y) * size_t(p.frame.width) + size_t(x);
  if (!p.fragments.empty())
    for (uint32_t k = p.fragments.start[i]; k < p.fragments.start[i + 1]; ++k) red *= 1 - double(p.fragments.fragments[k].rgba[3]);
  return red;
}

}  // namespace

TEST_CASE("raster lines: the covered area is length times width plus the round caps, for any width and direction") {
  for (const double width : {0.4, 0.8, 1.0, 1.5, 3.0, 8.0})
    for (int k = 0; k < 12; ++k) {
      const double angle = 0.1 + k * 0.53, half = 60;  // pixels; 200 pixels are 200 world units
      Scene s;
      s.items = {line({float(-half * std::cos(angle)), float(-half * std::sin(angle)), 0, float(half * std::cos(angle)),
                       float(half * std::sin(angle)), 0},
                      width)};
      const double area = ink(draw(s, front_parallel(200), 200, 200)), wanted = 2 * half * width + pi * width * width / 4;
      CHECK(area == doctest::Approx(wanted).epsilon(0.012));
    }
}

TEST_CASE("raster lines: a polyline of many pieces covers what one line covers, and turns without gaps") {
  Scene a, b;
  std::vector<float> pieces;
  for (int i = 0; i <= 300; ++i) pieces.push_back(-60 + 0.4f * float(i)), pieces.push_back(-20 + 0.15f * float(i)), pieces.push_back(0);
  a.items = {line({-60, -20, 0, 60, 25, 0}, 2.5)}, b.items = {line(pieces, 2.5)};
  const Picture p = draw(a, front_parallel(200), 200, 200), q = draw(b, front_parallel(200), 200, 200);
  CHECK(ink(q) == doctest::Approx(ink(p)).epsilon(2e-3));
  double worst = 0;
  for (size_t i = 0; i < p.frame.pixels(); ++i) {
    auto alpha = [&](const Picture& x) {
      double rest = 1 - double(x.frame.rgba[4 * i + 3]);
      for (uint32_t k = x.fragments.start[i]; k < x.fragments.start[i + 1]; ++k) rest *= 1 - double(x.fragments.fragments[k].rgba[3]);
      return 1 - rest;
    };
    worst = std::max(worst, std::abs(alpha(p) - alpha(q)));
  }
  CHECK(worst < 0.02);
  // A closed circle of 64 chords: its length times its width.
  std::vector<float> circle;
  for (int i = 0; i <= 64; ++i)
    circle.push_back(float(70 * std::cos(2 * pi * i / 64))), circle.push_back(float(70 * std::sin(2 * pi * i / 64))), circle.push_back(0);
  a.items = {line(circle, 3)};
  CHECK(ink(draw(a, front_parallel(200), 200, 200)) == doctest::Approx(64 * 140 * std::sin(pi / 64) * 3).epsilon(0.01));
}

TEST_CASE("raster lines: width grows with the pixel scale") {
  Scene s;
  s.items = {line({-50, 0, 0, 50, 0, 0}, 2)};
  CHECK(ink(draw(s, front_parallel(200), 200, 200, 3)) == doctest::Approx(100 * 6 + pi * 9).epsilon(0.01));
}

TEST_CASE("raster lines: hidden behind a surface, seen in front of it and lying on it") {
  const Camera c = front_parallel(200);
  Scene s;
  s.items = {item(quad(90, 0)), line({-50, 0, -20, 50, 0, -20}, 3)};
  Picture p = draw(s, c, 200, 200);
  CHECK(p.fragments.empty());
  CHECK(p.id(100, 100) == 1);
  s.items = {item(quad(90, 0)), line({-50, 0, 3, 50, 0, 3}, 3)};
  p = draw(s, c, 200, 200);
  CHECK(p.id(100, 100) == 2);
  CHECK(p.depth(100, 100) == doctest::Approx(7));
  // On a plane that is seen at a slant of 70 degrees, along its steepest direction and across it.
  const float z = 80 * float(std::tan(70 * pi / 180));
  Scene slanted;
  slanted.items = {item(surface({-80, -80, -z, 80, -80, -z, 80, 80, z, -80, 80, z}, {0, 1, 2, 0, 2, 3})), line({-60, 0, 0, 60, 0, 0}, 2),
                   line({0, -60, -z * 0.75f, 0, 60, z * 0.75f}, 2)};
  Camera far = front_parallel(200, 500);
  p = draw(slanted, far, 200, 200);
  Scene alone;
  alone.items = {slanted.items[1], slanted.items[2]};
  const Picture q = draw(alone, far, 200, 200);
  size_t wrong = 0;
  for (size_t i = 0; i < p.frame.pixels(); ++i) wrong += (q.frame.ids[i] > 0) != (p.frame.ids[i] > 1);
  CHECK(wrong == 0);
  CHECK(q.covered() > 100);
}

TEST_CASE("raster lines: what is behind the near plane is cut off, colours follow the line in perspective") {
  FieldSet f;
  f.add({"z", Association::point, Array::from_vector<float>({-100, 100}), "", Role::none});
  Scene s;
  LinesItem l = line({-1, -1, -100, -1, -1, 100}, 4, f);
  l.color_by = grey_by("z", -100, 0), s.items = {l};
  Camera c = front(0, 60);
  c.target = {0, 0, -1}, c.near_plane = 1;
  const Projection projection = make_projection(c, 400, 400);
  const Picture p = draw(s, c, 400, 400);
  const double near_row = projection.to_pixel({-1, -1, -1}).y;
  size_t seen = 0;
  for (int y = 0; y < 400; ++y)
    for (int x = 0; x < 400; ++x) {
      if (!p.id(x, y)) continue;
      ++seen;
      CHECK(y < near_row + 3);
      // Row -> depth: y = 200 + scale / depth.
      const double depth = projection.scale / (y + 0.5 - 200);
      if (depth > 2 && depth < 20) CHECK(p.rgba(x, y)[0] == doctest::Approx(1 - depth / 100).epsilon(0.01 + 2 * depth / projection.scale));
    }
  CHECK(seen > 300);
}

TEST_CASE("raster points: area, shading and hidden points") {
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector<float>({0.3f, 0.4f, 0, NAN, 0, 0, 50, 50, 0}, 3);
  DatasetParts parts;
  parts.mesh = cloud, parts.point_ghost = Array::from_vector<uint8_t>({0, 0, ghost_hidden_point});
  PointsItem dots;
  dots.data = make_dataset(parts), dots.size = 20, dots.color = {1, 1, 1}, dots.shaded = false;
  Scene s;
  s.items = {dots};
  Picture p = draw(s, front_parallel(200), 200, 200);
  CHECK(ink(p) == doctest::Approx(pi * 100).epsilon(0.005));
  CHECK(p.rgba(100, 100)[0] == 1);
  CHECK(p.id(150, 50) == 0);
  dots.shaded = true, s.items = {dots};
  s.lights = {{{0, 0, 1}, true, 1}};
  p = draw(s, front_parallel(200), 200, 200);
  CHECK(p.rgba(100, 99)[1] > 0.95f);
  CHECK(p.rgba(107, 99)[1] < 0.85f * p.rgba(100, 99)[1]);
  // The vertices of a surface mesh are its dots when there are any.
  SurfaceMesh m = triangle_mesh({-50, 0, 0, 50, 0, 0}, {});
  m.polygons = {}, m.vertices = {Array::from_vector<int32_t>({1}), {}, 1};
  dots.data = make_dataset(m), s.items = {dots};
  p = draw(s, front_parallel(200), 200, 200);
  CHECK(p.id(150, 100) == 1);
  CHECK(p.id(50, 100) == 0);
  // A lattice has points too.
  UniformGrid g;
  g.dims = {3, 2, 1}, g.origin = {-50, -20, 0}, g.spacing = {50, 40, 1}, dots.data = make_dataset(g), s.items = {dots};
  p = draw(s, front_parallel(200), 200, 200);
  for (int x : {50, 100, 150})
    for (int y : {80, 120}) CHECK(p.id(x, y) == 1);
}

TEST_CASE("raster edges: every edge once, over the surface, diagonals of polygons left out") {
  SurfaceMesh m = triangle_mesh({-60, -60, 0, 0, -60, 0, 60, -60, 0, -60, 60, 0, 0, 60, 0, 60, 60, 0}, {});
  m.polygons = {Array::from_vector<int32_t>({0, 1, 4, 3, 1, 2, 5, 4}), {}, 4};
  SurfaceItem q = item(make_dataset(m), {1, 1, 1}, false);
  q.edges = true, q.edge_color = {1, 0, 0};
  Scene s;
  s.items = {q};
  const Picture p = draw(s, front_parallel(200), 200, 200, 2);
  auto red = [&](int x, int y) { return p.rgba(x, y)[0] == 1 && p.rgba(x, y)[1] == 0; };
  CHECK(red(100, 100));
  CHECK(red(40, 100));
  CHECK(red(70, 40));
  CHECK_FALSE(red(70, 100));  // a diagonal would pass here
  CHECK(p.rgba(70, 100)[1] == 1);
  CHECK(p.id(100, 100) == 1);
}

TEST_CASE("raster edges: they fade where cells are narrower than eight pixels across them, and are gone below three") {
  // A square of 120 pixels in cells of dx by dy of them; a pixel of the rule is `scale` pixels.
  const auto drawn = [](int dx, int dy, int scale) {
    std::vector<float> xyz;
    std::vector<int32_t> ids;
    const int nx = 120 / dx, ny = 120 / dy;
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i) xyz.insert(xyz.end(), {float(i * dx - 60), float(j * dy - 60), 0});
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const int a = j * (nx + 1) + i;
        ids.insert(ids.end(), {a, a + 1, a + nx + 2, a + nx + 1});
      }
    SurfaceMesh m = triangle_mesh(xyz, {});
    m.polygons = {Array::from_vector(ids), {}, 4};
    SurfaceItem q = item(make_dataset(m), {1, 1, 1}, false);
    q.edges = true, q.edge_color = {0, 0, 0};
    Scene s;
    s.items = {q};
    return draw(s, front_parallel(200), 200, 200, scale);
  };
  for (const int scale : {1, 2}) {
    const Picture wide = drawn(20, 20, scale), narrow = drawn(2, 2, scale), layers = drawn(30, 2, scale),
                  five = drawn(5 * scale, 5 * scale, scale);
    CHECK(red_behind(wide, 100, 90) < 0.6);  // on the line x = 0
    CHECK(red_behind(wide, 110, 90) == 1);   // inside a cell
    for (int x = 60; x < 140; ++x) CHECK(red_behind(narrow, x, 90) == 1);
    CHECK(red_behind(layers, 100, 90) < 0.6);  // across the layers cells are wide, along them they are not
    for (int y = 60; y < 140; ++y) CHECK(red_behind(layers, 115, y) == 1);
    double dark = 1;
    for (int x = 90; x < 110; ++x) dark = std::min(dark, red_behind(five, x, 92));
    CHECK(dark > 0.5);
    CHECK(dark < 0.95);
  }
}

TEST_CASE("raster edges: without a colour of their own they are darker than bright surfaces and lighter than dark ones") {
  SurfaceMesh m = triangle_mesh({-60, -60, 0, 0, -60, 0, 60, -60, 0, -60, 60, 0, 0, 60, 0, 60, 60, 0}, {});
  m.polygons = {Array::from_vector<int32_t>({0, 1, 4, 3, 1, 2, 5, 4}), {}, 4};
  for (const float grey : {0.9f, 0.6f, 0.4f, 0.2f, 0.05f}) {
    SurfaceItem q = item(make_dataset(m), {grey, grey, grey}, false);
    q.edges = true;
    Scene s;
    s.items = {q};
    const Picture p = draw(s, front_parallel(200), 200, 200, 2);
    const double face = p.rgba(70, 100)[0], edge = p.rgba(100, 100)[0];
    CAPTURE(grey);
    if (grey > 0.35f) CHECK(edge < 0.5 * face);
    else CHECK(edge > 2 * face);
  }
}

TEST_CASE("raster edges: darker or lighter all over, as suits most of the surface") {
  // Two dark squares and a bright one, or one and two: the same edge is the same on all.
  for (const bool mostly_dark : {false, true}) {
    SurfaceMesh m = triangle_mesh({-90, -30, 0, -30, -30, 0, 30, -30, 0, 90, -30, 0, -90, 30, 0, -30, 30, 0, 30, 30, 0, 90, 30, 0}, {});
    m.polygons = {Array::from_vector<int32_t>({0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6}), {}, 4};
    const uint8_t middle = mostly_dark ? 20 : 200;
    FieldSet fields;
    fields.add(
        {"rgb", Association::cell, Array::from_vector<uint8_t>({20, 20, 20, middle, middle, middle, 200, 200, 200}, 3), "", Role::colors});
    SurfaceItem q = item(make_dataset(m, fields), {1, 1, 1}, false);
    q.color_by = FieldColor{"rgb", Association::cell, -1, {}, true};
    q.edges = true;
    Scene s;
    s.items = {q};
    const Picture p = draw(s, front_parallel(200), 200, 200, 2);
    const auto red = [&](int x, int y) { return p.rgba(x, y)[0]; };
    CAPTURE(mostly_dark);
    const double on_dark = red(40, 70) - red(40, 100), on_bright = red(160, 70) - red(160, 100);  // edge less face
    CHECK((on_dark > 0) == mostly_dark);
    CHECK((on_bright > 0) == mostly_dark);
  }
}

TEST_CASE("raster edges: where most cells are too small for edges, the others have none either") {
  // Squares of 20 pixels on the left; on the right as many columns, or none, of squares of 2.
  const auto left_edge = [](int small) {
    std::vector<float> xyz;
    std::vector<int32_t> ids;
    const auto squares = [&](float x0, int nx, int ny, float d) {
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i) {
          const auto at = int32_t(xyz.size() / 3);
          const float x = x0 + float(i) * d, y = -60 + float(j) * d;
          xyz.insert(xyz.end(), {x, y, 0, x + d, y, 0, x + d, y + d, 0, x, y + d, 0});
          ids.insert(ids.end(), {at, at + 1, at + 2, at + 3});
        }
    };
    squares(-60, 3, 6, 20), squares(0, small, small > 0 ? 60 : 0, 2);
    SurfaceMesh m = triangle_mesh(xyz, {});
    m.polygons = {Array::from_vector(ids), {}, 4};
    SurfaceItem q = item(make_dataset(m), {1, 1, 1}, false);
    q.edges = true, q.edge_color = {0, 0, 0};
    Scene s;
    s.items = {q};
    return red_behind(draw(s, front_parallel(200), 200, 200, 1), 60, 90);
  };
  CHECK(left_edge(0) < 0.6);
  CHECK(left_edge(30) == 1);
}

TEST_CASE("raster marks: mistakes are told") {
  Scene s;
  s.items = {LinesItem{}};
  CHECK(error_of([&] { draw(s, front(), 8, 8); }).find("lines: the item has no data") != std::string::npos);
  s.items = {PointsItem{}};
  CHECK(error_of([&] { draw(s, front(), 8, 8); }).find("points: the item has no data") != std::string::npos);
  LinesItem l;
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector<float>({0, 0, 0}, 3);
  l.data = make_dataset(cloud), s.items = {l};
  CHECK(error_of([&] { draw(s, front(), 8, 8); }).find("points mesh") != std::string::npos);
  PointsItem p;
  AmrGrid amr;
  amr.levels.resize(1);
  amr.levels[0].patches.push_back({{0, 0, 0}, {1, 1, 1}, 0, 0});
  p.data = make_dataset(amr), s.items = {p};
  CHECK(error_of([&] { draw(s, front(), 8, 8); }).find("amr mesh cannot be drawn") != std::string::npos);
  p.data = l.data, p.color_by = FieldColor{}, p.color_by->field = "v", p.color_by->association = Association::cell, s.items = {p};
  CHECK(error_of([&] { draw(s, front(), 8, 8); }).find("cell field 'v'") != std::string::npos);
}

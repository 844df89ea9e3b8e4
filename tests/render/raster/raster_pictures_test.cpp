// SPDX-License-Identifier: Apache-2.0
// Pictures on surfaces: where their texels are seen, what a pixel sees of them, and the same along paths of light.
#include <limits>

#include "image/texture/patterns.h"
#include "raster_support.h"
#include "render/trace/trace.h"
#include "scene/items/surface_pictures.h"
#include "scene/light/light_params.h"

using namespace sg;
using namespace sg::test;
using doctest::Approx;

namespace {

FieldSet coordinates(std::vector<float> uv) {
  FieldSet f;
  f.add({"uv", Association::point, Array::from_vector(std::move(uv), 2), "", Role::tcoords});
  return f;
}

SurfacePicture picture(Texture texture) {
  SurfacePicture p;
  p.texture = std::make_shared<const Texture>(std::move(texture)), p.coordinates = "uv";
  return p;
}

/// Unlit and white, under a picture.
SurfaceItem pictured(DatasetPtr data, SurfacePicture p, SurfacePictures::Alpha alpha = SurfacePictures::Alpha::none) {
  SurfaceItem s = item(std::move(data), {1, 1, 1}, false);
  auto all = std::make_shared<SurfacePictures>();
  all->color = std::move(p), all->alpha = alpha;
  s.pictures = all;
  return s;
}

/// A plane z = 0 to the horizon; u = x, v = y.
DatasetPtr plane(float a) { return quad(a, 0, coordinates({-a, -a, a, -a, a, a, -a, a})); }

Camera above_plane() {
  Camera c;
  c.position = {0, 0, 1}, c.target = {0, 10, 0}, c.up = {0, 0, 1}, c.view_angle = 50, c.near_plane = 0.01, c.far_plane = 1e5;
  return c;
}

Scene checkered() {
  SurfacePicture p = picture(pattern_texture(TexturePattern::checker, {0, 0, 0}, {1, 1, 1}));
  p.lookup.sharp = true;
  Scene s;
  s.items.emplace_back(pictured(plane(1000), p));
  return s;
}

/// What a pixel of the checkered plane sees, by many rays.
double seen(const Projection& projection, int x, int y) {
  constexpr int n = 24;
  double sum = 0;
  for (int k = 0; k < n * n; ++k) {
    const Projection::Ray r = projection.ray(x + (k % n + 0.5) / n, y + (k / n + 0.5) / n);
    const Vec3 hit = r.origin + r.direction * (-r.origin.z / r.direction.z);
    sum += (int64_t(std::floor(2 * hit.x)) + int64_t(std::floor(2 * hit.y))) % 2 != 0;
  }
  return sum / (n * n);
}

Frame traced(const Scene& scene, const Camera& camera, int w, int h,
             trace::IntegratorKind integrator = trace::IntegratorKind::ambient_occlusion) {
  Context context;
  LightOptions options;
  options.integrator = integrator, options.noise = 1e-4, options.paths = 64;
  TraceReport report;
  return trace_scene(scene, prepare_scene(scene, context), make_projection(camera, w, h), options, report, context);
}

}  // namespace

TEST_CASE("pictures: a ramp of texels is seen where the ray of each pixel meets it, in perspective") {
  std::vector<Vec4f> texels;
  constexpr int size = 64;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) texels.push_back({(float(x) + 0.5f) / size, (float(y) + 0.5f) / size, 0.5f, 1});
  Scene s;
  SurfacePicture p = picture({size, size, texels});
  p.lookup.wrap_u = p.lookup.wrap_v = TextureWrap::clamp;
  s.items.emplace_back(pictured(quad(2, 0, coordinates({0, 0, 1, 0, 1, 1, 0, 1})), p));
  Camera c;
  c.position = {0.5, -6, 2}, c.target = {0, 0, 0}, c.up = {0, 0, 1}, c.view_angle = 40;
  const Projection projection = make_projection(c, 300, 200);
  for (const TextureFilter f : {TextureFilter::bilinear, TextureFilter::anisotropic}) {
    auto all = std::make_shared<SurfacePictures>(*std::get<SurfaceItem>(s.items[0]).pictures);
    all->color->lookup.filter = f;
    std::get<SurfaceItem>(s.items[0]).pictures = all;
    const Picture drawn = draw(s, c, 300, 200);
    double worst = 0;
    for (int y = 0; y < 200; ++y)
      for (int x = 0; x < 300; ++x) {
        if (!drawn.id(x, y)) continue;
        const Projection::Ray r = projection.ray(x + 0.5, y + 0.5);
        const Vec3 hit = r.origin + r.direction * (-r.origin.z / r.direction.z);
        if (std::abs(hit.x) > 1.9 || std::abs(hit.y) > 1.9) continue;
        worst = std::max(
            {worst, std::abs(double(drawn.rgba(x, y)[0]) - (hit.x + 2) / 4), std::abs(double(drawn.rgba(x, y)[1]) - (hit.y + 2) / 4)});
      }
    CHECK(worst < 2e-4);
  }
}

TEST_CASE("pictures: a checkered plane to the horizon is what its pixels see of it, by the rasterizer and along paths") {
  const Scene s = checkered();
  const Camera c = above_plane();
  constexpr int w = 96, h = 96;
  const Projection projection = make_projection(c, w, h);
  const Picture drawn = draw(s, c, w, h);
  const Frame paths = traced(s, c, w, h);
  double off = 0, off_paths = 0, sharp = 0, far = 0;
  int n = 0;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const size_t at = 4 * (size_t(y) * w + size_t(x));
      const double depth = double(drawn.depth(x, y));
      if (!(depth < 500)) continue;
      const double truth = seen(projection, x, y), a = double(drawn.rgba(x, y)[0]), b = double(paths.rgba[at]);
      off += (a - truth) * (a - truth), off_paths += (b - truth) * (b - truth), sharp += (truth - 0.5) * (truth - 0.5), ++n;
      if (depth > 100) far = std::max({far, std::abs(a - 0.5), std::abs(b - 0.5)});
    }
  REQUIRE(n > 3000);
  CHECK(std::sqrt(off / n) < 0.06);
  CHECK(std::sqrt(off_paths / n) < 0.06);
  CHECK(std::sqrt(sharp / n) > 0.3);
  CHECK(far < 0.03);
}

TEST_CASE("pictures: what is transparent shows what is behind, without fringes") {
  Image image(4, 4, 4);  // the left half red, the right half a green that is not there
  for (int i = 0; i < 16; ++i) {
    uint8_t* p = image.at(i % 4, i / 4);
    if (i % 4 < 2) p[0] = p[3] = 255;
    else p[1] = 255;
  }
  Scene s;
  SurfacePicture p = picture(Texture::of(image, TexelEncoding::srgb));
  p.lookup.wrap_u = p.lookup.wrap_v = TextureWrap::clamp;
  s.items.emplace_back(pictured(quad(1, 0, coordinates({0, 0, 1, 0, 1, 1, 0, 1})), p, SurfacePictures::Alpha::coverage));
  s.background = {0, 0, 1};
  Context context;
  RenderOptions options;
  options.width = options.height = 64, options.samples = 1;
  const Frame f = render(s, front_parallel(2), options, context);
  for (int x = 0; x < 64; ++x) {
    const float* q = &f.rgba[4 * (32 * 64 + size_t(x))];
    CHECK(q[1] == Approx(0).epsilon(1e-4));
    CHECK(q[0] + q[2] == Approx(1).epsilon(1e-3));
    if (x < 23) CHECK(q[0] == Approx(1).epsilon(1e-3));
    if (x > 40) CHECK(q[2] == Approx(1).epsilon(1e-3));
  }
  // A hole has an edge.
  auto all = std::make_shared<SurfacePictures>(*std::get<SurfaceItem>(s.items[0]).pictures);
  all->alpha = SurfacePictures::Alpha::cutout;
  std::get<SurfaceItem>(s.items[0]).pictures = all;
  const Frame cut = render(s, front_parallel(2), options, context);
  for (int x = 0; x < 64; ++x) {
    CHECK(cut.rgba[4 * (32 * 64 + size_t(x))] == Approx(x < 32 ? 1 : 0).epsilon(1e-4));
    CHECK(cut.rgba[4 * (32 * 64 + size_t(x)) + 2] == Approx(x < 32 ? 0 : 1).epsilon(1e-4));
  }
}

TEST_CASE("pictures: texels and corners without numbers leave the surface its own colour") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Texture none = Texture::of(LinearPicture{1, 1, {{nan, nan, nan}}}), grey = Texture::of(LinearPicture{1, 1, {{0.5f, 0.5f, 0.5f}}});
  const auto middle = [&](const Texture& t, float v) {
    Scene s;
    SurfaceItem q = pictured(quad(1, 0, coordinates({0, 0, 1, 0, 1, v, 0, 1})), picture(t));
    s.items.emplace_back(q);
    return draw(s, front_parallel(2), 9, 9).rgba(6, 4)[0];
  };
  CHECK(middle(grey, 1) == Approx(0.5));
  CHECK(middle(none, 1) == Approx(1));
  CHECK(middle(grey, nan) == Approx(1));
}

TEST_CASE("pictures: coordinates that are missing or too short are told") {
  Scene s;
  s.items.emplace_back(pictured(quad(1, 0), picture(pattern_texture(TexturePattern::checker, {}, {1, 1, 1}))));
  CHECK(error_of([&] { draw(s, front(), 8, 8); }).find("uv") != std::string::npos);
  FieldSet f;
  f.add({"uv", Association::point, Array::from_vector(std::vector<float>(4)), "", Role::none});
  s.items[0] = pictured(quad(1, 0, f), picture(pattern_texture(TexturePattern::checker, {}, {1, 1, 1})));
  CHECK(error_of([&] { draw(s, front(), 8, 8); }).find("component") != std::string::npos);
}

TEST_CASE("pictures: roughness and metal by a picture turn a mirror into paper, side by side") {
  // Left a smooth metal, right a rough one, before a dark world with one strong light at the viewer: the mirror sends nothing back.
  std::vector<Vec4f> texels{{0, 0, 1, 1}, {0, 1, 0, 1}};
  auto all = std::make_shared<SurfacePictures>();
  all->factors.push_back({picture({2, 1, texels}), {{MaterialFactor::roughness, 1}, {MaterialFactor::metalness, 2}}});
  all->factors[0].picture.lookup.filter = TextureFilter::nearest;
  SurfaceItem q = item(quad(1, 0, coordinates({0, 0, 1, 0, 1, 1, 0, 1})), {1, 1, 1});
  q.pictures = all;
  SurfaceMaterial m;
  m.base_metalness = 1, m.specular_roughness = 1, m.base_color = {1, 1, 1};
  q.made_of = m;
  Scene s;
  s.items.emplace_back(q);
  s.lighting.lights = parse_lights("directional direction=1,1,1");
  s.lighting.environment = parse_environment("none");
  s.background = {0, 0, 0};
  const Frame f = traced(s, front_parallel(2), 16, 16, trace::IntegratorKind::path);
  CHECK(f.rgba[4 * (8 * 16 + 3)] < 1e-4f);
  CHECK(f.rgba[4 * (8 * 16 + 12)] > 0.05f);
}

TEST_CASE("pictures: what shines by a picture shines as bright as its texels") {
  std::vector<Vec4f> texels{{0.25f, 0.25f, 0.25f, 1}, {0.5f, 0.5f, 0.5f, 1}};
  auto all = std::make_shared<SurfacePictures>();
  all->emission = picture({2, 1, texels});
  all->emission->lookup.filter = TextureFilter::nearest;
  SurfaceItem q = item(quad(1, 0, coordinates({0, 0, 1, 0, 1, 1, 0, 1})), {0, 0, 0}, false);
  q.pictures = all;
  SurfaceMaterial m;
  m.base_color = {0, 0, 0}, m.specular_weight = 0, m.emission = {1, 1, 1};
  q.made_of = m;
  Scene s;
  s.items.emplace_back(q);
  s.lighting.environment = parse_environment("none");
  s.background = {0, 0, 0};
  const Frame f = traced(s, front_parallel(2), 16, 16, trace::IntegratorKind::path);
  const Picture drawn = draw(s, front_parallel(2), 16, 16);
  for (const auto& [x, v] : {std::pair{3, 0.25}, {12, 0.5}}) {
    CHECK(f.rgba[4 * (8 * 16 + size_t(x))] == Approx(v));
    CHECK(drawn.rgba(x, 8)[0] == Approx(v));
  }
}

TEST_CASE("pictures: lines of equal value are as wide everywhere, by the rasterizer and along paths, and fade where they crowd") {
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(std::vector<float>{-1, 1, 1, -1}), "", Role::scalars});
  SurfaceItem q = item(quad(1, 0, f), {1, 1, 1}, false);
  auto lines = std::make_shared<SurfacePictures>();
  lines->isolines = SurfaceIsolines{"v", -1, {-0.503, 0.21}, 2, {0, 0, 0}};
  q.pictures = lines;
  Scene s;
  s.items.emplace_back(q);
  const auto dark = [](const Frame& frame, int y, int from, int to) {
    double sum = 0;
    for (int x = from; x < to; ++x) sum += 1 - double(frame.rgba[4 * (size_t(y) * size_t(frame.width) + size_t(x))]);
    return sum;
  };
  const Picture drawn = draw(s, front_parallel(2), 64, 64);
  const Frame paths = traced(s, front_parallel(2), 64, 64);
  for (const int y : {5, 40}) {
    CHECK(dark(drawn.frame, y, 0, 32) == Approx(2).epsilon(0.01));
    CHECK(dark(drawn.frame, y, 32, 64) == Approx(2).epsilon(0.01));
    CHECK(dark(paths, y, 0, 64) == Approx(4).epsilon(0.03));
  }
  // Twice as many samples: lines of the finished picture are as wide.
  CHECK(dark(draw(s, front_parallel(2), 128, 128, 2).frame, 20, 0, 128) == Approx(8).epsilon(0.02));
  auto many = std::make_shared<SurfacePictures>(*lines);
  many->isolines->values.clear();
  for (int i = 0; i < 200; ++i) many->isolines->values.push_back(-1 + i * 0.01);
  std::get<SurfaceItem>(s.items[0]).pictures = many;
  CHECK(dark(draw(s, front_parallel(2), 64, 64).frame, 20, 0, 64) == Approx(0));
}

TEST_CASE("pictures: a lamp by a picture lights alike by chance, by asking for it, and from its own end") {
  // Half of a lamp over a floor shines; what the floor gets is the closed irradiance of that half.
  std::vector<Vec4f> texels{{1, 1, 1, 1}, {0, 0, 0, 1}};
  auto all = std::make_shared<SurfacePictures>();
  all->emission = picture({2, 1, texels});
  all->emission->lookup.filter = TextureFilter::nearest;
  SurfaceItem lamp = item(quad(1, 1, coordinates({0, 0, 1, 0, 1, 1, 0, 1})), {0, 0, 0}), floor = item(quad(0.01f, 0), {1, 1, 1});
  lamp.pictures = all;
  SurfaceMaterial shines, white;
  shines.base_color = {0, 0, 0}, shines.specular_weight = 0, shines.emission = {1, 1, 1};
  white.specular_weight = 0;
  lamp.made_of = shines, floor.made_of = white;
  Scene s;
  s.items.emplace_back(floor), s.items.emplace_back(lamp);
  s.lighting.environment = parse_environment("none");
  s.background = {0, 0, 0};
  Camera c;  // from below the lamp
  c.position = {0.5, 0, 0.5}, c.target = {0, 0, 0}, c.up = {0, 1, 0}, c.view_angle = 0.5, c.near_plane = 0.01, c.far_plane = 10;
  // Of the rectangle 0 > x > -1, -1 < y < 1 at the distance 1: a form factor over a corner is (X atan(Y/X') / X' + ...) / 2 pi.
  const double r = 1 / std::sqrt(2.0), corner = (r * std::atan(r) + r * std::atan(r)) / (2 * pi), expected = 2 * corner;
  for (const auto kind : {trace::IntegratorKind::path, trace::IntegratorKind::bdpt}) {
    Context context;
    LightOptions options;
    options.integrator = kind, options.noise = 1e-4, options.paths = 2048;
    TraceReport report;
    const Frame f = trace_scene(s, prepare_scene(s, context), make_projection(c, 8, 8), options, report, context);
    double sum = 0;
    for (int i = 0; i < 64; ++i) sum += double(f.rgba[4 * size_t(i)]) / 64;
    CHECK(sum == Approx(expected).epsilon(0.02));
  }
}

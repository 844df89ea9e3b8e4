// SPDX-License-Identifier: Apache-2.0
// Shadows, occlusion, fading with depth and illustrative styles, by what is known of slabs, balls and empty space.
#include "base/error.h"
#include "render/composite/background.h"
#include "render/volume/effects/effects.h"
#include "render/volume/prepare_cast.h"
#include "volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

volume::CastVolume cast_of(const VolumeItem& v) {
  Context context;
  return volume::prepare_cast(v, 1, std::make_shared<const volume::Volume>(volume::prepare(v, 1, {})), parallel_view(1, 1, 1), {}, context);
}

/// Integral of tau from a place towards a lamp, by the midpoint rule on every stretch.
double direct_depth(const volume::CastVolume& v, Vec3 place, Vec3 towards, int cuts = 64) {
  const auto walker = v.source->walker();
  walker->start(place, towards, 0, 100);
  volume::Stretch s[16];
  double sum = 0;
  for (size_t n; (n = walker->next(s)) > 0;)
    for (size_t i = 0; i < n; ++i)
      for (int k = 0; k < cuts; ++k) {
        const double h = (s[i].to - s[i].from) / cuts;
        sum += h * double(v.medium->tau(s[i].value(s[i].from + (k + 0.5) * h)));
      }
  return sum;
}

double ball(Vec3 p) { return 3 * std::exp(-6 * dot(p, p)); }
/// tau is the value.
VolumeItem fog(DatasetPtr data, double most = 4) {
  return item(std::move(data), one_color({0.5f, 0.25f, 0.75f}), density_is_value(0, most));
}
VolumeItem even_fog(double tau, size_t n = 9) {
  return item(grid(cube(n, -1, 1), [](Vec3) { return 1.0; }), one_color({0.5f, 0.25f, 0.75f}), constant_opacity(tau));
}
Scene lit_from(VolumeItem v, Vec3 towards, Vec3f background = {1, 1, 1}) {
  Scene s = scene_of({std::move(v)});
  s.lights = {{towards, false, 1}};
  s.background = background;
  return s;
}

}  // namespace

TEST_CASE("volume light: optical depth of thin spikes, steps and parabolas is the direct integral") {
  const auto data = grid(cube(13, -1, 1), [](Vec3 p) { return std::sin(3 * p.x + 1) * std::cos(2.5 * p.y) + 0.7 * p.z; });
  for (const auto& points : {std::vector<Vec2>{{-2, 0}, {0, 0.05}, {2, 0.7}}, std::vector<Vec2>{{-2, 0}, {0.1, 0}, {0.1, 0.4}, {2, 0.1}},
                             std::vector<Vec2>{{-2, 0}, {0.299, 0}, {0.3, 0.95}, {0.301, 0}, {2, 0}}}) {
    OpacityCurve opacity;
    opacity.points = points;
    VolumeItem v = item(data, one_color({1, 1, 1}), opacity);
    const volume::CastVolume c = cast_of(v);
    const volume::DepthIntegral integral(*c.medium);
    const auto walker = c.source->walker();
    for (uint64_t i = 0; i < 20; ++i) {
      const Vec3 from{random_unit(1, i) - 0.5, random_unit(2, i) - 0.5, -2};
      const Vec3 along = normalize(Vec3{random_unit(3, i) - 0.5, random_unit(4, i) - 0.5, 1});
      float depth[2];
      volume::depths_along({from, along}, *walker, integral, 50, HUGE_VALF, depth);
      CHECK(depth[0] == 0);
      CHECK(double(depth[1]) == doctest::Approx(direct_depth(c, from, along, 4000)).epsilon(1e-3));
    }
  }
}

TEST_CASE("volume light: a light map equals the direct integral at voxel centres to second order") {
  const UniformGrid g = cube(33, -1.5, 1.5);
  VolumeItem v = fog(grid(g, ball));
  const volume::CastVolume c = cast_of(v);
  for (const Vec3 towards : {Vec3{0.3, 0.5, 0.8}, Vec3{-1, 0.2, 0.1}, Vec3{0, 0, -1}}) {
    const Vec3 lamp = normalize(towards);
    double error[3] = {0, 0, 0};
    for (int level = 0; level < 3; ++level) {
      const volume::LightMap map(*c.source, *c.medium, {}, lamp, {0.12 / double(1 << level), size_t(1) << 24});
      for (size_t k = 4; k < 32; k += 4)
        for (size_t j = 4; j < 32; j += 4)
          for (size_t i = 4; i < 32; i += 4) {
            const Vec3 p = g.origin + g.spacing * Vec3(double(i), double(j), double(k));
            error[level] = std::max(error[level], std::abs(double(map.at(p)) - std::exp(-direct_depth(c, p, lamp))));
          }
    }
    MESSAGE("light map errors ", error[0], " ", error[1], " ", error[2]);
    CHECK(error[2] < 0.003);
    CHECK(std::log2(error[0] / error[2]) / 2 > 1.7);
  }
}

TEST_CASE("volume light: a slab casts the shadow that its thickness and the slant of the light say") {
  // A layer between z = 0.25 and 0.5 of extinction 3, on samples 1/16 apart with steep sides.
  const auto layer = [](Vec3 p) { return p.z > 0.24 && p.z < 0.51 ? 1.0 : 0.0; };
  VolumeItem v = item(grid(cube(33, -1, 1), layer), one_color({1, 1, 1}), {});
  v.opacity.points = {{0.5, 0}, {0.5, 1 - std::exp(-3.0)}};  // from the middle of the sides on: 1/16 more in all
  const volume::CastVolume c = cast_of(v);
  const double thick = 0.25 + 0.0625;
  for (const Vec3 towards : {Vec3{0, 0, 1}, Vec3{0.6, 0, 0.8}, Vec3{0.2, -0.3, 0.9}}) {
    const Vec3 lamp = normalize(towards);
    const volume::LightMap map(*c.source, *c.medium, {}, lamp, {});
    for (const Vec3 p : {Vec3{-0.1, 0.1, 0}, Vec3{-0.3, 0.2, -0.3}})
      CHECK(double(map.at(p)) == doctest::Approx(std::exp(-3 * thick / lamp.z)).epsilon(2e-3));
    CHECK(map.at({0, 0, 0.8}) == doctest::Approx(1));
  }
}

TEST_CASE("volume light: a map stays within its memory and coarsens for it") {
  VolumeItem v = even_fog(1, 65);
  const volume::CastVolume c = cast_of(v);
  const volume::LightMap fine(*c.source, *c.medium, {}, {0, 0, 1}, {}), coarse(*c.source, *c.medium, {}, {0, 0, 1}, {0, 1000});
  CHECK(fine.spacing() == c.source->edge);
  CHECK(coarse.bytes() <= 2000);
  CHECK(coarse.spacing() > fine.spacing());
  CHECK(double(fine.at({0.3, -0.4, 0.25})) == doctest::Approx(std::exp(-0.75)).epsilon(1e-4));
  CHECK(double(coarse.at({0.3, -0.4, 0.25})) == doctest::Approx(std::exp(-0.75)).epsilon(5e-3));
  CHECK(double(fine.at({1, 1, -1})) == doctest::Approx(std::exp(-2.0)).epsilon(1e-4));
}

TEST_CASE("volume light: what is clipped away casts no shadow") {
  VolumeItem v = even_fog(1);
  v.clip = {{{0, 0, 1}, 0.5}};
  const volume::CastVolume c = cast_of(v);
  const volume::LightMap map(*c.source, *c.medium, v.clip, {0, 0, 1}, {0.05, size_t(1) << 22});
  CHECK(double(map.at({0, 0, -0.5})) == doctest::Approx(std::exp(-1.0)).epsilon(1e-3));
}

TEST_CASE("volume light: shadows in an even fog lit from the viewer are the analytic integral") {
  const double tau = 1.3, length = 2;
  for (double shadows : {0.5, 1.0}) {
    VolumeItem v = even_fog(tau, 33);
    v.light.shadows = shadows;
    const Frame f = look(lit_from(v, {0, 0, 1}));
    const double ambient = v.light.ambient, once = 1 - std::exp(-tau * length), twice = 0.5 * (1 - std::exp(-2 * tau * length));
    const double light = (ambient + (1 - ambient) * (1 - shadows)) * once + (1 - ambient) * shadows * twice;
    CHECK(double(f.rgba[0]) == doctest::Approx(0.5 * light).epsilon(3e-3));
    CHECK(double(f.rgba[2]) == doctest::Approx(0.75 * light).epsilon(3e-3));
    CHECK(double(f.rgba[3]) == doctest::Approx(once).epsilon(1e-4));
  }
}

TEST_CASE("volume light: effects that take nothing away leave the picture as it is") {
  VolumeItem v = fog(grid(cube(24, -1.5, 1.5), ball));
  v.shaded = true;
  const Projection view = perspective_view(24, 24, 30, {1.9, 1.4, 2.6}, {0, 0, 0});
  const Frame plain = draw(scene_of({v}), view);
  for (double* share : {&v.light.shadows, &v.light.occlusion, &v.light.depth_cue}) {
    *share = 1e-9;
    CHECK(largest_difference(plain, draw(scene_of({v}), view)) < 1.0f / 512);
    *share = 0;
  }
  CHECK(same_bytes(plain, draw(scene_of({v}), view)));
  v.light.shadows = 1;
  CHECK(largest_difference(plain, draw(scene_of({v}), view)) > 0.05f);
}

TEST_CASE("volume light: occlusion of an even fog, of empty space and beside a wall is what its formula says") {
  VolumeItem v = even_fog(0.7, 33);
  const volume::CastVolume c = cast_of(v);
  const volume::Occlusion fogged(*c.source, *c.medium, {}, {});
  CHECK(fogged.radius() == doctest::Approx(2 * std::sqrt(3.0) / 12));
  const double hidden = 1 - std::exp(-0.7 * (fogged.radius() - 0.5 * fogged.cell()));
  CHECK(double(fogged.hidden({0.1, -0.2, 0.15}, {0, 0, 0}, 0)) == doctest::Approx(hidden).epsilon(1e-3));
  CHECK(double(fogged.hidden({0.1, -0.2, 0.15}, normalize(Vec3f{1, 2, 3}), 1)) == doctest::Approx(hidden).epsilon(1e-3));

  VolumeItem nothing = even_fog(0);
  const volume::CastVolume e = cast_of(nothing);
  CHECK(volume::Occlusion(*e.source, *e.medium, {}, {}).hidden({0, 0, 0}, {0, 0, 1}, 0.5f) == 0);

  // Stone below z = 0: hidden from below, open from above, half open to the sides.
  VolumeItem stone = item(grid(cube(65, -1, 1), [](Vec3 p) { return -p.z; }), one_color({1, 1, 1}), {});
  stone.opacity.points = {{0, 0}, {0, 1}};
  const volume::CastVolume s = cast_of(stone);
  const volume::Occlusion wall(*s.source, *s.medium, {}, {});
  CHECK(wall.hidden({0, 0, 0.02}, {0, 0, 1}, 1) < 0.1f);
  CHECK(wall.hidden({0, 0, 0.02}, {0, 0, -1}, 1) > 0.9f);
  CHECK(wall.hidden({0, 0, 0}, {1, 0, 0}, 1) > 0.5f);
  CHECK(wall.hidden({0, 0, 0.3}, {0, 0, -1}, 1) < 0.5f * wall.hidden({0, 0, 0.1}, {0, 0, -1}, 1));
  CHECK(wall.hidden({0, 0, 0.45}, {0, 0, -1}, 1) == 0);
}

TEST_CASE("volume light: ambient light alone is dimmed by the share that is hidden") {
  VolumeItem v = even_fog(0.7, 33);
  v.light.ambient = 1, v.light.diffuse = v.light.specular = 0, v.light.occlusion = 0.5;
  VolumeItem plain = v;
  plain.light.occlusion = 0;
  const volume::CastVolume c = cast_of(v);
  const volume::Occlusion around(*c.source, *c.medium, {}, {});
  // Along the ray, weighted by what is seen; less is hidden near the faces.
  double sum = 0, weights = 0;
  for (int i = 0; i < 2000; ++i) {
    const double s = (i + 0.5) * 1e-3, w = std::exp(-0.7 * s);
    sum += w * (1 - 0.5 * double(around.hidden({0.013, 0.017, 1 - s}, {0, 0, 0}, 0))), weights += w;
  }
  const Frame dim = look(lit_from(v, {0, 0, 1})), bright = look(lit_from(plain, {0, 0, 1}));
  CHECK(double(dim.rgba[0] / bright.rgba[0]) == doctest::Approx(sum / weights).epsilon(3e-3));
  CHECK(dim.rgba[0] < 0.95f * bright.rgba[0]);
}

TEST_CASE("volume light: a constant slab fades into the background by the analytic share, and hides as much as before") {
  const double tau = 0.9, d = tau * 2;
  for (const Vec3f background : {Vec3f{1, 1, 1}, Vec3f{0, 0, 0}, Vec3f{0.2f, 0.6f, 0.4f}})
    for (double cue : {0.4, 1.0}) {
      VolumeItem v = even_fog(tau);
      v.light.depth_cue = cue;
      const Frame f = look(lit_from(v, {0, 0, 1}, background));
      const double alpha = 1 - std::exp(-d), far = cue * (1 - (1 + d) * std::exp(-d)) / d;
      CHECK(double(f.rgba[0]) == doctest::Approx(0.5 * (alpha - far) + double(srgb_decode(background.x)) * far).epsilon(3e-3));
      CHECK(double(f.rgba[1]) == doctest::Approx(0.25 * (alpha - far) + double(srgb_decode(background.y)) * far).epsilon(3e-3));
      CHECK(double(f.rgba[3]) == doctest::Approx(alpha).epsilon(1e-4));
    }
}

TEST_CASE("volume light: a gradient background fades each row into its own colour, in bands too") {
  Scene s = lit_from(even_fog(1), {0, 0, 1}, {0, 0, 0});
  s.background_top = Vec3f{1, 1, 1};
  Camera camera;
  const Projection whole = make_projection(camera, 8, 64);
  const Vec3f row = background_of_row(s, whole, 37), in_band = background_of_row(s, band_of(whole, 32, 16), 5);
  CHECK(row == in_band);
  Frame frame(8, 64);
  composite_background(s, frame);
  CHECK(frame.rgba[4 * 8 * 37] == doctest::Approx(row.x).epsilon(1e-5));
  CHECK(background_of_row(s, whole, 0).x == 1);
}

TEST_CASE("volume light: maxima fade too") {
  VolumeItem v = item(grid(cube(9, -1, 1), [](Vec3 p) { return p.z; }), one_color({0, 0, 0}), constant_opacity(1));
  v.mode = RayFunction::maximum;
  v.light.depth_cue = 1;
  CHECK(look(lit_from(v, {0, 0, 1})).rgba[0] < 0.01f);  // the largest value is at the near end
  VolumeItem away = v;
  away.data = grid(cube(9, -1, 1), [](Vec3 p) { return -p.z; });
  CHECK(look(lit_from(away, {0, 0, 1})).rgba[0] > 0.99f);  // and here at the far end
}

TEST_CASE("volume light: silhouettes are darker and denser by their formula") {
  VolumeItem v = item(grid(cube(65, -1, 1), [](Vec3 p) { return 1 - length(p); }), one_color({0.5f, 0.25f, 0.75f}), {});
  v.opacity.points = {{0, 0.1}};
  v.mode = RayFunction::isosurface, v.levels = {0.2};
  v.light.style = LightStyle::silhouette;
  for (double x : {0.05, 0.4, 0.7, 0.77}) {
    const Frame f = look(lit_from(v, {0, 0, 1}), x, 0);
    const double facing = std::sqrt(1 - x * x / 0.64), rim = std::pow(1 - facing, 3);
    const double once = 1 - std::pow(0.9, 1 + 6 * rim), alpha = 1 - (1 - once) * (1 - once);
    CHECK(double(f.rgba[3]) == doctest::Approx(alpha).epsilon(0.02));
    CHECK(double(f.rgba[0] / f.rgba[3]) == doctest::Approx(0.5 * (1 - rim)).epsilon(0.02));
  }
  // A soft ball: the share of colour falls and the opacity rises against the plain one, at the rim only.
  VolumeItem soft = fog(grid(cube(33, -1.5, 1.5), ball));
  VolumeItem rimmed = soft;
  rimmed.light.style = LightStyle::silhouette;
  const auto pixel = [](const VolumeItem& i, double x) { return look(lit_from(i, {0, 0, 1}), x, 0).rgba; };
  const auto plain_rim = pixel(soft, 0.7), dark_rim = pixel(rimmed, 0.7), plain_middle = pixel(soft, 0.013), middle = pixel(rimmed, 0.013);
  CHECK(dark_rim[3] > 1.5f * plain_rim[3]);
  CHECK(dark_rim[0] / dark_rim[3] < 0.7f * plain_rim[0] / plain_rim[3]);
  CHECK(middle[3] == doctest::Approx(plain_middle[3]).epsilon(0.03));
}

TEST_CASE("volume light: tones go from cool to warm with the light") {
  VolumeItem v = item(grid(cube(65, -1, 1), [](Vec3 p) { return 1 - length(p); }), one_color({0.4f, 0.4f, 0.4f}), {});
  v.opacity.points = {{0, 1}};
  v.mode = RayFunction::isosurface, v.levels = {0.2};
  v.light.style = LightStyle::tone, v.light.specular = 0;
  const Scene s = lit_from(v, {1, 0, 0});
  const auto at = [&](double x) {
    const Frame f = look(s, x, 0);
    return Vec3f{f.rgba[0], f.rgba[1], f.rgba[2]};
  };
  for (double x : {-0.6, 0.0, 0.6}) {
    const double w = 0.5 + 0.5 * x / 0.8, factor = 0.25 * (1 - w) + 0.75 * w;
    CHECK(double(at(x).x) == doctest::Approx(0.4 * factor + 0.18 * w).epsilon(0.02));
    CHECK(double(at(x).z) == doctest::Approx(0.4 * factor + 0.2 * (1 - w)).epsilon(0.02));
  }
}

TEST_CASE("volume light: hatching leaves lit paper white, inks the dark, and its strokes stay where they are") {
  VolumeItem v = item(grid(cube(33, -1, 1), [](Vec3 p) { return p.z; }), one_color({0.8f, 0.8f, 0.8f}), {});
  v.opacity.points = {{0, 1}};
  v.mode = RayFunction::isosurface, v.levels = {0.2};
  v.light.style = LightStyle::hatch;
  const auto row = [&](Vec3 towards, const Projection& view) {
    const Frame f = draw(lit_from(v, towards), view);
    std::vector<float> out;
    for (size_t i = 0; i < f.rgba.size(); i += 4) out.push_back(f.rgba[i]);
    return out;
  };
  const auto mean = [](const std::vector<float>& r) {
    float sum = 0;
    for (float x : r) sum += x;
    return sum / float(r.size());
  };
  const Projection view = parallel_view(200, 1, 150);
  const std::vector<float> bright = row({0, 0, 1}, view), dusk = row({1, 0, 0.3}, view), dark = row({1, 0, 0.01}, view);
  for (float x : bright) CHECK(x == doctest::Approx(0.8).epsilon(1e-3));
  CHECK(mean(dusk) < 0.95f * mean(bright));
  CHECK(mean(dark) < 0.85f * mean(dusk));
  CHECK(*std::max_element(dusk.begin(), dusk.end()) == doctest::Approx(0.8).epsilon(1e-3));
  CHECK(*std::min_element(dusk.begin(), dusk.end()) < 0.15f);
  // The same places seen ten pixels further on.
  const std::vector<float> moved = row({1, 0, 0.3}, parallel_view(200, 1, 150, {0, 0, -1}, {0, 1, 0}, {10.0 / 150, 0, 0}));
  for (size_t i = 0; i < 190; ++i) CHECK(moved[i] == doctest::Approx(dusk[i + 10]).epsilon(1e-3));
}

TEST_CASE("volume light: every effect gives the same bytes for any number of threads and for a second picture") {
  for (const LightStyle style : {LightStyle::none, LightStyle::silhouette, LightStyle::tone, LightStyle::hatch}) {
    VolumeItem v = fog(grid(cube(20, -1.5, 1.5), ball));
    v.shaded = true;
    v.light.shadows = 0.9, v.light.occlusion = 0.8, v.light.depth_cue = 0.5, v.light.style = style;
    const Projection view = perspective_view(33, 33, 40, {1.9, 1.4, 2.6}, {0, 0, 0});
    set_thread_count(1);
    const Frame one = draw(scene_of({v}), view), again = draw(scene_of({v}), view);
    v.data = grid(cube(20, -1.5, 1.5), ball);  // nothing kept
    set_thread_count(8);
    const Frame eight = draw(scene_of({v}), view);
    set_thread_count(0);
    CHECK(same_bytes(one, again));
    CHECK(same_bytes(one, eight));
  }
}

TEST_CASE("volume light: steps and joint volumes are lit like the tolerant integral") {
  VolumeItem v = fog(grid(cube(33, -1.5, 1.5), ball));
  v.shaded = true;
  v.light.shadows = 1, v.light.depth_cue = 0.5, v.light.style = LightStyle::silhouette;
  const Projection view = parallel_view(16, 16, 6);
  const Frame whole = draw(scene_of({v}), view);
  VolumeItem steps = v;
  steps.sampling.step = 0.005;
  CHECK(largest_difference(whole, draw(scene_of({steps}), view)) < 0.01f);
  VolumeItem nothing = item(grid(cube(3, -1.5, 1.5), [](Vec3) { return 0.0; }), one_color({1, 1, 1}), constant_opacity(1e-7));
  CHECK(largest_difference(whole, draw(scene_of({v, nothing}), view)) < 0.01f);
}

TEST_CASE("volume light: shares outside 0..1 and shadows of maxima are refused") {
  const auto refused = [](auto change) {
    VolumeItem v = even_fog(1);
    change(v);
    CHECK_THROWS_AS(look(lit_from(v, {0, 0, 1})), Error);
  };
  refused([](VolumeItem& v) { v.light.shadows = 1.5; });
  refused([](VolumeItem& v) { v.light.occlusion = -0.1; });
  refused([](VolumeItem& v) { v.light.depth_cue = NAN; });
  refused([](VolumeItem& v) { v.light.shadows = 1, v.mode = RayFunction::maximum; });
}

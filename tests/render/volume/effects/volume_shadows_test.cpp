// SPDX-License-Identifier: Apache-2.0
// Shadows with a second axis, of surfaces and of other volumes, on surfaces; ink of silhouettes.
#include "base/error.h"
#include "render/volume/effects/effects.h"
#include "render/volume/prepare_cast.h"
#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

using doctest::Approx;

volume::CastVolume cast_of(const VolumeItem& v) {
  Context context;
  return volume::prepare_cast(v, 1, std::make_shared<const volume::Volume>(volume::prepare(v, 1, {})), parallel_view(1, 1, 1), {}, context);
}
/// Half of its opacity is left by the gradient, which is 1.
VolumeItem slanted(double tau, size_t n = 33) {
  VolumeItem v = item(grid(cube(n, -1, 1), [](Vec3 p) { return p.x; }), one_color({0.5f, 0.25f, 0.75f}), {});
  v.opacity.points = {{0, 2 * (1 - std::exp(-tau))}};
  v.detail.second = SecondAxis::gradient, v.detail.second_factor.points = {{0, 0}, {2, 1}};
  return v;
}
VolumeItem even(double tau, Vec3f color, UniformGrid where) {
  return item(grid(std::move(where), [](Vec3) { return 1.0; }), one_color(color), constant_opacity(tau));
}
Scene lit_from(std::vector<Item> items, Vec3 towards) {
  Scene s = scene_of(std::move(items));
  s.lights = {{towards, false, 1}};
  return s;
}
/// A rectangle from a corner along two edges.
SurfaceItem rectangle(Vec3 corner, Vec3 u, Vec3 v) {
  SurfaceMesh m;
  std::vector<double> xyz;
  for (const Vec3 p : {corner, corner + u, corner + u + v, corner + v}) xyz.insert(xyz.end(), {p.x, p.y, p.z});
  m.points.xyz = Array::from_vector(xyz, 3);
  m.polygons.connectivity = Array::from_vector(std::vector<int64_t>{0, 1, 2, 3});
  m.polygons.offsets = Array::from_vector(std::vector<int64_t>{0, 4});
  SurfaceItem s;
  s.data = make_dataset(std::move(m));
  return s;
}

}  // namespace

TEST_CASE("volume shadows: an even fog with a second axis shades itself by the analytic integral") {
  const double tau = 0.6, length = 2;
  VolumeItem v = slanted(tau);
  v.light.shadows = 1;
  const Frame f = look(lit_from({v}, {0, 0, 1}));
  const double ambient = v.light.ambient, once = 1 - std::exp(-tau * length), twice = 0.5 * (1 - std::exp(-2 * tau * length));
  CHECK(double(f.rgba[0]) == Approx(0.5 * (ambient * once + (1 - ambient) * twice)).epsilon(5e-3));
  CHECK(double(f.rgba[3]) == Approx(once).epsilon(2e-3));
}

TEST_CASE("volume shadows: occlusion and light maps with a second axis are those of its opacity") {
  const VolumeItem v = slanted(0.6);
  const volume::CastVolume c = cast_of(v);
  REQUIRE(c.extinction().detail);
  const volume::Occlusion around(*c.source, c.extinction(), {}, {});
  const double hidden = 1 - std::exp(-0.6 * (around.radius() - 0.5 * around.cell()));
  CHECK(double(around.hidden({0.1, -0.2, 0.15}, {0, 0, 0}, 0)) == Approx(hidden).epsilon(2e-3));
  const volume::LightMap map(*c.source, c.extinction(), {}, {0, 0, 1}, {});
  CHECK(double(map.at({0.1, 0.2, 0.25})) == Approx(std::exp(-0.6 * 0.75)).epsilon(2e-3));
  CHECK(double(map.at({0.1, 0.2, -5})) == Approx(std::exp(-0.6 * 2)).epsilon(2e-3));
  CHECK(map.at({3, 0.2, -5}) == 1);
  // Widgets over the value alone.
  VolumeItem w = v;
  w.detail = {};
  w.detail.widgets = {{TransferWidget::Shape::rectangle, -1, 1, -1, 1, 0.5, {1, 1, 1}}};
  const volume::CastVolume d = cast_of(w);
  double depth = 0;
  for (int i = 0; i < 2000; ++i) depth += -std::log(1 - 0.5 * (i + 0.5) / 2000) / 2000;  // -1 .. 0 along x
  CHECK(double(volume::LightMap(*d.source, d.extinction(), {}, {-1, 0, 0}, {}).at({0, 0.1, 0.1})) ==
        Approx(std::exp(-depth)).epsilon(5e-3));
}

TEST_CASE("volume shadows: an opaque surface takes the light from the places behind it, sharply") {
  const double tau = 0.8;
  VolumeItem v = even(tau, {1, 1, 1}, cube(33, -1, 1));
  v.light.ambient = 0, v.light.shadows = 1;
  const SurfaceItem lid = rectangle({-0.5, 0.5, -0.5}, {1, 0, 0}, {0, 0, 1});
  // Light from above; a ray along -z at height 0 is in the shadow for z in [-1/2, 1/2].
  const auto truth = [&](bool shadow) {
    double sum = 0;
    for (int i = 0; i < 4000; ++i) {
      const double z = 1 - 2 * (i + 0.5) / 4000;
      if (!shadow || std::abs(z) > 0.5) sum += tau * std::exp(-tau * (1 - z)) * std::exp(-tau) * 2 / 4000;
    }
    return sum;
  };
  const Scene scene = lit_from({v, lid}, {0, 1, 0});
  CHECK(double(look(scene, 0.1, 0).rgba[0]) == Approx(truth(true)).epsilon(0.01));
  CHECK(double(look(scene, 0.8, 0).rgba[0]) == Approx(truth(false)).epsilon(0.01));
  CHECK(double(look(scene, 0.1, 0.7).rgba[0]) > truth(false));  // above it
  // A translucent one casts none, nor does one on the other side.
  SurfaceItem glass = lid;
  glass.opacity = 0.5;
  CHECK(double(look(lit_from({v, glass}, {0, 1, 0}), 0.1, 0).rgba[0]) == Approx(truth(false)).epsilon(0.01));
  CHECK(double(look(lit_from({v, rectangle({-0.5, -0.9, -0.5}, {1, 0, 0}, {0, 0, 1})}, {0, 1, 0}), 0.1, 0).rgba[0]) ==
        Approx(truth(false)).epsilon(0.01));
  // Without shadows it is as if there were no light map at all.
  VolumeItem bare = v;
  bare.light.shadows = 0;
  CHECK(look(lit_from({bare, lid}, {0, 1, 0}), 0.1, 0).rgba[0] == look(lit_from({bare}, {0, 1, 0}), 0.1, 0).rgba[0]);
  // A surface far outside of the volume casts one, too.
  const Scene roof = lit_from({v, rectangle({-9, 20, -9}, {18, 0, 0}, {0, 0, 18})}, {0, 1, 0});
  CHECK(look(roof, 0.1, 0).rgba[0] < 1e-3f);
}

TEST_CASE("volume shadows: a volume takes light from a surface behind it and from another volume") {
  const double tau = 0.5;
  VolumeItem v = even(tau, {0, 0, 0}, cube(17, -1, 1));
  v.light.shadows = 1;
  const SurfaceItem wall = rectangle({-3, -3, -1.5}, {6, 0, 0}, {0, 6, 0});
  const Scene scene = lit_from({v, wall}, {0, 0, 1});
  const Projection view = parallel_view(1, 1, 1);
  const auto pixel = [&](const Scene& s, double x, uint32_t id) {
    Projection p = view;
    p.eye.x = x;
    Frame frame(1, 1);
    for (float& c : frame.rgba) c = 1;
    frame.depth[0] = float(p.to_eye({x, 0, -1.5}).z), frame.ids[0] = id;
    Context context;
    volume::composite_volumes(s, p, {}, frame, context, volume::Knobs{});
    return double(frame.rgba[0]);
  };
  const double ambient = double(wall.material.ambient), through = std::exp(-2 * tau);
  CHECK(pixel(scene, 0.1, 2) == Approx(through * (ambient + (1 - ambient) * through)).epsilon(5e-3));
  CHECK(pixel(scene, 2.5, 2) == Approx(1).epsilon(1e-6));        // beside the volume
  CHECK(pixel(scene, 0.1, 0) == Approx(through).epsilon(5e-3));  // not a surface
  // Another volume above, out of the picture.
  VolumeItem lit = even(tau, {1, 1, 1}, cube(17, -1, 1));
  lit.light.shadows = 1, lit.light.ambient = 0;
  UniformGrid above = cube(17, -1, 1);
  above.origin.y = 2;
  const float alone = look(lit_from({lit}, {0, 1, 0}), 0.1, 0).rgba[0];
  const float shaded = look(lit_from({lit, even(0.7, {0, 0, 0}, above)}, {0, 1, 0}), 0.1, 0).rgba[0];
  CHECK(double(shaded / alone) == Approx(std::exp(-1.4)).epsilon(0.01));
}

TEST_CASE("volume shadows: ink draws the rim of what is clear itself") {
  VolumeItem v = item(grid(cube(33, -1.5, 1.5), [](Vec3 p) { return std::exp(-3 * dot(p, p)); }), one_color({1, 0, 0}), {{{0, 0}}});
  v.light.style = LightStyle::silhouette;
  CHECK(look(scene_of({v}), 0, 0).rgba[3] == 0);
  v.light.ink = 0.8;
  const Frame middle = look(scene_of({v}), 0.01, 0.02), rim = look(scene_of({v}), 0.9, 0.02);
  CHECK(rim.rgba[3] > 0.3f);
  CHECK(middle.rgba[3] < 0.3f * rim.rgba[3]);
  CHECK(rim.rgba[0] < 1e-3f);  // black
  v.light.style = LightStyle::hatch;
  const Projection view = parallel_view(24, 24, 8);
  double most = 0;
  const Frame hatched = draw(scene_of({v}), view);
  for (size_t i = 3; i < hatched.rgba.size(); i += 4) most = std::max(most, double(hatched.rgba[i]));
  CHECK(most > 0.2);
  v.light.style = LightStyle::none;
  CHECK_THROWS_AS(look(scene_of({v})), Error);
  v.light.style = LightStyle::silhouette, v.light.ink = 1;
  CHECK_THROWS_AS(look(scene_of({v})), Error);
}

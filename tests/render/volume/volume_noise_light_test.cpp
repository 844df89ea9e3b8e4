// SPDX-License-Identifier: Apache-2.0
// Lit white noise: gradients turn by any angle within a cell, surfaces turn over there and back. Against the tests' own integral.
#include "volume_random.h"

using namespace sg;
using namespace sg::test;

namespace {

struct Noise {
  std::string name;
  TrueLattice lattice;
  TrueTransfer transfer;
  VolumeItem item;
};

/// White noise in [0, 255] on [-1, 1]^3, seen through a medium of `unit` cells.
Noise noise(ElementType type, std::vector<Vec2> opacity, double cells, bool colored) {
  Noise out;
  constexpr int n = 8;
  TrueLattice& l = out.lattice;
  l.n = {n, n, n};
  for (auto& x : l.x)
    for (int i = 0; i < n; ++i) x.push_back(2.0 * i / (n - 1) - 1);
  for (uint64_t i = 0; i < uint64_t(n * n * n); ++i) {
    const double v = 255 * random_unit(77, i);
    l.v.push_back(type == ElementType::u8 ? std::round(v) : double(float(v)));
  }
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(l.v).converted(type), "", Role::scalars});
  out.item.data = make_dataset(cube(n, -1, 1), fields);
  out.item.field = "f", out.item.shaded = true;
  TrueTransfer& t = out.transfer;
  t.opacity = out.item.opacity.points = std::move(opacity);
  t.unit = out.item.unit_distance = cells * 2 / (n - 1);
  t.lo = out.item.color.lo = 0, t.hi = out.item.color.hi = 255;
  t.stops = {{0, {1, 0.2, 0}}, {1, colored ? Vec3{0, 0.4, 1} : Vec3{1, 0.2, 0}}};
  parse_color_stops(colored ? "0:#ff3300,1:#0066ff" : "0:#ff3300,1:#ff3300", out.item.color, true);
  return out;
}

TrueLight light_of(const Noise& noise, const Projection& view, const Scene& scene) {
  const VolumeLight& l = noise.item.light;
  const auto [lo, hi] = std::minmax_element(noise.lattice.v.begin(), noise.lattice.v.end());
  const double edge = 2.0 / (noise.lattice.n[0] - 1);
  TrueLight out{l.ambient, l.diffuse, l.specular, l.power, {}, 0.002 * (*hi - *lo) / edge};
  for (const Light& lamp : lights_of(scene)) {
    const Vec3 d =
        lamp.follows_camera ? view.right * lamp.direction.x + view.up * lamp.direction.y - view.forward * lamp.direction.z : lamp.direction;
    out.lamps.push_back({normalize(d), double(lamp.intensity)});
  }
  return out;
}

std::array<double, 4> truth_of(const Noise& noise, const TrueLight& light, const Projection& view, int x, int y) {
  const Projection::Ray ray = view.ray(x + 0.5, y + 0.5);
  TrueVolume v{&noise.transfer,
               noise.transfer.knots(),
               [&](double t) { return noise.lattice.value(ray.origin + ray.direction * t); },
               [&](double t) { return noise.lattice.gradient(ray.origin + ray.direction * t); },
               &light,
               noise.lattice.ends(ray.origin, ray.direction)};
  const auto [from, to] = std::minmax_element(v.ends.begin(), v.ends.end());
  const TrueSum sum = TrueRay({v}, ray.direction, 64).integrate(*from, *to);
  return {sum.color.x, sum.color.y, sum.color.z, 1 - sum.pass};
}

}  // namespace

TEST_CASE("volume: lit white noise keeps every tolerance, by packets and by single rays") {
  const Projection view = perspective_view(12, 12, 13, {1.9, 1.4, 2.6}, {0, 0, 0});
  const std::vector<Vec2> even{{0, 0.7}, {255, 0.7}}, step{{100, 0}, {100, 0.95}}, ramp{{40, 0}, {220, 0.9}};
  for (const ElementType type : {ElementType::f32, ElementType::u8}) {
    Noise scenes[] = {noise(type, even, 2, false), noise(type, step, 0.3, false), noise(type, ramp, 0.5, true)};
    const char* names[] = {"even", "step", "ramp"};
    for (size_t s = 0; s < std::size(scenes); ++s) {
      Noise& one = scenes[s];
      const TrueLight light = light_of(one, view, scene_of({one.item}));
      std::vector<std::array<double, 4>> truth;
      for (int i = 0; i < view.width * view.height; ++i) truth.push_back(truth_of(one, light, view, i % view.width, i / view.width));
      for (const double tolerance : {1.0 / 64, 1.0 / 512, 1.0 / 4096})
        for (const bool single : {false, true}) {
          one.item.sampling.tolerance = tolerance;
          const Frame frame = draw(scene_of({one.item}), view, {}, single ? by_single_rays(view) : FragmentLists());
          double worst = 0;
          size_t at = 0;
          for (size_t i = 0; i < frame.rgba.size(); ++i) {
            const double off = std::abs(truth[i / 4][i % 4] - double(frame.rgba[i]));
            if (!(off <= worst)) worst = off, at = i / 4;
          }
          INFO(std::string(element_name(type)) << ", " << std::string(names[s]) << ", tolerance 1/" << 1 / tolerance
                                               << std::string(single ? ", single rays" : ", packets") << ", pixel " << at % 12 << " "
                                               << at / 12);
          CHECK(worst <= tolerance + 1e-4);
        }
    }
  }
}

// SPDX-License-Identifier: Apache-2.0
// The default integrator against brute force.
#include <numbers>

#include "volume_brute_force.h"

using namespace sg;
using namespace sg::test;

namespace {

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto noise = [seed = uint64_t(0)](Vec3) mutable { return random_unit(5, seed++); };
  const auto add = [&](std::string name, Lattice l, ColorScale color, OpacityCurve opacity, double unit, bool shaded = false,
                       bool uneven = false, ElementType type = ElementType::f32, int per_cell = 100) {
    Case c{std::move(name), std::move(l), nullptr, std::move(color), std::move(opacity), unit, shaded, per_cell};
    if (type == ElementType::u8)
      for (double& v : c.lattice.v) v = double(uint8_t(v));
    c.data = dataset_of(c.lattice, uneven, type);
    all.push_back(std::move(c));
  };
  const OpacityCurve ramp = curve({{-1.7, 0}, {-0.2, 0}, {1.7, 0.8}});
  const OpacityCurve spikes = curve({{-2, 0}, {-0.505, 0}, {-0.5, 0.95}, {-0.495, 0}, {0.3, 0}, {0.3001, 0.99}, {0.3002, 0}, {2, 0}});
  add("smooth ramp", lattice_of(24, bumpy), colored(-1.7, 1.7), ramp, 0.1);
  add("thin spikes", lattice_of(24, bumpy), colored(-1.7, 1.7, "coolwarm"), spikes, 0.005, false, false, ElementType::f32, 40000);
  add("noise", lattice_of(20, noise), colored(0, 1), curve({{0, 0}, {0.3, 0}, {0.6, 0.5}, {0.8, 0}, {1, 0.9}}), 0.1);
  add("noise and spikes", lattice_of(20, noise), colored(0, 1),
      curve({{0, 0}, {0.49, 0}, {0.5, 0.9}, {0.51, 0}, {0.8, 0}, {0.801, 0.9}, {0.802, 0}}), 0.01, false, false, ElementType::f32, 4000);
  add("steps of opacity", lattice_of(24, bumpy), colored(-1.7, 1.7),
      curve({{-2, 0}, {0.1, 0}, {0.1, 0.3}, {0.6, 0.3}, {0.6, 0}, {1.2, 0}, {1.2, 0.9}, {2, 0.9}}), 0.05, false, false, ElementType::f32,
      4000);
  add("solid", lattice_of(24, bumpy), colored(-1.7, 1.7), curve({{-2, 0}, {0.2, 0}, {0.9, 0.999}, {2, 0.999}}), 0.02);
  add("fog", lattice_of(24, bumpy), colored(-1.7, 1.7), curve({{-2, 0.01}, {2, 0.05}}), 0.1);
  add("bytes", lattice_of(24, [](Vec3 p) { return 128 + 70 * bumpy(p); }), colored(0, 255, "jet"),
      curve({{0, 0}, {90, 0}, {140, 0.4}, {180, 0}, {250, 0.9}}), 0.05, false, false, ElementType::u8);
  Lattice turned = lattice_of(20, bumpy);
  const double a = 0.5;
  turned.turn.m[0][0] = std::cos(a), turned.turn.m[0][1] = -std::sin(a), turned.turn.m[1][0] = std::sin(a),
  turned.turn.m[1][1] = std::cos(a);
  turned.origin = {0.1, -0.2, 0.05};
  add("turned", turned, colored(-1.7, 1.7), ramp, 0.1);
  add("uneven axes", lattice_of(20, bumpy, true), colored(-1.7, 1.7), ramp, 0.1, false, true);
  ColorScale logarithmic = colored(0.01, 10);
  logarithmic.kind = ScaleKind::log;
  add("logarithmic colours", lattice_of(24, [](Vec3 p) { return std::exp(2 * bumpy(p)); }), logarithmic,
      curve({{0, 0}, {0.1, 0.02}, {1, 0.1}, {5, 0.4}}), 0.1);
  add("uneven axes, lit", lattice_of(20, bumpy, true), colored(-1.7, 1.7), ramp, 0.1, true, true);
  add("lit", lattice_of(24, bumpy), colored(-1.7, 1.7), ramp, 0.1, true);
  add("lit and solid", lattice_of(24, bumpy), colored(-1.7, 1.7), curve({{-2, 0}, {0.2, 0}, {0.6, 0.95}, {2, 0.95}}), 0.05, true);
  return all;
}

}  // namespace

TEST_CASE("volume: the error stays within the tolerance of a hundredth-step reference on every scene") {
  const Projection outside = perspective_view(20, 20, 24, {1.9, 1.4, 2.6}, {0, 0, 0});
  const Projection inside = perspective_view(10, 10, 6, {0.1, 0.05, 0.2}, {0.7, 0.3, -1});
  for (const Case& c : cases())
    for (const Projection* view : {&outside, &inside}) {
      INFO(c.name, view == &inside ? ", from inside" : "");
      VolumeItem v = item(c.data, c.color, c.opacity);
      v.unit_distance = c.unit, v.shaded = c.shaded;
      const Scene scene = scene_of({v});
      const Frame f = draw(scene, *view);
      double worst = 0;
      const int every = c.per_cell > 10000 ? 10 : c.per_cell > 100 ? 5 : 1;
      for (int y = every / 2; y < view->height; y += every)
        for (int x = every / 2; x < view->width; x += every) {
          const Vec4 truth = brute_force(c, *view, x, y, scene);
          const float* p = &f.rgba[4 * (size_t(y) * size_t(view->width) + size_t(x))];
          for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(truth[k] - double(p[k])));
          worst = std::max(worst, std::abs(1 - truth.w - double(p[3])));
        }
      CHECK(worst < 1.0 / 512);
    }
}

namespace {

/// 24 waves, `cells` to twice as many cells long.
Lattice sum_of_waves(double cells) {
  const size_t n = 28;
  std::vector<std::pair<Vec3, double>> waves;
  for (uint64_t i = 0; i < 24; ++i) {
    const Vec3 k = normalize(Vec3{random_unit(1, i) - 0.5, random_unit(2, i) - 0.5, random_unit(3, i) - 0.5});
    waves.emplace_back(k * (std::numbers::pi * double(n - 1) / cells * (0.5 + 0.5 * random_unit(6, i))), 6.28 * random_unit(4, i));
  }
  return lattice_of(n, [&](Vec3 p) {
    double s = 0;
    for (const auto& [k, phase] : waves) s += 0.35 * std::cos(dot(k, p) + phase);
    return s;
  });
}

enum class DrawnBy { packets, rectilinear_packets, single_rays };

/// The default picture against brute force at these pixels and some others, `apart` from each other.
void check_waves(double cells, OpacityCurve opacity, double unit, bool shaded, int per_cell, std::vector<std::pair<int, int>> pixels,
                 int apart, DrawnBy by = DrawnBy::packets) {
  const Projection view = perspective_view(64, 64, 80, {1.9, 1.4, 2.6}, {0, 0, 0});
  Case c{"", sum_of_waves(cells), nullptr, colored(-1.7, 1.7), std::move(opacity), unit, shaded, per_cell};
  c.data = dataset_of(c.lattice, by == DrawnBy::rectilinear_packets);
  VolumeItem v = item(c.data, c.color, c.opacity);
  v.unit_distance = unit, v.shaded = shaded;
  const Scene scene = scene_of({v});
  const Frame f = draw(scene, view, {}, by == DrawnBy::single_rays ? by_single_rays(view) : FragmentLists());
  for (int y = 5; y < view.height; y += apart)
    for (int x = 5; x < view.width; x += apart) pixels.emplace_back(x, y);
  for (const auto& [x, y] : pixels) {
    const Vec4 truth = brute_force(c, view, x, y, scene);
    const float* p = &f.rgba[4 * (size_t(y) * size_t(view.width) + size_t(x))];
    INFO("waves of " << cells << " cells, unit " << unit << ", lit " << shaded << ", pixel " << x << " " << y);
    for (int k = 0; k < 3; ++k) CHECK(std::abs(truth[k] - double(p[k])) < 1.0 / 512);
  }
}

}  // namespace

// Where a ray grazes a dense lit surface the side that it sees may change several times within a cell, and with it the light jumps. Some of
// these rays were off by up to eight times the tolerance when that was told from the ends of strides and cells alone.
TEST_CASE("volume: rays that graze dense lit surfaces stay within the tolerance") {
  const OpacityCurve ramp = curve({{-1.7, 0}, {-0.2, 0}, {1.7, 0.8}}), solid = curve({{-2, 0}, {0.2, 0}, {0.6, 0.95}, {2, 0.95}});
  for (const double cells : {2.2, 3.0, 4.0, 6.0, 10.0})
    for (const OpacityCurve& opacity : {ramp, solid})
      for (const DrawnBy by : {DrawnBy::packets, DrawnBy::rectilinear_packets, DrawnBy::single_rays})
        check_waves(cells, opacity, 0.03, true, 2000, {{46, 26}, {28, 35}, {30, 36}, {16, 21}, {61, 11}, {46, 51}, {23, 63}}, 9, by);
}

TEST_CASE("volume: strides through waves of all lengths stay within the tolerance") {
  const OpacityCurve bands = curve({{-3, 0}, {-.9, 0}, {-.6, .15}, {-.3, 0}, {.2, 0}, {.5, .3}, {.8, 0}, {1.6, 0}, {2, .8}, {4, .8}});
  for (const double cells : {2.2, 3.0, 4.0, 6.0, 10.0, 20.0})
    for (const double unit : {0.15, 0.6})
      for (const bool shaded : {false, true}) check_waves(cells, bands, unit, shaded, shaded ? 400 : 100, {}, 9);
}

// Smooth and rough, in all materials, dense and thin, seen from their border on. Each of these had pixels over the tolerance with one or
// another simpler idea of how light goes between the ends of strides.
TEST_CASE("volume: lit polynomials of three variables stay within the tolerance") {
  struct Scenes {
    uint64_t seed;
    size_t n;
    int degree, curve;
    double unit;
    Vec3 terms;
  };
  const Vec3 usual{0.12, 0.88, 0.18}, peers{0.2, 0.7, 0.3}, ambient{0.2, 0, 0};
  for (const Scenes& s : {Scenes{97, 17, 2, 1, 0.03, peers},
                          {182, 33, 2, 2, 0.03, usual},
                          {178, 33, 1, 2, 0.2, peers},
                          {85, 17, 2, 0, 0.2, peers},
                          {1043, 97, 1, 0, 0.2, ambient},
                          {2092, 17, 2, 1, 0.2, peers}}) {
    double c[16];
    for (uint64_t i = 0; i < 16; ++i) c[i] = 2 * random_unit(s.seed, i) - 1;
    const auto polynomial = [&](Vec3 p) {
      const auto [x, y, z] = std::array{p.x, p.y, p.z};
      double sum = c[0] * x * x + c[1] * y * y + c[2] * z * z + 2 * (c[3] * x * y + c[4] * y * z + c[5] * x * z);
      if (s.degree > 0) sum += 0.3 * (c[6] * x + c[7] * y + c[8] * z);
      if (s.degree > 1)
        sum += c[9] * x * x * x + c[10] * y * y * y + c[11] * z * z * z + 2 * c[12] * x * y * z + c[13] * x * x * y + c[14] * y * y * z +
               c[15] * z * z * x;
      return sum;
    };
    Lattice l = lattice_of(s.n, polynomial);
    const auto [lowest, highest] = std::minmax_element(l.v.begin(), l.v.end());
    const double lo = *lowest, size = *highest - *lowest;
    const auto at = [&](std::vector<Vec2> points) {
      for (Vec2& p : points) p.x = lo + p.x * size;
      return curve(std::move(points));
    };
    const OpacityCurve opacity = s.curve == 0   ? at({{0, 0.3}, {1, 0.3}})
                                 : s.curve == 1 ? at({{0, 0}, {0.3, 0}, {1, 0.8}})
                                                : at({{0, 0}, {0.3, 0}, {0.4, 0.6}, {0.5, 0}, {0.7, 0}, {0.72, 0.7}, {1, 0.7}});
    Case scene_case{"", std::move(l), nullptr, colored(lo, lo + size), opacity, s.unit, true, s.n < 40 ? 400 : 150};
    scene_case.data = dataset_of(scene_case.lattice, false);
    VolumeItem v = item(scene_case.data, scene_case.color, scene_case.opacity);
    v.unit_distance = s.unit, v.shaded = true;
    v.light.ambient = s.terms.x, v.light.diffuse = s.terms.y, v.light.specular = s.terms.z;
    v.light.power = s.terms == peers ? 20 : 32;
    const Scene scene = scene_of({v});
    const Projection view = perspective_view(64, 64, 80, {1.9, 1.4, 2.6}, {0, 0, 0});
    const Frame f = draw(scene, view);
    for (int y = 1; y < view.height; y += 5)
      for (int x = 1; x < view.width; x += 5) {
        const Vec4 truth = brute_force(scene_case, view, x, y, scene);
        const float* p = &f.rgba[4 * (size_t(y) * size_t(view.width) + size_t(x))];
        INFO("polynomial " << s.seed << ", pixel " << x << " " << y);
        for (int k = 0; k < 3; ++k) CHECK(std::abs(truth[k] - double(p[k])) < 1.0 / 512);
      }
  }
}

// A surface fades where the field hardly changes. Strides over such a place, which begin and end in full light, were off by up to ten times
// the tolerance when nobody looked between their ends.
TEST_CASE("volume: light that fades around a place without a gradient stays within the tolerance") {
  const auto saddle = [](Vec3 p) { return p.x * p.z; };  // trilinear, so its differences are exact; along z the same side is seen
  for (const size_t n : {33, 49, 65})                    // it fades over 1, 2.3 and 4 cells
    for (const Vec3 terms : {Vec3{0.2, 0, 0}, Vec3{0.2, 0.7, 0.3}, Vec3{1.5, 0, 0}}) {
      const double density = 3;
      VolumeItem v = item(grid(cube(n, -1, 1), saddle), one_color({0.9f, 0.6f, 0.3f}), constant_opacity(density));
      v.shaded = true, v.light.ambient = terms.x, v.light.diffuse = terms.y, v.light.specular = terms.z, v.light.power = 20;
      Scene scene = scene_of({v});
      scene.lights = {{{0, 0, 1}, true, 1}};
      const Projection view = perspective_view(19, 19, 300, {0.03, 0.02, 4}, {0.01, 0, 0});
      const Frame packets = draw(scene, view), single = draw(scene, view, {}, by_single_rays(view));
      const double edge = 2 / double(n - 1), enough = 0.002 * 2;
      for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
          const Projection::Ray ray = view.ray(x + 0.5, y + 0.5);
          const double from = (1 - ray.origin.z) / ray.direction.z, to = (-1 - ray.origin.z) / ray.direction.z;
          const int steps = 20000;
          const double h = (to - from) / steps;
          double sum = 0, pass = 1;
          for (int i = 0; i < steps; ++i) {
            const Vec3 p = ray.origin + ray.direction * (from + (i + 0.5) * h), g{p.z, 0, p.x};
            const double size = length(g), much = std::min(1.0, size * edge / enough), alpha = 1 - std::exp(-density * h);
            const Vec3 normal = g * ((dot(g, ray.direction) > 0 ? -1 : 1) / size), lamp = view.forward * -1.0;
            const double c = std::max(0.0, dot(normal, lamp)), s = c > 0 ? std::pow(dot(normal, normalize(lamp - ray.direction)), 20) : 0;
            sum += pass * alpha * (0.9 * (1 + much * (terms.x + terms.y * c - 1)) + much * terms.z * s), pass *= 1 - alpha;
          }
          INFO("of " << n << ", terms " << terms.x << " " << terms.y << " " << terms.z << ", pixel " << x << " " << y);
          const size_t p = size_t(y * view.width + x);
          CHECK(std::abs(double(packets.rgba[4 * p]) - sum) < 1.0 / 512);
          CHECK(std::abs(double(single.rgba[4 * p]) - sum) < 1.0 / 512);
        }
    }
}

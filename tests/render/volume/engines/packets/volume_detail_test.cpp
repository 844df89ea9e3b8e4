// SPDX-License-Identifier: Apache-2.0
// Opacity that hangs on the gradient, too, by packets and by single rays, against brute force and each other.
#include "render/volume/engines/packets/detail_table.h"
#include "render/volume/volume_brute_force.h"

using namespace sg;
using namespace sg::test;

namespace {

double noise(Vec3 p) { return random_unit(5, uint64_t(std::llround(1e3 * (p.x + 3) + 1e6 * (p.y + 3) + 1e9 * (p.z + 3)))); }

struct Scenes {
  const char* name;
  double (*field)(Vec3);
  size_t n;
  std::vector<Vec2> opacity, factor;
  double unit;
  int per_cell;
};

const std::vector<Scenes> scenes{
    {"borders", bumpy, 24, {{-1.7, 0}, {-0.2, 0}, {1.7, 0.8}}, {{0, 0.1}, {2, 0.5}, {4, 1}}, 0.1, 100},
    {"one height of the gradient", bumpy, 24, {{-2, 0.3}, {2, 0.3}}, {{1.5, 0}, {1.7, 1}, {1.9, 0}}, 0.05, 100},
    {"thin shells of value and gradient", bumpy, 24, {{0.2, 0}, {0.23, 0.9}, {0.26, 0}}, {{2, 0}, {2.2, 1}}, 0.02, 400},
    {"steps", bumpy, 24, {{0.1, 0}, {0.1, 0.3}, {0.6, 0.3}, {0.6, 0}, {1.2, 0}, {1.2, 0.9}}, {{0, 0}, {2.5, 0}, {2.5, 1}}, 0.1, 1000},
    {"solid", bumpy, 24, {{0.2, 0}, {0.6, 0.999}}, {{0, 0}, {1, 1}}, 0.05, 4000},
    {"noise", noise, 20, {{0, 0}, {0.3, 0}, {0.6, 0.5}, {0.8, 0}, {1, 0.9}}, {{0, 1}, {3, 0.2}, {6, 1}}, 0.2, 200},
};

VolumeItem item_of(const Case& c) {
  VolumeItem v = item(c.data, c.color, c.opacity);
  v.unit_distance = c.unit, v.shaded = c.shaded;
  v.detail.second = SecondAxis::gradient, v.detail.second_factor = c.factor;
  return v;
}

}  // namespace

TEST_CASE("volume: opacity by value and gradient stays within the tolerance of brute force") {
  const Projection view = perspective_view(48, 48, 60, {1.9, 1.4, 2.6}, {0, 0, 0});
  for (const Scenes& s : scenes)
    for (const bool shaded : {false, true}) {
      Case c{s.name, lattice_of(s.n, s.field), nullptr, colored(-1.7, 1.7), curve(s.opacity), s.unit, shaded, s.per_cell, curve(s.factor)};
      c.data = dataset_of(c.lattice, false);
      const Scene scene = scene_of({item_of(c)});
      const Frame packets = draw(scene, view), single = draw(scene, view, {}, by_single_rays(view));
      double worst[2] = {0, 0};
      const int apart = s.per_cell > 400 ? 9 : 5;
      for (int y = 2; y < view.height; y += apart)
        for (int x = 2; x < view.width; x += apart) {
          const Vec4 truth = brute_force(c, view, x, y, scene);
          for (int way = 0; way < 2; ++way) {
            const float* p = &(way == 0 ? packets : single).rgba[4 * (size_t(y) * size_t(view.width) + size_t(x))];
            for (int k = 0; k < 3; ++k) worst[way] = std::max(worst[way], std::abs(truth[k] - double(p[k])));
            worst[way] = std::max(worst[way], std::abs(1 - truth.w - double(p[3])));
          }
        }
      INFO(std::string(s.name) << ", lit " << shaded);
      CHECK(worst[0] < 1.0 / 512);
      CHECK(worst[1] < 1.0 / 512);
    }
}

TEST_CASE("volume: packets that see the gradient, one ray at a time and single rays give one picture") {
  const Projection view = perspective_view(45, 37, 55, {1.9, 1.4, 2.6}, {0, 0, 0});
  volume::Knobs one;
  one.simd = false;
  for (const Scenes& s : scenes)
    for (const ElementType type : {ElementType::f32, ElementType::i16}) {
      Case c{s.name, lattice_of(s.n, s.field), nullptr, colored(-1.7, 1.7), curve(s.opacity), s.unit, true, 1, curve(s.factor)};
      if (type == ElementType::i16)
        for (double& v : c.lattice.v) v = std::round(v * 2);
      c.data = dataset_of(c.lattice, false, type);
      const Scene scene = scene_of({item_of(c)});
      const Frame packets = draw(scene, view), single = draw(scene, view, {}, by_single_rays(view));
      CHECK(same_bytes(packets, draw(scene, view, one)));
      // Where both ways differ most brute force tells which is right.
      size_t most = 0;
      for (size_t i = 0; i < packets.rgba.size(); ++i)
        if (std::abs(packets.rgba[i] - single.rgba[i]) > std::abs(packets.rgba[most] - single.rgba[most])) most = i;
      const int x = int(most / 4) % view.width, y = int(most / 4) / view.width;
      INFO(std::string(s.name) << " of " << std::string(element_name(type)) << ", pixel " << x << " " << y);
      c.per_cell = 8000;
      const Vec4 truth = brute_force(c, view, x, y, scene);
      const double want[4] = {truth.x, truth.y, truth.z, 1 - truth.w};
      for (size_t k = 0; k < 4; ++k) {
        CHECK(std::abs(double(packets.rgba[4 * (most / 4) + k]) - want[k]) < 1.0 / 512);
        CHECK(std::abs(double(single.rgba[4 * (most / 4) + k]) - want[k]) < 1.0 / 512);
      }
    }
}

// Sampled at the ends and the middles of cells alone, such a sheet was not there.
TEST_CASE("volume: thin sheets of a second field are seen") {
  const UniformGrid g = cube(9, -1, 1);
  FieldSet fields;
  std::vector<double> values(729, 0.5), x;
  for (size_t i = 0; i < values.size(); ++i) x.push_back(-1 + 0.25 * double(i % 9));
  fields.add({"f", Association::point, Array::from_vector(values), "", Role::scalars});
  fields.add({"g", Association::point, Array::from_vector(x), "", Role::none});
  const Projection along = parallel_view(3, 3, 2, {1, 0, 0});
  for (const double width : {0.1, 0.02, 0.004}) {
    VolumeItem v = item(make_dataset(g, fields), one_color({1, 1, 1}), constant_opacity(1));
    v.unit_distance = width;
    v.detail.second = SecondAxis::field, v.detail.second_field = "g";
    v.detail.second_factor.points = {{0.3, 0}, {0.3 + width, 1}, {0.3 + 2 * width, 0}};
    // tau = -ln(1 - (1 - 1/e) f) / width over 2 width, with f from 0 to 1 and back.
    const double o = 1 - std::exp(-1.0);
    const double depth = 2 * ((1 - o) * std::log(1 - o) + o) / o;
    INFO("width " << width);
    CHECK(double(draw(scene_of({v}), along).rgba[4 * 4 + 3]) == doctest::Approx(1 - std::exp(-depth)).epsilon(2e-3));
  }
}

TEST_CASE("volume: a rectangle over value and gradient is a curve times steps") {
  const Projection view = perspective_view(45, 37, 55, {1.9, 1.4, 2.6}, {0, 0, 0});
  Case c{"", lattice_of(24, bumpy), nullptr, colored(-1.7, 1.7), curve({{0.1, 0}, {0.25, 0.6}, {0.4, 0}}), 0.05};
  c.factor = curve({{2, 0}, {2, 1}, {2.6, 1}, {2.6, 0}});
  c.data = dataset_of(c.lattice, false);
  VolumeItem by_curves = item_of(c), by_widget = by_curves;
  by_widget.detail.second_factor = {{{0, 1}}};
  by_widget.detail.widgets = {{TransferWidget::Shape::rectangle, 0.1, 0.4, 2, 2.6, 0.6, {-1, -1, -1}}};
  const Frame packets = draw(scene_of({by_curves}), view), single = draw(scene_of({by_widget}), view);
  CHECK(largest_difference(packets, single) < 1.0f / 512);
  CHECK(*std::max_element(packets.rgba.begin(), packets.rgba.end()) > 0.2f);
}

// Told by the samples of a part alone, such regions were missed where a ray enters and leaves them between two of them.
TEST_CASE("volume: thin widgets over value and gradient, lit, stay within the tolerance of brute force") {
  const Projection view = perspective_view(48, 48, 60, {1.9, 1.4, 2.6}, {0, 0, 0});
  using Shape = TransferWidget::Shape;
  const std::vector<std::vector<TransferWidget>> widgets{{{Shape::rectangle, -0.5, 0.5, 2, 2.05, 0.9, {-1, -1, -1}}},
                                                         {{Shape::rectangle, 0.2, 0.23, 0, 9, 0.95, {-1, -1, -1}}},
                                                         {{Shape::rectangle, 0.1, 0.13, 1, 1.8, 0.9, {-1, -1, -1}},
                                                          {Shape::rectangle, -1, -0.9, 2, 2.1, 0.8, {-1, -1, -1}},
                                                          {Shape::triangle, 0.4, 0.8, 0.5, 3, 0.7, {-1, -1, -1}}}};
  for (const auto& all : widgets)
    for (const bool shaded : {false, true}) {
      Case c{"", lattice_of(24, bumpy), nullptr, colored(-1.7, 1.7), constant_opacity(1), 0.03, shaded, 1000};
      c.data = dataset_of(c.lattice, false);
      c.plane = [&](double value, double gradient) {
        double most = 0;
        for (const TransferWidget& w : all) {
          if (gradient < w.second_lo || gradient > w.second_hi) continue;
          double half = 0.5 * (w.hi - w.lo);
          if (w.shape == Shape::triangle) half *= (gradient - w.second_lo) / (w.second_hi - w.second_lo);
          most = std::max(most, w.opacity * (1 - std::abs(value - 0.5 * (w.lo + w.hi)) / half));
        }
        return most;
      };
      VolumeItem v = item_of(c);
      v.detail.second_factor = {{{0, 1}}}, v.detail.widgets = all;
      const Scene scene = scene_of({v});
      const Frame frame = draw(scene, view);
      double worst = 0;
      int at = 0;
      for (int y = 2; y < view.height; y += 5)
        for (int x = 2; x < view.width; x += 5) {
          const Vec4 truth = brute_force(c, view, x, y, scene);
          const float* p = &frame.rgba[4 * (size_t(y) * size_t(view.width) + size_t(x))];
          for (int k = 0; k < 4; ++k)
            if (const double off = std::abs((k < 3 ? truth[k] : 1 - truth.w) - double(p[k])); !(off <= worst))
              worst = off, at = 100 * y + x;
        }
      INFO("widgets " << &all - widgets.data() << ", lit " << shaded << ", pixel " << at % 100 << " " << at / 100);
      CHECK(worst < 1.0 / 512);
    }
}

// Two media at once are cut until order does not matter; what is thin must be seen there, too.
TEST_CASE("volume: thin shells are seen among other volumes") {
  const Projection view = perspective_view(45, 37, 55, {1.9, 1.4, 2.6}, {0, 0, 0});
  const Scenes& thin = scenes[2];
  Case c{thin.name,         lattice_of(thin.n, thin.field), nullptr, colored(-1.7, 1.7), curve(thin.opacity), thin.unit, false, 1,
         curve(thin.factor)};
  c.data = dataset_of(c.lattice, false);
  VolumeItem faint = item(grid(cube(5, -1, 1), [](Vec3) { return 0.5; }), one_color({0, 0, 0}), constant_opacity(1e-4));
  const Frame alone = draw(scene_of({item_of(c)}), view), among = draw(scene_of({item_of(c), faint}), view);
  CHECK(largest_difference(alone, among) < 3.0f / 512);
}

// SPDX-License-Identifier: Apache-2.0
// Ellipses and painted strokes over value and gradient, in pictures.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "color/widgets/random_widgets.h"
#include "color/widgets/transfer_widget.h"
#include "render/volume/volume_brute_force.h"

using namespace sg;
using namespace sg::test;

namespace {

constexpr Vec3f of_map{-1, -1, -1};

TransferWidget soft_ellipse(double lo, double hi, double second_lo, double second_hi, double opacity) {
  return {TransferWidget::Shape::ellipse, lo, hi, second_lo, second_hi, opacity, of_map};
}

// An arc of values and gradients, thin and thick ones, a path that turns, a dab.
const std::vector<std::vector<TransferWidget>> soft_widgets{
    {soft_ellipse(-0.5, 0.5, 0.5, 3, 0.9)},
    {soft_ellipse(0.2, 0.24, 0, 4, 0.95), soft_ellipse(-1.2, -0.4, 1.9, 2.1, 0.9)},
    {painted({{-1, 0.4}, {0, 2.4}, {1, 0.4}}, 0.15, 0.4, 0.8, of_map)},
    {painted({{-1.2, 1}, {0.9, 2.2}}, 0.02, 0.05, 0.9, of_map), painted({{0.4, 1}}, 0.3, 0.6, 0.7, of_map)},
    {painted({{0, 0}, {0.5, 1}, {-0.5, 2}, {0.5, 3}, {-0.5, 4}}, 0.05, 0.1, 0.9, of_map),
     {TransferWidget::Shape::rectangle, -1.5, -1, 0.5, 1.5, 0.6, of_map}}};

VolumeItem soft_item(const Case& c, const std::vector<TransferWidget>& widgets) {
  VolumeItem v = item(c.data, c.color, c.opacity);
  v.unit_distance = c.unit, v.shaded = c.shaded;
  v.detail.second = SecondAxis::gradient, v.detail.widgets = widgets;
  v.opacity = bounding_curve(widgets);
  return v;
}

}  // namespace

TEST_CASE("volume: ellipses and strokes over value and gradient stay within the tolerance of brute force") {
  const Projection view = perspective_view(48, 48, 60, {1.9, 1.4, 2.6}, {0, 0, 0});
  for (const auto& all : soft_widgets)
    for (const bool shaded : {false, true}) {
      Case c{"", lattice_of(24, bumpy), nullptr, colored(-1.7, 1.7), constant_opacity(1), 0.05, shaded, 1000};
      c.data = dataset_of(c.lattice, false);
      c.plane = [&](double value, double gradient) {
        double most = 0;
        for (const TransferWidget& w : all) most = std::max(most, opacity_by_definition(w, value, gradient));
        return most;
      };
      const Scene scene = scene_of({soft_item(c, all)});
      const Frame frame = draw(scene, view);
      CHECK(*std::max_element(frame.rgba.begin(), frame.rgba.end()) > 0.2f);
      double worst = 0;
      int at = 0;
      for (int y = 2; y < view.height; y += 7)
        for (int x = 2; x < view.width; x += 7) {
          const Vec4 truth = brute_force(c, view, x, y, scene);
          const float* p = &frame.rgba[4 * (size_t(y) * size_t(view.width) + size_t(x))];
          for (int k = 0; k < 4; ++k)
            if (const double off = std::abs((k < 3 ? truth[k] : 1 - truth.w) - double(p[k])); !(off <= worst))
              worst = off, at = 100 * y + x;
        }
      INFO("widgets " << &all - soft_widgets.data() << ", lit " << shaded << ", pixel " << at % 100 << " " << at / 100);
      CHECK(worst < 1.0 / 512);
    }
}

TEST_CASE("volume: soft widgets give the same bytes for any number of threads, a block and its fine tilings the same picture") {
  const Projection view = perspective_view(45, 37, 55, {1.9, 1.4, 2.6}, {0, 0, 0});
  for (const auto& all : soft_widgets) {
    Case c{"", lattice_of(24, bumpy), nullptr, colored(-1.7, 1.7), constant_opacity(1), 0.05, true};
    c.data = dataset_of(c.lattice, false);
    VolumeItem v = soft_item(c, all);
    v.light.shadows = 0.5;
    const Scene scene = scene_of({v});
    set_thread_count(1);
    const Frame one = draw(scene, view);
    set_thread_count(7);
    CHECK(same_bytes(one, draw(scene, view)));
    set_thread_count(0);
    CHECK(largest_difference(one, draw(scene, view, {}, by_single_rays(view))) < 1.0f / 512);
  }
}

// Space is skipped by bounds on the value alone: a wrong one would leave holes.
TEST_CASE("volume: a stroke of one point is the ellipse, and one along a line of values is seen as far as it goes") {
  const Projection view = perspective_view(45, 37, 55, {1.9, 1.4, 2.6}, {0, 0, 0});
  Case c{"", lattice_of(24, bumpy), nullptr, colored(-1.7, 1.7), constant_opacity(1), 0.05};
  c.data = dataset_of(c.lattice, false);
  const TransferWidget ellipse = soft_ellipse(0, 1, 1, 3, 0.8), dab = painted({{0.5, 2}}, 0.5, 1, 0.8, of_map);
  CHECK(same_bytes(draw(scene_of({soft_item(c, {ellipse})}), view), draw(scene_of({soft_item(c, {dab})}), view)));
  // So wide over the gradient that only the value counts: a trapezoid with soft sides, which a curve can follow.
  const TransferWidget level = painted({{0, 0}, {0.6, 0}}, 0.3, 1e6, 0.8, of_map);
  OpacityCurve same{{{-0.3, 0}}};
  for (int i = 1; i < 200; ++i) {
    const double d = 1 - i / 200.0;
    same.points.push_back({-0.3 * d, 0.8 * (1 - d * d) * (1 - d * d)});
  }
  for (int i = 0; i < 200; ++i) {
    const double d = i / 200.0;
    same.points.push_back({0.6 + 0.3 * d, 0.8 * (1 - d * d) * (1 - d * d)});
  }
  same.points.push_back({0.9, 0});
  VolumeItem by_curve = item(c.data, c.color, same);
  by_curve.unit_distance = c.unit, by_curve.shaded = false;
  CHECK(largest_difference(draw(scene_of({soft_item(c, {level})}), view), draw(scene_of({by_curve}), view)) < 1.0f / 512);
}

// SPDX-License-Identifier: Apache-2.0
// The panel of opacity beside a volume's colour bar.
#include "render/annotate/legend/opacity.h"

#include <algorithm>

#include "color/cie.h"
#include "render/annotate/annotate.h"
#include "support/test.h"

using namespace sg;

namespace {

ColorScale temperature_to_100() {
  ColorScale s;
  s.map = find_colormap("sight");
  s.lo = 0, s.hi = 100, s.title = "temperature";
  return s;
}

Legend volume(OpacityCurve opacity, TransferDetail detail = {}) {
  VolumeLegend v{std::move(opacity), std::move(detail), temperature_to_100(), "gradient"};
  return Legend(temperature_to_100(), v);
}

struct Drawn {
  Image image;
  LegendLayout layout;
};

Drawn draw(const Legend& legend, int width = 1280, int height = 720) {
  Drawn d{Image(width, height, 3), {}};
  for (size_t i = 0; i < d.image.pixels.size(); ++i) d.image.pixels[i] = 255;
  Overlay overlay(width, height, false);
  const auto layouts = layout_legends(overlay, {legend}, {0, 0, double(width), double(height)}, 15, false);
  REQUIRE(layouts.size() == 1);
  d.layout = layouts[0];
  draw_legend(d.image, overlay, legend, d.layout);
  overlay.put_on(d.image);
  return d;
}

bool is(const uint8_t* p, Vec4f c) {
  for (int k = 0; k < 3; ++k)
    if (p[k] != int(255 * c[k] + 0.5f)) return false;
  return true;
}
bool is_ground(const uint8_t* p) { return p[0] == p[1] && p[1] == p[2] && (p[0] == 255 || p[0] == int(255 * 0.86f + 0.5f)); }

}  // namespace

TEST_CASE("legend: a volume's opacity stands left of the bar, its area in exactly the colours of the rows") {
  const Legend legend = volume({{{0, 0}, {50, 0}, {50, 0.2}, {100, 0.4}}});
  const Drawn d = draw(legend);
  const LegendLayout& l = d.layout;
  REQUIRE(l.panel.width > 40);
  CHECK(l.panel.right() < l.bar.x);
  CHECK(l.panel.y == l.bar.y);
  CHECK(l.panel.height == l.bar.height);
  CHECK(l.panel.x >= l.column.x);
  CHECK(l.panel_right == "0.4");
  CHECK(l.panel_caption == "opacity");
  const int left = int(l.panel.x), last = int(l.panel.width) - 1, n = int(l.bar.height);
  for (int i = 2; i < n - 2; i += 7) {
    const int row = int(l.bar.y) + i;
    const double value = legend.value_at(1 - double(i) / (n - 1)), share = legend.volume->opacity.at(value) / 0.4;
    // The bar beside it is as without a volume.
    CHECK(is(d.image.at(int(l.bar.x) + 5, row), legend.color(value)) + (std::abs(value - std::round(value / 20) * 20) < 0.5) >= 1);
    const int reach = int(std::lround(share * last));
    if (reach > 6) CHECK(is(d.image.at(left + reach / 2, row), legend.color(value)));
    if (reach < last - 8) CHECK(is_ground(d.image.at(left + reach + 4, row)));
  }
  // Step: the line goes across.
  const int step = int(l.bar.y + std::lround(0.5 * (n - 1)));
  CHECK(d.image.at(left + last / 4, step)[0] + d.image.at(left + last / 4, step + 1)[0] + d.image.at(left + last / 4, step - 1)[0] < 600);
}

TEST_CASE("legend: a plane shows each place in its colour as opaque as it is") {
  TransferDetail detail;
  detail.second = SecondAxis::gradient;
  detail.second_lo = 0, detail.second_hi = 10;
  detail.second_factor.points = {{0, 0}, {10, 1}};
  const Legend legend = volume({{{0, 0.5}}}, detail);
  const Drawn d = draw(legend);
  const LegendLayout& l = d.layout;
  CHECK(l.panel_left == "0");
  CHECK(l.panel_right == "10");
  CHECK(l.panel_caption == "gradient");
  const int left = int(l.panel.x), last = int(l.panel.width) - 1;
  for (const int i : {20, 100, 200}) {
    const int row = int(l.bar.y) + i;
    const Vec4f c = legend.color(legend.value_at(1 - i / (l.bar.height - 1)));
    const uint8_t* full = d.image.at(left + last, row);
    for (int k = 0; k < 3; ++k) CHECK(std::abs(full[k] - 255 * c[k]) < 3);
    CHECK(is_ground(d.image.at(left, row)));
    // Halfway, halfway between the ground and the colour.
    const uint8_t* half = d.image.at(left + last / 2, row);
    for (int k = 0; k < 3; ++k) CHECK(std::abs(half[k] - 255 * (0.5 * c[k] + 0.5 * 0.93)) < 13);
  }
}

TEST_CASE("legend: widgets are outlined and nothing is drawn outside of them") {
  TransferDetail detail;
  detail.second = SecondAxis::gradient;
  detail.second_lo = 0, detail.second_hi = 10;
  detail.widgets = {{TransferWidget::Shape::rectangle, 40, 60, 2, 8, 0.7, {1, 0, 0}}};
  const Drawn d = draw(volume({{{0, 0}}}, detail));
  const LegendLayout& l = d.layout;
  const auto pixel = [&](double value, double second) {
    return d.image.at(int(l.panel.x + second / 10 * (l.panel.width - 1)),
                      int(std::lround(l.bar.y + (1 - value / 100) * (l.bar.height - 1))));
  };
  CHECK(pixel(50, 5)[0] > 250);
  CHECK(pixel(50, 5)[1] < 10);
  CHECK(is_ground(pixel(70, 5)));
  CHECK(is_ground(pixel(30, 5)));
  CHECK(is_ground(pixel(50, 0.8)));
  CHECK(is_ground(pixel(50, 9.2)));
  CHECK(pixel(60, 5)[0] < 140);  // the outline
  CHECK(pixel(40, 5)[0] < 140);
}

TEST_CASE("legend: colour by another field puts the opacity's own axis below the panel") {
  TransferDetail detail;
  detail.second = SecondAxis::field, detail.second_field = "temperature";
  detail.color_by_second = true;
  detail.second_color = temperature_to_100();
  ColorScale density;
  density.map = find_colormap("gray");
  density.lo = 0, density.hi = 4, density.title = "density";
  const Legend legend(temperature_to_100(), VolumeLegend{{{{0, 0}, {4, 0.5}}}, detail, density, "temperature"});
  const Drawn d = draw(legend);
  CHECK(d.layout.panel_right == "4");
  CHECK(d.layout.panel_caption == "opacity by density");
  const LegendLayout& l = d.layout;
  const int row = int(l.bar.y) + 40;
  const Vec4f c = legend.color(legend.value_at(1 - 40 / (l.bar.height - 1)));
  const uint8_t* p = d.image.at(int(l.panel.right()) - 1, row);
  for (int k = 0; k < 3; ++k) CHECK(std::abs(p[k] - 255 * c[k]) < 3);
}

TEST_CASE("legend: panels fit whatever the picture's size, and labels have none") {
  for (const int size : {2000, 800, 400, 200, 90}) {
    const Legend legend = volume({{{0, 0}, {100, 1}}});
    Overlay overlay(size, size, false);
    for (const LegendLayout& l : layout_legends(overlay, {legend, legend}, {0, 0, double(size), double(size)}, 15, true)) {
      CHECK(l.column.x >= 0);
      CHECK(l.column.right() <= size);
      CHECK(l.panel.x >= l.column.x - 0.5);
      CHECK(l.panel.right() <= l.bar.x);
      CHECK(l.bar.right() + l.label_width <= l.column.right() + 1);
      CHECK(l.panel.bottom() + 1.8 * l.font <= l.column.bottom() + 1);
    }
  }
  Legend labels = volume({{{0, 0}, {100, 1}}});
  labels.labels = {1, 2, 3};
  CHECK(draw(labels).layout.panel.width == 0);
}

TEST_CASE("legend: ellipses and strokes are outlined as they are") {
  TransferDetail detail;
  detail.second = SecondAxis::gradient;
  detail.second_lo = 0, detail.second_hi = 10;
  detail.widgets = {{TransferWidget::Shape::ellipse, 60, 90, 2, 8, 0.7, {1, 0, 0}}, painted({{20, 2}, {30, 8}}, 8, 1, 0.7, {1, 0, 0})};
  for (const int height : {720, 2160}) {
    const Drawn d = draw(volume({{{0, 0}}}, detail), height * 16 / 9, height);
    const LegendLayout& l = d.layout;
    const auto pixel = [&](double value, double second) {
      return d.image.at(int(l.panel.x + second / 10 * (l.panel.width - 1)),
                        int(std::lround(l.bar.y + (1 - value / 100) * (l.bar.height - 1))));
    };
    // Of a thin line the pixel itself may be the one beside it.
    const auto darkest = [&](double value, double second) {
      const auto index = size_t(pixel(value, second) - d.image.at(0, 0)) / 3;
      const int x = int(index) % d.image.width, y = int(index) / d.image.width;
      int least = 255;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) least = std::min(least, int(d.image.at(x + i, y + j)[0]));
      return least;
    };
    INFO(height);
    CHECK(pixel(75, 5)[0] > 250);
    CHECK(pixel(75, 5)[1] < 10);
    CHECK(darkest(75, 2) < 120);  // the outlines
    CHECK(darkest(90, 5) < 120);
    CHECK(darkest(20 - 8, 2) < 120);
    CHECK(darkest(30 + 8, 8) < 120);
    CHECK(pixel(25, 5)[1] < 10);  // on the stroke's line
    // The corners of the boxes round them are empty.
    CHECK(is_ground(pixel(62, 2.4)));
    CHECK(is_ground(pixel(88, 7.6)));
    CHECK(is_ground(pixel(14, 8)));
    CHECK(is_ground(pixel(36, 2)));
  }
}

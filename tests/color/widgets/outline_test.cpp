// SPDX-License-Identifier: Apache-2.0
#include "color/widgets/outline.h"

#include <cmath>

#include "color/widgets/random_widgets.h"
#include "support/test.h"

using namespace sg;

TEST_CASE("property: the outline of paint lies a radius from its line, and all round it") {
  for (uint64_t seed : test::property_seeds(100)) {
    CAPTURE(seed);
    test::Random random(seed);
    TransferWidget w;
    do w = test::random_widget(random, {-3, 10}, {5, 1000});
    while (w.shape != TransferWidget::Shape::paint);
    const auto lines = outline(w);
    Vec2 least{w.hi, w.second_hi}, most{w.lo, w.second_lo};
    for (const auto& line : lines) {
      REQUIRE(line.size() >= 2);
      for (const Vec2& p : line) {
        least = {std::min(least.x, p.x), std::min(least.y, p.y)}, most = {std::max(most.x, p.x), std::max(most.y, p.y)};
        const double d = test::brush_distance(w, p.x, p.y);
        CHECK(d < 1 + 1e-6);
        CHECK(d > 1 - 1e-2);
      }
    }
    // It reaches the bounds, but for the pieces of its circles.
    CHECK(std::abs(least.x - w.lo) < 0.01 * w.radius);
    CHECK(std::abs(most.x - w.hi) < 0.01 * w.radius);
    CHECK(std::abs(least.y - w.second_lo) < 0.01 * w.second_radius);
    CHECK(std::abs(most.y - w.second_hi) < 0.01 * w.second_radius);
  }
}

TEST_CASE("outline: sides of a triangle and a rectangle, an ellipse closed") {
  TransferWidget w;
  w.lo = 2, w.hi = 6, w.second_lo = 1, w.second_hi = 3;
  CHECK(outline(w).size() == 4);
  w.shape = TransferWidget::Shape::triangle;
  REQUIRE(outline(w).size() == 3);
  CHECK(outline(w)[0][0] == Vec2{4, 1});
  w.shape = TransferWidget::Shape::ellipse;
  REQUIRE(outline(w).size() == 1);
  const auto round = outline(w)[0];
  for (const Vec2& p : round) CHECK(std::hypot((p.x - 4) / 2, p.y - 2) == doctest::Approx(1));
  CHECK(round.front().x == doctest::Approx(round.back().x));
  // Two points at one place are a dab.
  CHECK(outline(painted({{1, 1}, {1, 1}}, 1, 1, 1, {})).size() == 1);
}

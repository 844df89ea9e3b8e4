// SPDX-License-Identifier: Apache-2.0
#include "render/trace/sampling/mis.h"

#include "base/random.h"
#include "render/trace/sampling/local_frame.h"
#include "render/trace/sampling/warp.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;
using doctest::Approx;

TEST_CASE("mis: weights of both ways sum to one, also of densities whose squares overflow") {
  for (const auto& [a, b] : {std::pair{1.f, 3.f}, {1e30f, 2e30f}, {0.f, 2.f}, {1e-30f, 1e-30f}}) {
    CHECK(balance_weight(a, b) + balance_weight(b, a) == Approx(1));
    CHECK(power_weight(a, b) + power_weight(b, a) == Approx(1));
  }
  CHECK(balance_weight(1, 3) == .25f);
  CHECK(power_weight(1, 3) == Approx(.1));
  CHECK(balance_weight(0, 0) == 0);
  CHECK(power_weight(0, 0) == 0);
  CHECK(power_weight(1, INFINITY) == 0);
}

TEST_CASE("mis: the solid angle of a disc by the density of its area") {
  // A disc of radius 1 at distance 2, seen along its axis: 2 pi (1 - cos).
  double angle = 0;
  const int n = 20'000;
  for (int i = 0; i < n; ++i) {
    const Vec2f d = concentric_disc({float(random_unit(1, uint64_t(i))), float(random_unit(2, uint64_t(i)))});
    const float r2 = d.x * d.x + d.y * d.y + 4;
    angle += 1 / double(solid_angle_pdf(1 / pi, r2, 2 / std::sqrt(r2))) / n;
  }
  CHECK(angle == Approx(2 * M_PI * (1 - 2 / std::sqrt(5.))).epsilon(5e-3));
}

TEST_CASE("local frame: orthonormal and right-handed about every normal; there and back; a tangent is kept") {
  for (uint64_t i = 0; i < 2000; ++i) {
    Vec3f n = uniform_sphere({float(random_unit(3, i)), float(random_unit(4, i))});
    if (i < 6) n = Vec3f(i == 0, i == 1, i == 2) - Vec3f(i == 3, i == 4, i == 5);
    const Vec3f t = uniform_sphere({float(random_unit(5, i)), float(random_unit(6, i))});
    for (const LocalFrame& f : {LocalFrame::about(n), LocalFrame::about(n, t), LocalFrame::about(n, n)}) {
      CHECK(std::abs(length(f.x) - 1) < 1e-6f);
      CHECK(std::abs(dot(f.x, f.z)) < 1e-6f);
      CHECK(length(cross(f.x, f.y) - f.z) < 1e-6f);
      CHECK(length(f.to_world(f.to_local(t)) - t) < 1e-6f);
    }
    CHECK(LocalFrame::about(n, t).to_local(t).x > -1e-6f);
    CHECK(std::abs(LocalFrame::about(n, t).to_local(t).y) < 1e-6f);
  }
}

// SPDX-License-Identifier: Apache-2.0
// Media over two axes: how many places are looked at.
#include "render/volume/rays/integrate.h"
#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

/// A value that rises along the ray with an even gradient; counts how often it is asked for.
struct Slope : volume::RayField {
  void start(Vec3, Vec3, double, double) override {}
  size_t next(std::span<volume::Stretch>) override { return 0; }
  double entry() const override { return 0; }
  Vec3f gradient(const volume::Stretch&, double) override { return ++asked, Vec3f{1, 0, 0}; }
  size_t asked = 0;
};

}  // namespace

TEST_CASE("volume: a steep ramp of opacity over two axes costs only where a value crosses it, and is not missed") {
  const ColorScale color = one_color({1, 1, 1});
  OpacityCurve ramp;
  ramp.points = {{0, 0.2}, {0.5, 0.2}, {0.500001, 0.6}, {1, 0.6}};
  TransferDetail axes;
  axes.second = SecondAxis::gradient;
  const TransferFunction transfer(color, ramp, axes);
  const volume::Medium medium(color, ramp, {.unit = 1, .lo = 0, .hi = 1, .base = 0, .accuracy = 1e-4, .faint = 0.1, .most_tau = 1000});
  const volume::Detail detail{transfer, SecondAxis::gradient, 1, 1000};
  const volume::Look look{medium, {1.0 / 512, 1, 0}, 1, nullptr, 1, 1, &detail};
  for (const float from : {0.0f, 0.5001f, 0.3f}) {
    Slope walker;
    volume::RayState state;
    const float to = from + 0.4f, third = (to - from) / 3;
    volume::composite(look, {0, 0.4, {from, from + third, to - third, to}}, walker, state);
    CHECK(walker.asked < 60);
    const double before = std::clamp(0.5 - double(from), 0.0, 0.4), truth = std::pow(0.8, before) * std::pow(0.4, 0.4 - before);
    CHECK(std::abs(double(state.sum.transmittance) - truth) < 1.0 / 512);
  }
}

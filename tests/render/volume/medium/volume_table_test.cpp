// SPDX-License-Identifier: Apache-2.0
// Pre-integrated classification from a table by (front, back, length): V5.
#include "render/volume/medium/preintegrated.h"
#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

using doctest::Approx;

OpacityCurve spiky() {
  OpacityCurve c;
  c.points = {{-1, 0}, {-0.6, 0.3}, {-0.2, 0.1}, {0.30, 0.1}, {0.305, 0.95}, {0.31, 0}, {1, 0.5}};
  return c;
}
volume::Medium medium_of(const OpacityCurve& curve) {
  volume::Medium::Plan plan;
  plan.unit = 0.1, plan.lo = -1, plan.hi = 1;
  return volume::Medium(grey(-1, 1), curve, plan);
}

struct Truth {
  Vec3 color{0, 0, 0};
  double alpha = 0;
};
/// Of the medium in straight lines, by the midpoint rule on parts of each.
Truth integral(const volume::Medium& medium, double front, double back, double length, int parts = 400) {
  const auto lines = medium.straight();
  std::vector<double> cuts{0, 1};
  for (const auto& l : lines)
    for (double v : {double(l.lo), double(l.hi)})
      if (front != back && (v - front) / (back - front) > 0 && (v - front) / (back - front) < 1)
        cuts.push_back((v - front) / (back - front));
  std::sort(cuts.begin(), cuts.end());
  Truth t;
  double pass = 1;
  for (size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double middle = front + (back - front) * 0.5 * (cuts[i] + cuts[i + 1]);
    size_t k = 0;
    while (k + 1 < lines.size() && middle >= double(lines[k].hi)) ++k;
    for (int q = 0; q < parts; ++q) {
      const double f = cuts[i] + (cuts[i + 1] - cuts[i]) * (q + 0.5) / parts, d = front + (back - front) * f - double(lines[k].lo);
      const double tau = std::max(0.0, double(lines[k].at.tau) + d * double(lines[k].slope.tau));
      const double passes = std::exp(-tau * length * (cuts[i + 1] - cuts[i]) / parts);
      t.color += (Vec3(lines[k].at.color) + Vec3(lines[k].slope.color) * d) * (pass * (1 - passes));
      pass *= passes;
    }
  }
  t.alpha = 1 - pass;
  return t;
}

double off(const volume::Preintegrated& table, const volume::Medium& m, float front, float back, float length) {
  const auto s = table.at(front, back, length);
  const Truth t = integral(m, double(front), double(back), double(length));
  return std::max({std::abs(double(s.color.x) - t.color.x), std::abs(double(s.color.y) - t.color.y),
                   std::abs(double(s.color.z) - t.color.z), std::abs(1 - std::exp(-double(s.depth)) - t.alpha)});
}

}  // namespace

TEST_CASE("table: at its nodes it is the true integral with self-attenuation to 1e-6, spikes included (V5)") {
  const volume::Medium m = medium_of(spiky());
  const volume::Preintegrated table(m, {-1, 1, 0.3f, 24});
  const auto& nodes = table.nodes();
  // Thin as it is, the spike has nodes at its foot, its top and its end.
  CHECK(std::count_if(nodes.begin(), nodes.end(), [](float v) { return v > 0.299f && v < 0.311f; }) >= 3);
  double most = 0;
  for (size_t i = 0; i < nodes.size(); i += 4)
    for (size_t j = i % 3; j < nodes.size(); j += 3)
      for (int k = 1; k <= 3; ++k) most = std::max(most, off(table, m, nodes[i], nodes[j], 0.3f * float(k) / 3));
  CHECK(most < 2e-6);
}

TEST_CASE("table: equal values are one sample, and front and back are not the same (V5)") {
  const volume::Medium m = medium_of(spiky());
  const volume::Preintegrated table(m, {-1, 1, 0.3f, 64});
  for (float v : {-0.6f, -0.2f, 1.0f}) {
    const auto s = table.at(v, v, 0.2f);
    const double alpha = 1 - std::exp(-0.2 * double(m.tau(v)));
    CHECK(1 - std::exp(-double(s.depth)) == Approx(alpha).epsilon(1e-4));
    CHECK(double(s.color.y) == Approx(alpha * double(m.color(v).y)).epsilon(2e-3));
  }
  const auto up = table.at(-0.6f, 1, 0.3f), down = table.at(1, -0.6f, 0.3f);
  CHECK(up.depth == Approx(down.depth).epsilon(1e-6));
  CHECK(std::abs(down.color.x - up.color.x) > 0.03f);  // what lies in front hides the rest
  CHECK(table.at(-1, -1, 0.3f).depth < 1e-9f);
}

TEST_CASE("table: between nodes and lengths it is right to 1/256") {
  OpacityCurve curve;
  curve.points = {{-1, 0}, {-0.5, 0.2}, {0.1, 0.02}, {0.6, 0.5}, {1, 0.3}};
  const volume::Medium m = medium_of(curve);
  const volume::Preintegrated table(m, {-1, 1, 0.3f});
  double most = 0;
  for (uint64_t i = 0; i < 300; ++i) {
    const float a = float(2 * random_unit(1, i) - 1), b = float(2 * random_unit(2, i) - 1), l = float(0.3 * random_unit(3, i));
    most = std::max(most, off(table, m, a, b, l));
  }
  CHECK(most < 1.0 / 256);
  CHECK(most > 1e-7);
  CHECK(table.bytes() < size_t(16) << 20);
}

TEST_CASE("table: a picture by it sees a spike that steps miss, and is the closed form's") {
  const DatasetPtr ramp = grid(cube(9, -1, 1), [](Vec3 p) { return p.z; });
  VolumeItem v = item(ramp, one_color({1, 1, 1}), {{{-1, 0}, {0.10, 0}, {0.12, 0.9}, {0.14, 0}, {1, 0}}});
  v.unit_distance = 0.02;
  double depth = 0;
  for (int i = 0; i < 200000; ++i) depth += -std::log(1 - 0.9 * (i + 0.5) / 200000) / 200000 * 0.04 / 0.02;
  for (const double step : {0.3, 0.07, 0.011}) {
    v.sampling.step = step, v.sampling.classify = VolumeClassify::table;
    CHECK(-std::log(1 - double(look(scene_of({v})).rgba[3])) == Approx(depth).epsilon(1e-2));
  }
  VolumeItem w = item(grid(cube(17, -1, 1), [](Vec3 p) { return std::sin(3 * p.x) * std::cos(2 * p.y) + 0.3 * p.z; }), grey(-1.3, 1.3),
                      {{{-1.3, 0}, {0, 0.1}, {0.2, 0.6}, {0.4, 0}, {1.3, 0.5}}});
  w.unit_distance = 0.3, w.sampling.step = 0.09;
  const Projection view = parallel_view(20, 20, 9, {0.2, -0.4, -1});
  for (bool shaded : {false, true}) {
    w.shaded = shaded;
    w.sampling.classify = VolumeClassify::integrated;
    const Frame closed = draw(scene_of({w}), view);
    w.sampling.classify = VolumeClassify::table;
    CHECK(largest_difference(closed, draw(scene_of({w}), view)) < 1.0f / 128);
  }
}

// SPDX-License-Identifier: Apache-2.0
// What a medium does within one cell: cubics of the length across knots of opacity and of colour, against an integral in tiny steps.
#include <fmt/core.h>

#include "color/transfer_text.h"
#include "render/volume/rays/integrate.h"
#include "render/volume/volume_support.h"
#include "render/volume/volume_truth.h"
#include "support/property.h"

using namespace sg;
using namespace sg::test;

namespace {

/// A walker that unlit stretches ask nothing of.
class NoField final : public volume::RayField {
 public:
  void start(Vec3, Vec3, double, double) override {}
  size_t next(std::span<volume::Stretch>) override { return 0; }
  double entry() const override { return 0; }
  Vec3f gradient(const volume::Stretch&, double) override { return {0, 0, 0}; }
};

/// A cell along a ray.
struct Cell {
  const char* name;
  std::array<float, 4> b;  ///< Bernstein coefficients of the value
  std::vector<Vec2> opacity;
  std::vector<TrueTransfer::Stop> stops;
  double lo = 0, hi = 1;  ///< of the scale
  double unit = 1;        ///< the cell is one long
  ScaleKind kind = ScaleKind::linear;
  double diagonal = 4;  ///< of the volume
};

constexpr double threshold = 5;  // of scales about zero

const std::vector<TrueTransfer::Stop> kinked{{0, {0, 0, 0}}, {0.24, {1, 0.8, 0.6}}, {0.4, {0, 0, 0}}, {1, {0, 0, 0}}};

int byte(double x) { return int(x * 255 + 0.5); }

TrueTransfer transfer_of(const Cell& c) {
  TrueTransfer t;
  t.opacity = c.opacity, t.stops = c.stops, t.lo = c.lo, t.hi = c.hi, t.unit = c.unit, t.kind = c.kind, t.threshold = threshold;
  for (TrueTransfer::Stop& stop : t.stops)
    for (int k = 0; k < 3; ++k) stop.srgb[k] = byte(stop.srgb[k]) / 255.0;
  return t;
}

ColorScale scale_of(const Cell& c) {
  ColorScale s;
  s.lo = c.lo, s.hi = c.hi, s.kind = c.kind, s.linear_threshold = threshold;
  std::string text;
  for (const TrueTransfer::Stop& stop : c.stops) {
    text +=
        fmt::format("{}{}:#{:02x}{:02x}{:02x}", text.empty() ? "" : ",", stop.at, byte(stop.srgb.x), byte(stop.srgb.y), byte(stop.srgb.z));
  }
  parse_color_stops(text, s, true);
  return s;
}

std::array<double, 4> in_tiny_steps(const Cell& c) {
  const TrueTransfer t = transfer_of(c);
  constexpr int n = 40000;
  Vec3 color{0, 0, 0};
  double pass = 1;
  for (int i = 0; i < n && pass > 1e-9; ++i) {
    const double f = (i + 0.5) / n, g = 1 - f;
    const double v = g * g * (g * double(c.b[0]) + 3 * f * double(c.b[1])) + f * f * (3 * g * double(c.b[2]) + f * double(c.b[3]));
    const double depth = -std::log1p(-t.opacity_on(v, v)) / (c.unit * n), alpha = -std::expm1(-depth);
    color += t.color_on(v, v) * (pass * alpha), pass *= 1 - alpha;
  }
  return {color.x, color.y, color.z, 1 - pass};
}

std::array<double, 4> in_pieces(const Cell& c, double tolerance) {
  OpacityCurve curve;
  curve.points = c.opacity;
  volume::Medium::Plan plan;
  plan.unit = c.unit, plan.accuracy = 0.25 * tolerance, plan.faint = 0.5 / c.diagonal, plan.most_tau = 1000;
  plan.lo = std::min(c.lo, c.opacity.front().x), plan.hi = std::max(c.hi, c.opacity.back().x);
  const volume::Medium medium(scale_of(c), curve, plan);
  volume::RayState state;
  NoField none;
  volume::composite({medium, {tolerance, c.diagonal, 0}}, {0, 1, {c.b[0], c.b[1], c.b[2], c.b[3]}}, none, state);
  return {double(state.sum.r), double(state.sum.g), double(state.sum.b), 1 - double(state.sum.transmittance)};
}

}  // namespace

TEST_CASE("volume: cells in which the value bends, turns and meets knots are right to the tolerance, thin or dense") {
  const std::vector<TrueTransfer::Stop> plain{{0, {0.94, 0.24, 0.04}}, {1, {0.94, 0.24, 0.04}}},
      ramp{{0, {0.13, 0.67, 0.2}}, {1, {0.9, 0.31, 0.8}}}, step{kinked},
      tent{{0, {0.75, 0.29, 0.41}}, {0.5, {0.92, 0.99, 0.78}}, {1, {0.5, 0.02, 0.84}}};
  const Cell cells[] = {
      {"a ramp that a value with a sharp bend meets",
       {1.62f, 1.0f, 0.87f, 0.81f},
       {{0, 0}, {0.58, 0}, {1.39, 0.78}, {2, 0.78}},
       plain,
       0,
       2},
      {"a plateau that a value leaves at first slowly",
       {0.9017f, 0.9014f, 0.9008f, 0.898f},
       {{0, 0}, {0.5, 0.26}, {0.8987, 0.26}, {0.902, 0}, {1, 0}},
       plain,
       0,
       1,
       0.1},
      {"a dense cell in which the value turns", {0.33f, 0.42f, 0.43f, 0.34f}, {{0, 0.89}, {1, 0.89}}, ramp, 0, 1, 0.07},
      {"a dense cell in which the value falls faster and faster", {0.8f, 0.8f, 0.7f, 0.1f}, {{0, 0.95}, {1, 0.95}}, ramp, 0, 1, 0.3},
      {"a ramp of opacity and of colour along a parabola", {0, 0, 0.33f, 1}, {{0, 0}, {1, 0.6}}, ramp, 0, 1, 1},
      {"a faint step in a thin volume", {0.3f, 0.75f, 0.7f, 0.32f}, {{0, 0}, {0.45, 0}, {0.45, 0.14}, {1, 0.14}}, plain, 0, 1, 1},
      {"colours end within the values", {0.9f, 0.7f, 0.3f, 0.05f}, {{0, 0.7}, {1, 0.7}}, ramp, 0.45, 1, 1},
      {"colours kink", {0.9f, 0.7f, 0.3f, 0.1f}, {{0, 0.7}, {1, 0.7}}, tent, 0, 1, 0.4},
      {"colours kink beyond both ends of the value, which turns there",
       {0.23795f, 0.24295f, 0.24345f, 0.23945f},
       {{0, 0.5}, {1, 0.5}},
       step,
       0,
       1,
       1},
      {"a logarithmic scale over some octaves", {1, 30, 60, 100}, {{1, 0.5}, {100, 0.5}}, ramp, 1, 100, 1, ScaleKind::log},
      {"a logarithmic scale about zero", {-40, -10, 30, 50}, {{-50, 0.5}, {50, 0.5}}, ramp, -50, 50, 1, ScaleKind::symlog},
  };
  for (const double tolerance : {1.0 / 512, 1.0 / 4096})
    for (const Cell& cell : cells) {
      Cell c = cell;
      for (int turned = 0; turned < 2; ++turned) {
        if (turned) std::reverse(c.b.begin(), c.b.end());
        INFO(std::string(c.name), std::string(turned ? ", backwards, " : ", "), tolerance);
        const auto seen = in_pieces(c, tolerance), want = in_tiny_steps(c);
        for (size_t k = 0; k < 4; ++k) CHECK(std::abs(seen[k] - want[k]) < tolerance);
      }
    }
}

TEST_CASE("volume: opacity 1 in a lattice hides what lies behind it, however short the way through it and however many values have it") {
  // x (1 - y) goes up to 1/4 along a diagonal of the cell: a millionth beyond the step on three thousandths of it.
  const auto data = grid(cube(2, 0, 1), [](Vec3 p) { return p.x * (1 - p.y); });
  OpacityCurve curve;
  curve.points = {{0, 0}, {0.249999, 0}, {0.249999, 1}, {1, 1}};
  const Scene scene = scene_of({item(data, one_color({1, 1, 1}), curve)});
  Projection view = parallel_view(1, 1, 1, normalize(Vec3{1, 1, 0}), {0, 0, 1}, {0.5, 0.5, 0.4});
  CHECK(draw(scene, view).rgba[3] > 0.999);
  CHECK(draw(scene, view, {}, by_single_rays(view)).rgba[3] > 0.999);
}

TEST_CASE("property: cells with random values and transfer functions are right to the tolerance") {
  for (uint64_t seed : property_seeds(150)) {
    CAPTURE(seed);
    Random r(seed);
    const auto color = [&] { return Vec3{double(r.whole(0, 255)), double(r.whole(0, 255)), double(r.whole(0, 255))} / 255.0; };
    Cell c{"", {}, {}, {{0, color()}}};
    for (float& b : c.b) b = float(r.in(0, 1));
    double x = 0;
    for (int i = 0; i < 4; ++i)
      x += (1 - x) * (r.chance(0.2) ? r.magnitude(1e-4, 0.1) : r.in(0, 0.6)), c.opacity.push_back({x, r.chance(0.3) ? 0 : r.in(0, 0.98)});
    c.opacity.insert(c.opacity.begin(), Vec2{0, c.opacity.front().y}), c.opacity.push_back({1, c.opacity.back().y});
    const double middle = r.in(0.1, 0.9);
    c.stops.push_back({middle, color()});
    if (r.chance(0.3)) c.stops.push_back({middle, color()});
    c.stops.push_back({1, color()});
    c.unit = r.magnitude(0.05, 20), c.diagonal = r.in(1, 20);
    const double tolerance = r.one_of({1.0 / 64, 1.0 / 512, 1.0 / 4096});
    const TrueTransfer transfer = transfer_of(c);
    TrueVolume v{&transfer,
                 transfer.knots(),
                 [&c](double f) {
                   const double g = 1 - f;
                   return g * g * (g * double(c.b[0]) + 3 * f * double(c.b[1])) + f * f * (3 * g * double(c.b[2]) + f * double(c.b[3]));
                 },
                 nullptr,
                 nullptr,
                 {0, 1}};
    const TrueSum sum = TrueRay({v}, {0, 0, 1}, 64).integrate(0, 1);
    const auto seen = in_pieces(c, tolerance);
    const double want[4] = {sum.color.x, sum.color.y, sum.color.z, 1 - sum.pass};
    for (size_t k = 0; k < 4; ++k) CHECK(std::abs(seen[k] - want[k]) < tolerance);
  }
}

TEST_CASE("volume medium: a step of colour has both of its colours and a knot between them, wherever it is") {
  Random r(7);
  for (const ScaleKind kind : {ScaleKind::linear, ScaleKind::log, ScaleKind::symlog})
    for (int i = 0; i < 150; ++i) {
      const double at = r.in(0.01, 0.99), lo = kind == ScaleKind::log ? r.magnitude(1e-3, 10) : r.in(-30, 10),
                   hi = lo + r.magnitude(1, 100);
      ColorScale scale;
      scale.kind = kind, scale.lo = lo, scale.hi = hi, scale.linear_threshold = 3;
      parse_color_stops(fmt::format("0:red,{0}:red,{0}:#00ff00,1:#00ff00", at), scale, true);
      OpacityCurve curve;
      curve.points = {{lo, 0.5}};
      volume::Medium::Plan plan;
      plan.lo = lo, plan.hi = hi;
      const volume::Medium medium(scale, curve, plan);
      INFO(int(kind), " ", at, " from ", lo, " to ", hi);
      const auto knot = float(scale.value_at(at));
      const size_t line = size_t(medium.line_of(knot));
      REQUIRE(line > 0);
      CHECK(medium.lines()[line].lo == knot);
      CHECK(medium.recolors(line));
      CHECK(medium.abrupt(float(lo), float(hi)));
      CHECK(medium.color(knot, int(line) - 1).x > 0.99f);
      CHECK(medium.color(knot, int(line)).y > 0.99f);
    }
}

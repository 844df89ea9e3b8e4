// SPDX-License-Identifier: Apache-2.0
// Very dense media: what opacity says is what is drawn, however thin.
#include <fmt/core.h>

#include "color/cie.h"
#include "color/transfer_text.h"
#include "render/volume/engines/tets/tet_rays.h"
#include "volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

/// One cell with values 0 to 1 along z.
DatasetPtr one_cell(bool tets) {
  DatasetPtr data = grid(cube(2, 0, 1), [](Vec3 p) { return p.z; });
  if (tets) {
    UnstructuredMesh m;
    std::vector<double> xyz;
    for (int c = 0; c < 8; ++c)
      for (int a = 0; a < 3; ++a) xyz.push_back(c >> a & 1);
    m.points.xyz = Array::from_vector(xyz, 3), m.single_type = CellType::tetra;
    m.cells.connectivity = Array::from_vector(std::vector<int64_t>{0, 1, 2, 4, 3, 1, 7, 2, 5, 1, 4, 7, 6, 2, 7, 4, 1, 2, 4, 7});
    m.cells.fixed = 4;
    data = make_dataset(m, data->fields());
  }
  return data;
}

/// Alpha of a ray along it.
double alpha_through(OpacityCurve opacity, double unit, bool single, bool tets = false) {
  VolumeItem v = item(one_cell(tets), one_color({1, 1, 1}), std::move(opacity));
  v.unit_distance = unit;
  const Projection view = parallel_view(1, 1, 1, {0, 0, -1}, {0, 1, 0}, {0.513, 0.417, 0});
  return double(draw(scene_of({v}), view, {}, single ? by_single_rays(view) : FragmentLists{}).rgba[3]);
}

}  // namespace

TEST_CASE("volume: a thin layer of opacity 1 is opaque") {
  for (const double width : {0.1, 0.01, 0.001, 0.0001})
    for (const bool single : {false, true})
      for (const bool tets : {false, true}) {
        INFO(width, std::string(single ? ", single rays" : ""), std::string(tets ? ", tetrahedra" : ""));
        CHECK(alpha_through({{{0.4, 0}, {0.4, 1}, {0.4 + width, 1}, {0.4 + width, 0}}}, 0.01, single, tets) > 0.998);
      }
}

TEST_CASE("volume: opacity 1 hides what lies behind the edge of a cell, in tetrahedra too") {
  for (const double beside : {1e-3, 1e-4})
    for (const bool single : {false, true})
      for (const VolumeMethod method : {VolumeMethod::ray, VolumeMethod::cells}) {
        INFO(beside, std::string(single ? ", single rays" : ""));
        VolumeItem v = item(one_cell(true), one_color({1, 1, 1}), {{{0, 1}, {0.5, 1}, {0.5, 0}, {1, 0}}});
        v.unit_distance = 0.01, v.method = method;
        const Projection view = parallel_view(1, 1, 1, {1, -1, 0}, {0, 0, 1}, {0.5 * beside, 0.5 * beside, 0.3});
        CHECK(double(draw(scene_of({v}), view, {}, single ? by_single_rays(view) : FragmentLists{}).rgba[3]) > 0.998);
      }
}

// Opacity 1 shows the colour of a single value.
TEST_CASE("volume: colours of tetrahedra lie between those of the nodes of a table") {
  ColorScale scale;
  scale.lo = 0, scale.hi = 1;
  parse_color_stops("0:#102030,0.6:#102030,0.65:#f0e0d0,1:#f0e0d0", scale, true);
  volume::Medium::Plan plan;
  plan.accuracy = 0.25 / 4096;
  const volume::Medium medium(scale, OpacityCurve{{{0, 1}, {1, 1}}}, plan);
  Range range;
  range.add({0, 1});
  const volume::TetMedium tets(medium, range, 1.0f / 4096);
  double worst = 0;
  for (int i = 0; i <= 5000; ++i) {
    const double v = 0.61 + 0.03 * i / 5000, share = (v - 0.6) / 0.05;
    for (const auto& l : tets.intervals)
      if (double(l.lo) <= v && v <= double(l.hi))
        for (int k = 0; k < 3; ++k) {
          const double srgb = (16 * (k + 1) + share * (240 - 16 * k - 16 * (k + 1))) / 255;
          worst = std::max(worst, std::abs(double(l.at[k + 1]) + (v - double(l.lo)) * double(l.slope[k + 1]) - srgb_to_linear(srgb)));
        }
  }
  CHECK(worst < 0.5 / 4096);
}

TEST_CASE("volume: opacities below 1 have their own extinction, however large") {
  // 0.75 per 1e-6 of the edge, over 1e-6 of it: 0.75 of the light.
  for (const double thin : {1e-4, 1e-5})
    for (const bool single : {false, true}) {
      INFO(thin, std::string(single ? ", single rays" : ""));
      CHECK(alpha_through({{{0.5, 0}, {0.5, 0.75}, {0.5 + thin, 0.75}, {0.5 + thin, 0}}}, thin, single) ==
            doctest::Approx(0.75).epsilon(0.02));
    }
}

namespace {

/// Red of rays along z through a cell, from its top down or from its bottom up, as all engines draw it; and its farthest from `want`.
double farthest(VolumeItem v, bool tets, bool up, double want) {
  v.data = one_cell(tets), v.unit_distance = 1;
  const Projection view = parallel_view(5, 5, 6, {0, 0, up ? 1.0 : -1.0}, {0, 1, 0}, {0.513, 0.487, 0.5});
  double worst = 0;
  for (const VolumeMethod method : {VolumeMethod::ray, VolumeMethod::cells}) {
    if (method == VolumeMethod::cells && !tets) continue;
    v.method = method;
    for (const bool single : {false, true}) {
      const Frame f = draw(scene_of({v}), view, {}, single ? by_single_rays(view) : FragmentLists{});
      for (size_t i = 0; i < 25; ++i) worst = std::max(worst, std::abs(double(f.rgba[4 * i]) - want));
    }
  }
  return worst;
}

ColorScale stops(const std::string& text) {
  ColorScale scale;
  scale.lo = 0, scale.hi = 1;
  parse_color_stops(text, scale, true);
  return scale;
}

}  // namespace

TEST_CASE("volume: what is opaque shows its front, though colours rise and fall behind it") {
  for (const bool tets : {false, true})
    for (int i = 0; i <= 40; ++i) {
      const double bright = 0.8 + 0.004 * i;
      INFO(bright, std::string(tets ? ", tetrahedra" : ""));
      VolumeItem v = item(nullptr, stops(fmt::format("0:#000000,{}:#ffffff,1:#c0c0c0", bright)), {{{0, 1}, {1, 1}}});
      CHECK(farthest(v, tets, false, srgb_to_linear(192 / 255.0)) < 1.0 / 512 + 1e-4);
    }
}

TEST_CASE("volume: what is opaque from a value on shows the colour of that value, to a fine tolerance") {
  for (const bool tets : {false, true})
    for (int i = 0; i <= 20; ++i) {
      const double begin = 0.5 + 0.0017 * i;
      INFO(begin, std::string(tets ? ", tetrahedra" : ""));
      VolumeItem v = item(nullptr, stops("0:#000000,1:#ffffff"), {{{0, 0}, {begin, 0}, {begin + 1e-3, 1}, {1, 1}}});
      v.sampling.tolerance = 1.0 / 4096;
      // The ramp takes about a thousandth of the light on its way to that colour.
      CHECK(farthest(v, tets, true, srgb_to_linear(begin + 1e-3)) < 1.0 / 4096 + 1e-4);
    }
}

TEST_CASE("volume: what is opaque in one of two volumes is seen through the haze of the other") {
  for (int i = 0; i <= 110; ++i) {
    const double depth = 2 + 0.1 * i;
    INFO(depth);
    VolumeItem haze = item(one_cell(false), one_color({0, 0, 0}), constant_opacity(depth));
    VolumeItem wall = item(one_cell(false), one_color({1, 1, 1}), {{{0, 1}, {0.5, 1}, {0.5, 0}, {1, 0}}});
    const Projection view = parallel_view(1, 1, 1, {0, 0, -1}, {0, 1, 0}, {0.513, 0.417, 0});
    CHECK(std::abs(double(draw(scene_of({haze, wall}), view).rgba[0]) - std::exp(-0.5 * depth)) < 1.0 / 512);
  }
}

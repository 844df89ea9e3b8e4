// SPDX-License-Identifier: Apache-2.0
// The same volumes with the instructions of every processor that the vector code knows. Data are made anew for each, as bricks of
// empty space are kept with them.
#include <hwy/targets.h>

#include "render/volume/engines/packets/gathers.h"
#include "render/volume/sources/cells/volume_cells_support.h"
#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

/// Draws with the best target and with each alone, by gathers and by single loads; the number of targets.
template <class Draw>
size_t same_on_all_targets(Draw&& draw_it) {
  const bool measured = volume::loads_beat_gathers();
  const Frame best = draw_it();
  CHECK(*std::max_element(best.rgba.begin(), best.rgba.end()) > 0.2f);
  const auto targets = hwy::SupportedAndGeneratedTargets();
  for (const int64_t target : targets) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    for (const bool loads : {false, true}) {
      volume::set_loads_beat_gathers(loads);
      INFO(std::string(hwy::TargetName(target)) << (loads ? ", by loads" : ", by gathers"));
      const Frame frame = draw_it();
      CHECK(largest_difference(best, frame) == 0);
      CHECK(best.depth == frame.depth);
      CHECK(same_bytes(best, frame));
    }
  }
  volume::set_loads_beat_gathers(measured);
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
  return targets.size();
}

double waves(Vec3 p) { return 60 + 25 * std::sin(5 * p.x + 1) * std::cos(4 * p.y) + 20 * std::sin(6 * p.z + p.x); }

VolumeItem wave_item(ElementType type, bool shaded, double step) {
  VolumeItem v = item(grid(cube(37, -1, 1), waves, type), grey(0, 120), {}, step);
  v.opacity.points = {{60, 0}, {70, 0.4}, {75, 0}, {85, 0}, {95, 0.9}};
  v.unit_distance = 0.05, v.shaded = shaded;
  return v;
}
const Projection oblique = perspective_view(45, 37, 55, {1.5, 1.1, 3}, {0, 0, 0});

}  // namespace

TEST_CASE("volume targets: rows a page apart, fetched for few rays at a time, give the same bytes") {
  UniformGrid g = cube(14, -1, 1);
  g.dims[0] = 1024, g.spacing.x = 2.0 / 1023;
  for (const bool shaded : {false, true}) {
    const auto made = [&] {
      VolumeItem v = wave_item(ElementType::f32, shaded, 0.02);
      v.data = grid(g, waves);
      return v;
    };
    INFO("shaded " << shaded);
    CHECK(same_on_all_targets([&] { return draw(scene_of({made()}), oblique); }) >= 2);
    CHECK(same_bytes(draw(scene_of({made()}), oblique), draw(scene_of({made()}), oblique, [] {
                       volume::Knobs one;
                       one.simd = false;
                       return one;
                     }())));
  }
}

TEST_CASE("volume targets: packets give the same bytes with every width of vectors") {
  size_t targets = 0;
  for (const ElementType type : {ElementType::f32, ElementType::u8, ElementType::i16})
    for (const bool shaded : {false, true}) {
      for (const double step : {0.0, 0.01, 0.1}) {  // within the tolerance; lit one by one; lit by twos
        INFO(std::string(element_name(type)) << " shaded " << shaded << " step " << step);
        targets = same_on_all_targets([&] { return draw(scene_of({wave_item(type, shaded, step)}), oblique); });
      }
      INFO(std::string(element_name(type)) << " opacity by the gradient, shaded " << shaded);
      same_on_all_targets([&] {
        VolumeItem v = wave_item(type, shaded, 0);
        v.detail.second = SecondAxis::gradient, v.detail.second_factor.points = {{0, 0}, {100, 0}, {100, 0.2}, {200, 1}};
        return draw(scene_of({v}), oblique);
      });
      INFO(std::string(element_name(type)) << " maximum");
      same_on_all_targets([&] {
        VolumeItem v = wave_item(type, shaded, 0);
        v.mode = RayFunction::maximum, v.opacity.points = {{0, 0}, {60, 0.5}, {100, 1}};
        return draw(scene_of({v}), oblique);
      });
    }
  CHECK(targets > 1);
}

TEST_CASE("volume targets: rectilinear grids are the same with every width of vectors") {
  for (const bool shaded : {false, true})
    same_on_all_targets([&] {
      RectilinearGrid g;
      std::vector<double> x, v;
      for (int i = 0; i < 25; ++i) x.push_back(i / 12.0 - 1 + 0.03 * std::sin(0.9 * i));
      for (const double z : x)
        for (const double y : x)
          for (const double u : x) v.push_back(waves({u, y, z}));
      g.x = g.y = g.z = Array::from_vector(x);
      FieldSet fields;
      fields.add({"f", Association::point, Array::from_vector(v).converted(ElementType::f32), "", Role::scalars});
      VolumeItem item = wave_item(ElementType::f32, shaded, 0);
      item.data = make_dataset(g, fields);
      return draw(scene_of({item}), oblique);
    });
}

TEST_CASE("volume targets: light beside holes is the same with every width of vectors") {
  for (const double step : {0.0, 0.01, 0.1}) {
    CAPTURE(step);
    same_on_all_targets([&] {
      const auto holed = [](Vec3 p) { return length(p - Vec3(0.4, 0.3, 0.5)) < 0.35 ? NAN : waves(p); };
      VolumeItem v = wave_item(ElementType::f32, true, step);
      v.data = grid(cube(37, -1, 1), holed);
      return draw(scene_of({v}), oblique);
    });
  }
}

TEST_CASE("volume targets: strides through smooth fields, shadows and two crossing volumes are the same with every width of vectors") {
  same_on_all_targets([] {
    VolumeItem v = item(grid(cube(65, -1, 1), [](Vec3 p) { return 1 - dot(p, p) / 3; }), grey(0, 1), {});
    v.opacity.points = {{0, 0}, {1, 0.3}}, v.unit_distance = 0.1;
    return draw(scene_of({v}), oblique);
  });
  same_on_all_targets([] {
    VolumeItem v = wave_item(ElementType::f32, true, 0);
    v.light.shadows = 0.7, v.light.occlusion = 0.5;
    return draw(scene_of({v}), oblique);
  });
  same_on_all_targets([] {
    VolumeItem a = wave_item(ElementType::f32, true, 0), b = wave_item(ElementType::u8, false, 0.03);
    b.data = grid(
        cube(21, -0.7, 1.2), [](Vec3 p) { return 100 * p.x * p.y + 60; }, ElementType::u8);
    return draw(scene_of({a, b}), oblique);
  });
}

TEST_CASE("volume targets: rays through tetrahedra are the same with every width of vectors") {
  for (const bool shaded : {false, true})
    same_on_all_targets([&] {
      VolumeItem v =
          item(with_field(test::cube(CellType::tetra, 5, bent), [](Vec3 p) { return waves(p * 2.0 - Vec3(1, 1, 1)); }), grey(0, 120), {});
      v.opacity.points = {{60, 0}, {70, 0.4}, {75, 0}, {85, 0}, {95, 0.9}}, v.unit_distance = 0.05, v.shaded = shaded;
      const Frame frame = draw(scene_of({v}), perspective_view(45, 37, 80, {1.5, 1.1, 3}, {0.5, 0.5, 0.5}));
      // Where half of the light is gone there is a depth.
      for (size_t i = 0; i < frame.depth.size(); ++i) CHECK((frame.depth[i] < HUGE_VALF) == (frame.rgba[4 * i + 3] > 0.5f));
      return frame;
    });
}

TEST_CASE("volume targets: projected tetrahedra and the classic methods are the same with every width of vectors") {
  for (const VolumeMethod method : {VolumeMethod::cells, VolumeMethod::splat, VolumeMethod::slices, VolumeMethod::shear_warp}) {
    INFO(std::string(word_of(method)));
    same_on_all_targets([&] {
      VolumeItem v = wave_item(ElementType::f32, method != VolumeMethod::cells, 0);
      v.method = method;
      return draw(scene_of({v}), oblique);
    });
  }
}

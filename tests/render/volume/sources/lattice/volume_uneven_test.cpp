// SPDX-License-Identifier: Apache-2.0
// Rectilinear grids with uneven axes: derivatives, and packets of rays against single ones.
#include "render/volume/sources/lattice/lattice_ray.h"
#include "render/volume/sources/lattice/uneven_axes.h"
#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

/// n samples from -1 to 1, wider towards the middle; backwards on request.
std::vector<double> uneven_axis(size_t n, double phase, bool backwards = false) {
  std::vector<double> x;
  for (size_t i = 0; i < n; ++i) {
    const double t = 2 * double(i) / double(n - 1) - 1;
    x.push_back(t + 0.25 * std::sin(std::numbers::pi * t) + 0.05 * phase * (1 - t * t));
  }
  if (backwards) std::reverse(x.begin(), x.end());
  return x;
}

DatasetPtr on_axes(const std::vector<double> (&x)[3], const std::function<double(Vec3)>& f, ElementType type = ElementType::f32) {
  std::vector<double> v;
  for (const double z : x[2])
    for (const double y : x[1])
      for (const double u : x[0]) v.push_back(f({u, y, z}));
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(v).converted(type), "", Role::scalars});
  RectilinearGrid g;
  g.x = Array::from_vector(x[0]), g.y = Array::from_vector(x[1]), g.z = Array::from_vector(x[2]);
  return make_dataset(g, fields);
}
DatasetPtr uneven(const std::function<double(Vec3)>& f, ElementType type = ElementType::f32) {
  return on_axes({uneven_axis(33, 0.3), uneven_axis(29, -1, true), uneven_axis(37, 1)}, f, type);
}

double waves(Vec3 p) { return 60 + 25 * std::sin(5 * p.x + 1) * std::cos(4 * p.y) + 20 * std::sin(6 * p.z + p.x); }

VolumeItem wave_item(DatasetPtr data, bool shaded) {
  VolumeItem v = item(std::move(data), grey(0, 120), {});
  v.opacity.points = {{60, 0}, {70, 0.4}, {75, 0}, {85, 0}, {95, 0.9}};
  v.unit_distance = 0.05, v.shaded = shaded;
  return v;
}
Frame singly(const VolumeItem& v, const Projection& view) { return draw(scene_of({v}), view, {}, by_single_rays(view)); }
const Projection oblique = perspective_view(45, 37, 55, {1.5, 1.1, 3}, {0, 0, 0});
const Projection within = perspective_view(45, 37, 30, {0.1, 0.2, 0.3}, {-1, -0.5, -0.7});

}  // namespace

TEST_CASE("volume uneven: derivatives of straight lines and parabolas are exact up to the border, on even axes too") {
  const auto check = [](const DatasetPtr& data, const std::function<Vec3(Vec3)>& exact, int least_places = 300) {
    const VolumeItem v = wave_item(data, true);
    const auto source = volume::lattice_source(std::make_shared<const volume::Volume>(volume::prepare(v, 1, {})), nullptr);
    const auto walker = source->walker();
    int places = 0;
    for (uint64_t i = 0; i < 100; ++i) {
      const Vec3 from{random_unit(1, i) * 2 - 1, random_unit(2, i) * 2 - 1, random_unit(3, i) * 2 - 1};
      const Vec3 along = normalize(Vec3{random_unit(4, i) - 0.5, random_unit(5, i) - 0.5, random_unit(6, i) - 0.5});
      walker->start(from, along, 0, 0.3);
      volume::Stretch parts[16];
      for (size_t n = walker->next(parts); n > 0; n = walker->next(parts))
        for (size_t k = 0; k < n; ++k) {
          const double t = 0.3 * parts[k].from + 0.7 * parts[k].to;
          const Vec3 p = from + along * t;
          if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > 1) continue;
          CHECK(length(Vec3(walker->gradient(parts[k], t)) - exact(p)) < 2e-4);
          ++places;
        }
    }
    CHECK(places > least_places);
  };
  const auto plane = [](Vec3 p) { return 3 * p.x - 2 * p.y + p.z; };
  const auto bowl = [](Vec3 p) { return 3 * p.x * p.x - 2 * p.y * p.y + p.z * p.z + p.x * p.y; };
  const auto bowl_slope = [](Vec3 p) { return Vec3{6 * p.x + p.y, -4 * p.y + p.x, 2 * p.z}; };
  check(uneven(plane), [](Vec3) { return Vec3{3, -2, 1}; });
  check(uneven(bowl), bowl_slope);
  check(grid(cube(14, -1, 1), bowl), bowl_slope);
  // With three samples an axis there is one parabola, with two a straight line.
  check(grid(cube(3, -1, 1), bowl), bowl_slope, 80);
  check(
      grid(cube(2, -1, 1), plane),
      [](Vec3) {
        return Vec3{3, -2, 1};
      },
      80);
}

TEST_CASE("volume uneven: packets show what single rays show, whatever the type, lit or not, from outside and inside") {
  for (const ElementType type : {ElementType::f32, ElementType::u8, ElementType::i8, ElementType::u16, ElementType::i16})
    for (const bool shaded : {false, true})
      for (const Projection* view : {&oblique, &within}) {
        INFO(std::string(element_name(type)) << " shaded " << shaded << (view == &within ? " from inside" : ""));
        const VolumeItem v = wave_item(uneven(waves, type), shaded);
        const Frame packets = draw(scene_of({v}), *view), single = singly(v, *view);
        CHECK(largest_difference(packets, single) < 2.0f / 512);
        CHECK(*std::max_element(packets.rgba.begin(), packets.rgba.end()) > 0.2f);
        volume::Knobs one;
        one.simd = false;
        CHECK(same_bytes(packets, draw(scene_of({v}), *view, one)));
        one.simd = true, one.skip_empty = false;
        CHECK(largest_difference(packets, draw(scene_of({v}), *view, one)) < 1e-3f);
      }
}

TEST_CASE("volume uneven: holes, thin grids and even axes are drawn as by single rays and uniform grids") {
  const auto same = [](const std::string& what, const VolumeItem& v, const Frame& other) {
    INFO(what);
    CHECK(largest_difference(draw(scene_of({v}), oblique), other) < 2.0f / 512);
  };
  const auto holes = [](Vec3 p) { return length(p - Vec3(0.4, 0.3, 0.5)) < 0.35 ? NAN : waves(p); };
  const VolumeItem holed = wave_item(uneven(holes), true), even_holed = wave_item(grid(cube(37, -1, 1), holes), true);
  same("holes", holed, singly(holed, oblique)), same("holes, even axes", even_holed, singly(even_holed, oblique));
  VolumeItem steps = even_holed;
  steps.sampling.step = 0.001;
  same("holes, small steps", even_holed, draw(scene_of({steps}), oblique));
  const VolumeItem thin = wave_item(on_axes({uneven_axis(9, 1), {0.25}, uneven_axis(8, 0)}, waves), true);
  same("thin", thin, singly(thin, oblique));
  std::vector<double> even;
  for (int i = 0; i < 37; ++i) even.push_back(i / 18.0 - 1);
  same("even", wave_item(on_axes({even, even, even}, waves), true),
       draw(scene_of({wave_item(grid(cube(37, -1, 1), waves), true)}), oblique));
}

TEST_CASE("volume uneven: fields of cells are drawn as by single rays, on even axes too; holes stay clear") {
  for (const bool even : {false, true})
    for (const bool holes : {false, true}) {
      INFO(std::string(even ? "even" : "uneven") << std::string(holes ? ", holes" : ""));
      std::vector<double> v;
      for (uint64_t i = 0; i < 16 * 16 * 16; ++i) {
        const Vec3 p{double(i % 16), double(i / 16 % 16), double(i / 256)};
        v.push_back(holes && i % 7 == 0 ? NAN : waves(p / 8.0 - Vec3(1, 1, 1)));
      }
      FieldSet fields;
      fields.add({"f", Association::cell, Array::from_vector(v).converted(ElementType::f32), "", Role::scalars});
      RectilinearGrid g;
      g.x = Array::from_vector(uneven_axis(17, 1)), g.y = g.z = Array::from_vector(uneven_axis(17, -1));
      VolumeItem item = wave_item(even ? make_dataset(cube(17, -1, 1), fields) : make_dataset(g, fields), true);
      item.association = Association::cell;
      CHECK(volume::prepare(item, 1, {}).direct != holes);
      CHECK(largest_difference(draw(scene_of({item}), oblique), singly(item, oblique)) < 2.0f / 512);
    }
}

TEST_CASE("volume uneven: grids with cells too small for floats go by single rays, which draw them") {
  const std::vector<double> x = uneven_axis(20, 1);
  std::vector<double> dense = x;
  dense.insert(dense.begin() + 10, dense[10] - 1e-6);
  const VolumeItem v = wave_item(on_axes({dense, x, x}, waves), false), plain = wave_item(on_axes({x, x, x}, waves), false);
  CHECK(volume::UnevenAxes::fits(volume::prepare(plain, 1, {})));
  CHECK_FALSE(volume::UnevenAxes::fits(volume::prepare(v, 1, {})));
  CHECK(largest_difference(draw(scene_of({v}), oblique), draw(scene_of({plain}), oblique)) < 2.0f / 512);
}

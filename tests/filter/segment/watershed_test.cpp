// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/watershed.h"

#include <algorithm>

#include "base/random.h"
#include "filter/segment/region_grow.h"
#include "segment_support.h"

using namespace sg;
using test::array_of;
using test::image_of;

namespace {

DatasetPtr flood(const DatasetPtr& d, WatershedParams p = {}) {
  Context context;
  return watershed(d, p, context);
}
DatasetPtr grow(const DatasetPtr& d, RegionGrowParams p) {
  Context context;
  return region_grow(d, p, context);
}
RegionGrowParams seeded(std::vector<double> seeds) {
  RegionGrowParams p;
  p.seeds = std::move(seeds);
  return p;
}

}  // namespace

TEST_CASE("watershed: two bowls part at the ridge between them") {
  const auto bowls = [](Vec3 p) { return std::min(length(p - Vec3(8, 10, 10)), length(p - Vec3(24, 10, 10)) + 1); };
  for (const auto& d : {image_of<float>({33, 21, 21}, bowls), image_of<double>({33, 21, 21}, bowls)}) {
    const auto r = flood(d);
    const Array& w = array_of(r, "watershed");
    size_t wrong = 0;
    for (size_t i = 0; i < w.count(); ++i) {
      const Vec3 p{double(i % 33), double(i / 33 % 21), double(i / 693)};
      const double a = length(p - Vec3(8, 10, 10)), b = length(p - Vec3(24, 10, 10)) + 1;
      if (std::abs(a - b) > 2) wrong += w.get(i) != (a < b ? 1 : 2);  // 1 is the lower one
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("watershed: shallow minima are no basins, equal levels are shared by distance") {
  const auto rough = image_of<float>(
      {64, 16, 1}, [](Vec3 p) { return 10 * std::abs(std::sin(p.x * M_PI / 32)) + 0.5 * random_unit(1, uint64_t(p.x + 64 * p.y)); });
  WatershedParams p;
  CHECK(array_of(flood(rough), "watershed").get(63) > 0);
  Context context;
  std::string said;
  context.on_log = [&](LogLevel, std::string_view t) { said = t; };
  watershed(rough, p, context);
  CHECK(said.find("watershed: 3 ") == std::string::npos);
  p.min_depth = 2;
  watershed(rough, p, context);
  CHECK(said.find("watershed: 3 basins") != std::string::npos);

  // A flat image with two markers: each sample goes to the nearer one.
  UniformGrid g;
  g.dims = {41, 1, 1};
  std::vector<int16_t> marks(41, 0);
  marks[0] = -5, marks[40] = 300;
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(std::vector<uint8_t>(41, 3)), "", Role::scalars});
  f.add({"marks", Association::point, Array::from_vector(marks), "", Role::none});
  p.markers.name = "marks";
  const auto r = flood(make_dataset(g, f), p);
  CHECK(array_of(r, "watershed").get(19) == -5);
  CHECK(array_of(r, "watershed").get(21) == 300);
  p.markers.name = "v";
  f.add({"v", Association::point, Array::from_vector(std::vector<uint8_t>(41, 0)), "", Role::scalars});
  CHECK(test::error_of([&] { flood(make_dataset(g, f), p); }).find("marks no sample") != std::string::npos);
}

TEST_CASE("watershed: markers flood the gradient up to the edge of a ball, not beyond") {
  auto d = image_of<int16_t>({30, 30, 15}, [](Vec3 p) { return length(p - Vec3(15, 15, 15)) < 9 ? 100.0 : 20.0; }, {1, 1, 2});
  std::vector<uint8_t> marks(d->point_count(), 0);
  marks[0] = 1, marks[15 + 30 * (15 + 30 * 7)] = 2;
  DatasetParts parts = d->parts();
  parts.fields.add({"marks", Association::point, Array::from_vector(marks), "", Role::none});
  WatershedParams p;
  p.gradient = true, p.markers.name = "marks";
  const auto r = flood(make_dataset(parts), p);
  size_t wrong = 0, ball = 0;
  for (size_t i = 0; i < d->point_count(); ++i) {
    const Vec3 q = Vec3(double(i % 30), double(i / 30 % 30), 2 * double(i / 900)) - Vec3(15, 15, 15);
    ball += length(q) < 9;
    if (std::abs(length(q) - 9) > 1.8) wrong += array_of(r, "watershed").get(i) != (length(q) < 9 ? 2 : 1);
  }
  CHECK(ball > 1000);
  CHECK(wrong == 0);
}

TEST_CASE("watershed: samples without a value are dry and stop the water; runs repeat byte for byte") {
  const auto wall = image_of<float>({9, 5, 1}, [](Vec3 p) { return p.x == 4 ? double(NAN) : p.x; });
  const auto r = flood(wall);
  CHECK(array_of(r, "watershed").get(4) == 0);
  CHECK(array_of(r, "watershed").get(0) == 1);
  CHECK(array_of(r, "watershed").get(8) == 2);
  CHECK(array_of(flood(image_of<float>({3, 3, 1}, [](Vec3) { return double(NAN); })), "watershed").get(4) == 0);
  const auto noise =
      image_of<float>({40, 40, 20}, [](Vec3 p) { return std::floor(9 * random_unit(7, uint64_t(p.x + 40 * (p.y + 40 * p.z)))); });
  WatershedParams p;
  p.connectivity = 26, p.min_depth = 1, p.gradient = true;
  CHECK(test::same_for_threads("watershed", [&] { return flood(noise, p); }));
}

TEST_CASE("region grow: a range fills what hangs together, and nothing behind a gap") {
  const auto d = image_of<uint16_t>({20, 5, 5}, [](Vec3 p) { return p.x < 4 ? 100.0 : p.x == 4 ? 900.0 : 110.0; }, {0.5, 1, 1});
  RegionGrowParams p = seeded({1, 2, 2});
  p.min = 50, p.max = 200;
  const auto r = grow(d, p);
  CHECK(array_of(r, "region").get(7) == 1);
  CHECK(array_of(r, "region").get(8) == 0);
  CHECK(array_of(r, "region").get(9) == 0);
  p.seeds = {1, 2, 2, 9, 0, 0};
  CHECK(array_of(grow(d, p), "region").get(9) == 1);
}

TEST_CASE("region grow: confidence finds a noisy ball, whatever the direction of the grid") {
  UniformGrid g;
  g.dims = {30, 30, 30};
  g.direction.m[0][0] = 0, g.direction.m[0][1] = -1, g.direction.m[1][0] = 1, g.direction.m[1][1] = 0;
  g.origin = {5, 6, 7};
  std::vector<float> v(27000);
  size_t ball = 0;
  for (size_t i = 0; i < v.size(); ++i) {
    const bool in = length(Vec3(double(i % 30), double(i / 30 % 30), double(i / 900)) - Vec3(10, 15, 15)) < 8;
    ball += in;
    v[i] = float(in ? 100 : 20) + 10 * float(random_unit(3, i));
  }
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(v), "", Role::scalars});
  const auto d = make_dataset(g, f);
  const Vec3 seed = g.origin + g.direction * Vec3(10, 15, 15);
  const auto r = grow(d, seeded({seed.x, seed.y, seed.z}));
  size_t size = 0;
  for (size_t i = 0; i < v.size(); ++i) size += array_of(r, "region").get(i) == 1;
  CHECK(double(size) == doctest::Approx(double(ball)).epsilon(0.02));
}

TEST_CASE("region grow: seeds must be inside, on a value, in the range") {
  const auto d = image_of<float>({4, 4, 4}, [](Vec3 p) { return p.x == 3 ? double(NAN) : p.x; });
  CHECK(test::error_of([&] { grow(d, {}); }).find("no seed") != std::string::npos);
  CHECK(test::error_of([&] { grow(d, seeded({1, 2})); }).find("2 numbers") != std::string::npos);
  CHECK(test::error_of([&] { grow(d, seeded({9, 0, 0})); }).find("outside the grid") != std::string::npos);
  CHECK(test::error_of([&] { grow(d, seeded({3, 0, 0})); }).find("no value") != std::string::npos);
  RegionGrowParams p = seeded({1, 0, 0});
  p.min = 2;
  CHECK(test::error_of([&] { grow(d, p); }).find("outside the range") != std::string::npos);
}

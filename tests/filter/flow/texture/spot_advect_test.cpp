// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "filter/flow/texture/advect.h"
#include "filter/flow/texture/spot_noise.h"
#include "texture_support.h"

using namespace sg;
using namespace sg::test;

namespace {

DatasetPtr along_x(size_t n, size_t m, float speed) {
  return flow_2d(n, m, [speed](double, double, float* u) { u[0] = speed; });
}

DatasetPtr with_field(const DatasetPtr& d, const char* name, const std::function<double(double, double)>& f) {
  const auto& g = *d->as<UniformGrid>();
  std::vector<double> v;
  for (size_t j = 0; j < g.dims[1]; ++j)
    for (size_t i = 0; i < g.dims[0]; ++i) v.push_back(f(double(i), double(j)));
  DatasetParts parts = d->parts();
  parts.fields.add({name, Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  return make_dataset(std::move(parts));
}

std::vector<float> spots_of(const DatasetPtr& d, SpotNoiseParams p) {
  Context c;
  p.resolution = int64_t(d->as<UniformGrid>()->dims[0]);
  return values_of(spot_noise(d, p, c), "spot noise");
}

DatasetPtr advected(const DatasetPtr& d, AdvectParams p, const DatasetPtr& image = nullptr) {
  Context c;
  p.resolution = int64_t(d->as<UniformGrid>()->dims[0]);
  return advect(d, image, p, c);
}

double value(const DatasetPtr& d, const char* field, size_t i, size_t j) {
  return d->fields().require(field).array.get(i + d->as<UniformGrid>()->dims[0] * j);
}

}  // namespace

TEST_CASE("spot noise: mean 0, the deviation asked for, and longer correlation along the flow than across") {
  for (const bool bent : {true, false}) {
    SpotNoiseParams p;
    p.bent = bent, p.contrast = 0.3;
    const std::vector<float> v = spots_of(along_x(400, 400, 2), p);
    const Statistics s{v, 400, 400, 0};
    CHECK(std::abs(s.mean()) < 1e-6);
    CHECK(std::sqrt(s.covariance(0, 0)) == doctest::Approx(0.3).epsilon(1e-4));
    // Half as long as a spot (20 pixels each way) the texture is still itself; two widths (0.8 each) across nothing is left.
    CHECK(s.correlation(8, 0) > 0.5);
    CHECK(std::abs(s.correlation(0, 3)) < 0.1);
    CHECK(std::abs(s.correlation(60, 0)) < 0.1);
  }
}

TEST_CASE("spot noise: spots are round where nothing flows, and their correlation is that of the spot with itself") {
  SpotNoiseParams p;
  p.radius = 8, p.density = 6;
  const std::vector<float> v = spots_of(along_x(512, 512, 0), p);
  const Statistics s{v, 512, 512, 0};
  // The spot's own correlation at distance d, by sums over the plane.
  auto spot = [](double x, double y) { return std::pow(std::max(0.0, 1 - (x * x + y * y) / 64), 2); };
  auto own = [&](double d) {
    double sum = 0, all = 0;
    for (double x = -9; x <= 9; x += 0.25)
      for (double y = -9; y <= 9; y += 0.25) sum += spot(x, y) * spot(x + d, y), all += spot(x, y) * spot(x, y);
    return sum / all;
  };
  for (const size_t d : {2, 4, 6, 10}) {
    CHECK(std::abs(s.correlation(d, 0) - own(double(d))) < 0.08);
    CHECK(std::abs(s.correlation(0, d) - own(double(d))) < 0.08);
  }
}

TEST_CASE("spot noise: bent spots lie along circles when the flow does, the same bytes for one thread and eight") {
  SpotNoiseParams p;
  p.stretch = 6, p.radius = 5;
  const DatasetPtr d = rotation(300);
  set_thread_count(1);
  const std::vector<float> one = spots_of(d, p);
  set_thread_count(8);
  const std::vector<float> eight = spots_of(d, p);
  set_thread_count(0);
  CHECK(same_bytes(one, eight));
  // Correlation of places 12 pixels apart, along circles of radius 60 to 100 and across them.
  double along = 0, across = 0, all = 0;
  auto at = [&](double r, double a) {
    return double(one[size_t(std::lround(149.5 + r * std::cos(a))) + 300 * size_t(std::lround(149.5 + r * std::sin(a)))]);
  };
  for (double r = 60; r < 100; r += 1)
    for (double a = 0; a < 6.28; a += 1 / r) {
      along += at(r, a) * at(r, a + 12 / r), across += at(r, a) * at(r + 12, a), all += at(r, a) * at(r, a);
    }
  CHECK(along / all > 0.3);
  CHECK(std::abs(across / all) < 0.1);
}

TEST_CASE("spot noise: bad inputs are named") {
  Context c;
  UniformGrid g;
  g.dims = {4, 4, 4};
  FieldSet fields;
  fields.add({"v", Association::point, Array::from_vector(std::vector<float>(3 * 64, 1.0f), 3), "", Role::vectors});
  SpotNoiseParams p;
  p.resolution = 16;
  CHECK(error_of([&] { spot_noise(make_dataset(g, fields), p, c); }).find("slice") != std::string::npos);
  p.resolution = 1200, p.radius = 1, p.density = 50;
  CHECK(error_of([&] { spot_noise(along_x(8, 8, 1), p, c); }).find("too many") != std::string::npos);
  const DatasetPtr holes = flow_2d(64, 64, [](double x, double, float* u) { u[0] = x > 40 ? NAN : 1.0f; });
  p = {};
  const std::vector<float> v = spots_of(holes, p);
  CHECK(std::isnan(v[50]));
  CHECK(v[20] == v[20]);
}

TEST_CASE("advect: whole pixels move exactly, and back again") {
  const DatasetPtr d = with_field(along_x(60, 20, 0.5f), "s", [](double x, double y) { return std::sin(3 * x) + 7 * y; });
  AdvectParams p;
  p.time = 14;  // seven pixels
  const DatasetPtr out = advected(d, p);
  for (size_t j = 0; j < 20; ++j)
    for (size_t i = 0; i < 60; ++i) CHECK(value(out, "s", i, j) == doctest::Approx(value(d, "s", i < 7 ? 0 : i - 7, j)).epsilon(1e-12));
  p.time = -14;
  const DatasetPtr back = advected(d, p);
  for (size_t i = 0; i < 60; ++i)
    CHECK(value(back, "s", i, 3) == doctest::Approx(value(d, "s", std::min<size_t>(59, i + 7), 3)).epsilon(1e-12));
  p.time = 14, p.border = InflowBorder::nan;
  const DatasetPtr open = advected(d, p);
  CHECK(std::isnan(value(open, "s", 6, 5)));
  CHECK(value(open, "s", 7, 5) == doctest::Approx(value(d, "s", 0, 5)).epsilon(1e-12));
}

TEST_CASE("advect: a whole turn brings the image back, with the order of the paths") {
  const size_t n = 81;
  const DatasetPtr d = with_field(rotation(n), "s", [](double x, double y) { return std::sin(x / 5) * std::cos(y / 7); });
  double h[3], error[3];
  int at = 0;
  for (const int64_t steps : {20, 40, 80}) {
    AdvectParams p;
    p.time = 2 * M_PI, p.steps = steps, p.carry = {"s"};
    const DatasetPtr out = advected(d, p);
    double most = 0;
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i)
        if (std::hypot(double(i) - 40, double(j) - 40) < 38) most = std::max(most, std::abs(value(out, "s", i, j) - value(d, "s", i, j)));
    h[at] = 1.0 / double(steps), error[at++] = most;
  }
  CHECK(error[2] < 1e-3);
  CHECK(observed_order(h, error, 3) > 3.7);
  AdvectParams p;
  p.time = 2 * M_PI, p.steps = 2000;
  const DatasetPtr fine = advected(d, p);
  CHECK(std::abs(value(fine, "s", 60, 30) - value(d, "s", 60, 30)) < 1e-8);
}

TEST_CASE("advect: images of a second input are warped, colours stay bytes, threads do not matter") {
  const DatasetPtr d = rotation(64);
  UniformGrid g;
  g.dims = {32, 32, 1};
  std::vector<uint8_t> rgb;
  for (int i = 0; i < 32 * 32; ++i) rgb.insert(rgb.end(), {uint8_t(8 * (i % 32)), uint8_t(8 * (i / 32)), 77});
  FieldSet fields;
  fields.add({"photo", Association::point, Array::from_vector(std::move(rgb), 3), "", Role::colors});
  const DatasetPtr image = make_dataset(g, fields);
  AdvectParams p;
  p.time = M_PI / 2, p.dye = {32, 10, 0}, p.dye_radius = 4;
  set_thread_count(1);
  const DatasetPtr one = advected(d, p, image);
  set_thread_count(8);
  const DatasetPtr eight = advected(d, p, image);
  set_thread_count(0);
  const Array& a = one->fields().require("photo").array;
  CHECK(a.type() == ElementType::u8);
  CHECK(std::memcmp(a.raw(), eight->fields().require("photo").array.raw(), a.bytes()) == 0);
  CHECK(same_bytes(values_of(one, "dye"), values_of(eight, "dye")));
  // A quarter turn against the clock: what was at the bottom is at the right.
  CHECK(a.get(60 + 64 * 32, 0) == doctest::Approx(8 * 31.0 * 32 / 63).epsilon(0.1));
  CHECK(a.get(32 + 64 * 60, 1) == doctest::Approx(8 * 31.0 * 31 / 63).epsilon(0.1));
  CHECK(a.get(20, 2) == 77);
  // The dye has gone a quarter of its circle (radius 21.5): from the bottom to the right, not to the left.
  CHECK(value(one, "dye", 32, 10) == 1);
  CHECK(value(one, "dye", 53, 31) == 1);
  CHECK(value(one, "dye", 10, 31) == 0);
  CHECK(value(one, "dye", 32, 31) == 0);
}

TEST_CASE("advect: bad inputs are named") {
  AdvectParams p;
  const DatasetPtr d = along_x(16, 16, 1);
  CHECK(error_of([&] { advected(d, p); }).find("no scalar or colour") != std::string::npos);
  p.carry = {"w"};
  CHECK(error_of([&] { advected(d, p); }).find("available: v") != std::string::npos);
  p.carry = {}, p.dye = {1, 2};
  CHECK(error_of([&] { advected(d, p); }).find("three per point") != std::string::npos);
  p.dye = {1, 2, 0}, p.time = 1e9;
  CHECK(error_of([&] { advected(d, p); }).find("shorter time") != std::string::npos);
  // A flow that rests carries nothing away.
  p.time = 5;
  const DatasetPtr still = with_field(flow_2d(16, 16, [](double, double, float*) {}), "s", [](double x, double y) { return x * y; });
  CHECK(value(advected(still, p), "s", 7, 9) == 63);
}

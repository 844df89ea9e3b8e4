// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/classify.h"

#include <algorithm>

#include "base/random.h"
#include "filter/segment/dice.h"
#include "filter/segment/segment_support.h"
#include "simulate/tissue_phantom.h"

using namespace sg;
using test::array_of;
using test::image_of;

namespace {

DatasetPtr run(const DatasetPtr& d, ClassifyParams p = {}) {
  Context context;
  return classify(d, p, context);
}

DatasetPtr phantom(double noise, double bias, bool mix, int size = 96) {
  TissuePhantomParams p;  // an eighth of the head with 1 mm samples
  p.grid.size = size;
  p.grid.bounds = {-10, 85, -85, 10, -30, 65};
  p.noise = noise, p.bias = bias, p.partial_volume = mix;
  Context context;
  return tissue_phantom(p, context);
}

// Dice of labels 0 to 3.
std::vector<double> agreement(const DatasetPtr& d) {
  Context context;
  DiceParams p;
  p.field.name = "label", p.truth.name = "truth";
  const TablePtr t = dice(d, p, context);
  std::vector<double> r;
  for (size_t i = 0; i < t->columns[4].array.count(); ++i) r.push_back(t->columns[4].array.get(i));
  return r;
}

double rms_where_tissue(const DatasetPtr& d, const char* a, const char* b, bool ratio) {
  double sum = 0, square = 0, n = 0;
  for (size_t i = 0; i < d->point_count(); ++i) {
    if (array_of(d, "truth").get(i) == 0) continue;
    const double x = array_of(d, a).get(i), y = array_of(d, b).get(i), e = ratio ? std::log(x / y) : x - y;
    sum += e, square += e * e, ++n;
  }
  return std::sqrt(square / n - (ratio ? sum / n * sum / n : 0));
}

}  // namespace

TEST_CASE("classify: Dice above 0.97 at 5% noise and 40% bias, partial volume and all") {
  const auto r = run(phantom(5, 40, true));
  const auto dice = agreement(r);
  REQUIRE(dice.size() == 4);
  for (const double d : dice) CHECK(d > 0.97);
  CHECK(rms_where_tissue(r, "bias", "truth_bias", true) < 0.01);
  for (const char* k : {"1", "2", "3"})
    CHECK(rms_where_tissue(r, (std::string("fraction_") + k).c_str(), (std::string("truth_fraction_") + k).c_str(), false) < 0.08);
  // Fractions and background make one.
  for (size_t i = 0; i < r->point_count(); i += 997) {
    double sum = 0;
    for (const char* k : {"fraction_1", "fraction_2", "fraction_3"}) sum += array_of(r, k).get(i);
    CHECK(sum <= 1.00001);
  }
}

TEST_CASE("classify: with tissues that do not mix, labels are all but perfect") {
  const auto dice = agreement(run(phantom(5, 40, false, 64)));
  REQUIRE(dice.size() == 4);
  for (const double d : dice) CHECK(d > 0.985);
}

TEST_CASE("classify: an exact mix of two values keeps its proportion") {
  // A ramp between two plateaus: the fraction is the proportion.
  const auto d = image_of<double>({64, 24, 24}, [](Vec3 p) {
    const double noise = 0.4 * (random_unit(5, uint64_t(p.x + 64 * (p.y + 24 * p.z))) - 0.5);
    return 10 + 10 * std::clamp((p.x - 24) / 16, 0.0, 1.0) + noise;
  });
  ClassifyParams p;
  p.classes = 2, p.background = false, p.bias_degree = 0, p.smoothness = 0;
  const auto r = run(d, p);
  CHECK(!r->fields().find("bias"));
  CHECK(array_of(r, "class means").get(0) == doctest::Approx(10).epsilon(0.01));
  CHECK(array_of(r, "class means").get(1) == doctest::Approx(20).epsilon(0.01));
  for (int x = 26; x < 40; ++x) {
    const size_t id = size_t(x) + 64 * (12 + 24 * 12);
    CHECK(array_of(r, "fraction_2").get(id) == doctest::Approx((array_of(r, "v").get(id) - 10) / 10).epsilon(0.05));
  }
  CHECK(array_of(r, "label").get(0) == 1);
  CHECK(array_of(r, "label").get(63) == 2);
}

TEST_CASE("classify: a plane image, samples without a value, and a mask") {
  const auto d = image_of<float>({96, 96, 1}, [](Vec3 p) {
    const double noise = 3 * (random_unit(2, uint64_t(p.x + 96 * p.y)) - 0.5), bias = 1 + 0.2 * std::sin(p.x / 40) * std::cos(p.y / 50);
    if (p.x == 5) return double(NAN);
    return bias * (std::hypot(p.x - 48, p.y - 48) < 25 ? 60.0 : 30.0) + noise;
  });
  ClassifyParams p;
  p.classes = 2, p.background = false, p.bias_degree = 3;
  const auto r = run(d, p);
  CHECK(array_of(r, "label").get(48 + 96 * 48) == 2);
  CHECK(array_of(r, "label").get(10 + 96 * 10) == 1);
  CHECK(array_of(r, "label").get(5) == 0);
  CHECK(std::isnan(array_of(r, "fraction_1").get(5)));
  size_t wrong = 0;
  for (size_t i = 0; i < 96 * 96; ++i)
    if (i % 96 != 5) wrong += array_of(r, "label").get(i) != (std::hypot(double(i % 96) - 48, double(i / 96) - 48) < 25 ? 2 : 1);
  CHECK(wrong < 10);

  std::vector<uint8_t> mask(96 * 96);
  for (size_t i = 0; i < mask.size(); ++i) mask[i] = i % 96 > 20;
  DatasetParts parts = d->parts();
  parts.fields.add({"mask", Association::point, Array::from_vector(mask), "", Role::none});
  p.mask.name = "mask";
  const auto masked = run(make_dataset(parts), p);
  CHECK(array_of(masked, "label").get(20) == 0);
  CHECK(array_of(masked, "label").get(21) == 1);
}

TEST_CASE("classify: constant images and too many classes are refused") {
  const auto constant = image_of<uint8_t>({8, 8, 8}, [](Vec3) { return 9.0; });
  CHECK(test::error_of([&] { run(constant); }).find("1 different value") != std::string::npos);
  const auto two = image_of<uint8_t>({8, 8, 8}, [](Vec3 p) { return p.x < 4 ? 9.0 : 50.0; });
  ClassifyParams p;
  p.classes = 2;
  p.bias_degree = 0;
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector<float>({0, 0, 0}, 3);
  CHECK(test::error_of([&] { run(make_dataset(cloud), p); }).find("uniform and rectilinear") != std::string::npos);
  p.background = false, p.smoothness = 0;
  const auto r = run(two, p);  // two values without any noise
  CHECK(array_of(r, "label").get(0) == 1);
  CHECK(array_of(r, "label").get(7) == 2);
}

TEST_CASE("classify: the same bytes for any number of threads") {
  const auto d = phantom(5, 20, true, 32);
  CHECK(test::same_for_threads("fraction_2", [&] { return run(d); }));
}

// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/otsu.h"

#include <algorithm>

#include "base/random.h"
#include "filter/segment/dice.h"
#include "segment_support.h"

using namespace sg;
using test::array_of;
using test::image_of;

namespace {

DatasetPtr otsu_of(const DatasetPtr& d, OtsuParams p = {}) {
  Context context;
  return otsu(d, p, context);
}

OtsuParams classes(int n) {
  OtsuParams p;
  p.classes = n;
  return p;
}

// Sum of squares within classes for a split, straight from the definition.
double within(const ValueCounts& h, const std::vector<size_t>& split) {
  double total = 0;
  for (size_t c = 0, begin = 0; c <= split.size(); ++c) {
    const size_t end = c < split.size() ? split[c] : h.value.size();
    double w = 0, mean = 0;
    for (size_t i = begin; i < end; ++i) w += h.count[i], mean += h.count[i] * h.value[i];
    mean /= w;
    for (size_t i = begin; i < end; ++i) total += h.count[i] * (h.value[i] - mean) * (h.value[i] - mean);
    begin = end;
  }
  return total;
}

}  // namespace

TEST_CASE("otsu: two values are parted midway, in every number type") {
  const auto two = [](Vec3 p) { return p.x < 3 ? 20.0 : 100.0; };
  for (const auto& d : {image_of<uint8_t>({8, 4, 2}, two), image_of<int16_t>({8, 4, 2}, two), image_of<uint16_t>({8, 4, 2}, two),
                        image_of<float>({8, 4, 2}, two), image_of<double>({8, 4, 2}, two)}) {
    const auto r = otsu_of(d);
    CHECK(array_of(r, "otsu thresholds").get(0) == doctest::Approx(60).epsilon(0.001));
    CHECK(array_of(r, "otsu").get(2) == 0);
    CHECK(array_of(r, "otsu").get(3) == 1);
    CHECK(r->fields().require("otsu").role == Role::labels);
  }
}

TEST_CASE("otsu: the split is the best of all splits") {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    ValueCounts h;
    double x = -5;
    for (size_t i = 0; i < 13; ++i) {
      h.value.push_back(x += 0.1 + random_unit(seed, 2 * i));
      h.count.push_back(1 + std::floor(20 * random_unit(seed, 2 * i + 1)));
    }
    double best2 = HUGE_VAL, best4 = HUGE_VAL;
    for (size_t a = 1; a < 13; ++a) {
      best2 = std::min(best2, within(h, {a}));
      for (size_t b = a + 1; b < 13; ++b)
        for (size_t c = b + 1; c < 13; ++c) best4 = std::min(best4, within(h, {a, b, c}));
    }
    CHECK(within(h, best_split(h, 2)) == doctest::Approx(best2));
    CHECK(within(h, best_split(h, 4)) == doctest::Approx(best4));
    CHECK(best_split(h, 13).size() == 12);
    CHECK(within(h, best_split(h, 13)) == doctest::Approx(0));
  }
}

TEST_CASE("otsu: NaN and hidden samples have no say, and the label 0") {
  auto d = image_of<float>({10, 1, 1}, [](Vec3 p) { return p.x == 0 ? NAN : p.x == 1 ? 1e6 : p.x < 5 ? 1.0 : 2.0; });
  d = test::with_hidden_points(d, [](size_t i) { return i == 1; });
  const auto r = otsu_of(d);
  CHECK(array_of(r, "otsu thresholds").get(0) == doctest::Approx(1.5).epsilon(0.001));
  CHECK(array_of(r, "otsu").get(0) == 0);
  CHECK(array_of(r, "otsu").get(1) == 0);
  CHECK(array_of(r, "otsu").get(9) == 1);
}

TEST_CASE("otsu: says what cannot be split") {
  const auto constant = image_of<float>({4, 4, 1}, [](Vec3) { return 7.0; });
  CHECK(test::error_of([&] { otsu_of(constant); }).find("7 everywhere") != std::string::npos);
  const auto two = image_of<uint8_t>({4, 4, 1}, [](Vec3 p) { return p.x < 2 ? 1.0 : 3.0; });
  CHECK(test::error_of([&] { otsu_of(two, classes(3)); }).find("2 different values") != std::string::npos);
  const auto nothing = image_of<float>({4, 4, 1}, [](Vec3) { return double(NAN); });
  CHECK(test::error_of([&] { otsu_of(nothing); }).find("no finite value") != std::string::npos);
  OtsuParams unknown;
  unknown.field.name = "w";
  CHECK(test::error_of([&] { otsu_of(two, unknown); }).find("'w'") != std::string::npos);
}

TEST_CASE("otsu: the same bytes for any number of threads") {
  const auto d = image_of<float>({160, 100, 90}, [](Vec3 p) { return std::sin(p.x * 0.3) * std::cos(p.y * 0.2) + p.z * 0.01; });
  CHECK(test::same_for_threads("otsu thresholds", [&] { return otsu_of(d, classes(5)); }));
}

TEST_CASE("dice: agreement per label") {
  UniformGrid g;
  g.dims = {6, 1, 1};
  FieldSet f;
  f.add({"a", Association::point, Array::from_vector<int16_t>({1, 1, 2, 2, -3, 0}), "", Role::none});
  f.add({"b", Association::point, Array::from_vector<float>({1, 2, 2, 2, 0, NAN}), "", Role::none});
  const auto d = make_dataset(g, f);
  Context context;
  DiceParams p;
  p.field.name = "a", p.truth.name = "b";
  const auto t = dice(d, p, context);
  REQUIRE(t->columns[0].array.count() == 4);  // -3, 0, 1, 2
  CHECK(t->columns[0].array.get(0) == -3);
  CHECK(t->columns[4].array.get(0) == 0);
  CHECK(t->columns[4].array.get(2) == doctest::Approx(2.0 / 3));
  CHECK(t->columns[4].array.get(3) == doctest::Approx(4.0 / 5));
  CHECK(t->columns[5].array.get(3) == doctest::Approx(2.0 / 3));
  p.truth.name = "";
  CHECK(test::error_of([&] { dice(d, p, context); }).find("truth=NAME") != std::string::npos);
  FieldSet bad = f;
  bad.add({"c", Association::point, Array::from_vector<float>({1, 2, 2.5f, 2, 0, 0}), "", Role::none});
  p.truth.name = "c";
  CHECK(test::error_of([&] { dice(make_dataset(g, bad), p, context); }).find("2.5") != std::string::npos);
}

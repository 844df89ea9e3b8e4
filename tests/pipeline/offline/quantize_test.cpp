// SPDX-License-Identifier: Apache-2.0
#include "pipeline/offline/pack/quantize.h"

#include <cmath>
#include <cstring>

#include "support/test.h"

using namespace sg;
using namespace sg::offline;

namespace {

// Codes as they were given to the store, which has not compressed them.
std::vector<uint32_t> codes_in(const ArrayStore& store, const Json& packed) {
  const PackedArray& a = store.arrays()[packed["array"].whole()];
  std::vector<uint32_t> out(a.count);
  for (size_t i = 0; i < a.count; ++i) std::memcpy(&out[i], &a.bytes[i * bytes_of(a.type)], bytes_of(a.type));
  return out;
}

}  // namespace

TEST_CASE("page positions: no further off than half a step along any axis, the ends exact") {
  std::vector<float> xyz;
  for (int i = 0; i < 500; ++i)
    for (const double a : {12.9898, 78.233, 37.719}) xyz.push_back(float(100 * std::sin(i * a)));
  for (const int bits : {8, 12, 16, 20}) {
    ArrayStore store;
    const Json p = pack_positions(xyz, {1000, 0, 0}, bits, store);
    const std::vector<uint32_t> codes = codes_in(store, p);
    REQUIRE(codes.size() == xyz.size());
    double worst = 0;
    for (size_t i = 0; i < xyz.size(); ++i) {
      const double size = p["size"][i % 3].number(), step = size / double((1u << bits) - 1);
      worst = std::max(worst, std::abs(p["lo"][i % 3].number() + step * codes[i] - double(xyz[i])) / step);
    }
    CHECK(worst <= 0.5 + 1e-6);
    CHECK(p["origin"][size_t(0)].number() == 1000);
  }
}

TEST_CASE("page positions: a flat axis stays flat") {
  ArrayStore store;
  const Json p = pack_positions({1, 2, 5, 3, 4, 5}, {}, 16, store);
  CHECK(p["size"][2].number() == 0);
  CHECK(p["lo"][2].number() == 5);
}

TEST_CASE("page normals: the largest turn halves twice with every two bits") {
  double turn[3];
  const int bits[] = {8, 10, 12};
  for (int k = 0; k < 3; ++k) {
    std::vector<float> normals;
    for (int i = 0; i < 4000; ++i) {  // a spiral over the whole sphere
      const double z = -1 + 2 * (i + 0.5) / 4000, r = std::sqrt(1 - z * z), a = 2.399963 * i;
      for (const double x : {r * std::cos(a), r * std::sin(a), z}) normals.push_back(float(x));
    }
    ArrayStore store;
    const std::vector<uint32_t> codes = codes_in(store, pack_normals(normals, bits[k], store));
    turn[k] = 0;
    for (size_t i = 0; i < normals.size() / 3; ++i) {
      const Vec3f n = unpacked_normal(codes[2 * i], codes[2 * i + 1], bits[k]);
      turn[k] = std::max(turn[k], double(length(n - Vec3f{normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]})));
    }
  }
  CHECK(turn[0] < 0.017);  // a degree
  CHECK(turn[0] / turn[1] == doctest::Approx(4).epsilon(0.15));
  CHECK(turn[1] / turn[2] == doctest::Approx(4).epsilon(0.15));
}

TEST_CASE("page values: the ends of the scale are exact, what lies beyond stays beyond, and none stays none") {
  const std::vector<double> t{0, 1, 0.25, -1e-9, 1 + 1e-9, -0.5, 1.7, NAN, -1000, 1000};
  for (const int bits : {8, 12, 16}) {
    ArrayStore store;
    const Json p = pack_scale_positions(t, bits, store);
    const std::vector<uint32_t> codes = codes_in(store, p);
    const auto at = [&](size_t i) { return unpacked_scale_position(codes[i], bits, p["least"].number(), p["most"].number()); };
    const double step = 1.0 / ((1 << bits) * 7 / 8 - 1);
    CHECK(at(0) == 0);
    CHECK(at(1) == 1);
    CHECK(std::abs(at(2) - 0.25) <= 0.51 * step);
    CHECK(at(3) < 0);
    CHECK(at(4) > 1);
    CHECK(at(5) == doctest::Approx(-0.5).epsilon(0.1));
    CHECK(at(6) == doctest::Approx(1.7).epsilon(0.1));
    CHECK(std::isnan(at(7)));
    CHECK(at(8) == doctest::Approx(-2).epsilon(0.01));
    CHECK(at(9) == doctest::Approx(3).epsilon(0.01));
  }
}

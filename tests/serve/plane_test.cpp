// SPDX-License-Identifier: Apache-2.0
// Counts over value and second axis of a two-dimensional transfer function.
#include "serve/support/looking.h"
#include "support/test.h"

using namespace sg;
using doctest::Approx;
using sg::test::Window;

namespace {

// u from 0 to 1 along x, and w = 10 + 5 u, which has no steep place anywhere.
Json plane_of(const std::string& second, const std::string& more = "") {
  const auto session = test::opened(
      "sightglass: 1\nsteps:\n  ball: {sphere: {size: 25, radius: 0.7692307692307693}}\n  u: {calc: {expr: (x+1)/2, name: u}}\n"
      "  head: {calc: {expr: 10+5*u, name: w}}\nshow:\n  - {volume: {field: u, opacity: 0.3, second: " +
      second + "}, of: head}\n");
  Window window(*session);
  window.next("state");
  window.say("{'do':'plane','n':3,'show':0" + more + "}");
  return window.next("plane");
}

}  // namespace

TEST_CASE("plane: over a second field it counts that field's values, over its range") {
  const Json plane = plane_of("w");
  CHECK(plane["value"][0].number() == Approx(0));
  CHECK(plane["value"][1].number() == Approx(1));
  CHECK(plane["second"][0].number() == Approx(10));
  CHECK(plane["second"][1].number() == Approx(15));
  const auto columns = size_t(plane["size"][0].number()), rows = size_t(plane["size"][1].number());
  uint64_t sum = 0;
  for (size_t j = 0; j < rows; ++j)
    for (size_t i = 0; i < columns; ++i)
      if (const uint64_t n = plane["counts"][i + columns * j].whole()) {
        sum += n;
        CHECK(double(j) / double(rows) == Approx(double(i) / double(columns)).scale(1).epsilon(0.05));  // a line
        CHECK(n == 25 * 25);
      }
  CHECK(sum == 25 * 25 * 25);
}

TEST_CASE("plane: over the gradient it stays as it was") {
  const Json plane = plane_of("gradient");
  CHECK(plane["second"][0].number() == 0);
  CHECK(plane["second"][1].number() == Approx(0.5).epsilon(0.01));
}

TEST_CASE("plane: at a place it tells the value and what stands on the second axis there") {
  const Json steep = plane_of("gradient", ",'at':[0.25,0.1,-0.3]")["at"];
  CHECK(steep[0].number() == Approx(0.625));
  CHECK(steep[1].number() == Approx(0.5));
  const Json other = plane_of("w", ",'at':[0.25,0.1,-0.3]")["at"];
  CHECK(other[0].number() == Approx(0.625));
  CHECK(other[1].number() == Approx(13.125));
  CHECK(plane_of("gradient", ",'at':[3,0,0]")["at"].is_null());
  CHECK(plane_of("curvature", ",'at':[0,0,0]")["at"].is_null());
}

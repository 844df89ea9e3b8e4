// SPDX-License-Identifier: Apache-2.0
#include "base/text/json.h"

#include <doctest/doctest.h>

#include "base/error.h"

using namespace sg;

TEST_CASE("json: every kind of value is what it is, and asked for another it is nothing") {
  const Json v =
      parse_json(R"({"a": [1, -2, 2.5, 1e300, true, null, "é\n", {}], "b": 18446744073709551615, "c": 18446744073709551616})", "x");
  REQUIRE(v.is_object());
  CHECK(v.size() == 3);
  const Json& a = v["a"];
  REQUIRE(a.is_list());
  REQUIRE(a.size() == 8);
  CHECK(a[0].is_whole());
  CHECK(a[0].whole() == 1);
  CHECK(a[0].number() == 1);
  CHECK_FALSE(a[1].is_whole());
  CHECK(a[1].is_number());
  CHECK(a[1].negative() == -2);
  CHECK(a[1].number() == -2);
  CHECK(a[2].is_real());
  CHECK(a[2].number() == 2.5);
  CHECK(a[4].boolean());
  CHECK(a[5].is_null());
  CHECK(a[6].text() == "é\n");
  CHECK(a[7].is_object());
  CHECK(a[7].empty());
  CHECK(a[8].is_null());  // beyond the end
  CHECK(v["b"].whole() == 18446744073709551615u);
  CHECK(v["c"].is_real());
  CHECK_FALSE(v.contains("d"));
  CHECK(v["d"].is_null());
  CHECK(v["d"]["e"][3].is_null());
  CHECK(a[0].text().empty());
  CHECK(a.members().empty());
  CHECK(v.items().empty());
}

TEST_CASE("json: members keep the order of the file, and of two of one name the last stands") {
  const Json v = parse_json(R"({"z": 1, "a": 2, "z": 3})", "x");
  REQUIRE(v.size() == 2);
  CHECK(v.members()[0].first == "z");
  CHECK(v["z"].whole() == 3);
  CHECK(v.dump() == R"({"z":3,"a":2})");
}

TEST_CASE("json: an object of 100,000 members is read and searched without looking at all of them each time") {
  std::string text = "{";
  for (int i = 0; i < 100000; ++i) text += (i ? ",\"m" : "\"m") + std::to_string(i * 7919 % 100000) + "\":" + std::to_string(i);
  const Json v = parse_json(text + "}", "x");
  REQUIRE(v.size() == 100000);
  for (uint64_t i = 0; i < 100000; ++i) REQUIRE(v.find("m" + std::to_string(i * 7919 % 100000))->whole() == i);
  CHECK(v.find("m100000") == nullptr);
}

TEST_CASE("json: what is no JSON, and what is nested too deeplyly, names the file") {
  for (const char* bad : {"", "{", "[1,]", "{\"a\":}", "NaN", "[1] 2", "\"\xff\"", "{1:2}"}) {
    CAPTURE(bad);
    try {
      parse_json(bad, "some.json");
      FAIL("was taken");
    } catch (const Error& e) {
      CHECK(std::string(e.what()).find("is not valid JSON") != std::string::npos);
      CHECK(std::string(e.what()).find("some.json") != std::string::npos);
    }
  }
  CHECK_NOTHROW(parse_json(std::string(size_t(deepest_json), '[') + std::string(size_t(deepest_json), ']'), "x"));
  CHECK_THROWS_WITH_AS(parse_json(std::string(1000000, '['), "x"), doctest::Contains("nested more than 64 deep"), Error);
}

TEST_CASE("json: a value printed and read again is the same text") {
  const std::string text = R"({"a":[1,-9223372036854775808,0.1,1e+300,true,null,"\"\\\u0001"],"b":{"c":[]}})";
  CHECK(parse_json(text, "x").dump() == text);
}

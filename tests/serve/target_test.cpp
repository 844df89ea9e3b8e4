// SPDX-License-Identifier: Apache-2.0
// Targets and cookies of requests.
#include "serve/http/target.h"
#include "support/test.h"

namespace sg {

using namespace serve;

TEST_CASE("targets: decoded once, words in their order") {
  const auto target = parse_target("/files.json?below=a%20b%2Fc+d&x&y=%2525&&=z");
  REQUIRE(target.has_value());
  CHECK(target->path == "/files.json");
  const Query expected{{"below", "a b/c d"}, {"x", ""}, {"y", "%25"}, {"", "z"}};
  CHECK(target->query == expected);
  CHECK(parse_target("/a+b")->path == "/a+b");
  CHECK(parse_target("/%252e%252e")->path == "/%2e%2e");
  CHECK(parse_target("/?")->query.empty());
}

TEST_CASE("targets: what no browser sends is refused") {
  for (const char* text : {"", "a", "*", "http://127.0.0.1/", "/a#b", "/%", "/%4", "/%zz", "/%00", "/a%0d%0ab", "/%7f", "/%c0%af",
                           "/%e0%80%af", "/%ff", "/?a=%0a", "/?%00=1", "/?a=%e2%82"})
    CHECK_MESSAGE(!parse_target(text).has_value(), text);
  std::string many = "/?";
  for (int i = 0; i < 33; ++i) many += "a=1&";
  CHECK_FALSE(parse_target(many).has_value());
}

TEST_CASE("cookies: all of a name, at most eight") {
  const auto values = cookie_values("a=1; sightglass_1=x;sightglass_1=y ; sightglass_10=z; =; sightglass_1", "sightglass_1");
  CHECK(values == std::vector<std::string_view>{"x", "y"});
  std::string many;
  for (int i = 0; i < 20; ++i) many += "a=b;";
  CHECK(cookie_values(many, "a").size() == 8);
  CHECK(cookie_values("", "a").empty());
}

}  // namespace sg

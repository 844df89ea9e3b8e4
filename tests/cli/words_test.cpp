// SPDX-License-Identifier: Apache-2.0
// Words of the command line: those of the chain and those of operations.
#include <nlohmann/json.hpp>

#include "cli/program.h"
#include "support/test.h"

using namespace sg;
using test::sightglass;

TEST_CASE("calc: on=cell can be said on the command line, beside on=STEP") {
  auto r = sightglass({"info", "--json", "--source", "sphere size=4", "-f", "calc expr=x name=c on=cell"});
  INFO(r.err);
  CHECK(r.status == 0);
  CHECK(r.out.find("\"association\":\"cell\"") != std::string::npos);
  r = sightglass({"info", "--source", "sphere size=4", "-f", "contour values=0", "-f", "calc on=input on=cell expr=x name=c"});
  INFO(r.err);
  CHECK(r.status == 0);
  CHECK(r.out.find("uniform") != std::string::npos);
  // A step of that name is meant when there is one.
  r = sightglass({"info", "--source", "sphere size=4", "-f", "cell: contour values=0", "-f", "calc on=cell expr=x name=c"});
  CHECK(r.status == 0);
  CHECK(r.out.find("surface") != std::string::npos);
  r = sightglass({"info", "--source", "sphere size=4", "-f", "calc on=cells expr=x name=c"});
  CHECK(r.status != 0);
  CHECK(r.err.find("there is no step 'cells'") != std::string::npos);
}

TEST_CASE("words: operations share none with the chain that could not be told apart") {
  const auto ops = nlohmann::json::parse(sightglass({"ops", "--json"}).out);
  for (const auto& o : ops["operations"])
    for (const auto& [name, value] : o["params"]["properties"].items()) {
      CAPTURE(o["name"].get<std::string>());
      CHECK(name != "with");
      if (name == "on") CHECK(value.contains("enum"));  // choices, by which they are told apart
    }
  for (const auto& o : ops["show"])
    for (const auto& [name, value] : o["params"]["properties"].items()) CHECK(name != "of");
}

TEST_CASE("ops calc: every function and operator has its line, in JSON too") {
  const std::string text = sightglass({"ops", "calc"}).out;
  for (const char* each : {"clamp(a, b, c)", "cross(u, v)", "a ? b : c", "a && b", "isnan(a)", "u[1]", "position", "log10(a)"})
    CHECK(text.find(each) != std::string::npos);
  const auto one = nlohmann::json::parse(sightglass({"ops", "calc", "--json"}).out);
  CHECK(one["words"].size() > 50);
  for (const auto& w : one["words"]) CHECK(text.find(w["form"].get<std::string>()) != std::string::npos);
}

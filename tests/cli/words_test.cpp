// SPDX-License-Identifier: Apache-2.0
// Words of the command line: those of the chain and those of operations.
#include <nlohmann/json.hpp>

#include "base/file/file.h"
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

TEST_CASE("info: labels are told with their names, and threshold takes these") {
  const std::string f = test::fresh_folder("label_names");
  write_file(f + "m.mtl", "newmtl steel\nKd 1 0 0\nnewmtl glass\nKd 0 0 1\n");
  write_file(f + "m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl steel\nf 1 2 3\nusemtl glass\nf 3 2 1\nf 2 3 1\n");
  const auto told = sightglass({"info", "m.obj"}, f);
  CHECK(told.out.find("names 1 = steel, 2 = glass") != std::string::npos);
  CHECK(sightglass({"info", "m.obj", "--quick"}, f).out.find("glass") != std::string::npos);
  const auto kept = sightglass({"info", "m.obj", "-f", "threshold field=MaterialIds names=glass"}, f);
  CHECK(kept.out.find("2 cells") != std::string::npos);
  CHECK(kept.out.find("2 (constant); names 2 = glass") != std::string::npos);
}

TEST_CASE("--range and --legend: a range as its own option, and a title of two words without its quotes") {
  const std::string f = test::fresh_folder("legend_words");
  const auto bare = sightglass({"render", "-s", "sphere size=8", "--legend", "title=Gas temperature unit=K", "-o", "a.png"}, f);
  CHECK(bare.status == 2);
  CHECK(bare.err.find("title='Gas temperature'") != std::string::npos);
  const auto drawn =
      sightglass({"render", "-s", "sphere size=8", "--show", "surface", "--range", "0,0.5", "--size", "60x40", "-o", "b.png"}, f);
  CHECK(drawn.status == 0);
  CHECK(MappedFile(f + "b.png").text().find("range: [0, 0.5]") != std::string::npos);  // its recipe
}

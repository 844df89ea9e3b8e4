// SPDX-License-Identifier: Apache-2.0
// Fields whose numbers stand for words: `info` names them.
#include <nlohmann/json.hpp>

#include "base/file/file.h"
#include "cli/program.h"
#include "support/test.h"

using namespace sg;
using test::contains;
using test::sightglass;

namespace {

std::string faces_of_materials(int count) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int k = 0; k < count; ++k) text += "usemtl paint " + std::string(1, char('a' + k)) + "\nf 1 2 3\n";
  return text;
}

nlohmann::json names_in(const std::string& json) {
  const auto all = nlohmann::json::parse(json);
  for (const auto& f : all["fields"])
    if (f.contains("names")) return f["names"];
  return nlohmann::json::object();
}

}  // namespace

TEST_CASE("info: names of labels, the first of them in the text and all in JSON") {
  const std::string f = test::fresh_folder("info_names");
  write_file(f + "five.obj", faces_of_materials(5)), write_file(f + "nine.obj", faces_of_materials(9));
  const std::string five = sightglass({"info", "five.obj"}, f).out, nine = sightglass({"info", "nine.obj"}, f).out;
  INFO(five);
  INFO(nine);
  CHECK(contains(five, "names 1 = paint a, 2 = paint b, 3 = paint c, 4 = paint d, 5 = paint e\n"));
  CHECK(contains(nine, "4 = paint d, ... (9 in all)\n"));
  CHECK(contains(sightglass({"info", "nine.obj", "--quick"}, f).out, "(9 in all)"));
  const auto names = names_in(sightglass({"info", "nine.obj", "--json"}, f).out);
  CHECK(names.size() == 9);
  CHECK(names["9"] == "paint i");
}

TEST_CASE("info: words of maps are names, numbers have none") {
  const std::string f = test::fresh_folder("info_map_names");
  write_file(f + "m.geojson",
             R"({"type":"FeatureCollection","features":[
  {"type":"Feature","properties":{"place":"North\u001b[31m","people":5},"geometry":{"type":"Point","coordinates":[1,2]}},
  {"type":"Feature","properties":{"place":"South","people":6},"geometry":{"type":"Point","coordinates":[2,3]}}]})");
  const std::string text = sightglass({"info", "m.geojson"}, f).out;
  INFO(text);
  CHECK(contains(text, "= South"));
  CHECK_FALSE(contains(text, "\x1b"));
  const auto all = nlohmann::json::parse(sightglass({"info", "m.geojson", "--json"}, f).out);
  size_t named = 0;
  for (const auto& field : all["fields"]) named += field.contains("names");
  CHECK(named == 1);
}

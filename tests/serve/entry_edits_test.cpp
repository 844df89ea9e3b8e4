// SPDX-License-Identifier: Apache-2.0
// Keys and copies of nodes, as a window edits them.
#include "serve/session/edits/edits.h"
#include "serve/support/looking.h"
#include "support/test.h"

using namespace sg;
using namespace sg::serve;

namespace {

using Words = std::vector<std::string>;

const std::string moving =
    "sightglass: 1\nsteps:\n  ball: {sphere: {size: 12}}\n  skin: {contour: {values: 0}, from: ball}\nscene:\n"
    "  - {node: a/b, time: 0.5, keys: [{time: 0}, {time: 2, angle: 90}], show: [{surface: , of: skin}]}\n"
    "  - {node: many, instances: [{translate: [1, 0, 0]}, {translate: [2, 0, 0]}], show: [{surface: , of: skin}]}\n";

struct Edited {
  PipelineFile file;
  std::vector<EditMistake> mistakes;
};

// Single quotes stand for double ones.
Edited edit(std::string edits) {
  std::replace(edits.begin(), edits.end(), '\'', '"');
  Edited e;
  e.file = edited(test::parsed(moving), parse_json("[" + edits + "]", "edits"), e.mistakes);
  return e;
}

PipelineFile good(const std::string& edits) {
  const Edited e = edit(edits);
  CHECK_MESSAGE(e.mistakes.empty(), (e.mistakes.empty() ? "" : e.mistakes[0].text));
  return e.file;
}

void refused(const std::string& edits, const char* at, const char* word) {
  const Edited e = edit(edits);
  REQUIRE(e.mistakes.size() == 1);
  CHECK(e.mistakes[0].at == at);
  CHECK(e.mistakes[0].word == word);
}

}  // namespace

TEST_CASE("entry edits: keys are set, put where their time belongs, and taken away") {
  CHECK(good("{'at':'keys/1/a/b','set':{'angle':'45','time':'3'}}").scene[0].keys[1] == Words{"angle=45", "time=3"});
  const PipelineFile between = good("{'add':'key','to':'a/b','set':{'time':'1','translate':'0,0,1'}}");
  REQUIRE(between.scene[0].keys.size() == 3);
  CHECK(between.scene[0].keys[1] == Words{"time=1", "translate=0,0,1"});
  CHECK(good("{'add':'key','to':'a/b','set':{'time':'-1'}}").scene[0].keys[0] == Words{"time=-1"});
  CHECK(good("{'add':'key','to':'many','set':{}}").scene[1].keys.size() == 1);
  const PipelineFile still = good("{'remove':'keys/0/a/b'},{'remove':'keys/0/a/b'}");
  CHECK(still.scene[0].keys.empty());
  CHECK(still.scene[0].words.empty());  // what moved no more has no moment

  refused("{'at':'keys/1/a/b','set':{'time':'0'}}", "keys/1/a/b", "time");
  refused("{'add':'key','to':'a/b','set':{'time':'2'}}", "keys/2/a/b", "time");
  refused("{'at':'keys/1/a/b','set':{'scale':'0'}}", "keys/1/a/b", "scale");
  refused("{'at':'keys/2/a/b','set':{'angle':'1'}}", "keys/2/a/b", "");
  refused("{'at':'keys/x','set':{'angle':'1'}}", "keys/x", "");
  refused("{'remove':'keys/7/a/b'}", "keys/7/a/b", "");
  refused("{'add':'key','to':'ghost','set':{}}", "", "");
}

TEST_CASE("entry edits: copies are listed or stand at points, one in place of the other") {
  CHECK(good("{'at':'copies/1/many','set':{'angle':'30'}}").scene[1].instances[1] == Words{"translate=2,0,0", "angle=30"});
  CHECK(good("{'add':'copy','to':'many','set':{'translate':'3,0,0'}}").scene[1].instances.size() == 3);
  CHECK(good("{'remove':'copies/0/many'}").scene[1].instances == std::vector<Words>{{"translate=2,0,0"}});
  const PipelineFile points = good("{'add':'points','to':'many','of':'ball','set':{'scale':'0.1'}}");
  CHECK(points.scene[1].at == "ball");
  CHECK(points.scene[1].at_words == Words{"scale=0.1"});
  CHECK(points.scene[1].instances.empty());
  CHECK(good("{'add':'points','to':'many','of':'ball','set':{}},{'at':'points/many','set':{'scale':'2'}},{'remove':'points/many'}")
            .scene[1]
            .at.empty());
  CHECK(good("{'add':'points','to':'many','of':'ball','set':{}},{'add':'copy','to':'many','set':{}}").scene[1].at.empty());

  refused("{'at':'points/many','set':{'scale':'2'}}", "points/many", "");
  refused("{'at':'copies/0/many','set':{'euler':'1,2,3','angle':'4'}}", "copies/0/many", "");
  refused("{'add':'points','to':'many','of':'ghost','set':{}}", "", "");
}

TEST_CASE("entry edits: a session tells the words of entries, and takes them back") {
  const auto session = test::opened(moving);
  test::Window window(*session);
  Json node = window.next("state")["scene"][0];
  CHECK(node["keys"].whole() == 2);
  CHECK(node["key_words"][1]["angle"].text() == "90");
  window.say("{'do':'edit','n':1,'edits':[{'at':'keys/1/a/b','set':{'angle':'60'}}]}");
  CHECK(window.next("state")["scene"][0]["key_words"][1]["angle"].text() == "60");
  window.say("{'do':'undo','n':2}");
  const Json state = window.next("state");
  CHECK(state["scene"][0]["key_words"][1]["angle"].text() == "90");
  CHECK(state["scene"][1]["copy_words"][1]["translate"].text() == "2,0,0");
}

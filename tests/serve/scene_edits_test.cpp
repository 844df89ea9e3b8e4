// SPDX-License-Identifier: Apache-2.0
// Lights, the environment and nodes, as a window edits them.
#include "base/text/utf8.h"
#include "pipeline/picture/picture.h"
#include "serve/renderer/local_renderer.h"
#include "serve/session/session.h"
#include "serve/support/window.h"
#include "support/test.h"

using namespace sg;
using namespace sg::serve;
using sg::test::Window;

namespace {

std::shared_ptr<Session> session_of(const std::string& below) {
  const std::string text = "sightglass: 1\nsteps:\n  ball: {sphere: {size: 24}}\n  skin: {contour: {values: 0}, from: ball}\n" + below;
  return Session::open(std::make_unique<LocalRenderer>(64 << 20, std::vector<std::string>{}),
                       parse_pipeline(text, "", picture_vocabulary()), "ball.vti");
}

Json after(Window& window, const std::string& edits, bool live = false) {
  static int n = 100;
  const int mine = ++n;
  window.say("{'do':'edit','n':" + std::to_string(mine) + ",'live':" + (live ? "true" : "false") + ",'edits':[" + edits + "]}");
  Json state;
  do state = window.next("state");
  while (state["by"].whole() < uint64_t(mine));
  return state;
}

Json refused(Window& window, const std::string& edits) {
  window.say("{'do':'edit','n':50,'edits':[" + edits + "]}");
  const Json errors = window.next("refused")["errors"];
  REQUIRE(errors.size() > 0);
  CHECK_FALSE(errors[0]["text"].text().empty());
  return errors[0];
}

PipelineFile file_of(const Json& state) { return parse_pipeline(state["pipeline"].text(), "", picture_vocabulary()); }

}  // namespace

TEST_CASE("session: lights are told, added, set, dragged and taken away") {
  const auto session = session_of("picture: {lights: [{sphere: {from: left, size: 0.3}}, sun]}\n");
  Window window(*session);
  Json state = window.next("state");
  REQUIRE(state["lights"].size() == 2);
  CHECK(state["lights"][0]["kind"].text() == "sphere");
  CHECK(state["lights"][0]["words"]["from"].text() == "left");
  CHECK(state["lights"][1]["kind"].text() == "sun");
  CHECK(state["environment"].is_null());

  state = after(window, "{'add':'light','kind':'spot','set':{'from':'right'}}");
  REQUIRE(state["lights"].size() == 3);
  CHECK(state["lights"][2]["words"]["from"].text() == "right");
  for (const char* angle : {"20", "25", "30"})
    state = after(window, "{'at':'lights/2','set':{'angle':'" + std::string(angle) + "'}}", true);
  state = after(window, "{'at':'lights/2','set':{'angle':'35'}}");
  CHECK(state["lights"][2]["words"]["angle"].text() == "35");
  window.say("{'do':'undo','n':500}");  // all of the drag
  do state = window.next("state");
  while (state["by"].whole() != 500);
  CHECK_FALSE(state["lights"][2]["words"].contains("angle"));

  state = after(window, "{'remove':'lights/0'},{'remove':'lights/0'}");
  REQUIRE(state["lights"].size() == 1);
  CHECK(state["lights"][0]["kind"].text() == "spot");
  state = after(window, "{'remove':'lights/0'}");
  CHECK(state["lights"].size() == 0);
  CHECK_FALSE(state["picture"].contains("lights"));
}

TEST_CASE("session: an environment takes the place of the one before") {
  const auto session = session_of("");
  Window window(*session);
  window.next("state");
  Json state = after(window, "{'add':'environment','kind':'even','set':{'color':'tomato'}}");
  CHECK(state["environment"]["kind"].text() == "even");
  state = after(window, "{'add':'environment','kind':'sky','set':{}},{'at':'environment','set':{'elevation':'10'}}");
  CHECK(state["environment"]["kind"].text() == "sky");
  CHECK(state["environment"]["words"]["elevation"].text() == "10");
  CHECK(word_value(file_of(state).picture, "environment") == "sky elevation=10");
  CHECK(refused(window, "{'add':'environment','kind':'panorama','set':{'file':'/etc/hall.hdr'}}")["text"].text().find("no file of this") !=
        std::string::npos);
  state = after(window, "{'remove':'environment'}");
  CHECK(state["environment"].is_null());
}

TEST_CASE("session: what cannot be of a light is refused at its control") {
  const auto session = session_of("picture: {lights: [{point: {position: [1, 2, 3]}}]}\n");
  Window window(*session);
  window.next("state");
  const auto at = [&](const std::string& edit, const char* place, const char* word) {
    const Json mistake = refused(window, edit);
    CHECK(mistake["at"].text() == place);
    CHECK(mistake["word"].text() == word);
  };
  at("{'at':'lights/0','set':{'brightness':'-1'}}", "lights/0", "brightness");
  at("{'at':'lights/0','set':{'from':'left'}}", "lights/0", "from");  // its place is stated already
  at("{'at':'lights/0','set':{'color':'no colour'}}", "lights/0", "color");
  at("{'at':'lights/0','set':{'color':'red; sun'}}", "lights/0", "color");
  at("{'at':'lights/0','set':{'angle':'3'}}", "lights/0", "angle");  // points have none
  at("{'at':'lights/1','set':{'brightness':'1'}}", "lights/1", "");
  at("{'at':'environment','set':{'brightness':'1'}}", "environment", "");
  at("{'remove':'lights/1'}", "lights/1", "");
  at("{'add':'light','kind':'torch'}", "", "");
}

TEST_CASE("session: nodes are told, moved, and take in what is shown") {
  const auto session = session_of(
      "show:\n  - {surface: , of: skin}\nscene:\n"
      "  - {node: cage, translate: [3, 0, 0], show: [{surface: , of: skin}], children: [{node: bar, instances: [{angle: 10}, {angle: "
      "20}]}]}\n"
      "  - {node: last, show: [{outline: , of: ball}]}\n");
  Window window(*session);
  Json state = window.next("state");
  REQUIRE(state["scene"].size() == 3);
  CHECK(state["scene"][0]["words"]["translate"].text() == "3,0,0");
  CHECK(state["scene"][1]["name"].text() == "bar");
  CHECK(state["scene"][1]["in"].text() == "cage");
  CHECK(state["scene"][1]["copies"].whole() == 2);
  CHECK(state["show"][0]["in"].text() == "");
  CHECK(state["show"][1]["in"].text() == "cage");
  const double before = state["bounds"][1].number();

  state = after(window, "{'at':'scene/cage','set':{'translate':'8,0,0'}}");
  CHECK(state["bounds"][1].number() == doctest::Approx(before + 5));

  // A node in another one stands behind all that is in there, and what is shown keeps its node.
  state = after(window, "{'add':'node','name':'lid','in':'cage','set':{'angle':'30'}},{'move':'show/0','to':'lid'}");
  REQUIRE(state["scene"].size() == 4);
  CHECK(state["scene"][2]["name"].text() == "lid");
  CHECK(state["scene"][2]["in"].text() == "cage");
  CHECK(state["show"][0]["in"].text() == "lid");
  CHECK(state["show"][2]["in"].text() == "last");
  state = after(window, "{'add':'node'},{'add':'show','kind':'outline','of':'ball','in':'node1','set':{}}");
  CHECK(state["scene"][4]["name"].text() == "node1");
  CHECK(state["show"][3]["in"].text() == "node1");
  CHECK(file_of(state).scene.size() == 5);

  // All that is in it goes, too.
  state = after(window, "{'remove':'scene/cage'}");
  REQUIRE(state["scene"].size() == 2);
  CHECK(state["scene"][0]["name"].text() == "last");
  REQUIRE(state["show"].size() == 2);
  CHECK(state["show"][0]["in"].text() == "last");
  CHECK(state["show"][1]["in"].text() == "node1");
  window.say("{'do':'undo','n':900}");
  do state = window.next("state");
  while (state["by"].whole() != 900);
  CHECK(state["scene"].size() == 5);
  CHECK(state["show"].size() == 4);
}

TEST_CASE("session: any name of a node is kept, and told as it was given") {
  const auto session = session_of("show:\n  - {surface: , of: skin}\n");
  Window window(*session);
  window.next("state");
  for (const std::string name : {"null", "7", "a b: c", "x/y", "{t}", "#", "a\\nb", "\\u00e4", "- [", "~"}) {
    Json state = after(window, "{'add':'node','name':'" + name + "'},{'at':'scene/" + name + "','set':{'angle':'5'}}");
    REQUIRE(state["scene"].size() == 1);
    CHECK(state["scene"][0]["words"]["angle"].text() == "5");
    CHECK(text_of_bytes(file_of(state).scene.at(0).name) == state["scene"][0]["name"].text());
    state = after(window, "{'remove':'scene/" + name + "'}");
    CHECK(state["scene"].size() == 0);
  }
}

TEST_CASE("session: what cannot be of a node is refused at its control") {
  const auto session = session_of("show:\n  - {surface: , of: skin}\nscene:\n  - {node: lid, angle: 40, show: [{surface: , of: skin}]}\n");
  Window window(*session);
  window.next("state");
  const auto at = [&](const std::string& edit, const char* place, const char* word) {
    const Json mistake = refused(window, edit);
    CHECK(mistake["at"].text() == place);
    CHECK(mistake["word"].text() == word);
  };
  at("{'at':'scene/lid','set':{'translate':'1,2'}}", "scene/lid", "translate");
  at("{'at':'scene/lid','set':{'scale':'0'}}", "scene/lid", "scale");
  at("{'at':'scene/lid','set':{'euler':'1,2,3'}}", "scene/lid", "euler");  // its rotation is stated twice
  at("{'at':'scene/lid','set':{'time':'1'}}", "scene/lid", "time");        // without keys
  at("{'at':'scene/rim','set':{'angle':'1'}}", "scene/rim", "");
  at("{'remove':'scene/rim'}", "scene/rim", "");
  at("{'move':'show/0','to':'rim'}", "show/0", "");
  at("{'move':'show/7','to':'lid'}", "show/7", "");
  at("{'add':'node','name':'lid'}", "", "");
  at("{'add':'node','in':'rim'}", "", "");
}

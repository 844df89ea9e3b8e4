// SPDX-License-Identifier: Apache-2.0
// What windows keep in a session, and the view that they share.
#include "serve/support/looking.h"
#include "serve/support/window.h"
#include "support/test.h"

using namespace sg;
using sg::test::Window;

TEST_CASE("session: measurements are kept in the file and leave the picture, and what is asked of it, as they are") {
  const auto session = test::opened("sightglass: 1\nsteps:\n  head: {sphere: {size: 9}}\nshow:\n  - {outline: , of: head}\n");
  Window window(*session);
  const uint64_t revision = window.next("state")["revision"].whole();
  window.say("{'do':'draw','n':1,'view':0,'size':[200,150],'scale':1,'moving':false}");
  window.frames();
  window.say("{'do':'edit','n':2,'edits':[{'at':'picture','set':{'measurements':'Gap @ 0,0,0 0.3,0.4,0'}}]}");
  Json state = window.next("state");
  CHECK(state["revision"].whole() == revision);
  CHECK(state["by"].whole() == 2);
  CHECK(state["picture"]["measurements"].text() == "Gap @ 0,0,0 0.3,0.4,0");
  CHECK(state["can_undo"].boolean());
  CHECK(test::parsed(state["pipeline"].text()).picture.back() == "measurements=Gap @ 0,0,0 0.3,0.4,0");
  window.say("{'do':'probe','n':3,'view':0,'at':[100,75]}");
  CHECK(window.next("probe").contains("position"));  // as the picture still stands, it can be asked
  window.say("{'do':'undo','n':4}");
  state = window.next("state");
  CHECK(state["revision"].whole() == revision);
  CHECK_FALSE(state["picture"].contains("measurements"));
}

TEST_CASE("session: one view for all windows is that of whoever moved it last") {
  const auto session = test::opened("sightglass: 1\nsteps:\n  head: {sphere: {size: 5}}\nshow:\n  - {outline: , of: head}\n");
  Window a(*session), b(*session);
  const auto camera = [](double x) {
    return "{'position':[" + std::to_string(x) + ",0,5],'target':[0,0,0],'up':[0,1,0],'parallel':false,'view_angle':30,'height':1}";
  };
  const auto until = [](Window& w, auto&& good) {
    Json people = w.next("people");
    while (!good(people)) people = w.next("people");
    return people;
  };
  const auto at = [](double x) {
    return [x](const Json& p) { return p["together"].boolean() && p["camera"]["position"][0].number() == x; };
  };
  a.say("{'do':'cursor','view':0,'at':[0.5,0.5],'leads':true,'camera':" + camera(9) + "}");  // nobody has asked for one view
  CHECK_FALSE(until(b, [](const Json& p) { return p["cursors"].size() == 1; }).contains("camera"));
  a.say("{'do':'together','n':1,'on':true,'camera':" + camera(1) + "}");
  CHECK_FALSE(until(b, at(1))["led"].boolean());
  CHECK(until(a, at(1))["led"].boolean());
  b.say("{'do':'cursor','view':0,'at':[0.5,0.5],'leads':true,'camera':" + camera(2) + "}");
  CHECK_FALSE(until(a, at(2))["led"].boolean());
  a.say("{'do':'cursor','view':0,'at':[0.1,0.5],'camera':" + camera(7) + "}");  // points alone
  CHECK(until(b, [](const Json& p) { return p["cursors"][0]["at"][0].number() == 0.1; })["camera"]["position"][0].number() == 2);
  Window late(*session);
  CHECK(late.next("people")["camera"]["position"][0].number() == 2);
  b.say("{'do':'together','n':2,'on':false}");
  CHECK_FALSE(until(a, [](const Json& p) { return !p["together"].boolean(); }).contains("camera"));
}

// SPDX-License-Identifier: Apache-2.0
// The graph of a pipeline as a window edits it: what steps take, steps between others, steps that go.
#include "serve/session/edits/edits.h"

#include <array>
#include <random>

#include "pipeline/picture/picture.h"
#include "serve/support/looking.h"
#include "support/test.h"

using namespace sg;
using namespace sg::serve;

namespace {

using Names = std::vector<std::string>;

// ball -> skin -> smooth1 and ball -> cut; all but the ball is shown.
const std::string forked =
    "sightglass: 1\nsteps:\n  ball: {sphere: {size: 16}}\n  skin: {contour: {values: 0}, from: ball}\n  smooth1: {smooth: , from: skin}\n"
    "  cut: {slice: {axis: z}, from: ball}\nshow:\n  - {surface: , of: skin}\n  - {surface: , of: smooth1}\n  - {surface: , of: cut}\n";

struct Edited {
  PipelineFile file;
  std::vector<EditMistake> mistakes;
  const PipelineFile::Step& step(const std::string& name) const {
    for (const auto& s : file.steps)
      if (s.name == name) return s;
    FAIL("there is no step ", name);
    return file.steps[0];
  }
  Names order() const {
    Names names;
    for (const auto& s : file.steps) names.push_back(s.name);
    return names;
  }
};

// Single quotes stand for double ones.
Edited edit(const std::string& text, std::string edits) {
  std::replace(edits.begin(), edits.end(), '\'', '"');
  Edited e;
  e.file = edited(test::parsed(text), parse_json("[" + edits + "]", "edits"), e.mistakes);
  return e;
}

Edited good(const std::string& edits, const std::string& text = forked) {
  Edited e = edit(text, edits);
  CHECK_MESSAGE(e.mistakes.empty(), (e.mistakes.empty() ? "" : e.mistakes[0].text));
  build_graph(e.file);
  return e;
}

void refused(const std::string& edits, const char* at, const char* text) {
  const Edited e = edit(forked, edits);
  REQUIRE(e.mistakes.size() == 1);
  CHECK(e.mistakes[0].at == at);
  CHECK_MESSAGE(e.mistakes[0].text.find(text) != std::string::npos, e.mistakes[0].text);
}

}  // namespace

TEST_CASE("step edits: a step takes other steps, and stands behind them") {
  CHECK(good("{'at':'steps/smooth1','from':['cut']}").order() == Names{"ball", "skin", "cut", "smooth1"});
  const Edited cut = good("{'at':'steps/cut','from':['ball','skin']}");
  CHECK(cut.step("cut").from == Names{"ball", "skin"});
  CHECK(cut.order() == Names{"ball", "skin", "smooth1", "cut"});
  // What is joined comes before what joins it, with all that hangs on that.
  const Edited joined = good(
      "{'add':'step','operation':'append','from':['skin'],'set':{}},{'add':'step','operation':'sphere','from':[],'set':{'size':'8'}},"
      "{'at':'steps/append1','from':['skin','cut','sphere1'],'set':{'part':'false'}}");
  CHECK(joined.order() == Names{"ball", "skin", "smooth1", "cut", "sphere1", "append1"});
  CHECK(joined.step("append1").words == Names{"part=false"});
  // A branch becomes the trunk of another: no order that a window sends first is wrong.
  const Edited turned = good("{'at':'steps/skin','from':['cut']},{'at':'steps/cut','from':['ball']}");
  CHECK(turned.order() == Names{"ball", "cut", "skin", "smooth1"});
}

TEST_CASE("step edits: circles, unknown names and wrong numbers of inputs are refused at the step") {
  refused("{'at':'steps/skin','from':['smooth1']}", "steps/skin", "'smooth1' hangs on 'skin': the pipeline would go in a circle");
  refused("{'at':'steps/skin','from':['skin']}", "steps/skin", "cannot take itself");
  refused("{'at':'steps/skin','from':['ghost']}", "steps/skin", "there is no step 'ghost'");
  refused("{'at':'steps/skin','from':[]}", "steps/skin", "'contour' takes 1 step, not 0");
  refused("{'at':'steps/cut','from':['ball','skin','skin']}", "steps/cut", "'slice' takes 1 to 2 steps, not 3");
  refused("{'at':'steps/ball','from':['skin']}", "steps/ball", "'sphere' takes no step");
  refused("{'at':'steps/ghost','from':['skin']}", "steps/ghost", "nothing there");
  refused("{'add':'step','operation':'probe','from':['skin'],'set':{}}", "", "'probe' takes 2 steps, not 1");
}

TEST_CASE("step edits: a step is put between others, in all branches or in one") {
  const Edited all =
      good("{'add':'step','operation':'gradient','from':['ball'],'before':['steps/skin','steps/cut'],'set':{'as':'g'},'show':false}");
  CHECK(all.order() == Names{"ball", "gradient1", "skin", "smooth1", "cut"});
  CHECK(all.step("skin").from == Names{"gradient1"});
  CHECK(all.step("cut").from == Names{"gradient1"});
  CHECK(all.step("gradient1").words == Names{"as=g"});
  CHECK(all.file.show.size() == 3);
  const Edited one = good("{'add':'step','operation':'gradient','from':['ball'],'before':['steps/cut'],'set':{}}");
  CHECK(one.step("skin").from == Names{"ball"});
  CHECK(one.step("cut").from == Names{"gradient1"});
  // What is shown may hang on it, too.
  const Edited seen = good("{'add':'step','operation':'smooth','from':['skin'],'before':['steps/smooth1','show/0'],'set':{},'show':false}");
  CHECK(seen.file.show.at(0).of == "smooth2");
  CHECK(seen.file.show.at(1).of == "smooth1");
  // With a further input that stands behind.
  const Edited joins = good("{'add':'step','operation':'append','from':['skin','cut'],'before':['steps/smooth1'],'set':{}}");
  CHECK(joins.order() == Names{"ball", "skin", "cut", "append1", "smooth1"});

  refused("{'add':'step','operation':'append','from':['ball','skin'],'before':['steps/skin'],'set':{}}", "", "go in a circle");
  refused("{'add':'step','operation':'smooth','from':['skin'],'before':['steps/cut'],'set':{}}", "", "does not take 'skin'");
  refused("{'add':'step','operation':'smooth','from':['skin'],'before':['show/9'],'set':{}}", "", "'show/9' does not take 'skin'");
  refused("{'add':'step','operation':'sphere','from':[],'before':['steps/cut'],'set':{}}", "", "stands in front of none");
}

TEST_CASE("step edits: what hung on a step that goes hangs on its input") {
  const Edited gone = good("{'remove':'steps/skin','join':['steps/smooth1','show/0']}");
  CHECK(gone.order() == Names{"ball", "smooth1", "cut"});
  CHECK(gone.step("smooth1").from == Names{"ball"});
  CHECK(gone.file.show.at(0).of == "ball");
  const Edited shows_go = good("{'remove':'steps/skin','join':['steps/smooth1']}");
  CHECK(shows_go.file.show.size() == 2);
  const std::string copies = forked + "scene:\n  - {node: n, instances: {of: cut}, show: [{surface: , of: smooth1}]}\n";
  CHECK(good("{'remove':'steps/cut','join':['scene/n']}", copies).file.scene.at(0).at == "ball");

  refused("{'remove':'steps/skin'}", "steps/skin", "'smooth1' takes it");
  refused("{'remove':'steps/skin','join':['steps/cut']}", "steps/skin", "'steps/cut' does not take it");
  refused("{'remove':'steps/ball','join':['steps/skin','steps/cut']}", "steps/ball", "takes no step");
}

TEST_CASE("step edits: what is shown may be of another step") {
  const PipelineFile file = good("{'at':'show/0','of':'cut','set':{'color':'red'}}").file;
  CHECK(file.show.at(0).of == "cut");
  CHECK(file.show.at(0).words == Names{"color=red"});
  refused("{'at':'show/0','of':'ghost'}", "show/0", "no step 'ghost'");
  refused("{'at':'show/9','of':'cut'}", "show/9", "nothing there");
}

// Whatever is asked for, wise or not: what is accepted can be built, and is read back from its file.
TEST_CASE("step edits: thousands of random edits leave a pipeline that can be built") {
  std::mt19937 random(7);
  const auto below = [&](size_t n) { return size_t(random() % n); };
  PipelineFile file = test::parsed(forked);
  int made = 0, refusals = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto name = [&] { return file.steps[below(file.steps.size())].name; };
    const auto list = [](const Names& names, const std::string& in_front) {
      std::string text;
      for (const std::string& n : names) text += (text.empty() ? "\"" : ",\"") + in_front + n + "\"";
      return "[" + text + "]";
    };
    Names some, takers;
    for (size_t n = below(4); n > 0; --n) some.push_back(name());
    const std::string one = name(), operation = std::array{"sphere", "contour", "append", "slice", "probe"}[below(5)];
    for (const auto& s : file.steps)
      if (!some.empty() && std::find(s.from.begin(), s.from.end(), some[0]) != s.from.end() && below(2)) takers.push_back(s.name);
    const bool full = file.steps.size() > 30;
    const std::string edit = full || below(3) == 0 ? "{\"remove\":\"steps/" + one + "\",\"join\":" + list(some, "steps/") + "}"
                             : below(2)            ? "{\"at\":\"steps/" + one + "\",\"from\":" + list(some, "") + "}"
                                                   : "{\"add\":\"step\",\"operation\":\"" + operation + "\",\"from\":" + list(some, "") +
                                              ",\"before\":" + list(takers, "steps/") + ",\"show\":false}";
    std::vector<EditMistake> mistakes;
    PipelineFile next = edited(file, parse_json("[" + edit + "]", "edits"), mistakes);
    if (!mistakes.empty() || next.steps.empty()) {
      ++refusals;
      continue;
    }
    ++made;
    REQUIRE_NOTHROW(build_graph(next));
    if (i % 50 == 0) REQUIRE(parse_pipeline(emit_pipeline(next), "", picture_vocabulary()) == next);
    file = std::move(next);
  }
  CHECK(made > 300);
  CHECK(refusals > 500);
}

TEST_CASE("step edits: a session takes them back, and tells what the data do not allow at the step") {
  const auto session = test::opened(forked);
  test::Window window(*session);
  const auto state_by = [&](uint64_t by) {
    Json state;
    do state = window.next("state");
    while (state["by"].whole() != by);
    return state;
  };
  window.next("state");
  window.say("{'do':'edit','n':1,'edits':[{'add':'step','operation':'append','from':['smooth1','cut'],'set':{}}]}");
  Json state = state_by(1);
  CHECK(state["steps"][4]["from"][1].text() == "cut");
  CHECK(state["steps"][4]["kind"].text() == "surface");
  window.say("{'do':'edit','n':2,'edits':[{'at':'steps/append1','from':['smooth1','skin']}]}");
  CHECK(state_by(2)["steps"][4]["from"][1].text() == "skin");
  window.say("{'do':'undo','n':20}");
  CHECK(state_by(20)["steps"][4]["from"][1].text() == "cut");
  window.say("{'do':'edit','n':30,'edits':[{'add':'step','operation':'join_fields','from':['ball','ball'],'set':{}}]}");
  state_by(30);
  window.say("{'do':'edit','n':40,'edits':[{'at':'steps/join_fields1','from':['ball','cut']}]}");  // of another mesh
  const Json errors = window.next("refused")["errors"];
  CHECK(errors[0]["at"].text() == "steps/join_fields1");
  CHECK(errors[0]["text"].text().find("join_fields") != std::string::npos);
  window.say("{'do':'undo','n':50}");  // of what was made, not of what was refused
  CHECK(state_by(50)["steps"].size() == 5);
}

// SPDX-License-Identifier: Apache-2.0
#include "serve/session/session.h"

#include <sys/stat.h>

#include <chrono>
#include <cmath>
#include <span>
#include <thread>

#include "base/file/file.h"
#include "image/codec.h"
#include "pipeline/picture/picture.h"
#include "serve/renderer/local_renderer.h"
#include "serve/support/window.h"
#include "support/test.h"

using namespace sg;
using namespace sg::serve;
using sg::test::Shot;
using sg::test::Window;

namespace {

PipelineFile pipeline(const std::string& steps, const std::string& show = "  - {auto: }\n") {
  return parse_pipeline("sightglass: 1\nsteps:\n" + steps + "show:\n" + show, "", picture_vocabulary());
}

const std::string ball = "  ball: {sphere: {size: 24}}\n";
const std::string skin = "  skin: {contour: {values: 0}, from: ball}\n";
const std::string draw = "{'do':'draw','n':1,'view':0,'size':[240,180],'scale':1,'moving':false}";

std::shared_ptr<Session> session_of(PipelineFile file) {
  return Session::open(std::make_unique<LocalRenderer>(64 << 20, std::vector<std::string>{}), std::move(file), "ball.vti");
}

Image image_of(const std::string& png) { return decode_png(std::as_bytes(std::span(png)), "picture"); }

double word_number(const Json& state, size_t show, const char* word) { return std::stod(state["show"][show]["words"][word].text()); }

}  // namespace

TEST_CASE("session: a window is told of steps, fields and looks") {
  const auto session = session_of(pipeline(ball + skin, "  - {surface: {color: tomato}, of: skin}\n"));
  Window window(*session);
  window.say(draw);
  const Json state = window.next("state");
  CHECK(state["title"].text() == "ball.vti");
  CHECK(state["may_edit"].boolean());
  CHECK_FALSE(state["can_undo"].boolean());
  REQUIRE(state["steps"].size() == 2);
  CHECK(state["steps"][0]["kind"].text() == "uniform");
  CHECK(state["steps"][0]["size"].text() == "24x24x24");
  CHECK(state["steps"][1]["from"][0].text() == "ball");
  CHECK(state["steps"][1]["kind"].text() == "surface");
  CHECK(state["bounds"].size() == 6);
  CHECK(state["show"][0]["kind"].text() == "surface");
  CHECK(parse_pipeline(state["pipeline"].text(), "", picture_vocabulary()).steps.size() == 2);
}

TEST_CASE("session: pictures become better up to the one that a file would hold, byte for byte") {
  PipelineFile file = pipeline(ball, "  - {volume: {opacity: \"0:0.3,1:0\"}, of: ball}\n");
  const auto session = session_of(file);
  Window window(*session);
  window.say(draw);
  const std::vector<Shot> frames = window.frames();
  REQUIRE(frames.size() == 3);
  CHECK(frames[0].header["coarse"].number() > 1);
  CHECK(frames[1].header["coarse"].number() == 1);
  for (const Shot& f : frames) CHECK(f.header["n"].whole() == 1);
  file.picture.push_back("size=240x180");
  Context context;
  const Image expected = make_picture(file, {}, context).image;
  CHECK(image_of(frames[2].bytes).pixels == expected.pixels);
  CHECK(frames[2].header["type"].text() == "image/png");
}

TEST_CASE("session: a saved picture has the window's camera, and its recipe makes its bytes again") {
  const auto session = session_of(pipeline(ball + skin));
  Window window(*session);
  window.say(draw);
  window.frames();
  for (const std::string camera : {"'position':[3,-4,2],'target':[0.1,0,0],'up':[0,0.1,1],'parallel':false,'view_angle':25",
                                   "'position':[3,4,2],'target':[0,0,0],'up':[0,0,1],'parallel':true,'height':2.5"}) {
    window.say("{'do':'save','n':7,'size':[300,200],'type':'png','camera':{" + camera + "}}");
    const Json saved = window.next("saved");
    CHECK(saved["n"].whole() == 7);
    CHECK(saved["name"].text() == "ball.png");
    const auto kept = session->saved(saved["url"].text().substr(7));
    REQUIRE(kept);
    const Image image = image_of(*kept->bytes);
    CHECK(image.width == 300);
    PipelineFile recipe = recipe_in(image, "ball.png");
    Context context;
    Picture again = make_picture(recipe, {}, context);
    attach_recipe(again.image, recipe, "ball.png");
    const std::vector<uint8_t> bytes = encode_png(again.image);
    CHECK(std::string(bytes.begin(), bytes.end()) == *kept->bytes);
  }
  CHECK_FALSE(session->saved("somethingelse"));
}

TEST_CASE("session: pictures by paths grow while nothing else is wanted, and end as the one that a file would hold") {
  PipelineFile file = pipeline(ball + skin, "  - {surface: {color: tomato}, of: skin}\n");
  file.picture = {"integrator=path", "noise=0.0001", "paths=48", "denoise=yes"};
  const auto session = session_of(file);
  Window window(*session);
  window.say(draw);
  const std::vector<Shot> shots = window.frames();
  // One by the rasterizer, one path a pixel, two, perhaps more, and all.
  REQUIRE(shots.size() >= 4);
  CHECK(shots[0].header["told"].text().empty());
  CHECK(shots[1].header["told"].text() == "1 path a pixel, too few to know the error");
  CHECK(shots[2].header["told"].text().starts_with("2 paths a pixel"));
  CHECK(shots.back().header["told"].text().find("standard error") != std::string::npos);
  for (size_t i = 0; i + 1 < shots.size(); ++i) {
    CHECK_FALSE(shots[i].header["final"].boolean());
    CHECK(shots[i].header["size"][0].number() == (i == 0 ? shots[0].header["size"][0].number() : 240));
  }
  CHECK(shots.back().header["final"].boolean());
  file.picture.push_back("size=240x180");
  Context context;
  const Picture whole = make_picture(file, {}, context);
  CHECK(image_of(shots.back().bytes).pixels == whole.image.pixels);
}

TEST_CASE("session: a camera that turns ends a picture by paths at once, and nothing of it comes afterwards") {
  PipelineFile file = pipeline(ball + skin, "  - {surface: {color: tomato}, of: skin}\n");
  file.picture = {"integrator=path", "noise=0.0001", "paths=1000000"};  // an hour
  const auto session = session_of(file);
  Window window(*session);
  window.say(draw);
  while (!window.next_frame().header["told"].text().starts_with("2 paths")) continue;
  const std::string camera = "'camera':{'position':[3,-4,2],'target':[0,0,0],'up':[0,0,1],'parallel':true,'view_angle':30,'height':2.5}";
  window.say("{'do':'draw','n':2,'view':0,'size':[240,180],'scale':1,'moving':true," + camera + "}");
  Shot shot = window.next_frame();
  while (shot.header["n"].number() == 1) shot = window.next_frame();  // what was on its way
  CHECK(shot.header["n"].number() == 2);
  CHECK(shot.header["told"].text().empty());
  window.say("{'do':'draw','n':3,'view':0,'size':[240,180],'scale':1,'moving':false," + camera + "}");
  for (int i = 0; i < 3; ++i) CHECK(window.next_frame().header["n"].number() >= 2);
  window.close();
}

TEST_CASE("session: of several wishes the newest counts, and pictures wait until the last one was shown") {
  const auto session = session_of(pipeline(ball, "  - {volume: {opacity: \"0:0.3,1:0\"}, of: ball}\n"));
  Window window(*session);
  window.say(draw);
  window.frames();
  window.shows = false;
  for (int n = 2; n <= 40; ++n)
    window.say("{'do':'draw','n':" + std::to_string(n) + ",'view':0,'size':[240,180],'moving':true,'camera':{'position':[3,-4," +
               std::to_string(n * 0.1) + "],'target':[0,0,0],'up':[0,0,1]}}");
  const Shot first = window.next_frame();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  CHECK(window.waiting() == 0);  // nothing else is on its way
  window.shows = true;
  window.say("{'do':'shown','n':2,'view':0}");
  Shot last = first;
  while (last.header["n"].whole() < 40) {
    const Shot next = window.next_frame();
    CHECK(next.header["n"].whole() >= last.header["n"].whole());
    last = next;
  }
  CHECK(last.header["camera"]["position"][2].number() == doctest::Approx(4.0));
}

TEST_CASE("session: edits change the pipeline, are taken back and made again") {
  const auto session = session_of(pipeline(ball + skin));
  Window window(*session);
  CHECK(window.next("state")["steps"].size() == 2);
  window.say("{'do':'edit','n':3,'edits':[{'at':'steps/skin','set':{'values':'-0.2'}},{'at':'picture','set':{'title':'A ball'}}]}");
  Json state = window.next("state");
  CHECK(state["by"].whole() == 3);
  CHECK(state["steps"][1]["words"]["values"].text() == "-0.2");
  CHECK(state["picture"]["title"].text() == "A ball");
  CHECK(state["can_undo"].boolean());
  window.say("{'do':'edit','n':4,'edits':[{'add':'step','operation':'slice','from':['ball'],'set':{'normal':'0,0,1'}}]}");
  state = window.next("state");
  REQUIRE(state["steps"].size() == 3);
  CHECK(state["steps"][2]["name"].text() == "slice1");
  CHECK(state["show"].size() == 2);
  CHECK(state["show"][1]["kind"].text() == "surface");
  window.say("{'do':'edit','n':5,'edits':[{'remove':'steps/slice1'}]}");
  CHECK(window.next("state")["show"].size() == 1);
  window.say("{'do':'undo','n':6}");
  CHECK(window.next("state")["steps"].size() == 3);
  for (int i = 0; i < 2; ++i) window.say("{'do':'undo','n':7}");
  window.next("state");
  window.say("{'do':'rows','n':8,'step':'skin','on':'point','from':0,'count':1}");  // a question after them all
  window.next("rows");
  window.say("{'do':'redo','n':9}");
  do state = window.next("state");
  while (state["by"].whole() != 9);
  CHECK(state["steps"][1]["words"]["values"].text() == "-0.2");
  CHECK(state["steps"].size() == 2);
  CHECK(state["can_redo"].boolean());
}

TEST_CASE("session: what is dragged is taken back as a whole") {
  const auto session = session_of(pipeline(ball, "  - {volume: {opacity: 0.3}, of: ball}\n"));
  Window window(*session);
  window.next("state");
  for (int i = 1; i <= 5; ++i)  // the last one ends the drag
    window.say("{'do':'edit','n':" + std::to_string(i) + ",'live':" + (i < 5 ? "true" : "false") +
               ",'edits':[{'at':'show/0','set':{'opacity':'0." + std::to_string(i) + "'}}]}");
  Json state;
  do state = window.next("state");
  while (state["by"].whole() != 5);
  CHECK(word_number(state, 0, "opacity") == 0.5);
  window.say("{'do':'undo','n':6}");
  state = window.next("state");
  CHECK(word_number(state, 0, "opacity") == 0.3);
  CHECK_FALSE(state["can_undo"].boolean());
  // A second drag, and a change of something else within it, are steps of their own.
  window.say("{'do':'edit','n':7,'live':true,'edits':[{'at':'show/0','set':{'opacity':'0.6'}}]}");
  window.say("{'do':'edit','n':8,'edits':[{'at':'picture','set':{'title':'Ball'}}]}");
  window.say("{'do':'edit','n':9,'edits':[{'at':'show/0','set':{'opacity':'0.7'}}]}");
  window.say("{'do':'undo','n':10}");
  window.say("{'do':'undo','n':11}");
  do state = window.next("state");
  while (state["by"].whole() != 11);
  CHECK(word_number(state, 0, "opacity") == 0.6);
  CHECK(state["can_undo"].boolean());
}

TEST_CASE("session: an edit that changes nothing is not one to be taken back") {
  const auto session = session_of(pipeline(ball, "  - {volume: {opacity: 0.3}, of: ball}\n"));
  Window window(*session);
  window.next("state");
  const auto opacity = [&](int n, const char* value, bool live) {
    window.say("{'do':'edit','n':" + std::to_string(n) + ",'live':" + (live ? "true" : "false") +
               ",'edits':[{'at':'show/0','set':{'opacity':'" + value + "'}}]}");
  };
  opacity(1, "0.4", false);
  opacity(2, "0.4", false);
  opacity(3, "0.4", true);  // a drag that begins where it stands
  opacity(4, "0.5", true);
  opacity(5, "0.5", false);
  window.say("{'do':'undo','n':6}");
  Json state;
  do state = window.next("state");
  while (state["by"].whole() != 6);
  CHECK(word_number(state, 0, "opacity") == 0.4);
  window.say("{'do':'undo','n':7}");
  do state = window.next("state");
  while (state["by"].whole() != 7);
  CHECK(word_number(state, 0, "opacity") == 0.3);
  CHECK_FALSE(state["can_undo"].boolean());
}

TEST_CASE("session: what cannot be is refused at its control, and changes nothing") {
  const auto session = session_of(pipeline(ball + skin));
  Window window(*session);
  const std::string before = window.next("state")["pipeline"].text();
  const auto refused = [&](const std::string& edits) {
    window.say("{'do':'edit','n':11,'edits':[" + edits + "]}");
    const Json answer = window.next("refused");
    CHECK(answer["n"].whole() == 11);
    REQUIRE(answer["errors"].size() > 0);
    CHECK_FALSE(answer["errors"][0]["text"].text().empty());
    return answer["errors"][0];
  };
  Json mistake = refused("{'at':'steps/skin','set':{'values':'wool'}}");
  CHECK(mistake["at"].text() == "steps/skin");
  CHECK(mistake["word"].text() == "values");
  mistake = refused("{'at':'show/0','set':{'opacty':'1'}}");
  CHECK(mistake["at"].text() == "show/0");
  CHECK(mistake["word"].text() == "opacty");
  mistake = refused("{'at':'steps/skin','set':{'field':'nothing'}}");  // only the data can tell
  CHECK(mistake["at"].text() == "steps/skin");
  CHECK(mistake["word"].text() == "field");
  refused("{'remove':'steps/ball'}");
  refused("{'at':'steps/none','set':{'a':'1'}}");
  refused("{'add':'step','operation':'contuor','from':['ball']}");
  refused("{'add':'step','operation':'contour','from':['bal']}");
  refused("{'at':'steps/skin','set':{'values':3}}");
  refused("7");
  window.say("{'do':'pipeline','n':12,'text':'sightglass: 1\\nsteps: [oh'}");
  window.next("refused");
  window.say("{'do':'edit','n':13,'edits':[]}");
  CHECK(window.next("state")["pipeline"].text() == before);
}

TEST_CASE("session: a window reads no other files and writes none") {
  const auto session = session_of(pipeline(ball, "  - {volume: {opacity: 0.3}, of: ball}\n"));
  Window window(*session);
  window.next("state");
  const auto refused = [&](const std::string& message) {
    window.say(message);
    return window.next("refused")["errors"][0]["text"].text();
  };
  CHECK(refused("{'do':'pipeline','n':2,'text':'sightglass: 1\\nsteps:\\n  a: {read: /etc/passwd}\\nshow:\\n  - {surface: , of: a}\\n'}")
            .find("no file of this session") != std::string::npos);
  CHECK(refused("{'do':'edit','n':3,'edits':[{'at':'show/0','set':{'save':'/tmp/sightglass_test_x.yaml'}}]}").find("writes no files") !=
        std::string::npos);
  CHECK(refused("{'do':'edit','n':4,'edits':[{'at':'show/0','set':{'map':'/etc/passwd.cpt'}}]}").find("no file of") != std::string::npos);
  CHECK(refused("{'do':'edit','n':5,'edits':[{'at':'show/0','set':{'transfer':'/etc/passwd'}}]}").find("no file of") != std::string::npos);
}

TEST_CASE("session: whoever may only look cannot change anything") {
  const auto session = session_of(pipeline(ball));
  Window guest(*session, Rights::view);
  CHECK_FALSE(guest.next("state")["may_edit"].boolean());
  for (const std::string what : {"edit", "undo", "redo", "pipeline", "time"}) {
    guest.say("{'do':'" + what + "','n':2,'edits':[],'text':'','time':0}");
    CHECK(guest.next("refused")["n"].whole() == 2);
  }
  guest.say(draw);
  CHECK(guest.frames().back().header["final"].boolean());
}

TEST_CASE("session: a place of the picture is a place of the data, with its values") {
  const auto session = session_of(pipeline(ball + skin, "  - {surface: {}, of: skin}\n"));
  Window window(*session);
  window.say("{'do':'draw','n':1,'view':0,'size':[300,300],'camera':{'position':[0,-6,0],'target':[0,0,0],'up':[0,0,1]}}");
  const Shot last = window.frames().back();
  const Json& area = last.header["area"];
  const double x = area[0].number() + area[2].number() / 2, y = area[1].number() + area[3].number() / 2;
  window.say("{'do':'probe','n':2,'view':0,'at':[" + std::to_string(x) + "," + std::to_string(y) + "]}");
  const Json answer = window.next("probe");
  REQUIRE(answer["position"].size() == 3);
  const Vec3 at{answer["position"][0].number(), answer["position"][1].number(), answer["position"][2].number()};
  // The source: the signed distance to a sphere of radius 0.6 in [-1, 1]^3; its contour is off by the grid's error, of second order.
  const double radius = length(at);
  CHECK(at.y < 0);
  CHECK(std::abs(at.x) < 0.02);
  CHECK(std::abs(at.z) < 0.02);
  CHECK(answer["show"].whole() == 0);
  CHECK(answer["values"].size() > 0);
  window.say("{'do':'line','n':3,'step':'ball','field':'distance','from':[0,0,0],'to':[0.9,0,0],'count':10}");
  const Json line = window.next("line");
  REQUIRE(line["values"].size() == 10);
  for (size_t i = 0; i < 10; ++i)
    CHECK(line["values"][i].number() == doctest::Approx(line["distance"][i].number() - radius).epsilon(0.05).scale(1));
  window.say("{'do':'probe','n':4,'view':0,'at':[" + std::to_string(area[0].number() + 1) + "," + std::to_string(area[1].number() + 1) +
             "]}");
  CHECK(window.next("probe")["position"].is_null());
}

TEST_CASE("session: rows, histograms, planes and proposals") {
  const auto session = session_of(pipeline(ball, "  - {volume: {opacity: 0.3}, of: ball}\n"));
  Window window(*session);
  window.next("state");
  window.say("{'do':'rows','n':1,'step':'ball','on':'point','from':24,'count':2}");
  const Json rows = window.next("rows");
  CHECK(rows["total"].whole() == 24 * 24 * 24);
  REQUIRE(rows["rows"].size() == 2);
  CHECK(rows["columns"].size() == rows["rows"][0].size());
  window.say("{'do':'histogram','n':2,'step':'ball','field':'distance'}");
  const Json histogram = window.next("histogram");
  uint64_t sum = 0;
  for (const Json& n : histogram["counts"].items()) sum += n.whole();
  CHECK(sum == 24 * 24 * 24);
  window.say("{'do':'plane','n':3,'show':0}");
  const Json plane = window.next("plane");
  CHECK(plane["counts"].size() == size_t(plane["size"][0].number() * plane["size"][1].number()));
  window.say("{'do':'proposals','n':4,'show':0}");
  const Json proposals = window.next("proposals");
  REQUIRE(proposals["list"].size() >= 2);
  CHECK_FALSE(proposals["list"][0]["reason"].text().empty());
  CHECK(proposals["list"][0]["words"].contains("opacity"));
  for (const std::string bad :
       {"{'do':'rows','n':9,'step':'none'}", "{'do':'line','n':9,'step':'ball','field':'x','from':[0,0],'to':[1,1,1]}",
        "{'do':'histogram','n':9,'step':'ball','field':'none'}", "{'do':'save','n':9,'size':[0,5]}"}) {
    window.say(bad);
    CHECK(window.next("refused")["n"].whole() == 9);
  }
}

TEST_CASE("session: a pipeline that cannot be run is told of, and can be mended") {
  const auto session = session_of(pipeline(ball, "  - {volume: {field: wool}, of: ball}\n"));
  Window window(*session);
  const Json state = window.next("state");
  CHECK(state["show"][0]["words"]["field"].text() == "wool");
  window.say("{'do':'edit','n':2,'edits':[{'at':'show/0','set':{'field':null}}]}");
  CHECK(window.next("state")["steps"][0]["kind"].text() == "uniform");
  window.say(draw);
  CHECK(window.frames().back().header["final"].boolean());
}

TEST_CASE("session: steps in time") {
  const std::string folder = sg::test::temp_folder() + "/serve_steps";
  ::mkdir(folder.c_str(), 0700);
  for (int k = 0; k < 4; ++k)
    write_file(folder + "/t_" + std::to_string(k) + ".vtk",
               "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 0 0 0\nSPACING 1 1 1\n"
               "POINT_DATA 8\nSCALARS heat float 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 " +
                   std::to_string(10 * (k + 1)) + "\n");
  const auto session = session_of(pipeline("  room: {read: \"" + folder + "/t_{n}.vtk\"}\n"));
  Window window(*session);
  Json state = window.next("state");
  REQUIRE(state["times"].size() == 4);
  const std::string before = state["pipeline"].text();
  for (const size_t k : {size_t(2), size_t(0), size_t(3)}) {
    window.say("{'do':'time','n':2,'time':" + std::to_string(state["times"][k].number()) + "}");
    state = window.next("state");
    CHECK(state["time"].number() == state["times"][k].number());
    CHECK(state["steps"][0]["fields"][0]["range"][1].number() == 10.0 * double(k + 1));
    CHECK(state["pipeline"].text() == before);  // a time is not part of it
  }
}

TEST_CASE("session: messages that make no sense are answered, not followed") {
  const auto session = session_of(pipeline(ball));
  Window window(*session);
  window.next("state");
  for (const std::string bad : {"", "{", "7", "[]", "{'do':'dance','n':5}", "{'do':'draw','n':5,'view':99,'size':[10,10]}",
                                "{'do':'draw','n':5,'view':1e300,'size':[10,10]}", "{'do':'draw','n':5,'view':0,'size':[1e9,10]}",
                                "{'do':'draw','n':5,'view':0,'size':['a',10]}",
                                "{'do':'draw','n':5,'view':0,'size':[64,64],'camera':{'position':[0,0,0],'target':[0,0,0],'up':[0,0,1]}}",
                                "{'do':'draw','n':5,'view':0,'size':[64,64],'camera':7}"}) {
    INFO(bad);
    window.say(bad);
    CHECK(window.next("refused")["errors"].size() == 1);
  }
}

TEST_CASE("session: windows come and go while pictures are drawn") {
  const auto session = session_of(pipeline(ball, "  - {volume: {opacity: \"0:0.3,1:0\"}, of: ball}\n"));
  std::vector<std::unique_ptr<Window>> windows;
  for (int i = 0; i < 50; ++i) {
    windows.push_back(std::make_unique<Window>(*session));
    windows.back()->say(draw);
    if (i % 3 == 0) windows.back()->close();
  }
  CHECK(session->clients() == 33);
  for (int i = 1; i < 50; i += 7)
    if (i % 3) CHECK(windows[size_t(i)]->frames().back().header["final"].boolean());
  windows.clear();
  CHECK(session->clients() == 0);
}

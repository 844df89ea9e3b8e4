// SPDX-License-Identifier: Apache-2.0
// A field over time at a place, and the cell under the pointer.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <thread>
#include <vector>

#include "base/file/file.h"
#include "serve/renderer/local_renderer.h"
#include "serve/renderer/wish.h"
#include "serve/renderer/worker/worker_renderer.h"
#include "serve/serve.h"
#include "serve/support/looking.h"
#include "support/test.h"

using namespace sg;
using namespace sg::serve;
using doctest::Approx;
using sg::test::Window;

namespace {

// f_0.vtk to f_3.vtk: a grid over [0,2]^3 with v = x + 10 t and the vectors (3 t, 4 t, 0), t = 0, 0.5, 1, 1.5.
std::string series_folder() {
  const std::string folder = sg::test::fresh_folder("over_time");
  for (int k = 0; k < 4; ++k) {
    std::string text =
        "# vtk DataFile Version 3.0\nseries\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 3 3\nORIGIN 0 0 0\nSPACING 1 1 1\n"
        "POINT_DATA 27\nSCALARS v double 1\nLOOKUP_TABLE default\n";
    const double t = 0.5 * k;
    for (int i = 0; i < 27; ++i) text += std::to_string(i % 3 + 10 * t) + "\n";
    text += "VECTORS flow double\n";
    for (int i = 0; i < 27; ++i) text += std::to_string(3 * t) + " " + std::to_string(4 * t) + " 0\n";
    write_file(folder + "f_" + std::to_string(k) + ".vtk", text);
  }
  return folder;
}

std::string series_text(const std::string& folder) {
  return "sightglass: 1\nsteps:\n  flow: {read: {path: \"" + folder + "f_{n}.vtk\", times: \"0:0.5\"}}\n" +
         "  twice: {calc: {expr: 2*v, name: w}}\nshow:\n  - {volume: , of: flow}\n";
}

// Takes its time for each time, and counts them.
class Slow : public LocalRenderer {
 public:
  explicit Slow(std::atomic<int>& times) : LocalRenderer(64 << 20, {}), times_(times) {}
  Json::Members answer(const Json& question, Context& context) override {
    if (wish_of(question) == Wish::over_time) ++times_, std::this_thread::sleep_for(std::chrono::milliseconds(200));
    return LocalRenderer::answer(question, context);
  }

 private:
  std::atomic<int>& times_;
};

}  // namespace

TEST_CASE("measures and over_time: a process of its own gives the same answers") {
  const std::string folder = series_folder();
  WorkerOptions options;
  options.command = {sg::test::build_folder() + std::string("/sightglass"), worker_command};
  const auto session = Session::open(std::make_unique<WorkerRenderer>(options), test::parsed(series_text(folder)), "flow");
  Window window(*session);
  test::looked(window, test::along_z);
  window.say("{'do':'measures','n':5,'step':'flow','field':'v','among':{'view':0,'lasso':[[0,0],[400,0],[400,300],[0,300]]}}");
  const Json all = window.next("measures");
  CHECK(all["cells"].whole() > 0);
  REQUIRE(all["fields"].size() == 1);
  CHECK(all["fields"][0]["min"].number() == 0);
  window.say("{'do':'over_time','n':6,'step':'twice','field':'w','at':[0.5,0.5,0.5]}");
  const Json curve = window.next("over_time");
  REQUIRE(curve["values"].size() == 4);
  CHECK(curve["values"][3].number() == Approx(2 * (0.5 + 15)));
}

TEST_CASE("over_time: the values of a series at a place, in order, the picture left as it is") {
  const std::string folder = series_folder();
  const auto session = test::opened(series_text(folder));
  Window window(*session);
  CHECK(window.next("state")["times"].size() == 4);
  for (const double x : {0.0, 0.25, 2.0, 2.0005}) {  // the last but for the rounding of a picture's depth
    window.say("{'do':'over_time','n':3,'step':'flow','field':'v','at':[" + std::to_string(x) + ",1,1]}");
    const Json curve = window.next("over_time");
    CHECK(curve["n"].whole() == 3);
    REQUIRE(curve["times"].size() == 4);
    for (size_t k = 0; k < 4; ++k) {
      CHECK(curve["times"][k].number() == 0.5 * double(k));
      CHECK(curve["values"][k].number() == Approx(std::min(x, 2.0) + 5.0 * double(k)));
    }
  }
  window.say("{'do':'over_time','n':4,'step':'flow','field':'flow','at':[1,1,1]}");
  CHECK(window.next("over_time")["values"][2].number() == Approx(5));  // the length of (3, 4, 0)
  window.say("{'do':'over_time','n':5,'step':'flow','field':'v','at':[9,1,1]}");
  const Json outside = window.next("over_time");
  REQUIRE(outside["values"].size() == 4);
  CHECK(outside["values"][0].is_null());
  const auto refused = [&](const std::string& members) {
    window.say("{'do':'over_time','n':7" + members + "}");
    return window.next("refused")["errors"][0]["text"].text();
  };
  CHECK(refused(",'step':'flow','field':'wool','at':[1,1,1]").find("wool") != std::string::npos);
  CHECK(refused(",'step':'none','field':'v','at':[1,1,1]").find("no step") != std::string::npos);
  CHECK(refused(",'step':'flow','field':'v','at':[1,1]").find("not a place") != std::string::npos);
}

TEST_CASE("over_time: a file that cannot be read leaves a gap that names it; where none can, the question is refused") {
  const std::string folder = series_folder();
  const auto session = test::opened(series_text(folder));
  Window window(*session);
  CHECK(window.next("state")["times"].size() == 4);
  const std::string ask = "{'do':'over_time','n':3,'step':'flow','field':'v','at':[1,1,1]}";
  write_file(folder + "f_2.vtk", "# vtk DataFile Version 3.0\nbroken\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3");
  window.say(ask);
  const Json curve = window.next("over_time");
  REQUIRE(curve["values"].size() == 4);
  CHECK(curve["values"][1].number() == Approx(1 + 5));
  CHECK(curve["values"][2].is_null());
  CHECK(curve["values"][3].number() == Approx(1 + 15));
  REQUIRE(curve["gaps"].size() == 1);
  CHECK(curve["gaps"][0]["time"].number() == 1);
  CHECK(curve["gaps"][0]["text"].text().find("f_2.vtk") != std::string::npos);
  std::filesystem::remove(folder + "f_3.vtk");  // was there when the series was found
  window.say(ask);
  CHECK(window.next("over_time")["gaps"].size() == 2);
  for (const char* name : {"f_0.vtk", "f_1.vtk"}) write_file(folder + name, "nothing");
  window.say(ask);
  CHECK(window.next("refused")["errors"][0]["text"].text().find(".vtk") != std::string::npos);
}

TEST_CASE("over_time: other questions are answered in between, and a window that leaves ends it") {
  std::atomic<int> times{0};
  const auto session = Session::open(std::make_unique<Slow>(times), test::parsed(series_text(series_folder())), "flow");
  Window window(*session);
  window.next("state");
  window.say("{'do':'over_time','n':3,'step':'flow','field':'v','at':[1,1,1]}");
  window.say("{'do':'rows','n':4,'step':'flow','on':'point','from':0,'count':1}");
  CHECK(window.next("rows")["n"].whole() == 4);  // came before the curve, or next() would have left that out
  CHECK(window.next("over_time")["n"].whole() == 3);
  CHECK(times == 4);
  {
    Window other(*session);
    other.say("{'do':'over_time','n':3,'step':'flow','field':'v','at':[1,1,1]}");
    while (times == 4) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  window.say("{'do':'rows','n':5,'step':'flow','on':'point','from':0,'count':1}");
  CHECK(window.next("rows")["n"].whole() == 5);
  CHECK(times == 5);
}

TEST_CASE("over_time: without times there is nothing to plot") {
  const auto session = test::opened("sightglass: 1\nsteps:\n  head: {sphere: {size: 5}}\nshow:\n  - {outline: , of: head}\n");
  Window window(*session);
  window.next("state");
  window.say("{'do':'over_time','n':3,'step':'head','field':'distance','at':[0,0,0]}");
  CHECK(window.next("refused")["errors"][0]["text"].text().find("changes with time") != std::string::npos);
}

TEST_CASE("probe: of those that wait the last counts, and those to be kept") {
  std::atomic<int> times{0};
  const auto session = Session::open(std::make_unique<Slow>(times), test::parsed(series_text(series_folder())), "flow");
  Window window(*session);
  window.next("state");
  window.say("{'do':'over_time','n':1,'step':'flow','field':'v','at':[1,1,1]}");  // they wait behind it
  for (int n = 2; n <= 9; ++n)
    window.say("{'do':'probe','n':" + std::to_string(n) + ",'view':0,'at':[1,1]" + (n == 3 || n == 5 ? ",'keep':true}" : "}"));
  std::vector<uint64_t> answered;
  while (answered.empty() || answered.back() < 9) answered.push_back(window.next("probe")["n"].whole());
  CHECK(std::count(answered.begin(), answered.end(), 3) == 1);
  CHECK(std::count(answered.begin(), answered.end(), 5) == 1);
}

TEST_CASE("probe: the cell under the pointer, and what it has") {
  // A flat surface of 4 x 4 quads over [-1,1]^2, numbered row by row, and the solid grid.
  for (const bool surface : {true, false}) {
    const std::string steps = std::string("  ball: {sphere: {size: 5, radius: 0.7692307692307693}}\n") +
                              (surface ? "  flat: {slice: {axis: z, position: 0.25}}\n" : "") +
                              "  head: {calc: {expr: x, name: c, on: cell}}\n";
    const auto session = test::opened("sightglass: 1\nsteps:\n" + steps + "show:\n  - {surface: , of: head}\n");
    Window window(*session);
    const test::Looking seen = test::looked(window, test::along_z);
    const Vec3 at = seen.projection.to_pixel({0.7, -0.8, 1});
    window.say("{'do':'probe','n':2,'view':0,'at':[" + std::to_string(at.x + seen.x) + "," + std::to_string(at.y + seen.y) + "]}");
    const Json answer = window.next("probe");
    REQUIRE(answer["position"].size() == 3);
    CHECK(answer["position"][0].number() == Approx(0.7).epsilon(0.02));
    REQUIRE(answer["cell"].is_whole());
    if (!surface) CHECK(answer["cell"].whole() == 3 + 16 * 3);
    bool told = false;  // of the cell: x at its centre, between 0.5 and 1
    for (const Json& v : answer["values"].items()) told = told || (v["name"].text() == "c" && v["value"].text() == "0.75");
    CHECK(told);
  }
}

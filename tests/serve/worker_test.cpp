// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/worker/worker_renderer.h"

#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <future>
#include <thread>
#include <utility>

#include "base/error.h"
#include "pipeline/picture/picture.h"
#include "serve/renderer/local_renderer.h"
#include "serve/serve.h"
#include "serve/support/window.h"
#include "support/test.h"

using namespace sg;
using namespace sg::serve;
using sg::test::Window;

namespace {

WorkerOptions options() {
  WorkerOptions o;
  o.command = {sg::test::build_folder() + std::string("/sightglass"), worker_command};
  return o;
}

PipelineFile pipeline() {
  return parse_pipeline("sightglass: 1\nsteps:\n  ball: {sphere: {size: 24}}\nshow:\n  - {volume: {opacity: \"0:0.3,1:0\"}, of: ball}\n",
                        "", picture_vocabulary());
}

DrawRequest request() {
  DrawRequest r;
  r.width = 160, r.height = 120;
  r.camera = ViewCamera{{3, -4, 2}, {0, 0, 0}, {0, 0, 1}, true, 30, 2.5};
  return r;
}

}  // namespace

TEST_CASE("workers: the same bytes as in this process") {
  Context context;
  WorkerRenderer worker(options());
  LocalRenderer local(64 << 20, {});
  CHECK(worker.load(pipeline(), context) == local.load(pipeline(), context));
  const DrawnView there = worker.draw(request(), context), here = local.draw(request(), context);
  CHECK(*there.bytes == *here.bytes);
  CHECK(there.camera == here.camera);
  const Json told_there(worker.tell(context)), told_here(local.tell(context));
  for (const auto& [name, value] : told_here.members())
    if (name != "steps") CHECK(told_there[name].dump() == value.dump());  // steps tell what they took
  CHECK(told_there["steps"][0]["fields"].dump() == told_here["steps"][0]["fields"].dump());
  CHECK(told_there["steps"][0]["seconds"].number() > 0);
  CHECK(worker.save(request(), "a.png", context) == local.save(request(), "a.png", context));
}

TEST_CASE("workers: pictures by paths come on the way, and end as in this process") {
  PipelineFile file = parse_pipeline(
      "sightglass: 1\nsteps:\n  ball: {sphere: {size: 24}}\n  skin: {contour: {values: 0}, from: ball}\nshow:\n"
      "  - {surface: {color: tomato}, of: skin}\n",
      "", picture_vocabulary());
  file.picture = {"integrator=path", "noise=0.0001", "paths=64"};
  Context context;
  WorkerRenderer worker(options());
  LocalRenderer local(64 << 20, {});
  worker.load(file, context), local.load(file, context);
  std::vector<std::string> told;
  const OnFiner on_finer = [&](const DrawnView& d) {
    told.push_back(d.told);
    CHECK(d.width == 160);
    CHECK(d.type == "image/jpeg");
  };
  const DrawnView there = worker.draw(request(), on_finer, context), here = local.draw(request(), context);
  CHECK(*there.bytes == *here.bytes);
  CHECK(there.told == here.told);
  REQUIRE_FALSE(told.empty());
  CHECK(told[0].find("paths a pixel") != std::string::npos);
}

TEST_CASE("workers: what moves is drawn while an exact picture is") {
  PipelineFile file = pipeline();
  file.picture = {"integrator=path", "noise=0.0001", "paths=1000000"};  // an hour
  Context context, exact_context;
  WorkerRenderer worker(options());
  worker.load(file, context);
  std::promise<void> begun;
  std::thread exact([&] {
    bool first = true;
    const OnFiner on_finer = [&](const DrawnView&) {
      if (std::exchange(first, false)) begun.set_value();
    };
    CHECK_THROWS_AS(worker.draw(request(), on_finer, exact_context), Error);
  });
  begun.get_future().wait();
  DrawRequest moving = request();
  moving.view = 1, moving.quality = Quality::moving;
  CHECK(worker.draw(moving, context).type == "image/jpeg");
  exact_context.cancel();
  exact.join();
}

TEST_CASE("workers: errors and cancelling pass between the processes") {
  Context context;
  WorkerRenderer worker(options());
  PipelineFile wrong = pipeline();
  wrong.show[0].words.push_back("field=wool");
  try {
    worker.load(wrong, context);
    FAIL("nothing was thrown");
  } catch (const Error& e) {
    CHECK(e.kind() == ErrorKind::usage);
    CHECK(std::string(e.what()).find("wool") != std::string::npos);
  }
  worker.load(pipeline(), context);
  Context stopped;
  stopped.cancel();
  try {
    worker.draw(request(), stopped);
    FAIL("nothing was thrown");
  } catch (const Error& e) {
    CHECK(e.kind() == ErrorKind::cancelled);
  }
  CHECK(worker.draw(request(), context).width == 160);
}

TEST_CASE("workers: a process that dies is told of, and the next picture comes from a new one") {
  Context context;
  WorkerRenderer worker(options());
  worker.load(pipeline(), context);
  const std::string before = *worker.draw(request(), context).bytes;
  const int first = worker.process();
  REQUIRE(first > 0);
  ::kill(first, SIGKILL);
  bool told = false;
  std::string after;
  for (int tries = 0; tries < 3 && after.empty(); ++tries) try {
      after = *worker.draw(request(), context).bytes;
    } catch (const Error& e) {
      told = told || std::string(e.what()).find("has ended") != std::string::npos;
    }
  CHECK(after == before);
  CHECK(worker.process() != first);
}

TEST_CASE("workers: what needs more memory than a worker may take is told, and the view goes on") {
  WorkerOptions bounded = options();
  bounded.process_memory = least_worker_memory;
  const auto session = Session::open(std::make_unique<WorkerRenderer>(bounded), pipeline(), "ball");
  Window window(*session);
  window.say("{'do':'draw','n':1,'view':0,'size':[160,120]}");
  const std::string before = window.frames().back().bytes;
  window.say("{'do':'edit','n':2,'edits':[{'at':'steps/ball','set':{'size':'600'}}]}");
  const std::string told = window.next("refused")["errors"][0]["text"].text();
  INFO(told);
  CHECK(told.find("256.0 MiB") != std::string::npos);
  CHECK(told.find("--worker-memory") != std::string::npos);
  window.say("{'do':'save','n':5,'size':[4096,4096]}");
  const std::string of_save = window.next("refused")["errors"][0]["text"].text();
  INFO(of_save);
  CHECK((of_save.find("--worker-memory") != std::string::npos || of_save.find("has ended") != std::string::npos));
  window.say("{'do':'draw','n':3,'view':0,'size':[160,120]}");
  CHECK(window.frames().back().bytes == before);
  window.say("{'do':'edit','n':4,'edits':[{'at':'steps/ball','set':{'size':'20'}}]}");
  Json state = window.next("state");
  while (state["by"].whole() != 4) state = window.next("state");
  CHECK(state["steps"][0]["size"].text() == "20x20x20");
}

TEST_CASE("workers: a session outlives the process that draws for it") {
  auto renderer = std::make_unique<WorkerRenderer>(options());
  WorkerRenderer& worker = *renderer;
  const auto session = Session::open(std::move(renderer), pipeline(), "ball");
  Window window(*session);
  window.say("{'do':'draw','n':1,'view':0,'size':[160,120]}");
  const std::string before = window.frames().back().bytes;
  ::kill(worker.process(), SIGKILL);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  window.say("{'do':'draw','n':2,'view':0,'size':[160,120]}");
  CHECK(window.frames().back().bytes == before);
}

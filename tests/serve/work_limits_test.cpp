// SPDX-License-Identifier: Apache-2.0
// How long and how large the work of a window may become.
#include <string>

#include "serve/support/staged.h"
#include "serve/support/window.h"
#include "support/test.h"

using namespace sg;
using namespace sg::serve;
using sg::test::contains;
using sg::test::Stage;
using sg::test::Window;

namespace {

std::string refusal(Window& window, uint64_t n) {
  const Json refused = window.next("refused");
  CHECK(refused["n"].whole() == n);
  return refused["errors"][0]["text"].text();
}

}  // namespace

TEST_CASE("limits: a picture, a picture to save, a question and an edit that take too long are ended and told, and the session goes on") {
  Stage stage;
  const auto session = test::session_of(stage, std::chrono::milliseconds(100));
  Window window(*session);
  const std::string before = window.next("state")["pipeline"].text();
  window.say("{'do':'draw','n':1,'view':0,'size':[64,48]}");
  for (int i = 0; i < 2; ++i) CHECK_FALSE(window.next_frame().header["final"].boolean());
  const std::string told = refusal(window, 1);
  CHECK(contains(told, "0.1 s"));
  CHECK(contains(told, "--most-seconds"));
  window.say("{'do':'save','n':2,'size':[60,40]}");
  CHECK(refusal(window, 2) == told);
  stage.slow_questions = true;
  window.say("{'do':'measures','n':6,'step':'ball'}");
  CHECK(refusal(window, 6) == told);
  stage.slow_steps = true;
  window.say("{'do':'edit','n':3,'edits':[{'at':'steps/ball','set':{'size':'7'}}]}");
  CHECK(refusal(window, 3) == told);
  stage.slow_steps = false, stage.released = true;
  window.say("{'do':'edit','n':4,'edits':[]}");
  CHECK(window.next("state")["pipeline"].text() == before);
  window.say("{'do':'draw','n':5,'view':0,'size':[64,48]}");
  CHECK(window.frames().back().header["n"].whole() == 5);
}

TEST_CASE("limits: the first reading of what is opened ends when it takes too long, names it, and is tried again for who comes later") {
  Stage stage;
  stage.slow_steps = true;
  const auto session = test::session_of(stage, std::chrono::milliseconds(100));
  {
    Window window(*session);
    const std::string told = refusal(window, 0);
    for (const char* part : {"'ball'", "0.1 s", "--most-seconds"}) CHECK(contains(told, part));
    CHECK(window.next("state")["notes"][0].text() == told);
    Window other(*session);  // that did not wait for it
    CHECK(refusal(other, 0) == told);
  }
  stage.slow_steps = false, stage.released = true;
  Window later(*session);
  later.say("{'do':'draw','n':1,'view':0,'size':[64,48]}");
  CHECK(later.frames().back().header["n"].whole() == 1);
}

TEST_CASE("limits: reading ends when the last window goes, and begins anew when one comes") {
  Stage stage;
  stage.slow_steps = true;
  const auto session = test::session_of(stage);
  {
    Window window(*session);
    {
      Window other(*session);
      stage.begun.wait_for(1);
    }
    CHECK(stage.stopped.now() == 0);
  }
  stage.stopped.wait_for(1);
  CHECK(stage.begun.now() == 1);
  Window later(*session);
  stage.begun.wait_for(2);
  stage.released = true;
  CHECK(later.next("state")["revision"].whole() == 1);
}

TEST_CASE("limits: what waits of one window is bounded in bytes") {
  Stage stage;
  const auto session = test::session_of(stage);
  Window window(*session), other(*session);
  const auto save = [](uint64_t n) {
    return "{'do':'save','n':" + std::to_string(n) + ",'size':[60,40],'title':'" + std::string(200 << 10, 'a') + "'}";
  };
  window.say(save(1));
  stage.begun.wait_for(1);  // does not wait any more
  for (uint64_t n = 2; n <= 6; ++n) window.say(save(n));
  window.say(save(7));
  CHECK(contains(refusal(window, 7), "too large"));
  window.say("{'do':'edit','n':8,'edits':[],'title':'" + std::string(200 << 10, 'a') + "'}");
  CHECK(contains(refusal(window, 8), "too large"));
  other.say(save(9));
  stage.released = true;
  CHECK(other.next("saved")["n"].whole() == 9);
  for (uint64_t n = 1; n <= 6; ++n) CHECK(window.next("saved")["n"].whole() == n);
}

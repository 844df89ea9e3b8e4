// SPDX-License-Identifier: Apache-2.0
// Whose turn it is: windows at one session do not hold each other up.
#include <chrono>
#include <functional>
#include <future>

#include "serve/session/limits.h"
#include "serve/session/questions/question_queue.h"
#include "serve/support/staged.h"
#include "serve/support/window.h"
#include "support/test.h"

using namespace sg;
using namespace sg::serve;
using sg::test::Shot;
using sg::test::Stage;
using sg::test::Window;

namespace {

// The camera of its n-th picture.
void move(Window& window, int n) {
  window.say("{'do':'draw','n':" + std::to_string(n) + ",'view':0,'size':[64,48],'moving':true,'camera':{'position':[3,-4," +
             std::to_string(0.01 * n) + "],'target':[0,0,0],'up':[0,0,1]}}");
}

const std::string at_rest = "{'do':'draw','n':1,'view':0,'size':[64,48]}";

// Moves the window until `over`, waiting for each picture.
void move_until(Window& window, const std::function<bool()>& over) {
  const auto longest = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  for (int n = 1; !over(); ++n) {
    move(window, n);
    REQUIRE(window.next_frame().header["n"].whole() <= uint64_t(n));
    REQUIRE(std::chrono::steady_clock::now() < longest);
  }
}

}  // namespace

TEST_CASE("turns: what moves in one window interrupts the exact picture of another, which is drawn when nothing moves") {
  Stage stage;
  const auto session = test::session_of(stage);
  Window still(*session), moves(*session);
  still.say(at_rest);
  for (int i = 0; i < 2; ++i) CHECK_FALSE(still.next_frame().header["final"].boolean());
  stage.begun.wait_for(1);
  move(moves, 1);
  CHECK(moves.next_frame().header["n"].whole() == 1);  // the other picture would never end by itself
  stage.stopped.wait_for(1);
  stage.begun.wait_for(2);  // begun anew
  stage.released = true;
  CHECK(still.next_frame().header["final"].boolean());
}

TEST_CASE("turns: the first picture of a window does not wait for the exact one of another") {
  Stage stage;
  const auto session = test::session_of(stage);
  Window slow(*session), other(*session);
  slow.say(at_rest);
  for (int i = 0; i < 2; ++i) CHECK_FALSE(slow.next_frame().header["final"].boolean());
  stage.begun.wait_for(1);
  other.say(at_rest);
  for (int i = 0; i < 2; ++i) CHECK_FALSE(other.next_frame().header["final"].boolean());  // the draft, too
  stage.released = true;
  CHECK(other.frames().back().header["final"].boolean());
  CHECK(slow.frames().back().header["final"].boolean());
}

TEST_CASE("turns: an exact picture is finished, and a state told, while another window moves for ever") {
  for (const bool state : {false, true}) {
    Stage stage;
    stage.until_moved = 5;  // between two of which it would always be interrupted
    stage.slow_pictures = !state;
    const auto session = test::session_of(stage);
    Window still(*session), moves(*session);
    if (state) {
      still.next("state");
      stage.slow_state = true;
      still.say("{'do':'edit','n':9,'edits':[{'at':'picture','set':{'title':'Ball'}}]}");
      stage.begun.wait_for(1);
    } else {
      still.say(at_rest);
    }
    auto came = std::async(std::launch::async, [&] {
      if (state) return still.next("state")["by"].whole() == 9;
      return still.frames().back().header["final"].boolean();
    });
    move_until(moves, [&] { return came.wait_for(std::chrono::seconds(0)) == std::future_status::ready; });
    CHECK(came.get());
    CHECK(stage.stopped.now() > 0);
  }
}

TEST_CASE("turns: what moves is drawn as it was while the steps of another window's edit run") {
  Stage stage;
  const auto session = test::session_of(stage);
  Window edits(*session), moves(*session);
  const uint64_t revision = edits.next("state")["revision"].whole();
  stage.slow_steps = true;
  edits.say("{'do':'edit','n':1,'edits':[{'at':'steps/ball','set':{'size':'7'}}]}");
  stage.begun.wait_for(1);
  for (int n = 1; n <= 3; ++n) {
    move(moves, n);
    CHECK(moves.next_frame().header["revision"].whole() == revision);
  }
  stage.released = true;
  CHECK(edits.next("state")["revision"].whole() == revision + 1);
  move(moves, 4);
  Shot shot = moves.next_frame();
  while (shot.header["n"].whole() != 4) shot = moves.next_frame();
  CHECK(shot.header["revision"].whole() == revision + 1);
}

TEST_CASE("turns: a quick question does not wait for a picture that another window saves") {
  Stage stage;
  const auto session = test::session_of(stage);
  Window saves(*session), asks(*session);
  saves.next("state"), asks.next("state");
  saves.say("{'do':'save','n':1,'size':[60,40]}");
  stage.begun.wait_for(1);
  asks.say("{'do':'rows','n':2,'step':'ball','on':'point','from':0,'count':1}");
  CHECK(asks.next("rows")["n"].whole() == 2);
  stage.released = true;
  CHECK(saves.next("saved")["n"].whole() == 1);
}

TEST_CASE("turns: statistics do not wait for a picture that another window saves, nor for its statistics") {
  Stage stage;
  const auto session = test::session_of(stage);
  Window slow(*session), asks(*session);
  slow.next("state"), asks.next("state");
  slow.say("{'do':'save','n':1,'size':[60,40]}");
  stage.begun.wait_for(1);
  asks.say("{'do':'measures','n':2,'step':'ball'}");
  CHECK(asks.next("measures")["n"].whole() == 2);
  stage.slow_questions = true;
  slow.say("{'do':'measures','n':3,'step':'ball'}");
  slow.say("{'do':'measures','n':4,'step':'ball'}");  // waits for the one before it, whatever is free
  stage.begun.wait_for(2);
  stage.slow_questions = false;
  asks.say("{'do':'measures','n':5,'step':'ball'}");
  CHECK(asks.next("measures")["n"].whole() == 5);
  stage.released = true;
  for (const uint64_t n : {3, 4}) CHECK(slow.next("measures")["n"].whole() == n);
}

TEST_CASE("turns: questions go round among windows, each of which has a few that wait") {
  const auto question = [](int client, const std::string& what, uint64_t n) {
    return Question{client, parse_json("{\"do\":\"" + what + "\",\"n\":" + std::to_string(n) + "}", "question")};
  };
  QuestionQueue queue;
  for (uint64_t n = 1; n <= 3; ++n) CHECK(queue.push(question(1, "save", n)));
  CHECK(queue.push(question(2, "rows", 4)));
  CHECK(queue.push(question(2, "measures", 5)));
  CHECK(queue.push(question(3, "save", 6)));
  const auto take = [&](Lane lane) {  // and answer it at once
    const auto next = queue.pop(lane);
    if (next) queue.done(*next);
    return next ? next->message["n"].whole() : 0;
  };
  std::vector<uint64_t> order;
  while (const uint64_t n = take(Lane::save)) order.push_back(n);
  CHECK(order == std::vector<uint64_t>{1, 6, 2, 3});
  CHECK(take(Lane::lengthy) == 5);
  CHECK(take(Lane::quick) == 4);
  CHECK_FALSE(queue.pop(Lane::quick));
  for (size_t i = 0; i < most_questions; ++i) CHECK(queue.push(question(1, "rows", i)));
  CHECK_FALSE(queue.push(question(1, "rows", 99)));
  CHECK(queue.push(question(2, "rows", 100)));
  const auto first = queue.pop(Lane::quick);
  CHECK(first->client == 1);  // whose turn in this row was longest ago: it has had none
  CHECK(queue.pop(Lane::quick)->client == 2);
  CHECK_FALSE(queue.pop(Lane::quick));  // one of the first window is being answered
  queue.done(*first);
  CHECK(queue.pop(Lane::quick)->client == 1);
  queue.leave(1);
  CHECK_FALSE(queue.pop(Lane::quick));
}

// SPDX-License-Identifier: Apache-2.0
// Questions of all windows that wait, each window's in its turn.
#pragma once
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "base/text/json.h"
#include "serve/renderer/wish.h"
#include "serve/session/questions/lane.h"
#include "serve/session/questions/time_curve.h"

namespace sg::serve {

struct Question {
  int client;
  Json message;
  size_t bytes = 0;                       ///< of the message as it came
  std::shared_ptr<TimeCurve> curve = {};  ///< of a question over time, once it has begun

  Wish wish() const { return wish_of(message).value_or(Wish::probe); }
  Lane lane() const { return lane_of(wish()); }
};

/// Each lane is a row of its own. Of each row the window comes next whose turn was longest ago, and none of whose questions in this lane is
/// being answered: no window takes all threads of a lane.
class QuestionQueue {
 public:
  /// Of looks at places while the mouse moves only the last one of a window stays. False when as many wait as a window may have; what has
  /// begun is always taken back.
  bool push(Question question);
  /// Nothing where nobody waits whose turn it could be. What it gives is being answered until done().
  std::optional<Question> pop(Lane lane);
  void done(const Question& question);
  /// What a window asked is forgotten.
  void leave(int client);
  /// Of the messages of a window that wait.
  size_t bytes(int client) const;

 private:
  std::deque<Question> waiting_;
  using Row = std::pair<int, Lane>;  // of a window in a lane
  std::map<Row, uint64_t> turns_;    ///< when each last had one
  std::set<Row> answered_;           ///< have one that is being answered
  uint64_t turn_ = 0;
};

}  // namespace sg::serve

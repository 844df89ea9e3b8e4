// SPDX-License-Identifier: Apache-2.0
// Questions of all windows that wait, each window's in its turn.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>

#include "base/text/json.h"
#include "serve/renderer/wish.h"
#include "serve/session/questions/time_curve.h"

namespace sg::serve {

struct Question {
  int client;
  Json message;
  size_t bytes = 0;                       ///< of the message as it came
  std::shared_ptr<TimeCurve> curve = {};  ///< of a question over time, once it has begun

  Wish wish() const { return wish_of(message).value_or(Wish::probe); }
};

/// Quick and lengthy questions are two rows: nobody's look at a place waits for a picture that is saved. Of each row the window comes next
/// whose turn was longest ago.
class QuestionQueue {
 public:
  /// Of looks at places while the mouse moves only the last one of a window stays. False when as many wait as a window may have; what has
  /// begun is always taken back.
  bool push(Question question);
  std::optional<Question> pop(bool lengthy);
  /// What a window asked is forgotten.
  void leave(int client);
  /// Of the messages of a window that wait.
  size_t bytes(int client) const;

 private:
  std::deque<Question> waiting_;
  std::map<int, std::array<uint64_t, 2>> turns_;  ///< when each window last had one in each row
  uint64_t turn_ = 0;
};

}  // namespace sg::serve

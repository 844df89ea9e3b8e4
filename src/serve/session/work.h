// SPDX-License-Identifier: Apache-2.0
// What one thread of a session is at, so that others can stop it.
#pragma once
#include <chrono>
#include <memory>
#include <optional>

#include "base/context.h"
#include "serve/renderer/renderer.h"

namespace sg::serve {

/// All of it is guarded by the session's mutex; the thread itself may use the context meanwhile.
struct Work {
  using Moment = std::chrono::steady_clock::time_point;
  enum class Kind {
    pipeline,  ///< what was edited runs
    state,     ///< what windows are told of it
    unseen,    ///< a picture that nobody sees
    picture,
    question,
  };
  std::unique_ptr<Context> context;  ///< null: the thread rests
  Kind kind = Kind::picture;
  int client = 0;  ///< for whom; 0: for all
  int view = -1;   ///< of the renderer: that of a picture
  Quality quality = Quality::moving;
  bool moves = false;                            ///< that view moves: nothing but a newer picture of it stops it
  std::optional<Moment> until;                   ///< it may not take longer
  bool gave_way = false, took_too_long = false;  ///< why it was stopped

  bool goes_on() const { return context != nullptr; }
  bool is(Kind k) const { return goes_on() && kind == k; }
  bool draws(int of_view) const { return is(Kind::picture) && view == of_view; }
  void stop() {
    if (context) context->cancel();
  }
};

}  // namespace sg::serve

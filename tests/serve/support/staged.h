// SPDX-License-Identifier: Apache-2.0
// A session whose slow work goes on until the test lets it end.
#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>

#include "serve/session/session.h"

namespace sg::test {

/// What a renderer has begun and finished, for the test to wait for.
class Count {
 public:
  void add();
  int now() const;
  /// Fails the test after 60 seconds.
  void wait_for(int least);

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  int count_ = 0;
};

struct Stage {
  Count moved;                        ///< moving pictures that were drawn
  Count begun, stopped;               ///< slow work that began, and that was stopped
  std::atomic<bool> released{false};  ///< it may end
  int until_moved = 1 << 30;          ///< it ends as well when so many moving pictures were drawn since it began
  // Which work is slow; saving always is.
  std::atomic<bool> slow_pictures{true};  ///< exact ones
  std::atomic<bool> slow_state{false}, slow_steps{false}, slow_questions{false};

  void be_slow(Context& context);
};

/// Of a small ball. The stage outlives it.
std::shared_ptr<serve::Session> session_of(Stage& stage, std::chrono::milliseconds longest = {});

}  // namespace sg::test

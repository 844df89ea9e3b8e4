// SPDX-License-Identifier: Apache-2.0
// What hostile input may not do to the process: take a gigabyte, or go on for ever.
#pragma once
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <mutex>
#include <string>
#include <thread>

#include "base/context.h"
#include "data/memory/memory_budget.h"

namespace sg::test::hostile {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool shadow_memory = true;  // ten times as slow, and memory that nobody can count
#else
constexpr bool shadow_memory = false;
#endif

/// The operation that is asked for alone, or null.
inline const char* only() { return std::getenv("SG_HOSTILE_ONLY"); }

/// So many seconds of this program without a watch over its memory; $SG_HOSTILE_SLOW as many where that is set.
inline double seconds(double s) {
  if (const char* slow = std::getenv("SG_HOSTILE_SLOW")) return s * std::atof(slow);
  return shadow_memory ? 20 * s : s;
}

/// Within its life the process may have so many gigabytes more than before, and is told that half as many are allowed.
class MemoryFence {
 public:
  explicit MemoryFence(size_t gigabytes = 1) {
    set_memory_limit(array_memory() + (gigabytes << 29));
    if (uncounted()) return;
    getrlimit(RLIMIT_AS, &before_);
    size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    rlimit fence = before_;
    fence.rlim_cur = std::min<rlim_t>(before_.rlim_max, pages * 4096 + (gigabytes << 30));
    setrlimit(RLIMIT_AS, &fence);
  }
  ~MemoryFence() {
    set_memory_limit(0);
    if (!uncounted()) setrlimit(RLIMIT_AS, &before_);
  }

 private:
  static bool uncounted() { return shadow_memory || std::getenv("SG_HOSTILE_SLOW"); }
  rlimit before_{};
};

/// Within its life: asks the work to stop after so many seconds of wall-clock time; says what it is and ends the program when it has not
/// stopped after as many more.
class Watch {
 public:
  Watch(Context& context, double seconds, const std::string& what)
      : context_(context), seconds_(seconds), what_(what), thread_([this] { run(); }) {}
  ~Watch() {
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    const auto time = std::chrono::duration<double>(seconds_);
    const auto done = [this] { return done_; };
    if (changed_.wait_for(lock, time, done)) return;
    context_.cancel();
    if (changed_.wait_for(lock, time, done)) return;
    std::fprintf(stderr, "does not end, even when asked to: %s\n", what_.c_str());
    std::abort();
  }
  Context& context_;
  double seconds_;
  const std::string& what_;
  bool done_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::thread thread_;
};

}  // namespace sg::test::hostile

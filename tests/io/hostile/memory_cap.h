// SPDX-License-Identifier: Apache-2.0
// Tests that notice when memory is asked for that the file does not back.
#pragma once
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "base/parallel.h"

namespace sg::test {

/// Lets this process have `more` bytes of address space beyond what it has, so that asking for what a hostile size says fails.
class MemoryCap {
 public:
  explicit MemoryCap(size_t more) {
    size_t pages = 0;
    if (std::FILE* f = std::fopen("/proc/self/statm", "r")) {
      if (std::fscanf(f, "%zu", &pages) != 1) pages = 0;
      std::fclose(f);
    }
    ::getrlimit(RLIMIT_AS, &before_);
    rlimit now = before_;
    now.rlim_cur = std::min<rlim_t>(before_.rlim_max, pages * size_t(::sysconf(_SC_PAGESIZE)) + more);
    if (pages > 0) ::setrlimit(RLIMIT_AS, &now);
  }
  ~MemoryCap() { ::setrlimit(RLIMIT_AS, &before_); }
  MemoryCap(const MemoryCap&) = delete;

 private:
  rlimit before_{};
};

/// Threads have address space of their own, which says nothing of the file.
struct OneThread {
  int before = thread_count();
  OneThread() { set_thread_count(1); }
  ~OneThread() { set_thread_count(before); }
};

}  // namespace sg::test

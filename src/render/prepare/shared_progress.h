// SPDX-License-Identifier: Apache-2.0
// Progress of parallel work: chunks end on any thread, callbacks are called from one at a time.
#pragma once
#include <mutex>
#include <string_view>

#include "base/context.h"

namespace sg {

class SharedProgress {
 public:
  SharedProgress(const Context& context, size_t total, std::string_view doing) : context_(context), total_(total), doing_(doing) {}
  /// One of the chunks is done. The last one tells nothing: that is for who knows what comes next.
  void step() {
    if (!context_.on_progress) return;
    const std::lock_guard lock(mutex_);
    if (++done_ < total_) context_.progress(double(done_) / double(total_), doing_);
  }

 private:
  const Context& context_;
  size_t total_, done_ = 0;
  std::string_view doing_;
  std::mutex mutex_;
};

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/unfinished.h"

#include <algorithm>
#include <utility>

namespace sg::serve {

LightSoFar Unfinished::take(const DrawRequest& request, uint64_t picture) {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.request.view == request.view; });
  if (found == kept_.end()) return {};
  const Kept kept = std::move(*found);
  kept_.erase(found);
  const DrawRequest& was = kept.request;
  const bool same = was.width == request.width && was.height == request.height && was.camera == request.camera && kept.picture == picture;
  return same ? kept.so_far : LightSoFar();
}

void Unfinished::keep(const DrawRequest& request, uint64_t picture, LightSoFar so_far) {
  const std::lock_guard lock(mutex_);
  std::erase_if(kept_, [&](const Kept& k) { return k.request.view == request.view; });
  if (so_far.bytes > most_) return;
  kept_.push_back({request, picture, std::move(so_far)});
  uint64_t bytes = 0;
  for (const Kept& k : kept_) bytes += k.so_far.bytes;
  for (; bytes > most_; kept_.pop_front()) bytes -= kept_.front().so_far.bytes;
}

void Unfinished::forget(int view) {
  const std::lock_guard lock(mutex_);
  std::erase_if(kept_, [&](const Kept& k) { return k.request.view == view; });
}

void Unfinished::clear() {
  const std::lock_guard lock(mutex_);
  kept_.clear();
}

}  // namespace sg::serve

// SPDX-License-Identifier: Apache-2.0
// ByteCache: things that can be made again, kept up to a number of bytes; the one not used for longest goes first.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>

namespace sg {

/// Safe from any number of threads; each thing is made once at a time, by the thread that asks first, while others work on. What was
/// handed out lives until its last holder lets go, whether the cache still has it or not. `make` must not start parallel loops: threads
/// that wait for it hold a lock.
template <class T>
class ByteCache {
 public:
  explicit ByteCache(size_t limit) : limit_(limit) {}
  ByteCache(const ByteCache&) = delete;
  ByteCache& operator=(const ByteCache&) = delete;

  struct Stats {
    uint64_t asked = 0, made = 0;
    size_t bytes = 0;  ///< kept now
    size_t most = 0;   ///< ... at most so far
  };

  /// The thing of that key, or make() -> std::pair<std::shared_ptr<const T>, size_t bytes>. What make throws goes to the caller; the
  /// next one tries again.
  template <class F>
  std::shared_ptr<const T> get(uint64_t key, F&& make) {
    std::shared_ptr<Slot> slot;
    {
      const std::lock_guard lock(mutex_);
      ++stats_.asked;
      const auto it = places_.find(key);
      if (it != places_.end()) {
        order_.splice(order_.begin(), order_, it->second);
        slot = it->second->second;
      } else {
        slot = std::make_shared<Slot>();
        order_.emplace_front(key, slot);
        places_[key] = order_.begin();
      }
    }
    const std::lock_guard filling(slot->mutex);
    if (slot->thing) return slot->thing;
    auto [thing, bytes] = make();
    const std::lock_guard lock(mutex_);
    slot->thing = thing;
    ++stats_.made;
    const auto it = places_.find(key);
    if (it == places_.end() || it->second->second != slot) return thing;  // put out meanwhile: it is freed with its holder
    slot->bytes = bytes;
    stats_.bytes += bytes;
    trim(slot.get());
    stats_.most = std::max(stats_.most, stats_.bytes);
    return thing;
  }

  /// Puts out what is beyond the new limit.
  void set_limit(size_t limit) {
    const std::lock_guard lock(mutex_);
    limit_ = limit;
    trim(nullptr);
  }
  size_t limit() const {
    const std::lock_guard lock(mutex_);
    return limit_;
  }
  Stats stats() const {
    const std::lock_guard lock(mutex_);
    return stats_;
  }

 private:
  struct Slot {
    std::mutex mutex;  // held while the thing is made
    std::shared_ptr<const T> thing;
    size_t bytes = 0;
  };
  void trim(const Slot* spared) {
    for (auto it = order_.end(); stats_.bytes > limit_ && it != order_.begin();) {
      --it;
      if (it->second->bytes == 0 || it->second.get() == spared) continue;  // being made
      stats_.bytes -= it->second->bytes;
      places_.erase(it->first);
      it = order_.erase(it);
    }
  }

  mutable std::mutex mutex_;
  size_t limit_;
  std::list<std::pair<uint64_t, std::shared_ptr<Slot>>> order_;  // used last first
  std::unordered_map<uint64_t, typename std::list<std::pair<uint64_t, std::shared_ptr<Slot>>>::iterator> places_;
  Stats stats_;
};

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Memo: results derived from a dataset that are expensive to recompute, for example an index for repeated contouring.
#pragma once
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace sg {

/// Lives with its Dataset (Dataset::memo()). Results never depend on what is in it, only the time they take. Safe from any number
/// of threads.
class Memo {
 public:
  /// How often this was called with `key` before.
  int asked(const std::string& key);
  /// What was kept under the key, or null. A key names one type only.
  template <class T>
  std::shared_ptr<const T> find(const std::string& key) const {
    const std::lock_guard lock(mutex_);
    const auto it = entries_.find(key);
    return it == entries_.end() ? nullptr : std::static_pointer_cast<const T>(it->second.thing);
  }
  /// Keeps an object of that many bytes. When another thread was faster, its thing stays; returns the one that is kept.
  template <class T>
  std::shared_ptr<const T> keep(const std::string& key, T thing, size_t bytes) {
    const std::lock_guard lock(mutex_);
    Entry& e = entries_[key];
    if (!e.thing) e = {std::make_shared<const T>(std::move(thing)), bytes};
    return std::static_pointer_cast<const T>(e.thing);
  }
  /// Of everything that is kept.
  size_t bytes() const;

 private:
  struct Entry {
    std::shared_ptr<const void> thing;
    size_t bytes = 0;
  };
  mutable std::mutex mutex_;
  std::map<std::string, Entry> entries_;
  std::map<std::string, int> counts_;
};

}  // namespace sg

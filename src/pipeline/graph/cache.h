// SPDX-License-Identifier: Apache-2.0
// Cache: results by key. Keeps the most recently used up to a limit of bytes, finds what is still held elsewhere, and lets one thread
// compute what several request at once.
#pragma once
#include <functional>
#include <memory>
#include <optional>

#include "base/context.h"
#include "data/dataset.h"
#include "pipeline/graph/key.h"

namespace sg {

/// Bytes of all buffers that `data` refers to, each counted once however many arrays look into it.
uint64_t data_bytes(const Data& data);

/// Safe from any number of threads.
class Cache {
 public:
  /// `limit` bytes are kept beyond their use; 0 = nothing.
  explicit Cache(uint64_t limit);
  ~Cache();
  Cache(const Cache&) = delete;
  Cache& operator=(const Cache&) = delete;

  /// The result for that key, if it is cached or still held somewhere; counts as a use.
  std::optional<Data> find(const Key& key);
  /// Its bytes when find() would find it; does not count as a use.
  std::optional<uint64_t> peek(const Key& key) const;

  /// find(), or else compute() and remember. While one thread computes, others that request the key wait for it (and stop
  /// waiting when their own context is cancelled). When compute() throws, the error leaves here and a waiting thread computes.
  /// compute() may request other keys, as long as the keys form no cycle.
  Data find_or_compute(const Key& key, Context& context, const std::function<Data()>& compute);

  uint64_t limit() const;
  /// Bytes kept now; buffers that several results share count once.
  uint64_t bytes() const;
  size_t size() const;
  /// Drops the least recently used until at most `limit` bytes are kept.
  void set_limit(uint64_t limit);
  void clear();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sg

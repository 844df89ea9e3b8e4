// SPDX-License-Identifier: Apache-2.0
// A limit on the memory of arrays, kept while the work runs.
#pragma once
#include <cstddef>

namespace sg {

/// From now on the arrays of this process (Buffer::allocate; not mapped files, whose pages the system takes back when it must) may
/// hold this many bytes together; 0 = no limit. One more then throws Error(usage) that says what is in use and what helps.
void set_memory_limit(size_t bytes);
/// What set_memory_limit() said; 0 = nothing.
size_t memory_limit();
/// Bytes that arrays hold now.
size_t array_memory();

namespace detail {
/// Told of every array that its thread allocates while it lives, unless another one was made since: the innermost counts.
class ClaimWatch {
 public:
  ClaimWatch();
  virtual ~ClaimWatch();
  ClaimWatch(const ClaimWatch&) = delete;
  ClaimWatch& operator=(const ClaimWatch&) = delete;
  /// Before memory is asked for; may throw.
  virtual void on_claim(size_t bytes) = 0;

 private:
  ClaimWatch* outer_;
};
/// Called by Buffer::allocate, before and when freed.
void claim_memory(size_t bytes);
void return_memory(size_t bytes) noexcept;
}  // namespace detail

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// A limit on the memory of arrays, kept while the work runs.
#pragma once
#include <cstddef>
#include <string>

namespace sg {

/// From now on the arrays of this process (Buffer::allocate; not mapped files, whose pages the system takes back when it must) may
/// hold this many bytes together; 0 = no limit. Allocating more then throws Error(usage) that says what is in use and what helps.
void set_memory_limit(size_t bytes);
/// The value given to set_memory_limit(); 0 = nothing.
size_t memory_limit();
/// Bytes that arrays hold now.
size_t array_memory();

/// What may be taken together: set_memory_limit(), else half of this machine's memory.
size_t allowed_memory();
/// To be asked before work whose size follows from a few words: throws Error(usage) when `bytes` more than what arrays hold now are beyond
/// allowed_memory(). `what` says what would be made ("1000000000 seeds"), `hint` what to do instead; --memory is mentioned as well.
void need_memory(double bytes, const std::string& what, const std::string& where, const std::string& hint);

namespace detail {
/// Told of every array that its thread allocates while it lives, unless another one was made since: the innermost counts.
class ClaimWatch {
 public:
  ClaimWatch();
  virtual ~ClaimWatch();
  ClaimWatch(const ClaimWatch&) = delete;
  ClaimWatch& operator=(const ClaimWatch&) = delete;
  /// To be called before allocating; may throw.
  virtual void on_claim(size_t bytes) = 0;

 private:
  ClaimWatch* outer_;
};
/// Called by Buffer::allocate, before and when freed.
void claim_memory(size_t bytes);
void return_memory(size_t bytes) noexcept;
}  // namespace detail

}  // namespace sg

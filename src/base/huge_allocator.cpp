// SPDX-License-Identifier: Apache-2.0
#include "base/huge_allocator.h"

#include <sys/mman.h>

#include <cstdlib>

namespace sg {

void* allocate_large(size_t bytes) {
  constexpr size_t huge = size_t(2) << 20;
  const bool large = bytes >= 2 * huge;
  const size_t alignment = large ? huge : 64;
  const size_t rounded = ((bytes ? bytes : 1) + alignment - 1) / alignment * alignment;
  void* p = rounded < bytes ? nullptr : std::aligned_alloc(alignment, rounded);
  if (!p) throw std::bad_alloc();
  if (large) ::madvise(p, rounded, MADV_HUGEPAGE);  // first touch of 4 KiB pages costs 0.4 s per GiB
  return p;
}

void free_large(void* p) noexcept { std::free(p); }

}  // namespace sg

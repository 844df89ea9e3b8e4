// SPDX-License-Identifier: Apache-2.0
// An allocator for large planes of numbers: huge pages, and elements that stay uninitialised until they are written, so that
// the threads that fill them also touch their pages first.
#pragma once
#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace sg {

/// 64-byte aligned memory; from 4 MB on, on huge pages (a hint to the system). Throws std::bad_alloc.
void* allocate_large(size_t bytes);
/// `bytes` as requested. Blocks of a megabyte and more may be kept for the next request of about that size.
void free_large(void* p, size_t bytes) noexcept;
/// How much may be kept; the default is 256 MB. Never more than half of the peak use.
void keep_freed_blocks(size_t bytes);

template <class T>
struct HugeAllocator {
  using value_type = T;
  HugeAllocator() = default;
  template <class U>
  HugeAllocator(const HugeAllocator<U>&) {}
  T* allocate(size_t n) {
    if (n > size_t(-1) / 2 / sizeof(T)) throw std::bad_alloc();
    return static_cast<T*>(allocate_large(n * sizeof(T)));
  }
  void deallocate(T* p, size_t n) noexcept { free_large(p, n * sizeof(T)); }
  /// v.resize(n) leaves new elements as they are; v.assign(n, value) writes them.
  template <class U>
  void construct(U* p) noexcept {
    ::new (static_cast<void*>(p)) U;
  }
  template <class U, class... Args>
  void construct(U* p, Args&&... args) {
    ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
  }
  template <class U>
  friend bool operator==(const HugeAllocator&, const HugeAllocator<U>&) {
    return true;
  }
};

/// std::vector whose resize() does not initialise.
template <class T>
using Plane = std::vector<T, HugeAllocator<T>>;

}  // namespace sg

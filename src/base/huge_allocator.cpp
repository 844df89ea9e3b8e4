// SPDX-License-Identifier: Apache-2.0
#include "base/huge_allocator.h"

#include <sys/mman.h>

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <unordered_map>
#include <vector>

namespace sg {

namespace {

constexpr size_t huge_page = size_t(2) << 20;
constexpr size_t kept_from = size_t(1) << 20, kept_at_most = size_t(256) << 20;

#if defined(__SANITIZE_ADDRESS__)
constexpr bool may_keep = false;  // memory that is used after it was freed must be seen
#else
constexpr bool may_keep = true;
#endif

// Freed blocks whose pages are in memory already. Work that is repeated, a surface for another value or the next frame, writes
// to them at once; pages fresh from the system are cleared first, which takes as long as the work itself. Never more than half of
// what was in use at once, so that the peak of a program that runs once stays what it was.
struct Reserve {
  struct Block {
    void* p;
    size_t bytes;
  };
  std::mutex mutex;
  std::vector<Block> blocks;                 // by size
  std::unordered_map<void*, size_t> in_use;  // blocks that may come back
  size_t kept = 0, used = 0, most_used = 0, limit = kept_at_most;

  // The smallest that fits without wasting more than a quarter; null when there is none.
  void* take(size_t bytes) {
    const std::lock_guard lock(mutex);
    const auto b = std::lower_bound(blocks.begin(), blocks.end(), bytes, [](const Block& x, size_t n) { return x.bytes < n; });
    if (b == blocks.end() || b->bytes > bytes + bytes / 4) return nullptr;
    const Block block = *b;
    blocks.erase(b);
    kept -= block.bytes;
    note(block.p, block.bytes);
    return block.p;
  }
  void add(void* p, size_t bytes) {
    const std::lock_guard lock(mutex);
    note(p, bytes);
  }
  void note(void* p, size_t bytes) {
    in_use.emplace(p, bytes);
    used += bytes;
    most_used = std::max(most_used, used);
  }
  // Keeps the block or says that it must be freed, with those that make room.
  void give(void* p, std::vector<void*>& free_now) {
    const std::lock_guard lock(mutex);
    const auto it = in_use.find(p);
    if (it == in_use.end()) return free_now.push_back(p);
    const size_t bytes = it->second;
    in_use.erase(it);
    used -= bytes;
    const auto at = std::lower_bound(blocks.begin(), blocks.end(), bytes, [](const Block& x, size_t n) { return x.bytes < n; });
    blocks.insert(at, {p, bytes});
    kept += bytes;
    shrink(std::min(limit, most_used / 2), free_now);
  }
  // Small ones are dropped first: a large one saves more.
  void shrink(size_t to, std::vector<void*>& free_now) {
    while (kept > to) {
      const auto victim = blocks.back().bytes > to ? std::prev(blocks.end()) : blocks.begin();
      kept -= victim->bytes;
      free_now.push_back(victim->p);
      blocks.erase(victim);
    }
  }
};

Reserve& reserve() {
  static Reserve* r = new Reserve;  // outlives every array of the program
  return *r;
}

}  // namespace

void* allocate_large(size_t bytes) {
  const bool large = bytes >= 2 * huge_page;
  const size_t alignment = large ? huge_page : 64;
  const size_t rounded = ((bytes ? bytes : 1) + alignment - 1) / alignment * alignment;
  if (rounded < bytes) throw std::bad_alloc();
  const bool keep = may_keep && bytes >= kept_from;
  if (keep)
    if (void* p = reserve().take(rounded)) return p;
  void* p = std::aligned_alloc(alignment, rounded);
  if (!p) throw std::bad_alloc();
  if (large) ::madvise(p, rounded, MADV_HUGEPAGE);  // first touch of 4 KiB pages costs 0.4 s per GiB
  if (keep) reserve().add(p, rounded);
  return p;
}

void free_large(void* p, size_t bytes) noexcept {
  if (!may_keep || bytes < kept_from) return std::free(p);
  std::vector<void*> free_now;
  reserve().give(p, free_now);
  for (void* q : free_now) std::free(q);
}

void keep_freed_blocks(size_t bytes) {
  std::vector<void*> free_now;
  {
    const std::lock_guard lock(reserve().mutex);
    reserve().limit = bytes;
    reserve().shrink(std::min(bytes, reserve().kept), free_now);
  }
  for (void* q : free_now) std::free(q);
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "data/memory/memory_budget.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>

#include "base/error.h"
#include "base/huge_allocator.h"
#include "base/text/text.h"

namespace sg {

namespace {
std::atomic<size_t> limit{0}, in_use{0};
thread_local detail::ClaimWatch* innermost = nullptr;

// Bytes of this machine's memory.
size_t machine_memory() {
  static const size_t bytes = [] {
    const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
    return pages > 0 && page > 0 ? size_t(pages) * size_t(page) : SIZE_MAX;
  }();
  return bytes;
}
}  // namespace

void set_memory_limit(size_t bytes) {
  limit = bytes;
  if (bytes) keep_freed_blocks(0);  // what is kept for later counts for the system
}
size_t memory_limit() { return limit; }
size_t allowed_memory() {
  if (limit) return limit;
  const size_t all = machine_memory();
  return all == SIZE_MAX ? all : all / 2;
}

void need_memory(double bytes, const std::string& what, const std::string& where, const std::string& hint) {
  const size_t most = allowed_memory(), used = in_use;
  if (bytes <= double(most) - double(std::min(used, most))) return;
  const std::string need = human_bytes(uint64_t(std::clamp(bytes, 0.0, 1e18)));
  fail_usage(fmt::format("{} need {}, but {} of the {} allowed are in use", what, need, human_bytes(used), human_bytes(most)), where,
             hint + (hint.empty() ? "" : ", or ") + "allow more with --memory; --explain shows the steps");
}

size_t array_memory() { return in_use; }

detail::ClaimWatch::ClaimWatch() : outer_(std::exchange(innermost, this)) {}
detail::ClaimWatch::~ClaimWatch() { innermost = outer_; }

void detail::claim_memory(size_t bytes) {
  if (innermost) innermost->on_claim(bytes);
  const size_t before = in_use.fetch_add(bytes);
  // Not given: all of the machine's. The system would promise more and end the program when it is used.
  const bool stated = limit != 0;
  const size_t most = stated ? limit.load() : machine_memory();
  if (before <= most && bytes <= most - before) return;
  in_use -= bytes;
  fail_usage(fmt::format("{} more are needed, but {} of the {} {} are in use", human_bytes(bytes), human_bytes(before), human_bytes(most),
                         stated ? "allowed" : "of this machine"),
             "--memory", "read a smaller part (--region, --stride, --fields, --piece), or allow more; --explain shows the steps");
}

void detail::return_memory(size_t bytes) noexcept { in_use -= bytes; }

}  // namespace sg

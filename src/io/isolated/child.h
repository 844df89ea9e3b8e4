// SPDX-License-Identifier: Apache-2.0
// Child processes for libraries that a damaged file may crash, trap in a loop, or make allocate all memory: what they may take, and
// how they ended.
#pragma once
#include <sys/types.h>

#include <functional>
#include <string>
#include <string_view>

#include "base/context.h"

namespace sg {

/// What a child may take.
struct ChildLimits {
  size_t memory = 0;     ///< bytes of address space beyond what this process has
  double processor = 0;  ///< seconds of its processor
  double wall = 0;       ///< seconds from its start, also when it waits for what never comes
};

/// For reading a file of that size: twice what its numbers may fill (plausible_memory(); a larger limit given with --memory applies
/// instead), 256 MiB for the library; 5 s of the processor, one for each 512 MiB of that memory and one for each MiB of the file, or
/// $SIGHTGLASS_READ_SECONDS instead; ten times as long by the clock.
ChildLimits reading_limits(size_t file_bytes);
/// The size of a file, or of all files in a folder; 0 when there is none.
size_t bytes_at(const std::string& path);

/// In the child, first of all: one thread, the system's answers to signals, no core, no output, and the limits.
void become_child(const ChildLimits& limits);

/// Runs `work` in a child (after become_child(); it should end by _exit(), and ends with 0 where it returns) and waits until that ends.
/// Returns waitpid()'s status. Kills it when the context is cancelled or when it has outlived its time; then throws Error(cancelled), or
/// Error(data) naming `path` and what was exceeded.
///
/// A child has copies of all locks, but only one thread: those that another thread of this process holds at the fork (a scheduler's, a
/// library's own) stay locked in it for ever. A child whose threads all wait for locks of its own is started again, so `work` may run more
/// than once, from its begin.
int run_child(const ChildLimits& limits, const std::string& path, const Context& context, const std::function<void()>& work);

/// What is thrown for a child that ran out of its memory.
[[noreturn]] void fail_child_memory(const ChildLimits& limits, const std::string& path);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Reading in a process of its own: for libraries that end the program, or spoil its memory, on damaged files.
#pragma once
#include <functional>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Calls read() in a child process and brings its result here: uniform grids and point clouds with fields and notes, alone or as parts
/// of one collection. Errors and log lines of the child come along; a child that dies gives Error(data) naming `path`. The child has one
/// thread: TBB, and so parallel loops of more than one chunk, must not be used in it. It may use `memory` bytes more than this process,
/// and its processor for 2 s, a second for each 512 MiB of them and one for each 4 MiB of the file.
Data read_isolated(const std::string& path, const std::function<Data(Context&)>& read, size_t memory, Context& context);

/// Calls read() in a child process with one thread, and forgets what it gives or throws. Throws Error(data) naming `path` when the child
/// dies or takes more than a minute of its processor and a second for each 4 MiB of the file: then `library` must not see the file in this
/// process.
void try_in_child(const std::string& path, std::string_view library, const std::function<void()>& read);

}  // namespace sg

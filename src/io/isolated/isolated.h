// SPDX-License-Identifier: Apache-2.0
// Reading in a process of its own: for libraries that end the program, or spoil its memory, on damaged files.
#pragma once
#include <functional>

#include "base/context.h"
#include "data/dataset.h"
#include "io/isolated/child.h"

namespace sg {

/// Calls read() in a child process and brings its result here, whatever it is. Errors and log lines of the child come along; a child that
/// dies, or takes more than `limits`, gives Error(data) naming `path`. The child has one thread: parallel loops of ours run on it, and
/// libraries must not use TBB.
Data read_isolated(const std::string& path, const ChildLimits& limits, const std::function<Data(Context&)>& read, Context& context);
/// With reading_limits() of the file's size.
Data read_isolated(const std::string& path, const std::function<Data(Context&)>& read, Context& context);
/// Time values that are found so.
std::vector<double> times_isolated(const std::string& path, const std::function<std::vector<double>(Context&)>& read, Context& context);

/// Calls read() in a child process with one thread, and forgets what it gives or throws. Throws Error(data) naming `path` when the child
/// dies or takes more than reading_limits(): then `library` must not see the file in this process.
void try_in_child(const std::string& path, std::string_view library, const std::function<void()>& read);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Files that come through a pipe: `info <(command)`, /dev/stdin.
#pragma once
#include <string>

#include "base/context.h"

namespace sg {

/// `path` itself when it names no open stream of this process (/dev/fd/63, /dev/stdin, /proc/self/fd/0). A stream is read to its end into
/// a file in $TMPDIR that is removed when the program ends, at most `most` bytes (Error(data) beyond); its path is returned.
std::string spooled(const std::string& path, size_t most, const Context& context);

/// The text with the names of streams where it names the files that they were read into.
std::string with_stream_names(std::string text);

}  // namespace sg

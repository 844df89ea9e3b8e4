// SPDX-License-Identifier: Apache-2.0
// Calls into the library that crash or stall on damaged files.
#pragma once
#include <functional>
#include <optional>
#include <string>

namespace sg::h5 {

/// What f returns, computed in a child process; nothing when the child crashes, computes for longer than 0.3 s, or throws. HDF5 1.10
/// follows lengths in the global heap and in fill values without a check, and no caller can see them before it does. f may only look: what
/// it changes stays in the child. At most 1 MiB.
std::optional<std::string> guarded(const std::function<std::string()>& f);

}  // namespace sg::h5

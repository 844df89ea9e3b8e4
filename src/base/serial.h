// SPDX-License-Identifier: Apache-2.0
// For children of fork(): they have one thread, whatever the parent's scheduler assumes.
#pragma once

namespace sg {

/// From now on parallel loops of this process run on the calling thread, bypassing the scheduler, whose threads a child process lacks. This
/// cannot be undone.
void run_serially() noexcept;

}  // namespace sg

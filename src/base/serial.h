// SPDX-License-Identifier: Apache-2.0
// For children of fork(): they have one thread, whatever the scheduler of the parent believes.
#pragma once

namespace sg {

/// From now on parallel loops of this process run on the calling thread, without a word to the scheduler, whose threads a child process
/// lacks. There is no way back.
void run_serially() noexcept;

}  // namespace sg

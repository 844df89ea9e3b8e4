// SPDX-License-Identifier: Apache-2.0
// Lines that rounding has frayed or broken. Inside filter/flow/vortex only.
#pragma once
#include <span>

#include "filter/flow/vortex/parallel_vectors.h"

namespace sg::parallel {

/// Next to a vertex of the mesh rounding hides where a line leaves one cell and enters the next: small loops
/// become one point there (the first of them), and ends of different lines that are each other's nearest are joined. `reach`: a length
/// for each point, within which its place is uncertain. Points stay, with no segment where they are not needed.
void mend_lines(ParallelLines& lines, std::span<const double> reach);

}  // namespace sg::parallel

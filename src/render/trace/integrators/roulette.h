// SPDX-License-Identifier: Apache-2.0
// Russian roulette: which paths go on that carry little.
#pragma once
#include <algorithm>

namespace sg::trace {

/// Chance with which a path goes on after `turns` turns at surfaces, where it carries `share` of what it began with: it is divided by
/// that. Paths end by it below a tenth. What ends sooner adds more noise than its rays cost: with white walls that shine, all paths that
/// roulette takes after the third turn by their share make half as much noise again.
inline float chance_to_go_on(float share, int turns) {
  constexpr float least = 0.1f, most = 0.95f;
  constexpr int sure = 8;
  return std::min(turns > sure ? most : 1.f, share / least);
}

}  // namespace sg::trace

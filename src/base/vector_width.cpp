// SPDX-License-Identifier: Apache-2.0
#include "base/vector_targets.h"

#include "base/vector_width.h"

#include <hwy/targets.h>

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "base/error.h"

namespace sg {

void cap_vector_width() {
  const char* set = std::getenv("SG_SIMD");
  const std::string_view word = set ? set : "";
  // A target is a bit; the better it is, the lower.
  if (word == "avx2") hwy::DisableTargets(HWY_AVX2 - 1);
  else if (word == "baseline") hwy::DisableTargets(HWY_SSE4 - 1);
  else if (!word.empty())
    fail_usage("'" + std::string(word) + "' is not a vector width", "SG_SIMD", "use avx2 or baseline, or leave it unset");
}

std::string vector_target() {
  const int64_t usable = hwy::SupportedTargets() & ~int64_t(HWY_DISABLED_TARGETS);
  return hwy::TargetName(usable & -usable);
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "base/vector_targets.h"

#include "base/vector_width.h"

#include <hwy/targets.h>

#include "support/test.h"

using namespace sg;

#if HWY_ARCH_X86
TEST_CASE("vector width: the machine's instruction sets are those that the compiler's own test finds") {
  const int64_t found = hwy::SupportedTargets();
  CHECK(bool(found & HWY_SSSE3) == bool(__builtin_cpu_supports("ssse3")));
  if (found & HWY_SSE4) {
    CHECK(__builtin_cpu_supports("sse4.2"));
    CHECK(__builtin_cpu_supports("popcnt"));
    CHECK(__builtin_cpu_supports("aes"));
    CHECK(__builtin_cpu_supports("pclmul"));
  }
  const bool avx2 =
      __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
  CHECK(bool(found & HWY_AVX2) == avx2);
  const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
  CHECK(bool(found & HWY_AVX3) == avx512);
}

TEST_CASE("vector width: a disabled target is not used, nor one that a test leaves out, and one remains when all are") {
  hwy::DisableTargets(HWY_SSE4 - 1);
  CHECK(!(hwy::SupportedTargets() & (HWY_AVX2 | HWY_AVX3)));
  CHECK(vector_target().find("AVX") == std::string::npos);
  hwy::DisableTargets(-1);
  CHECK(hwy::SupportedTargets() == HWY_STATIC_TARGET);
  hwy::DisableTargets(0);
  hwy::SetSupportedTargetsForTest(HWY_SSE4);
  CHECK(hwy::SupportedTargets() == HWY_SSE4);
  CHECK(!hwy::GetChosenTarget().IsInitialized());
  hwy::SetSupportedTargetsForTest(0);
  CHECK(hwy::SupportedTargets() != 0);
}
#endif

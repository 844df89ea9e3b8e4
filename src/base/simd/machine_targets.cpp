// SPDX-License-Identifier: Apache-2.0
// What Highway asks of the machine, in place of its shared library, which when it is loaded measures the clock for 5 ms: longer than all
// else that the program does before it starts.
#include "base/vector_targets.h"

#include <hwy/targets.h>

#if HWY_ARCH_X86

#include <cpuid.h>

#include <atomic>
#include <cstdint>

namespace {

struct Registers {
  uint32_t a = 0, b = 0, c = 0, d = 0;
};
Registers cpuid(uint32_t leaf) {
  Registers r;
  __get_cpuid_count(leaf, 0, &r.a, &r.b, &r.c, &r.d);  // leaves them 0 for leaves that the machine does not know
  return r;
}

constexpr bool all(uint32_t word, std::initializer_list<int> bits) {
  for (const int bit : bits)
    if (!(word >> bit & 1)) return false;
  return true;
}

// Which registers the operating system keeps when it changes threads: bits of XCR0.
uint32_t kept_registers() {
  uint32_t low = 0, high = 0;
  asm volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return low;
}

// Each target with all that Highway lets its code use. The bits are those of CPUID (Intel 64 and IA-32 manual, volume 2A).
int64_t detect_targets() {
  int64_t targets = HWY_ENABLED_BASELINE;
  const Registers basic = cpuid(1), more = cpuid(7), extended = cpuid(0x80000001);
  const bool ssse3 = all(basic.c, {0, 9});                       // SSE3, SSSE3
  const bool sse4 = ssse3 && all(basic.c, {1, 19, 20, 23, 25});  // PCLMULQDQ, SSE4.1, SSE4.2, POPCNT, AES
  const uint32_t kept = all(basic.c, {27}) ? kept_registers() : 0;
  const bool avx2 = sse4 && all(kept, {1, 2}) && all(basic.c, {12, 28, 29}) && all(more.b, {3, 5, 8}) && all(extended.c, {5});
  const bool avx3 = avx2 && all(kept, {5, 6, 7}) && all(more.b, {16, 17, 28, 30, 31});  // AVX-512 F, DQ, CD, BW, VL
  if (ssse3) targets |= HWY_SSSE3;
  if (sse4) targets |= HWY_SSE4;
  if (avx2) targets |= HWY_AVX2;  // FMA, AVX, F16C; BMI, AVX2, BMI2; LZCNT
  if (avx3) targets |= HWY_AVX3;
  return targets;
}

std::atomic<int64_t> allowed{-1}, pretended{0};

}  // namespace

namespace hwy {

ChosenTarget& GetChosenTarget() {
  static ChosenTarget chosen;
  return chosen;
}

int64_t SupportedTargets() {
  static const int64_t found = detect_targets();
  const int64_t pretending = pretended, targets = (pretending ? pretending : found) & allowed;
  return targets ? targets : HWY_STATIC_TARGET;
}

void DisableTargets(int64_t disabled) {
  allowed = ~disabled;
  GetChosenTarget().DeInit();
}

void SetSupportedTargetsForTest(int64_t targets) {
  pretended = targets;
  GetChosenTarget().DeInit();
}

}  // namespace hwy

#endif

// SPDX-License-Identifier: Apache-2.0
#include "render/volume/engines/packets/gathers.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <vector>

#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/volume/engines/packets/gathers.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/volume/engines/packets/gathers-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// Fetches so many vectors of pairs, each at places that the one before tells.
HWY_NOINLINE float fetch(const float* data, int count, bool loads) {
  const hn::CappedTag<float, 16> d;
  const IntTag<decltype(d)> di;
  auto at = shift_left<4>(hn::Iota(di, 0));
  auto sum = set(d, 0);
  for (int i = 0; i < count; ++i) {
    const auto p = gather_pair(d, data, at, loads), q = gather_pair(d, data + 256, at, loads);
    sum = sum + ((p.a + q.a) + (p.b + q.b));
    at = (at + 37) & 255;
  }
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

bool time_fetches() {
#if SG_HARDWARE_GATHERS
  const std::vector<float> data(1024);
  using Clock = std::chrono::steady_clock;
  int64_t best[2] = {INT64_MAX, INT64_MAX};
  volatile float keep = 0;
  for (int round = 0; round < 6; ++round)
    for (const bool loads : {false, true}) {
      const auto begin = Clock::now();
      keep = keep + fetch(data.data(), 100, loads);
      best[loads] = std::min<int64_t>(best[loads], std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begin).count());
    }
  return best[1] * 10 < best[0] * 9;
#else
  return false;
#endif
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::volume {

HWY_EXPORT(time_fetches);

namespace {
enum Answer : int { unknown, no, yes };
std::atomic<int> answer{unknown};
}  // namespace

bool loads_beat_gathers() {
  if (answer == unknown) {
    int nobody = unknown;
    answer.compare_exchange_strong(nobody, HWY_DYNAMIC_DISPATCH(time_fetches)() ? yes : no);
  }
  return answer == yes;
}

void set_loads_beat_gathers(bool given) { answer = given ? yes : no; }

}  // namespace sg::volume
#endif

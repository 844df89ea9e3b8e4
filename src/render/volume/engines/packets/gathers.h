// SPDX-License-Identifier: Apache-2.0
// How vector lanes fetch numbers from memory: by one gather, or by a load for each lane. The numbers are the same; which way is faster
// depends on the processor (AMD's Zen 4 gathers half as fast as it loads, Intel's Sapphire Rapids does not).
#pragma once

namespace sg::volume {

/// Whether loads are faster here: timed when it is asked for the first time (some hundredths of a millisecond).
bool loads_beat_gathers();
/// From now on that answer, for tests and benchmarks.
void set_loads_beat_gathers(bool answer);

}  // namespace sg::volume

// SPDX-License-Identifier: Apache-2.0
// The instruction sets that vector code is compiled for: AVX-512, AVX2, and one lane at a time for machines without either. Set once here,
// and included before hwy/foreach_target.h. Each additional one multiplies the compile time of every such file.
#pragma once

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)

// SPDX-License-Identifier: Apache-2.0
// Vector width used by this process. Results never depend on it; SG_SIMD in the environment allows checking that.
#pragma once
#include <string>

namespace sg {

/// Caps the vector width as given by SG_SIMD: `avx2` leaves out AVX-512, `baseline` AVX2 too (files that are not compiled for
/// SSE4 compute one lane at a time);
/// unset or empty: no cap. Before the first vector code runs; not thread-safe. Throws Error(usage) for other words.
void cap_vector_width();

/// The instruction set that vector code runs on, by Highway's name: "AVX3" (AVX-512), "AVX2", "SSE2", ...
std::string vector_target();

}  // namespace sg

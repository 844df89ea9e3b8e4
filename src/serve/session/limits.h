// SPDX-License-Identifier: Apache-2.0
// How much a window may ask for (docs/security.md).
#pragma once
#include <chrono>
#include <cstddef>

namespace sg::serve {

inline constexpr int most_views = 4;                              ///< of a window
inline constexpr double most_pixels = 4096.0 * 4096.0;            ///< of a picture
inline constexpr size_t most_questions = 16, most_changes = 256;  ///< of a window that wait
inline constexpr size_t most_waiting = 1 << 20;                   ///< bytes of those messages
inline constexpr size_t most_times = 10000;                       ///< of a field over time
inline constexpr size_t most_saved = 8;                           ///< pictures that are kept for the browser to fetch
/// After which what can wait is done beside what moves.
inline constexpr std::chrono::milliseconds patience{1000};

}  // namespace sg::serve

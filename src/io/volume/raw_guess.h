// SPDX-License-Identifier: Apache-2.0
// What raw numbers without a header may be, by the size in their name ("ball_30x30x30.raw") and their length.
#pragma once
#include <array>
#include <optional>
#include <string>

#include "base/file/file.h"
#include "data/array.h"

namespace sg {

struct RawGuess {
  std::array<size_t, 3> dims{1, 1, 1};
  ElementType type = ElementType::u8;  ///< 1, 2, 4 or 8 bytes a number: u8, i16, f32, f64
  bool big_endian = false;
  /// "30x30x30 i16, little-endian".
  std::string text() const;
};

/// Nothing when the name has no size, or the length is not a multiple of it that fits a type. The byte order is the one in which the
/// numbers look like measurements: floats of usual size, integers that change little from one to the next.
std::optional<RawGuess> guess_raw(const MappedFile& file);

}  // namespace sg

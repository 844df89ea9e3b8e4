// SPDX-License-Identifier: Apache-2.0
// Numbers at given places of their order.
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sg {

/// Bits that rise with the number, and back.
inline uint64_t key_of(double x) {
  const auto bits = std::bit_cast<uint64_t>(x);
  return bits >> 63 ? ~bits : bits | uint64_t(1) << 63;
}
inline double number_of(uint64_t key) { return std::bit_cast<double>(key >> 63 ? key ^ uint64_t(1) << 63 : ~key); }

/// The numbers at these places, which rise, of the order of `v` (finite; -0 counts as 0): by counting digits of 16 bits. O(n), in parallel.
std::vector<double> numbers_in_order(std::span<const double> v, std::span<const size_t> places);

}  // namespace sg

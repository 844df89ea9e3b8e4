// SPDX-License-Identifier: Apache-2.0
// What the processes that share a piece of work come to together. Each of these is a collective call: every rank makes it. Without a
// communicator (null) this process is alone, and gets back what it gave.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "base/communicator.h"

namespace sg {

/// The values of every rank, by rank.
template <class T>
std::vector<std::vector<T>> all_gathered(std::span<const T> mine, const Communicator* communicator) {
  static_assert(std::is_trivially_copyable_v<T>);
  if (!communicator) return {{mine.begin(), mine.end()}};
  std::vector<std::vector<T>> all;
  for (const std::vector<std::byte>& bytes : communicator->all_gather(std::as_bytes(mine))) {
    std::vector<T>& values = all.emplace_back(bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  }
  return all;
}

/// The values of all ranks, one behind the other.
template <class T>
std::vector<T> all_concatenated(std::span<const T> mine, const Communicator* communicator) {
  std::vector<T> r;
  for (const std::vector<T>& values : all_gathered(mine, communicator)) r.insert(r.end(), values.begin(), values.end());
  return r;
}

/// Sums of numbers, element by element in the order of the ranks; all give equally many.
template <class T>
void all_sum(std::span<T> values, const Communicator* communicator) {
  if (!communicator) return;
  const auto all = all_gathered(std::span<const T>(values), communicator);
  std::fill(values.begin(), values.end(), T());
  for (const std::vector<T>& of : all)
    for (size_t i = 0; i < std::min(values.size(), of.size()); ++i) values[i] += of[i];
}
template <class T>
requires std::is_arithmetic_v<T> T all_sum(T value, const Communicator* communicator) {
  all_sum(std::span<T>(&value, 1), communicator);
  return value;
}

template <class T>
T all_least(T value, const Communicator* communicator) {
  for (const T& v : all_concatenated(std::span<const T>(&value, 1), communicator)) value = std::min(value, v);
  return value;
}
template <class T>
T all_most(T value, const Communicator* communicator) {
  for (const T& v : all_concatenated(std::span<const T>(&value, 1), communicator)) value = std::max(value, v);
  return value;
}

}  // namespace sg

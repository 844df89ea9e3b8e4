// SPDX-License-Identifier: Apache-2.0
// Communicator: the processes that share one piece of work, each with its part of the data.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace sg {

/// One rank's view of the others. Anything common to all parts (a range, a sum, a count) must come from all_gather(), combined in rank
/// order, so that all ranks compute the same bytes. A collective call: every rank makes it, in the same order.
class Communicator {
 public:
  virtual ~Communicator() = default;
  virtual int rank() const = 0;  ///< 0 .. size() - 1
  virtual int size() const = 0;
  /// The bytes of every rank, by rank; they may differ in length. Throws Error when a rank is lost.
  virtual std::vector<std::vector<std::byte>> all_gather(std::span<const std::byte> mine) const = 0;
};

}  // namespace sg

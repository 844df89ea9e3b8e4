// SPDX-License-Identifier: Apache-2.0
// Several ranks in one process, each a thread: for tests of what processes do together.
#pragma once
#include <atomic>
#include <barrier>
#include <exception>
#include <functional>
#include <thread>
#include <vector>

#include "base/communicator.h"
#include "base/context.h"
#include "base/error.h"

namespace sg::test {

/// What the ranks of one group share.
class RankGroup {
 public:
  explicit RankGroup(int size) : bytes_(size_t(size)), barrier_(size) {}

  std::vector<std::vector<std::byte>> all_gather(int rank, std::span<const std::byte> mine) {
    bytes_[size_t(rank)].assign(mine.begin(), mine.end());
    barrier_.arrive_and_wait();
    const std::vector<std::vector<std::byte>> all = lost_ ? std::vector<std::vector<std::byte>>{} : bytes_;
    const bool lost = lost_;
    barrier_.arrive_and_wait();
    if (lost) fail_internal("a rank is lost");
    return all;
  }
  /// The others do not wait for this one any longer.
  void leave() {
    lost_ = true;
    barrier_.arrive_and_drop();
  }
  int size() const { return int(bytes_.size()); }

 private:
  std::vector<std::vector<std::byte>> bytes_;
  std::atomic<bool> lost_{false};
  std::barrier<> barrier_;
};

class RankCommunicator : public Communicator {
 public:
  RankCommunicator(RankGroup& group, int rank) : group_(group), rank_(rank) {}
  int rank() const override { return rank_; }
  int size() const override { return group_.size(); }
  std::vector<std::vector<std::byte>> all_gather(std::span<const std::byte> mine) const override { return group_.all_gather(rank_, mine); }

 private:
  RankGroup& group_;
  int rank_;
};

/// Runs f once for each rank, at the same time; throws what the first rank that failed threw.
inline void on_ranks(int size, const std::function<void(int rank, Context& context)>& f) {
  RankGroup group(size);
  std::vector<std::exception_ptr> failed(static_cast<size_t>(size));
  std::vector<std::thread> threads;
  for (int rank = 0; rank < size; ++rank)
    threads.emplace_back([&, rank] {
      const RankCommunicator communicator(group, rank);
      Context context;
      context.communicator = &communicator;
      try {
        f(rank, context);
      } catch (...) {
        failed[size_t(rank)] = std::current_exception();
        group.leave();
      }
    });
  for (std::thread& t : threads) t.join();
  for (const std::exception_ptr& e : failed)
    if (e) std::rethrow_exception(e);
}

}  // namespace sg::test

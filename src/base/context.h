// SPDX-License-Identifier: Apache-2.0
// What a running operation needs from its environment: cancellation, progress, notes, the memory limit.
#pragma once
#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace sg {

class Communicator;
class Dataset;

enum class LogLevel { debug, info, warning };

/// Passed by reference through every operation; the callbacks may be empty. Callbacks are called from one thread at a time.
class Context {
 public:
  std::function<void(LogLevel, std::string_view)> on_log;
  std::function<void(double fraction, std::string_view doing)> on_progress;
  size_t memory_limit = 0;  ///< bytes; 0 = no limit stated
  /// The processes that hold the other parts of the data; null: this one holds all. Not owned. Reductions ask it (base/communicator.h).
  const Communicator* communicator = nullptr;
  /// All parts of the collection of which one is worked on; null: there are no others. Not owned. What is chosen from the data is chosen
  /// from all of them (data/ranks/over_all.h).
  const std::vector<std::shared_ptr<const Dataset>>* parts = nullptr;

  Context() = default;
  /// For one part of larger work: logs to `parent`, stops when it is cancelled, and reports progress between `from` and `to`
  /// of the parent's. `parent` must outlive it.
  Context(const Context& parent, double from, double to);

  /// Asks the running work to stop; safe from any thread and from a signal handler.
  void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed) || (parent_ && parent_->cancelled()); }
  /// Throws Error(cancelled) after cancel().
  void check() const;

  void progress(double fraction, std::string_view doing) const;
  void info(std::string_view text) const { log(LogLevel::info, text); }
  void warn(std::string_view text) const { log(LogLevel::warning, text); }
  void log(LogLevel level, std::string_view text) const;

 private:
  std::atomic<bool> cancelled_{false};
  const Context* parent_ = nullptr;
};

}  // namespace sg

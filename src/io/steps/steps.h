// SPDX-License-Identifier: Apache-2.0
// Series written step by step, as they are computed. When a step has been added it is in its place, and the series can be read: a run that
// is broken off leaves all steps that it had made, and can go on behind them.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"
#include "io/io.h"

namespace sg {

/// What will be written.
struct StepsPlan {
  std::vector<double> times;  ///< ascending
  std::string recipe;         ///< tells series apart: the text that they are made by
  bool resume = false;        ///< go on behind the steps that are there; else the series is begun anew
};

/// Takes the steps of a plan, one after the other.
class StepsWriter {
 public:
  virtual ~StepsWriter() = default;
  /// How many steps of the plan are there; the next one to add.
  size_t done() const { return done_; }
  /// Throws Error(usage) for data that the format cannot hold, Error(data) where it cannot be written.
  void add(const Data& data, Context& context);
  /// After the last step.
  virtual void finish() {}

 protected:
  explicit StepsWriter(StepsPlan plan) : plan_(std::move(plan)) {}
  virtual void write(size_t step, const Data& data, Context& context) = 0;

  StepsPlan plan_;
  size_t done_ = 0;
};

/// Whether a file of this name holds a series: a numbered one ("flow_{n}.vtu", of any format that is written), or one of a format with
/// time.
bool holds_steps(const std::string& path);
/// Throws Error(usage) for names that hold no series, and with `resume` where another series is there.
std::unique_ptr<StepsWriter> write_steps(const std::string& path, StepsPlan plan, const WriteOptions& options, Context& context);

/// For writers that resume: the number of steps that are there. Throws Error(usage) naming `path` where they are not the first of the plan,
/// or of another recipe.
size_t steps_there(const std::vector<double>& times, const std::string& recipe, const StepsPlan& plan, const std::string& path);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Time series that a program lends instead of files: a function that gives a step when it is asked for. Each has a path of its own
// ("series:1"), which read_data() and file_times() take, so everything that reads files over time does.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "io/io.h"

namespace sg {

/// Step `number` of a lent series, 0 first. What it throws ends the work.
using LoadStep = std::function<Data(size_t number, Context& context)>;

/// A series is known by its path as long as this is held. A path is never used twice in a process.
class LentSeries {
 public:
  /// Throws Error(usage) for no times, and for times that do not grow.
  LentSeries(std::vector<double> times, LoadStep load);
  ~LentSeries();
  LentSeries(const LentSeries&) = delete;
  LentSeries& operator=(const LentSeries&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Whether it is the path of a series that is, or was, lent.
bool is_lent(const std::string& path);
/// Throw Error(usage) when nobody holds the series any more. The step gets the time of the series where it has none.
std::vector<double> lent_times(const std::string& path);
Data read_lent(const std::string& path, const ReadOptions& options, Context& context);

}  // namespace sg

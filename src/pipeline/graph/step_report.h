// SPDX-License-Identifier: Apache-2.0
// What a step did and how long it took, for --verbose.
#pragma once
#include <chrono>
#include <string>

#include "data/dataset.h"

namespace sg {

/// Measures from its making on.
class StopWatch {
 public:
  /// "12.5 ms", "3.07 s": three digits that count.
  std::string text() const;
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// "surface of 120 points and 80 cells", "3 parts of 40 points and 12 cells in all", "table of 4 columns and 10 rows".
std::string result_text(const Data& data);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// A field over time at one place, as far as it is known.
#pragma once
#include <chrono>
#include <string>
#include <vector>

#include "base/text/json.h"
#include "pipeline/film/film_times.h"

namespace sg::serve {

/// It is asked for time by time, so that other questions are answered in between; edits meanwhile do not change it.
struct TimeCurve {
  PipelineFile file;
  FilmTimes film;
  std::vector<Json> values;  ///< of the first times
  std::vector<Json> gaps;    ///< times that could not be read: {"time", "text"}
  std::string unit;
  std::chrono::steady_clock::time_point told;    ///< how far it is
  std::chrono::steady_clock::duration spent{0};  ///< on the times so far
};

}  // namespace sg::serve

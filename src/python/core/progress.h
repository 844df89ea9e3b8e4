// SPDX-License-Identifier: Apache-2.0
// Long work tells how far it is, in a terminal or a notebook.
#pragma once
#include <chrono>
#include <mutex>
#include <string>

#include "api/sightglass.h"

namespace sightglass::python {

/// Whether calls from now on tell it; off at first (_progress.py switches it on where somebody can see it).
void show_progress(bool on);

/// Tells the progress of one call to sightglass._progress, from half a second on and at most ten times a second.
class Progress {
 public:
  explicit Progress(Context& context);
  ~Progress();  ///< under the interpreter's lock
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

 private:
  void tell(double fraction, std::string_view doing);

  using Clock = std::chrono::steady_clock;
  Clock::time_point begin_, next_;
  bool told_ = false;
};

}  // namespace sightglass::python

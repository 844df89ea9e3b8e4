// SPDX-License-Identifier: Apache-2.0
#include "python/core/progress.h"

#include <pybind11/pybind11.h>

#include <atomic>

namespace sightglass::python {

namespace py = pybind11;

namespace {

std::atomic<bool> shown{false};

// What goes wrong in telling must not end the work.
template <class... A>
void call_python(const char* function, A&&... a) {
  try {
    py::module_::import("sightglass._progress").attr(function)(std::forward<A>(a)...);
  } catch (py::error_already_set& e) {
    e.discard_as_unraisable("sightglass: telling the progress");
    shown = false;
  }
}

}  // namespace

void show_progress(bool on) { shown = on; }

Progress::Progress(Context& context) : begin_(Clock::now()), next_(begin_ + std::chrono::milliseconds(500)) {
  if (shown) context.on_progress([this](double fraction, std::string_view doing) { tell(fraction, doing); });
}

Progress::~Progress() {
  if (told_) call_python("end");
}

// From one thread at a time, which may be any.
void Progress::tell(double fraction, std::string_view doing) {
  const auto now = Clock::now();
  if (now < next_ || !shown) return;
  next_ = now + std::chrono::milliseconds(100);
  told_ = true;
  const py::gil_scoped_acquire lock;
  call_python("show", fraction, std::string(doing), std::chrono::duration<double>(now - begin_).count());
}

}  // namespace sightglass::python

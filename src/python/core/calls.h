// SPDX-License-Identifier: Apache-2.0
// Long work from Python: without the interpreter's lock, with its messages, and stopped by Ctrl-C.
#pragma once
#include <pybind11/pybind11.h>

#include <string>
#include <utility>
#include <vector>

#include "api/sightglass.h"
#include "python/core/progress.h"

namespace sightglass::python {

/// While it lives, Ctrl-C cancels the context, if this is the thread that Python gives signals to. Before it ends Python's own handler has
/// been told, so that KeyboardInterrupt follows.
class Interruptible {
 public:
  explicit Interruptible(const Context& context);
  ~Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

 private:
  bool active_ = false;
};
/// Called once when the module is loaded, by the thread that does it.
void remember_main_thread();

/// What the work says, given to Python's logging and warnings afterwards.
class Messages {
 public:
  explicit Messages(Context& context) {
    context.on_message([this](bool warning, std::string_view text) { said_.emplace_back(warning, text); });
  }
  void deliver() const;

 private:
  std::vector<std::pair<bool, std::string>> said_;
};

/// f(context) without the interpreter's lock.
template <class F>
auto call(F&& f) {
  Context context;
  const Messages messages(context);
  const Progress progress(context);
  const auto work = [&] {
    const Interruptible here(context);
    const pybind11::gil_scoped_release unlocked;
    return f(context);
  };
  try {
    auto r = work();
    messages.deliver();
    return r;
  } catch (const Error& e) {
    if (e.kind() == Error::Kind::cancelled && PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
    messages.deliver();
    throw;
  }
}

}  // namespace sightglass::python

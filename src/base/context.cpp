// SPDX-License-Identifier: Apache-2.0
#include "base/context.h"

#include "base/error.h"

namespace sg {

Context::Context(const Context& parent, double from, double to)
    : memory_limit(parent.memory_limit), communicator(parent.communicator), parts(parent.parts), parent_(&parent) {
  if (parent.on_log) on_log = [&parent](LogLevel level, std::string_view text) { parent.on_log(level, text); };
  if (parent.on_progress)
    on_progress = [&parent, from, to](double fraction, std::string_view doing) {
      parent.on_progress(from + (to - from) * fraction, doing);
    };
}

void Context::check() const {
  if (cancelled()) throw Error(ErrorKind::cancelled, "cancelled");
}
void Context::progress(double fraction, std::string_view doing) const {
  if (on_progress) on_progress(fraction, doing);
}
void Context::log(LogLevel level, std::string_view text) const {
  if (on_log) on_log(level, text);
}

}  // namespace sg

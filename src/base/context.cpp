// SPDX-License-Identifier: Apache-2.0
#include "base/context.h"

#include "base/error.h"

namespace sg {

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

// SPDX-License-Identifier: Apache-2.0
#include "serve/session/problem.h"

#include <fmt/core.h>

#include <new>

#include "base/text/utf8.h"

namespace sg::serve {

std::string problem_of(const std::exception& e) {
  return dynamic_cast<const std::bad_alloc*>(&e) ? "that needs more memory than there is; ask for less" : e.what();
}

std::string took_too_long(std::chrono::milliseconds longest) {
  return fmt::format(
      "this took longer than {:g} s, the most that one picture, question or edit may take here; ask for less, or start the server with a "
      "larger --most-seconds",
      std::chrono::duration<double>(longest).count());
}

std::string reading_took_too_long(const std::string& what, std::chrono::milliseconds longest) {
  return fmt::format("reading '{}' took longer than {:g} s, the most that it may take here; start the server with a larger --most-seconds",
                     printable(what), std::chrono::duration<double>(longest).count());
}

}  // namespace sg::serve

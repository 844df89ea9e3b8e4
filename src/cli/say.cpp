// SPDX-License-Identifier: Apache-2.0
#include "cli/say.h"

#include <cstdio>

#include "base/text/utf8.h"
#include "cli/spool.h"

namespace sg {

void say(const std::string& text) {
  const std::string shown = printable(with_stream_names(text), true);
  std::fwrite(shown.data(), 1, shown.size(), stdout);
}

void say_error(const std::string& text) {
  std::string line = with_stream_names(text);
  for (char& c : line)
    if (c == '\n' || c == '\r') c = ' ';
  line = printable(line) + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);
}

}  // namespace sg

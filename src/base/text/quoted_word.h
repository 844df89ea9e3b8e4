// SPDX-License-Identifier: Apache-2.0
// quoted_word: a word as quoted_words() takes it apart again.
#pragma once
#include <string>

namespace sg {

/// In quotes where it has blanks or quotes. One with both kinds of quotes cannot be written.
inline std::string quoted_word(const std::string& w) {
  if (w.find_first_of(" \t\r\n'\"") == w.npos) return w;
  return w.find('\'') == w.npos ? "'" + w + "'" : '"' + w + '"';
}

}  // namespace sg

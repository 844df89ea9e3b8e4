// SPDX-License-Identifier: Apache-2.0
#include "serve/session/edits/edit_words.h"

#include "base/error.h"
#include "base/text/utf8.h"

namespace sg::serve {

void set_words(const std::string& at, const Json& set, Schema& schema, std::vector<std::string>& words,
               std::vector<EditMistake>& mistakes) {
  for (const auto& [name, value] : set.members()) {
    const std::string key = bytes_of_text(name);
    if (key.empty() || key.find('=') != key.npos || !(value.is_text() || value.is_null())) {
      mistakes.push_back({at, key, "a word has a name and, as text, a value"});
      continue;
    }
    const std::string written = bytes_of_text(value.text());
    if (value.is_text()) {
      try {
        set_param(schema, key, written, "");
      } catch (const Error& e) {
        mistakes.push_back({at, key, e.what()});
        continue;
      }
    }
    std::erase_if(words, [&](const std::string& w) { return std::string_view(w).substr(0, w.find('=')) == key; });
    if (value.is_text()) words.push_back(key + "=" + written);
  }
}

EditMistake mistake_of_set(const std::string& at, const Json& set, const std::string& text) {
  return {at, set.size() == 1 ? bytes_of_text(set.members()[0].first) : std::string(), text};
}

}  // namespace sg::serve

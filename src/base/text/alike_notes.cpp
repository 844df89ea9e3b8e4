// SPDX-License-Identifier: Apache-2.0
#include "base/text/alike_notes.h"

#include <fmt/core.h>

#include <algorithm>

namespace sg {

namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_figure(char c) { return c >= '0' && c <= '9'; }

// The text with '#' for each number, but for those in quotes and in words, which are names.
std::string form_of(std::string_view text) {
  std::string form;
  bool quoted = false;
  for (size_t i = 0; i < text.size();) {
    if (text[i] == '\'') quoted = !quoted;
    const bool begins = !quoted && is_figure(text[i]) && (i == 0 || !is_letter(text[i - 1]));
    if (!begins) {
      form += text[i++];
      continue;
    }
    while (!form.empty() && form.back() == '-') form.pop_back();
    for (; i < text.size(); ++i) {
      const bool exponent =
          (text[i] == 'e' || text[i] == 'E') && i + 1 < text.size() &&
          (is_figure(text[i + 1]) || ((text[i + 1] == '-' || text[i + 1] == '+') && i + 2 < text.size() && is_figure(text[i + 2])));
      const bool point = text[i] == '.' && i + 1 < text.size() && is_figure(text[i + 1]);
      if (exponent && !is_figure(text[i + 1])) ++i;
      else if (!exponent && !point && !is_figure(text[i])) break;
    }
    form += '#';
  }
  return form;
}

}  // namespace

void AlikeNotes::add(LogLevel level, std::string_view text) {
  std::string form = form_of(text);
  const auto at = std::find_if(kinds_.begin(), kinds_.end(), [&](const Kind& k) { return k.level == level && k.form == form; });
  if (at == kinds_.end()) kinds_.push_back({level, std::move(form), {std::string(text)}});
  else if (std::find(at->texts.begin(), at->texts.end(), text) == at->texts.end()) at->texts.emplace_back(text);
}

void AlikeNotes::tell(const Context& context) const {
  for (const Kind& k : kinds_) {
    const size_t more = k.texts.size() - 1;
    context.log(k.level, more == 0 ? k.texts[0] : fmt::format("{} ({} more of this kind, with other numbers)", k.texts[0], more));
    for (size_t i = 1; i < k.texts.size(); ++i) context.log(LogLevel::debug, k.texts[i]);
  }
}

}  // namespace sg

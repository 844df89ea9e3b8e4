// SPDX-License-Identifier: Apache-2.0
#include "cli/hints/loose_words.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "io/file_series.h"

namespace sg {

namespace {

constexpr std::array of_keys = {"-f", "--filter", "-s", "--source", "--show", "--camera", "--picture", "--legend"};
constexpr std::array of_prose = {"--title", "--note", "--field"};

template <class List>
bool is_among(const List& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

bool names_files(const std::string& word) {
  if (file_exists(word)) return true;
  if (!names_series(word)) return false;
  try {
    return !series_files(word).empty();
  } catch (const Error&) {
    return false;
  }
}

// "values=1,2": a key such as parameters have, and no file.
bool is_key_and_value(const std::string& word) {
  const size_t equals = word.find('=');
  if (equals == word.npos || equals == 0) return false;
  const auto in_key = [](char c) { return c == '_' || c == '.' || (c >= '0' && c <= '9') || ((c | 32) >= 'a' && (c | 32) <= 'z'); };
  return std::all_of(word.begin(), word.begin() + std::ptrdiff_t(equals), in_key) && !names_files(word);
}

// A word of a sentence; what has a folder or a suffix is a file that is not there.
bool is_prose(const std::string& word) {
  return word.find('/') == word.npos && extension_of(word).empty() && !names_series(word) && !names_files(word);
}

std::string in_quotes(const std::string& text) {
  const char mark = text.find('\'') == text.npos ? '\'' : '"';
  return mark + text + mark;
}

// An option, and its text with the words that were meant for it.
struct Meant {
  std::string option, text;
  bool keys = false, prose = false;
  std::string loose;  ///< the first of these words; "" = none

  bool takes(const std::string& word) const {
    if (keys && is_key_and_value(word)) return true;
    return (prose || (keys && text.ends_with(','))) && is_prose(word);  // "values=1, 2"
  }
  void add(const std::string& word) {
    text += (keys && text.ends_with(',') ? "" : " ") + word;
    if (loose.empty()) loose = word;
  }
};

// The option before the first of the inputs that is a loose word, with all words that follow it.
Meant meant_in(const std::vector<std::string>& args, const std::vector<std::string>& inputs) {
  Meant now;
  for (size_t i = 0; i < args.size(); ++i) {
    const std::string& arg = args[i];
    if (arg.size() > 1 && arg[0] == '-' && !parse_double(arg)) {
      if (!now.loose.empty()) return now;
      const size_t equals = arg.starts_with("--") ? arg.find('=') : arg.npos;
      const std::string name = arg.substr(0, equals);
      now = {name, "", is_among(of_keys, name), is_among(of_prose, name), ""};
      if (equals != arg.npos) now.text = arg.substr(equals + 1);
      else if ((now.keys || now.prose) && i + 1 < args.size()) now.text = args[++i];
    } else if (is_among(inputs, arg) && now.takes(arg)) {
      now.add(arg);
    }
  }
  return now.loose.empty() ? Meant() : now;
}

}  // namespace

void refuse_loose_words(const std::vector<std::string>& args, const std::vector<std::string>& inputs, const std::string& command) {
  const std::string where = "sightglass " + command;
  if (const Meant m = meant_in(args, inputs); !m.loose.empty())
    fail_usage(fmt::format("there is no file '{}'", m.loose), where,
               fmt::format("several words of {} stand in quotes: {} {}", m.option, m.option, in_quotes(m.text)));
  for (const std::string& input : inputs)
    if (is_key_and_value(input))
      fail_usage(fmt::format("there is no file '{}'", input), where,
                 fmt::format("words of an operation or a way to show stand in quotes with it, like -f 'contour {}'", input));
}

}  // namespace sg

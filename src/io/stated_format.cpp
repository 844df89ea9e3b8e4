// SPDX-License-Identifier: Apache-2.0
#include "io/stated_format.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"

namespace sg {

namespace {

std::string first_extension(const Format& f) {
  const std::vector<std::string_view> all = words(f.extensions);
  return all.empty() ? std::string(f.name) : std::string(all[0]);
}

}  // namespace

bool is_called(const Format& f, std::string_view word) {
  std::string_view bare = word;
  if (bare.size() > 1 && bare[0] == '.') bare.remove_prefix(1);
  const std::string lower = to_lower(bare);
  if (lower == to_lower(f.name)) return true;
  const std::vector<std::string_view> all = words(f.extensions);
  return std::find(all.begin(), all.end(), lower) != all.end();
}

void check_stated_format(const std::string& word) {
  if (word.empty()) return;
  std::vector<std::string> names;
  for (const Format& f : formats()) {
    if (!f.read) continue;
    if (is_called(f, word)) return;
    for (const std::string_view e : words(f.extensions))
      if (std::find(names.begin(), names.end(), e) == names.end()) names.emplace_back(e);
    if (f.extensions.empty()) names.emplace_back(f.name);
  }
  fail_usage(fmt::format("'{}' is not a format", word), "format of the input", unknown_name_hint(to_lower(word), names));
}

const Format& stated_format(const std::string& word, std::span<const std::byte> whole, const std::string& path) {
  const std::span<const std::byte> head = whole.subspan(0, std::min<size_t>(whole.size(), 4096));
  const Format* named = nullptr;
  for (const Format& f : formats())
    if (f.read && is_called(f, word)) {
      if (f.sniff && f.sniff(head)) return f;
      if (!named) named = &f;
    }
  for (const Format& f : formats())
    if (f.read && is_called(f, word) && f.sniff_file && f.sniff_file(whole)) return f;
  for (const Format& f : formats())
    if (f.read && is_called(f, word) && !f.sniff && !f.sniff_file && !f.sniff_folder) return f;
  fail_data(fmt::format("is stated to be {}, but its content is not", named ? named->name : word), path, recognized_hint(whole));
}

const Format* recognized(std::span<const std::byte> whole) {
  for (const Format& f : formats())
    if (f.recognize && f.recognize(whole)) return &f;
  return nullptr;
}

std::string telling_extension(const std::string& path, const std::string& stated) {
  const std::string own = extension_of(path);
  for (const Format& f : formats())
    if (is_called(f, stated.empty() ? own : stated)) return stated.empty() ? own : first_extension(f);
  if (!file_exists(path) || is_folder(path)) return own;
  try {
    return first_extension(find_format(path, {}));
  } catch (const Error&) {  // whoever reads it says what is wrong
    return own;
  }
}

std::string recognized_hint(std::span<const std::byte> whole) {
  const Format* f = recognized(whole);
  return f ? fmt::format("its content looks like {}: format={} (--input-format {})", f->name, first_extension(*f), first_extension(*f))
           : "";
}

}  // namespace sg

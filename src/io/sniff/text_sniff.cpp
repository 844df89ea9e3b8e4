// SPDX-License-Identifier: Apache-2.0
// How to know texts without a magic number, where no name tells what they are (standard input): by what their first lines have in
// common. Each asks for more than its reader does, so that other texts are refused rather than misread.
#include <algorithm>
#include <array>
#include <cstring>

#include "base/bytes.h"
#include "base/text/text.h"
#include "io/formats.h"

namespace sg {

namespace {

constexpr size_t looked_at = 1 << 14;

// The whole lines of the beginning, without a byte order mark; "" where a byte is none of a text.
std::string_view first_lines(std::span<const std::byte> whole) {
  std::string_view text(reinterpret_cast<const char*>(whole.data()), std::min(whole.size(), looked_at));
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  if (whole.size() > looked_at) text = text.substr(0, text.rfind('\n') + 1);  // without the cut one; none where npos + 1 is 0
  for (const char c : text)
    if (uint8_t(c) < 32 && c != '\n' && c != '\r' && c != '\t' && c != '\f') return {};
  return text;
}

// f(line) for each that is not blank, until it is false.
template <class F>
void for_lines(std::string_view text, F&& f) {
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (!trim(line).empty() && !f(line)) return;
  }
}

bool is_number_at(const std::vector<std::string_view>& w, size_t i) { return i < w.size() && parse_double(w[i]).has_value(); }

// The number of cells that a delimiter makes, and whether one of them is a number; quotes keep what is in them together.
size_t count_cells(std::string_view line, char delimiter, bool& number) {
  size_t cells = 0, begin = 0;
  bool quoted = false;
  for (size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    if (i < line.size() && (quoted || line[i] != delimiter)) continue;
    number = number || parse_double(trim(line.substr(begin, i - begin))).has_value();
    begin = i + 1, ++cells;
  }
  return cells;
}

// The text behind blanks where it begins as JSON does: { or [, then what may follow.
std::string_view json_beginning(std::span<const std::byte> whole) {
  const std::string_view text = trim(first_lines(whole.subspan(0, std::min(whole.size(), looked_at))));
  if (text.size() < 2 || (text[0] != '{' && text[0] != '[')) return {};
  const std::string_view inside = trim(text.substr(1));
  if (inside.empty() || inside[0] == '"') return text;
  return text[0] == '[' && (inside[0] == '{' || inside[0] == '[') ? text : std::string_view();
}

}  // namespace

bool looks_like_stl(std::span<const std::byte> whole) {
  constexpr size_t header = 84, triangle = 50;
  if (whole.size() > header && load<uint32_t>(whole.data() + 80) == (whole.size() - header) / triangle &&
      (whole.size() - header) % triangle == 0)
    return true;
  size_t line_count = 0;
  bool solid = false, facet = false;
  for_lines(first_lines(whole), [&](std::string_view line) {
    const std::string first = to_lower(words(line)[0]);
    if (line_count++ == 0) solid = first == "solid";
    facet = first == "facet";
    return solid && !facet && line_count < 20;  // names may take several lines
  });
  return solid && facet;
}

// Every line is a statement of OBJ, and one is a vertex.
bool looks_like_obj(std::span<const std::byte> whole) {
  constexpr std::array known = {"v", "vt", "vn", "vp", "f", "l", "p", "o", "g", "s", "mtllib", "usemtl", "usemap"};
  bool all = true, vertex = false, continued = false;
  for_lines(first_lines(whole), [&](std::string_view line) {
    const bool is_rest = continued;
    continued = line.ends_with('\\');
    const std::vector<std::string_view> w = words(line);
    if (is_rest || w[0].starts_with('#')) return true;
    if (std::find(known.begin(), known.end(), w[0]) == known.end()) all = false;
    if (w[0] == "v") vertex = true, all = all && is_number_at(w, 1) && is_number_at(w, 2) && is_number_at(w, 3);
    return all;
  });
  return all && vertex;
}

// Two lines or more of equally many cells, and numbers below the first.
bool looks_like_csv(std::span<const std::byte> whole) {
  const std::string_view text = first_lines(whole);
  for (const char delimiter : {',', '\t', ';', '|'}) {
    size_t lines = 0, cells = 0;
    bool same = true, number = false;
    for_lines(text, [&](std::string_view line) {
      bool any = false;
      const size_t n = count_cells(line, delimiter, any);
      if (lines++ == 0) cells = n;
      else same = n == cells, number = number || any;
      return same && cells > 1;
    });
    if (same && number && lines > 1 && cells > 1) return true;
  }
  return false;
}

bool looks_like_gltf(std::span<const std::byte> whole) {
  const std::string_view text = json_beginning(whole);
  return text.starts_with('{') && text.find("\"asset\"") != text.npos && text.find("\"version\"") != text.npos;
}

bool looks_like_json(std::span<const std::byte> whole) { return !json_beginning(whole).empty() && !looks_like_gltf(whole); }

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/report/picture_notes.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/schema/schema.h"
#include "base/text/text.h"
#include "color/parse_color.h"

namespace sg {

namespace {

constexpr const char* owner = "picture note";

// What may follow the place.
struct NoteWords {
  double size = 1;
  std::string color;
};
void describe(Schema& s, NoteWords& p) {
  s("size", p.size, "Size of the letters, in those of the legends.").range(0.2, 10);
  s("color", p.color, "Colour of the letters.");
}

std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts(1);
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size() && text[i + 1] == ';') parts.back() += text[++i];
    else if (text[i] == ';') parts.emplace_back();
    else parts.back() += text[i];
  }
  return parts;
}

void take_place(const std::string& place, PictureNote& note) {
  if (const auto named = value_of_word<NotePlace>(place)) {
    note.place = *named;
    return;
  }
  const auto numbers = split(place, ',');
  const auto share = [&](size_t i) { return numbers.size() == 2 ? parse_double(trim(numbers[i])).value_or(-1) : -1; };
  const double x = share(0), y = share(1);
  if (!(x >= 0 && x <= 1 && y >= 0 && y <= 1)) {
    std::vector<std::string_view> names;
    for (const auto& w : enum_words(NotePlace())) names.push_back(w.word);
    fail_usage(fmt::format("'{}' is not a place in the picture", place), owner,
               fmt::format("write shares of its width and height from the top left, e.g. 0.1,0.9, or one of {}", fmt::join(names, ", ")));
  }
  note.at = Vec2{x, y};
}

PictureNote note_of(const std::string& part) {
  PictureNote note;
  const size_t at = part.rfind('@');
  note.text = trim(std::string_view(part).substr(0, at));
  if (note.text.empty()) fail_usage(fmt::format("'{}' has no text", trim(part)), owner, "write e.g. note='Inlet @ 0.1,0.9'");
  if (at == part.npos) return note;
  std::string place;
  std::vector<std::string> words;
  for (const std::string& w : quoted_words(std::string_view(part).substr(at + 1))) {
    if (w.find('=') == w.npos) place += w;
    else words.push_back(w);
  }
  take_place(place, note);
  NoteWords stated;
  Schema schema = schema_of(stated);
  set_params(schema, words, owner);
  note.size = stated.size;
  if (!stated.color.empty()) note.color = parse_color(stated.color, owner);
  return note;
}

}  // namespace

std::vector<PictureNote> parse_notes(const std::string& text) {
  constexpr size_t most = 100;
  std::vector<PictureNote> notes;
  for (const std::string& part : parts_of(text))
    if (!trim(part).empty()) notes.push_back(note_of(part));
  if (notes.size() > most) fail_usage(fmt::format("{} texts are stated", notes.size()), owner, fmt::format("at most {} have room", most));
  return notes;
}

}  // namespace sg

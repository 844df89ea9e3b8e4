// SPDX-License-Identifier: Apache-2.0
#include "data/fields/axis_notes.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/text/text.h"
#include "data/patient/patient_frame.h"

namespace sg {

namespace {

constexpr std::string_view flat = " (drawn flat)";  // degrees are drawn as lengths
constexpr std::string_view positive_words = ", positive ";

std::string note_name(int axis) { return fmt::format("{} axis", "xyz"[axis]); }

bool is_pressure(std::string_view unit) {
  static constexpr std::string_view known[] = {"pa",        "hpa", "kpa",  "mb",      "mbar",  "millibar",
                                               "millibars", "bar", "dbar", "decibar", "pascal"};
  return std::find(std::begin(known), std::end(known), to_lower(std::string(unit))) != std::end(known);
}

// "degrees_east", "degree_E", "degrees_north" as words.
std::string spoken(const std::string& unit) {
  static constexpr std::pair<std::string_view, std::string_view> directions[] = {{"_east", " east"},   {"_e", " east"},  {"e", " east"},
                                                                                 {"_north", " north"}, {"_n", " north"}, {"n", " north"}};
  const std::string lower = to_lower(unit);
  for (const std::string_view degrees : {"degrees", "degree"})
    if (lower.starts_with(degrees))
      for (const auto& [suffix, words] : directions)
        if (lower.substr(degrees.size()) == suffix) return "degrees" + std::string(words);
  return unit;
}

}  // namespace

bool AxisNote::down() const {
  if (!positive.empty()) return to_lower(positive) == "down";
  return is_pressure(unit) || to_lower(name).starts_with("depth");
}

std::string AxisNote::title() const { return unit.empty() ? name : fmt::format("{} [{}]", name, spoken(unit)); }

void note_axis(std::vector<std::pair<std::string, std::string>>& notes, int axis, const AxisNote& note) {
  std::string text = note.name;
  if (!note.unit.empty()) text += ", " + note.unit;
  if (!note.positive.empty()) text.append(positive_words).append(note.positive);
  if (note.in_degrees()) text += flat;
  notes.emplace_back(note_name(axis), text);
}

std::string length_unit(const Dataset& data) {
  for (const auto& [key, text] : data.notes())
    if (key == "length unit") return text;
  return in_patient_frame(data) ? "mm" : "";
}

std::optional<AxisNote> axis_note(const Dataset& data, int axis) {
  for (const auto& [key, value] : data.notes()) {
    if (key != note_name(axis)) continue;
    std::string_view text = value;
    AxisNote note;
    if (text.ends_with(flat)) text.remove_suffix(flat.size());
    if (const size_t at = text.rfind(positive_words); at != text.npos) {
      note.positive = text.substr(at + positive_words.size());
      text = text.substr(0, at);
    }
    const size_t comma = text.find(", ");
    note.name = text.substr(0, comma);
    if (comma != text.npos) note.unit = text.substr(comma + 2);
    return note;
  }
  return {};
}

}  // namespace sg

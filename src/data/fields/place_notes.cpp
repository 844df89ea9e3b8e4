// SPDX-License-Identifier: Apache-2.0
#include "data/fields/place_notes.h"

#include <algorithm>
#include <array>

#include "data/patient/patient_frame.h"

namespace sg {

namespace {

using Notes = std::vector<std::pair<std::string, std::string>>;

bool is_of_place(const std::pair<std::string, std::string>& note) {
  constexpr std::array<std::string_view, 6> names{"space", stored_space_note, "length unit", "x axis", "y axis", "z axis"};
  return std::find(names.begin(), names.end(), note.first) != names.end();
}

}  // namespace

Data with_place_of(const Dataset& from, Data result) {
  Notes of_place;
  std::copy_if(from.notes().begin(), from.notes().end(), std::back_inserter(of_place), is_of_place);
  const auto lacks = [](const DatasetPtr& d) { return std::none_of(d->notes().begin(), d->notes().end(), is_of_place); };
  bool some = false;
  for_each_dataset(result, [&](const std::string&, const DatasetPtr& d) { some = some || lacks(d); });
  if (of_place.empty() || !some) return result;
  return map_datasets(result, [&](const DatasetPtr& d) {
    if (!lacks(d)) return d;
    DatasetParts parts = d->parts();
    parts.notes.insert(parts.notes.end(), of_place.begin(), of_place.end());
    return make_dataset(std::move(parts));
  });
}

Data with_place_of(const Data& from, Data result) {
  DatasetPtr first;
  for_each_dataset(from, [&](const std::string&, const DatasetPtr& d) {
    if (!first) first = d;
  });
  return first ? with_place_of(*first, std::move(result)) : result;
}

}  // namespace sg

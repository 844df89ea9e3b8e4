// SPDX-License-Identifier: Apache-2.0
// Tables and collections from the caller's memory.
#include <fmt/format.h>

#include "api/held.h"

namespace sightglass {

namespace {

sg::Array places_of(const Column& column, size_t rows) {
  const sg::Array& a = column.values.held().array;
  const std::string where = fmt::format("table(): column '{}'", column.name);
  if (a.count() != rows) sg::fail_usage(fmt::format("has {} rows", a.count()), where, fmt::format("{} as the first one", rows));
  if (column.words.empty()) return a;
  if (sg::is_float(a.type()) || a.components() != 1)
    sg::fail_usage("its values are no places in its words", where, "one whole number per row, -1 for none");
  const sg::Array places = a.converted(sg::ElementType::i32);
  for (size_t i = 0; i < places.count(); ++i)
    if (const double at = a.get(i); at < -1 || at >= double(column.words.size()))
      sg::fail_usage(fmt::format("row {} is word {}", i, at), where, fmt::format("there are {} words", column.words.size()));
  return places;
}

}  // namespace

Data table(const std::vector<Column>& columns) {
  return guarded([&] {
    auto made = std::make_shared<sg::Table>();
    bool any_words = false;
    for (const Column& c : columns) {
      if (c.name.empty()) sg::fail_usage("a column needs a name", "table()");
      for (const sg::Field& f : made->columns)
        if (f.name == c.name) sg::fail_usage(fmt::format("there are two columns '{}'", c.name), "table()", "names that differ");
      sg::Field field;
      field.name = c.name, field.unit = c.unit, field.array = places_of(c, columns[0].values.count());
      made->columns.push_back(std::move(field));
      made->labels.push_back(c.words);
      any_words = any_words || !c.words.empty();
    }
    if (!any_words) made->labels.clear();
    std::string about = fmt::format("table of {} columns", columns.size());
    return data_from_memory(sg::Data(sg::TablePtr(std::move(made))), std::move(about));
  });
}

Data collection(const std::vector<std::pair<std::string, Data>>& parts) {
  return guarded([&] {
    auto made = std::make_shared<sg::Collection>();
    for (const auto& [name, data] : parts) made->parts.push_back({name, held_by(data).data});
    return data_from_memory(sg::Data(sg::CollectionPtr(std::move(made))), fmt::format("collection of {} parts", parts.size()));
  });
}

}  // namespace sightglass

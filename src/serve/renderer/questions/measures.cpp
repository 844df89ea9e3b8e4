// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/questions/measures.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/text/utf8.h"
#include "data/cells/cell_reader.h"
#include "data/fields/axis_notes.h"
#include "filter/stats/integrate.h"
#include "filter/stats/statistics.h"
#include "serve/renderer/tell.h"

namespace sg::serve {

namespace {

// The columns of a table of fields, a row for each component.
class Rows {
 public:
  explicit Rows(TablePtr t) : table_(std::move(t)) {}
  size_t count() const { return table_ && !table_->columns.empty() ? table_->columns[0].array.count() : 0; }
  double get(std::string_view column, size_t row) const {
    for (const Field& f : table_->columns)
      if (f.name == column) return f.array.get(row);
    fail_internal(fmt::format("a table has no column '{}'", column));
  }
  const std::string& field(size_t row) const { return (*table_->words(0))[size_t(get("field", row))]; }
  Association on(size_t row) const { return Association(int(get("association", row))); }

 private:
  TablePtr table_;
};

struct Integrals {
  std::optional<Rows> rows;  // none: there is no cell
  int dimension = -1;

  // NaN where there is none.
  double of(const std::string& field, Association on, int component) const {
    for (size_t i = 0; rows && i < rows->count(); ++i)
      if (rows->on(i) == on && rows->field(i) == field && int(rows->get("component", i)) == component) return rows->get("integral", i);
    return NAN;
  }
};

// The largest dimension of the cells that are left.
int dimension_of(const DatasetPtr& d) {
  CellReader reader(d);
  int most = -1;
  for (size_t c = 0; c < d->cell_count() && most < 3; ++c) {
    if (reader.hidden(c)) continue;
    reader.open(c);
    most = std::max(most, reader.dimension());
  }
  return most;
}

Integrals integrals_of(const std::vector<DatasetPtr>& parts, const std::vector<std::string>& fields, Context& context) {
  Integrals r;
  auto all = std::make_shared<Collection>();
  for (const DatasetPtr& d : parts) {
    r.dimension = std::max(r.dimension, dimension_of(d));
    all->parts.push_back({std::to_string(all->parts.size()), d});
  }
  if (r.dimension < 0) return r;
  r.rows.emplace(integrate(CollectionPtr(all), {fields}, context));
  return r;
}

std::string unit_of(const std::vector<DatasetPtr>& parts, const std::string& field, Association on) {
  for (const DatasetPtr& d : parts)
    if (const Field* f = d->fields().find(field, on)) return f->unit;
  return "";
}

// How many components a field has.
int width_of(const std::vector<DatasetPtr>& parts, const std::string& field, Association on) {
  int most = 1;
  for (const DatasetPtr& d : parts)
    if (const Field* f = d->fields().find(field, on)) most = std::max(most, f->components());
  return most;
}

}  // namespace

Json::Members measures_of(const Data& data, const Selection& selection, const std::string& field, Context& context) {
  if (std::holds_alternative<TablePtr>(data)) fail_usage("a table has no places to measure", "measures", "choose a step with a mesh");
  std::vector<DatasetPtr> cells, points;
  size_t cell_count = 0, point_count = 0;
  std::string unit_of_length;
  bool found = field.empty();
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
    if (!selection.field.empty() && !d->fields().find(selection.field)) return;  // as in threshold, such parts have nothing to select
    found = found || d->fields().find(field);
    Selected s = selected_of(d, selection, context);
    context.check();
    if (s.cells) cells.push_back(s.cells);
    points.push_back(s.points);
    cell_count += s.cell_count, point_count += s.point_count;
    if (unit_of_length.empty()) unit_of_length = length_unit(*d);
  });
  if (points.empty()) fail_usage(fmt::format("there is no field '{}'", printable(selection.field)), "value");
  if (!found) fail_usage(fmt::format("there is no field '{}'", printable(field)), "measures");
  const std::vector<std::string> wanted = field.empty() ? std::vector<std::string>() : std::vector<std::string>{field};
  std::erase_if(points, [&](const DatasetPtr& d) { return !field.empty() && !d->fields().find(field); });
  std::erase_if(cells, [&](const DatasetPtr& d) { return !field.empty() && !d->fields().find(field); });
  const Integrals integrals = integrals_of(cells, wanted, context);
  const Rows rows(statistics_of_all(points, {wanted}, context));
  std::vector<Json> list;
  for (size_t i = 0; i < rows.count(); ++i) {
    const std::string& name = rows.field(i);
    const Association on = rows.on(i);
    const int component = int(rows.get("component", i));
    const bool single = width_of(points, name, on) == 1;
    list.emplace_back(Json::Members{{"name", text(name)},
                                    {"on", text(std::string(association_name(on)))},
                                    {"component", Json(int64_t(single ? -1 : component))},
                                    {"unit", text(unit_of(points, name, on))},
                                    {"count", Json(uint64_t(rows.get("count", i)))},
                                    {"missing", Json(uint64_t(rows.get("missing", i) + rows.get("infinite", i)))},
                                    {"min", number(rows.get("min", i))},
                                    {"max", number(rows.get("max", i))},
                                    {"mean", number(rows.get("mean", i))},
                                    {"deviation", number(rows.get("deviation", i))},
                                    {"median", number(rows.get("median", i))},
                                    {"integral", number(integrals.of(name, on, component))}});
  }
  const bool measured = integrals.dimension >= 0;
  return {{"points", Json(uint64_t(point_count))},
          {"cells", Json(uint64_t(cell_count))},
          {"measure", measured ? number(integrals.rows->get("measure", 0)) : Json()},
          {"dimension", measured ? Json(int64_t(integrals.dimension)) : Json()},
          {"length_unit", text(unit_of_length)},
          {"fields", Json(std::move(list))},
          {"steps", steps_of(selection)}};
}

}  // namespace sg::serve

// SPDX-License-Identifier: Apache-2.0
// What can be asked of data.
#include <fmt/format.h>

#include <algorithm>

#include "api/held.h"
#include "base/text/text.h"
#include "data/cells/point_positions.h"
#include "data/fields/known_looks.h"
#include "data/lattice.h"
#include "filter/mesh/select/extract_ids.h"
#include "filter/mesh/to_unstructured.h"

namespace sightglass {

namespace {

static_assert(int(On::points) == int(sg::Association::point) && int(On::whole) == int(sg::Association::whole));

Array make_array(sg::Array a) { return Array(std::make_shared<const Array::Held>(Array::Held{std::move(a)})); }

Field make_field(const sg::Field& f) { return {f.name, On(int(f.association)), make_array(f.array), f.unit}; }

std::vector<sg::DatasetPtr> datasets_of(const sg::Data& data) {
  std::vector<sg::DatasetPtr> all;
  sg::for_each_dataset(data, [&](const std::string&, const sg::DatasetPtr& d) { all.push_back(d); });
  return all;
}

sg::DatasetPtr single(const Data& data, std::string_view who) { return sg::single_dataset(held_by(data).data, who); }

const sg::Table* table_of(const sg::Data& data) {
  auto* t = std::get_if<sg::TablePtr>(&data);
  return t ? t->get() : nullptr;
}

[[noreturn]] void fail_no_field(std::string_view name, const std::vector<std::string>& names) {
  sg::fail_usage(fmt::format("field '{}' not found", name), "", sg::unknown_name_hint(name, names));
}

size_t column_of(const sg::Table& table, std::string_view name) {
  std::vector<std::string> names;
  for (size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].name == name) return i;
    names.push_back(table.columns[i].name);
  }
  fail_no_field(name, names);
}

Array offsets_of(const sg::CellArray& lists) {
  if (lists.fixed <= 0) return make_array(lists.offsets);
  std::vector<int64_t> offsets(lists.size() + 1);
  for (size_t i = 0; i < offsets.size(); ++i) offsets[i] = int64_t(i) * lists.fixed;
  return Array(std::move(offsets));
}

// Types as one number a cell, offsets in any case.
Cells lists_of(const sg::UnstructuredMesh& mesh) {
  const size_t n = mesh.cells.size();
  Cells cells;
  cells.ids = make_array(mesh.cells.connectivity);
  cells.offsets = offsets_of(mesh.cells);
  cells.types = mesh.types.empty() ? Array(std::vector<uint8_t>(n, uint8_t(mesh.single_type))) : make_array(mesh.types);
  if (mesh.polyhedron_faces.empty()) return cells;
  cells.face_ids = make_array(mesh.faces.connectivity);
  cells.face_offsets = offsets_of(mesh.faces);
  cells.cell_faces = make_array(mesh.polyhedron_faces);
  return cells;
}

// The step that takes one part out: by its path, or by its number where the path is that of an earlier one or reads as a number.
std::shared_ptr<const Made> made_of_part(const std::vector<sg::Collection::Part>& parts, size_t number,
                                         const std::shared_ptr<const Made>& collection) {
  const auto first = std::find_if(parts.begin(), parts.end(), [&](const auto& p) { return p.name == parts[number].name; });
  const std::string& name = parts[number].name;
  const bool named = !name.empty() && !name.starts_with('#') && size_t(first - parts.begin()) == number;
  auto made = std::make_shared<Made>();
  made->operation = "extract";
  made->words = {"part=" + (named ? name : fmt::format("#{}", number))};
  made->inputs = {collection};
  return made;
}

}  // namespace

Data::Data() = default;
Data::Data(std::shared_ptr<const Held> held) : held_(std::move(held)) {}

std::string Data::kind() const {
  return guarded([&]() -> std::string {
    const sg::Data& data = held_by(*this).data;
    if (auto* d = std::get_if<sg::DatasetPtr>(&data)) return std::string((*d)->kind());
    return std::holds_alternative<sg::TablePtr>(data) ? "table" : "collection";
  });
}

std::string Data::summary() const {
  return guarded([&]() -> std::string {
    const sg::Data& data = held_by(*this).data;
    if (auto* d = std::get_if<sg::DatasetPtr>(&data)) return sg::summary(**d);
    if (const sg::Table* t = table_of(data)) return fmt::format("table of {} columns", t->columns.size());
    return fmt::format("collection of {} parts, {} points", parts().size(), point_count());
  });
}

const std::vector<std::string>& Data::notes() const {
  static const std::vector<std::string> none;
  return held_ ? held_->notes : none;
}

size_t Data::point_count() const {
  return guarded([&] {
    size_t n = 0;
    for (const auto& d : datasets_of(held_by(*this).data)) n += d->point_count();
    return n;
  });
}

size_t Data::cell_count() const {
  return guarded([&] {
    size_t n = 0;
    for (const auto& d : datasets_of(held_by(*this).data)) n += d->cell_count();
    return n;
  });
}

Box Data::bounds() const {
  return guarded([&] {
    sg::Box3 b;
    for (const auto& d : datasets_of(held_by(*this).data)) b.add(d->bounds());
    return Box{{b.lo.x, b.lo.y, b.lo.z}, {b.hi.x, b.hi.y, b.hi.z}};
  });
}

std::vector<Field> Data::fields() const {
  return guarded([&] {
    std::vector<Field> all;
    if (const sg::Table* t = table_of(held_by(*this).data))
      for (const sg::Field& f : t->columns) all.push_back(make_field(f));
    else
      for (const sg::Field& f : single(*this, "fields()")->fields()) all.push_back(make_field(f));
    return all;
  });
}

Field Data::field(std::string_view name) const {
  return guarded([&] {
    if (const sg::Table* t = table_of(held_by(*this).data)) return make_field(t->columns[column_of(*t, name)]);
    return make_field(single(*this, "field()")->fields().require(name));
  });
}

Range Data::range(std::string_view field, int component) const {
  return guarded([&] {
    const sg::Data& data = held_by(*this).data;
    sg::Range r;
    bool found = false;
    std::vector<std::string> names;
    auto check = [&](int components) {
      if (component < -1 || component >= components)
        sg::fail_usage(fmt::format("there is no component {} of '{}'", component, field), "range()",
                       fmt::format("-1 to {}; -1 is the only one, or the length", components - 1));
    };
    if (const sg::Table* t = table_of(data)) {
      const sg::Array& a = t->columns[column_of(*t, field)].array;
      check(a.components());
      const sg::FieldStats s = sg::field_stats(a, component < 0);
      r = component < 0 && a.components() > 1 ? s.magnitude : s.range[size_t(std::max(component, 0))];
      return Range{r.lo, r.hi};
    }
    for (const auto& d : datasets_of(data)) {
      for (const std::string& n : d->fields().names()) names.push_back(n);
      const sg::Field* f = d->fields().find(field);
      if (!f) continue;
      check(f->components());
      r.add(d->range(*f, component < 0 && f->components() == 1 ? 0 : component));
      found = true;
    }
    if (!found) fail_no_field(field, names);
    return Range{r.lo, r.hi};
  });
}

std::vector<std::string> Data::words(std::string_view column) const {
  return guarded([&] {
    const sg::Table* t = table_of(held_by(*this).data);
    if (!t) sg::fail_usage("is not a table", "words()", "kind() says what it is");
    const auto* list = t->words(column_of(*t, column));
    return list ? *list : std::vector<std::string>();
  });
}

Array Data::points() const {
  return guarded([&] { return make_array(sg::point_positions(single(*this, "points()")->mesh())); });
}

std::array<size_t, 3> Data::dims() const {
  return guarded([&] {
    const sg::DatasetPtr d = single(*this, "dims()");
    if (!sg::is_lattice(d->mesh()))
      sg::fail_usage(fmt::format("a mesh of kind '{}' has no dimensions", d->kind()), "dims()", "point_count() and cells() tell its size");
    return sg::lattice_dims(d->mesh());
  });
}

Placing Data::placing() const {
  return guarded([&] {
    const sg::DatasetPtr d = single(*this, "placing()");
    const auto* grid = d->as<sg::UniformGrid>();
    if (!grid) sg::fail_usage(fmt::format("a mesh of kind '{}' has no even spacing", d->kind()), "placing()", "points() are its positions");
    Placing p;
    for (int a = 0; a < 3; ++a) {
      const sg::Vec3 axis = grid->direction.column(a);
      p.spacing[size_t(a)] = grid->spacing[a], p.origin[size_t(a)] = grid->origin[a], p.axes[size_t(a)] = {axis.x, axis.y, axis.z};
    }
    return p;
  });
}

std::array<Array, 3> Data::coordinates() const {
  return guarded([&]() -> std::array<Array, 3> {
    const sg::DatasetPtr d = single(*this, "coordinates()");
    if (const auto* grid = d->as<sg::RectilinearGrid>()) return {make_array(grid->x), make_array(grid->y), make_array(grid->z)};
    const auto* grid = d->as<sg::UniformGrid>();
    if (!grid) sg::fail_usage(fmt::format("a mesh of kind '{}' has no axes", d->kind()), "coordinates()", "points() are its positions");
    std::array<Array, 3> all;
    for (int a = 0; a < 3; ++a) {
      std::vector<double> axis(grid->dims[size_t(a)]);
      for (size_t i = 0; i < axis.size(); ++i) axis[i] = grid->origin[a] + grid->spacing[a] * double(i);
      all[size_t(a)] = Array(std::move(axis));
    }
    return all;
  });
}

Cells Data::cells() const {
  return guarded([&] {
    sg::DatasetPtr d = single(*this, "cells()");
    if (!d->as<sg::UnstructuredMesh>()) {  // the mesh alone: fields would be carried along
      sg::DatasetParts mesh = d->parts();
      mesh.fields = {};
      d = sg::to_unstructured(sg::make_dataset(std::move(mesh)));
    }
    return lists_of(*d->as<sg::UnstructuredMesh>());
  });
}

std::vector<std::pair<std::string, Data>> Data::parts() const {
  return guarded([&] {
    std::vector<std::pair<std::string, Data>> all;
    const Held& held = held_by(*this);
    if (!std::holds_alternative<sg::CollectionPtr>(held.data)) {
      all.emplace_back("", *this);
      return all;
    }
    const std::vector<sg::Collection::Part> parts = sg::all_parts(held.data);
    for (size_t i = 0; i < parts.size(); ++i) all.emplace_back(parts[i].name, make_data(parts[i].data, made_of_part(parts, i, held.made)));
    return all;
  });
}

Data Data::with_field(Field field) const {
  return guarded([&] {
    sg::DatasetParts parts = single(*this, "with_field()")->parts();
    if (field.name.empty()) sg::fail_usage("a field needs a name", "with_field()");
    const sg::FieldLook look = sg::known_look(field.name);
    parts.fields.add(
        {std::move(field.name), sg::Association(int(field.on)), field.values.held().array, std::move(field.unit), sg::Role::none, look});
    return data_from_memory(sg::make_dataset(std::move(parts)));
  });
}

Data Data::with_point_field(std::string name, Array values, std::string unit) const {
  return with_field({std::move(name), On::points, std::move(values), std::move(unit)});
}
Data Data::with_cell_field(std::string name, Array values, std::string unit) const {
  return with_field({std::move(name), On::cells, std::move(values), std::move(unit)});
}

}  // namespace sightglass

// SPDX-License-Identifier: Apache-2.0
#include "data/dataset.h"

#include <fmt/core.h>

#include "data/fields/field_component.h"

#include "base/error.h"
#include "data/bricked.h"
#include "data/cells/own_indices.h"
#include "data/lattice.h"
#include "data/memory/memo.h"
#include "data/trusted.h"

namespace sg {

Data::Data(const Data&) = default;
Data::Data(Data&&) noexcept = default;
Data& Data::operator=(const Data&) = default;
Data& Data::operator=(Data&&) noexcept = default;
Data::~Data() = default;

Dataset::Dataset(DatasetParts parts, BrickedPtr bricks)
    : parts_(std::move(parts)),
      bricks_(std::move(bricks)),
      points_(sg::point_count(parts_.mesh)),
      cells_(sg::cell_count(parts_.mesh)),
      memo_(std::make_shared<Memo>()) {}

namespace {

// A mesh without points has an empty list of 3-vectors, not of nothing in particular: what copies it may rely on that.
void shape_empty_points(Mesh& mesh) {
  std::visit(
      [](auto& m) {
        if constexpr (requires { m.points.xyz; }) {
          if (m.points.xyz.empty() && m.points.xyz.components() != 3) m.points.xyz = Array(Buffer{}, ElementType::f32, 0, 3);
        }
      },
      mesh);
}

}  // namespace

DatasetPtr make_dataset(DatasetParts parts) { return make_dataset(std::move(parts), BrickedPtr()); }

DatasetPtr make_dataset(DatasetParts parts, BrickedPtr bricks) {
  if (!detail::mesh_is_trusted()) own_indices(parts.mesh);
  validate(parts.mesh);
  shape_empty_points(parts.mesh);
  const size_t points = point_count(parts.mesh), cells = cell_count(parts.mesh);
  for (const Field& f : parts.fields) {
    if (f.association == Association::whole) continue;
    const size_t want = f.association == Association::point ? points : cells;
    if (f.array.count() != want)
      fail_data(fmt::format("{} field '{}' has {} tuples for {} {}s", association_name(f.association), f.name, f.array.count(), want,
                            association_name(f.association)));
  }
  auto check_ghost = [](const Array& a, size_t n, const char* what) {
    if (!a.empty() && (a.type() != ElementType::u8 || a.count() != n))
      fail_data(fmt::format("{} ghost array has {} entries for {}", what, a.count(), n));
  };
  check_ghost(parts.point_ghost, points, "point");
  check_ghost(parts.cell_ghost, cells, "cell");
  return DatasetPtr(new Dataset(std::move(parts), std::move(bricks)));
}

DatasetPtr make_dataset(Mesh mesh, FieldSet fields) {
  DatasetParts p;
  p.mesh = std::move(mesh);
  p.fields = std::move(fields);
  return make_dataset(std::move(p));
}

const Box3& Dataset::bounds() const {
  std::lock_guard lock(mutex_);
  if (!bounds_) {
    bounds_ = sg::bounds(parts_.mesh);
    if (bricks_) bounds_ = bricks_->bounds();  // the volume that the coarse level represents
  }
  return *bounds_;
}

const FieldStats& Dataset::stats(const Field& field) const {
  std::lock_guard lock(mutex_);
  const std::byte* key = field.array.raw();
  for (const auto& [have, stats] : stats_)
    if (have == key && stats->range.size() == size_t(field.components())) return *stats;
  const Array& skip = field.association == Association::point ? parts_.point_ghost : parts_.cell_ghost;
  stats_.emplace_back(key, std::make_unique<FieldStats>(field_stats(field.array, true, skip)));
  // Averages hide the extremes of the volume that the dataset represents.
  if (bricks_ && field.association == Association::point && field.name == bricks_->field)
    if (const Range r = bricks_->range(); !r.empty() && field.components() == 1) stats_.back().second->range[0].add(r);
  return *stats_.back().second;
}

Range Dataset::range(const Field& field, int component) const {
  check_component(field, component, "component");
  const FieldStats& s = stats(field);
  if (field.components() == 1) return s.range[0];
  if (component < 0) return s.magnitude;
  return s.range[size_t(component)];
}

void for_each_dataset(const Data& data, const std::function<void(const std::string&, const DatasetPtr&)>& f) {
  auto walk = [&](auto&& self, const std::string& path, const Data& d) -> void {
    if (auto* dataset = std::get_if<DatasetPtr>(&d)) {
      if (*dataset) f(path, *dataset);
    } else if (auto* collection = std::get_if<CollectionPtr>(&d)) {
      for (const auto& part : (*collection)->parts) self(self, path.empty() ? part.name : path + "/" + part.name, part.data);
    }
  };
  walk(walk, "", data);
}

Data map_datasets(const Data& data, const std::function<DatasetPtr(const DatasetPtr&)>& f) {
  if (auto* dataset = std::get_if<DatasetPtr>(&data)) return *dataset ? f(*dataset) : *dataset;
  if (auto* collection = std::get_if<CollectionPtr>(&data)) {
    auto out = std::make_shared<Collection>();
    for (const auto& part : (*collection)->parts) {
      Data mapped = map_datasets(part.data, f);
      if (auto* d = std::get_if<DatasetPtr>(&mapped); d && !*d) continue;
      out->parts.push_back({part.name, std::move(mapped)});
    }
    return CollectionPtr(out);
  }
  return data;
}

DatasetPtr single_dataset(const Data& data, std::string_view who) {
  DatasetPtr found;
  size_t n = 0;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { found = d, ++n; });
  if (n == 0) fail_usage("needs a mesh but got none", std::string(who));
  if (n > 1)
    fail_usage(fmt::format("needs a single mesh but got {} parts", n), std::string(who),
               "join them: -f append; take one: -f 'extract part=NAME'; or write all: .vtm");
  return found;
}

std::string summary(const Dataset& d) {
  std::string r(d.kind());
  if (is_lattice(d.mesh())) {
    const auto n = lattice_dims(d.mesh());
    r += fmt::format(" {}x{}x{}", n[0], n[1], n[2]);
  }
  return r + fmt::format(", {} points, {} cells, {} field{}", d.point_count(), d.cell_count(), d.fields().size(),
                         d.fields().size() == 1 ? "" : "s");
}

}  // namespace sg

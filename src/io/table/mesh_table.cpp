// SPDX-License-Identifier: Apache-2.0
#include "io/table/mesh_table.h"

#include <fmt/core.h>

#include "base/text/text.h"
#include "data/cells/point_positions.h"

namespace sg {

namespace {

constexpr std::string_view axes[] = {"x", "y", "z"};

// The axis whose column a field would be taken for: "x", and "position_x" of a table that was read; -1 for others.
int axis_named(const Field& f) {
  std::string_view name = f.name;
  if (name.starts_with("position_")) name.remove_prefix(9);
  for (int a = 0; a < 3; ++a)
    if (f.components() == 1 && equal_ignoring_case(name, axes[a])) return a;
  return -1;
}

bool repeats(const Field& f, const Array& positions, int axis) {
  for (size_t i = 0; i < positions.count(); ++i)
    if (f.array.get(i) != positions.get(i, axis)) return false;
  return true;
}

}  // namespace

TablePtr table_of_points(const Dataset& d) {
  auto table = std::make_shared<Table>();
  const Array positions = point_positions(d.mesh());
  bool taken = false;
  for (const Field& f : d.fields()) {
    if (f.association != Association::point) continue;
    const int axis = axis_named(f);
    if (axis >= 0 && repeats(f, positions, axis)) continue;
    taken = taken || axis >= 0;
    table->columns.push_back(f);
  }
  table->columns.insert(table->columns.begin(), {taken ? "position" : "", Association::whole, positions, "", Role::vectors});
  return table;
}

std::string column_name(const Field& f, int component) {
  const int n = f.components();
  if (n == 1) return f.name;
  const bool vector = n <= 3 && (f.role == Role::none || f.role == Role::scalars || f.role == Role::vectors || f.role == Role::normals);
  if (f.name.empty() && n == 3) return std::string(axes[component]);
  return vector ? fmt::format("{}_{}", f.name, axes[component]) : fmt::format("{}_{}", f.name, component);
}

}  // namespace sg

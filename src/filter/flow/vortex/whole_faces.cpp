// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/whole_faces.h"

#include <cmath>

#include "filter/scalar/contour/contour_amr.h"

namespace sg {

namespace {

size_t patch_count(const AmrGrid& g) {
  size_t n = 0;
  for (const auto& level : g.levels) n += level.patches.size();
  return n;
}

// Component c of a cell field, NaN where any of the fields has no value.
Array component_of(const Array& all, int c, const std::vector<uint8_t>& missing) {
  std::vector<double> v(all.count());
  for (size_t i = 0; i < v.size(); ++i) v[i] = missing[i] ? NAN : all.get(i, c);
  return Array::from_vector(std::move(v));
}

}  // namespace

DatasetPtr with_whole_faces(const DatasetPtr& in, const std::vector<Field>& vectors, Context& context) {
  const auto* grid = in->as<AmrGrid>();
  if (!grid || patch_count(*grid) < 2) return in;
  std::vector<uint8_t> missing(in->cell_count(), 0);
  const Field* of_cells = nullptr;
  for (const Field& f : vectors) {
    if (f.association != Association::cell) continue;
    of_cells = &f;
    for (size_t i = 0; i < missing.size(); ++i)
      for (int c = 0; c < f.components(); ++c) missing[i] |= uint8_t(!std::isfinite(f.array.get(i, c)));
  }
  if (!of_cells) return contouring::amr_cells_near(in, vectors.front(), 0, {}, context);
  DatasetPtr cells;
  std::vector<Field> made;
  for (const Field& f : vectors) {
    if (f.association != Association::cell) continue;
    std::vector<double> xyz;
    for (int c = 0; c < f.components(); ++c) {
      const Field part{f.name, Association::cell, component_of(f.array, c, missing), f.unit, Role::none};
      cells = contouring::amr_cells_near(in, part, 0, {}, context);
      const Array v = cells->fields().require(f.name, Association::point).array;
      xyz.resize(3 * v.count());
      for (size_t i = 0; i < v.count(); ++i) xyz[3 * i + size_t(c)] = v.get(i);
    }
    made.push_back({f.name, Association::point, Array::from_vector(std::move(xyz), 3), f.unit, Role::vectors});
  }
  DatasetParts parts = cells->parts();
  for (Field& f : made) {
    parts.fields.remove(f.name, Association::point);
    parts.fields.remove(f.name, Association::cell);
    parts.fields.add(std::move(f));
  }
  return make_dataset(std::move(parts));
}

}  // namespace sg

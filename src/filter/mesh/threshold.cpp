// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/threshold.h"

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "data/field_ops.h"
#include "data/lattice.h"
#include "filter/mesh/extract.h"
#include "filter/mesh/surface_builder.h"

namespace sg {

namespace {

constexpr size_t grain = 1 << 14;

// One byte per tuple: is its value in range? Compared in the field's own precision, widened to double.
std::vector<uint8_t> in_range(const Field& field, const ThresholdParams& p) {
  const double lo = p.min.value_or(-HUGE_VAL), hi = p.max.value_or(HUGE_VAL);
  const int components = field.components();
  if (p.component >= components)
    fail_usage(fmt::format("field '{}' has {} components, not component {}", field.name, components, p.component), "threshold",
               components == 1 ? "leave component out" : fmt::format("0 to {}, or -1 for the magnitude", components - 1));
  std::vector<uint8_t> r(field.array.count());
  const bool magnitude = p.component < 0 && components > 1;
  const int c = std::max(p.component, 0);
  dispatch(field.array, [&](auto v) {
    parallel_for(v.count, grain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        double x = double(v(i, c));
        if (magnitude) {
          x = 0;
          for (int k = 0; k < components; ++k) x += double(v(i, k)) * double(v(i, k));
          x = std::sqrt(x);
        }
        r[i] = x >= lo && x <= hi;
      }
    });
  });
  return r;
}

// Does every point of the cell (or any) pass?
template <class ForEachPoint>
bool passes(bool all, const std::vector<uint8_t>& ok, ForEachPoint for_each) {
  size_t points = 0, good = 0;
  for_each([&](size_t id) { ++points, good += ok[id]; });
  return all ? points > 0 && good == points : good > 0;
}

void cells_of_lists(const CellsView& v, size_t first, bool all, const std::vector<uint8_t>& ok, std::vector<uint8_t>& keep) {
  parallel_for(v.count, grain, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c)
      keep[first + c] = passes(all, ok, [&](auto&& f) {
        for (size_t i = v.begin(c); i < v.end(c); ++i) f(size_t(v.connectivity[i]));
      });
  });
}

void cells_of_box(std::array<size_t, 3> cells, std::array<size_t, 3> points, size_t first_cell, size_t first_point, bool all, const std::vector<uint8_t>& ok,
                  std::vector<uint8_t>& keep) {
  parallel_for(cells[1] * cells[2], std::max<size_t>(1, grain / cells[0]), [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row)
      for (size_t i = 0; i < cells[0]; ++i) {
        const size_t j = row % cells[1], k = row / cells[1];
        keep[first_cell + i + cells[0] * row] = passes(all, ok, [&](auto&& f) {
          for (size_t c = 0; c < 8; ++c) {
            const size_t x = i + (c & 1), y = j + (c >> 1 & 1), z = k + (c >> 2);
            if (x < points[0] && y < points[1] && z < points[2]) f(first_point + x + points[0] * (y + points[1] * z));
          }
        });
      }
  });
}

std::vector<uint8_t> cells_by_points(const Dataset& in, bool all, const std::vector<uint8_t>& ok) {
  std::vector<uint8_t> keep(in.cell_count());
  if (auto* u = in.as<UnstructuredMesh>()) {
    cells_of_lists(cells_view(u->cells), 0, all, ok, keep);
  } else if (auto* s = in.as<SurfaceMesh>()) {
    size_t first = 0;
    for (const CellArray* a : {&s->vertices, &s->lines, &s->polygons, &s->strips}) {
      cells_of_lists(cells_view(*a), first, all, ok, keep);
      first += a->size();
    }
  } else if (auto* g = in.as<AmrGrid>()) {
    for (const auto& level : g->levels)
      for (const auto& patch : level.patches) {
        const auto n = patch.cells();
        cells_of_box(n, {n[0] + 1, n[1] + 1, g->dimension == 3 ? n[2] + 1 : 1}, patch.cell_offset, patch.point_offset, all, ok, keep);
      }
  } else if (in.cell_count() > 0) {
    const auto d = lattice_dims(in.mesh());
    cells_of_box({std::max<size_t>(d[0], 2) - 1, std::max<size_t>(d[1], 2) - 1, std::max<size_t>(d[2], 2) - 1}, d, 0, 0, all, ok, keep);
  }
  return keep;
}

const Field& chosen_field(const Dataset& in, const ThresholdParams& p) {
  const Field* field = nullptr;
  if (p.field.empty()) {
    field = in.fields().active(1);
    if (!field) fail_usage("the mesh has no scalar field", "threshold", "name one: field=NAME");
  } else {
    field = with_context("threshold", [&] { return &in.fields().require(p.field.name); });
  }
  if (field->association == Association::whole) fail_usage(fmt::format("field '{}' belongs to the whole mesh, not to points or cells", field->name), "threshold");
  return *field;
}

}  // namespace

DatasetPtr threshold(const DatasetPtr& in, const ThresholdParams& p, Context& ctx) {
  if (p.min && p.max && *p.min > *p.max)
    fail_usage(fmt::format("min {} is above max {}", short_number(*p.min), short_number(*p.max)), "threshold", "swap them, or use invert=true");
  const Field& field = chosen_field(*in, p);
  std::vector<uint8_t> keep = in_range(field, p);
  ctx.check();
  const bool cloud = in->as<PointCloud>() != nullptr;
  if (!cloud && field.association == Association::point) keep = cells_by_points(*in, p.all_points, keep);
  if (p.invert)
    for (uint8_t& k : keep) k = !k;
  const std::vector<uint8_t> states = cloud ? std::vector<uint8_t>() : cell_states(*in);
  std::vector<int64_t> cells;
  for (size_t c = 0; c < keep.size(); ++c)
    if (keep[c] && (states.empty() || states[c] == cell_visible)) cells.push_back(int64_t(c));
  if (cells.empty()) ctx.info(fmt::format("threshold: no {} has '{}' in range", cloud ? "point" : "cell", field.name));
  return extract_cells(in, cells, "threshold");
}

}  // namespace sg

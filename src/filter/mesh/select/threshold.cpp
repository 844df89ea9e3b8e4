// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/select/threshold.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/field_ops.h"
#include "data/fields/label_names.h"
#include "data/lattice.h"
#include "filter/field/sampling/point_cell.h"
#include "filter/mesh/clip/corner_bits.h"
#include "filter/mesh/select/extract.h"
#include "filter/mesh/select/lattice_cells.h"
#include "filter/mesh/select/row_bits.h"
#include "filter/mesh/surface_builder.h"

namespace sg {

namespace {

constexpr size_t values_per_chunk = 1 << 14;

using Ranges = std::vector<std::pair<double, double>>;

// The labels of `names` that the field's values stand for; not finding one is told, as another part may have it.
Ranges labels_of_names(const Dataset& in, const Field& field, const ThresholdParams& p, Context& ctx) {
  if (p.min || p.max || !p.ranges.empty())
    fail_usage("names is given together with min, max or ranges", "threshold", "give either names or numbers");
  const auto note = std::find_if(in.notes().begin(), in.notes().end(), [&](const auto& n) { return n.first == "labels of " + field.name; });
  if (note == in.notes().end())
    fail_usage(fmt::format("the values of '{}' have no names", field.name), "threshold names", "give numbers with min, max or ranges");
  const std::map<double, std::string> known = names_in_note(note->second);
  Ranges labels;
  for (const std::string& name : p.names) {
    const size_t before = labels.size();
    for (const auto& [number, word] : known)
      if (to_lower(word) == to_lower(name)) labels.emplace_back(number, number);
    if (labels.size() > before) continue;
    std::string all;
    size_t count = 0;
    for (const auto& [number, word] : known)
      if (++count <= 20) all += (all.empty() ? "" : ", ") + word;
    ctx.warn(fmt::format("threshold: no label of '{}' is named '{}'; there are {}{}", field.name, name, all, count > 20 ? ", ..." : ""));
  }
  return labels;
}

Ranges ranges_of(const ThresholdParams& p) {
  if (p.ranges.empty()) return {{p.min.value_or(-HUGE_VAL), p.max.value_or(HUGE_VAL)}};
  if (p.min || p.max) fail_usage("ranges is given together with min or max", "threshold", "put all limits into ranges");
  if (p.ranges.size() % 2 != 0)
    fail_usage(fmt::format("needs pairs of numbers, not {}", p.ranges.size()), "threshold ranges", "write e.g. ranges=0,1,5,9");
  Ranges r;
  for (size_t i = 0; i < p.ranges.size(); i += 2) {
    if (!(p.ranges[i] <= p.ranges[i + 1]))
      fail_usage(fmt::format("the range {} to {} is empty", short_number(p.ranges[i]), short_number(p.ranges[i + 1])), "threshold ranges",
                 "give the smaller number first");
    r.emplace_back(p.ranges[i], p.ranges[i + 1]);
  }
  return r;
}

// One byte per tuple: is its value in range? Compared in the field's own precision, widened to double.
std::vector<uint8_t> in_range(const Field& field, const ThresholdParams& p, const Ranges& ranges) {
  const int components = field.components();
  if (p.component >= components)
    fail_usage(fmt::format("field '{}' has {} components; there is no component {}", field.name, components, p.component), "threshold",
               components == 1 ? "leave out component" : fmt::format("0 to {}, or -1 for the magnitude", components - 1));
  std::vector<uint8_t> r(field.array.count());
  const bool magnitude = p.component < 0 && components > 1;
  const int c = std::max(p.component, 0);
  dispatch(field.array, [&](auto v) {
    parallel_for(v.count, values_per_chunk, [&](size_t begin, size_t end) {
      if (!magnitude && v.stride == 1 && ranges.size() == 1) {
        const auto [lo, hi] = ranges[0];
        const auto* x = v.data;
        for (size_t i = begin; i < end; ++i) r[i] = uint8_t(double(x[i]) >= lo) & uint8_t(double(x[i]) <= hi);
        return;
      }
      for (size_t i = begin; i < end; ++i) {
        double x = double(v(i, c));
        if (magnitude) {
          x = 0;
          for (int k = 0; k < components; ++k) x += double(v(i, k)) * double(v(i, k));
          x = std::sqrt(x);
        }
        for (const auto& [lo, hi] : ranges) r[i] |= x >= lo && x <= hi;
      }
    });
  });
  return r;
}

// Whether every point of the cell (or any) passes.
template <class ForEachPoint>
bool passes(bool all, const std::vector<uint8_t>& ok, ForEachPoint for_each) {
  size_t points = 0, good = 0;
  for_each([&](size_t id) { ++points, good += ok[id]; });
  return all ? points > 0 && good == points : good > 0;
}

void cells_of_lists(const CellsView& v, size_t first, bool all, const std::vector<uint8_t>& ok, std::vector<uint8_t>& keep) {
  parallel_for(v.count, values_per_chunk, [&](size_t begin, size_t end) {
    (all ? all_of_corners : any_of_corners)(v, begin, end, ok.data(), keep.data() + first + begin);
  });
}

void cells_of_box(std::array<size_t, 3> cells, std::array<size_t, 3> points, size_t first_cell, size_t first_point, bool all,
                  const std::vector<uint8_t>& ok, std::vector<uint8_t>& keep) {
  parallel_for(cells[1] * cells[2], std::max<size_t>(1, values_per_chunk / cells[0]), [&](size_t begin, size_t end) {
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

const Field& usable(const Field& field) {
  if (field.association == Association::whole)
    fail_usage(fmt::format("field '{}' belongs to the whole mesh, not to points or cells", field.name), "threshold");
  return field;
}

std::vector<const Field*> chosen_fields(const Dataset& in, const ThresholdParams& p) {
  std::vector<const Field*> r;
  if (!p.fields.empty()) {
    if (!p.field.empty()) fail_usage("both field and fields are given", "threshold", "name them all in fields");
    for (const std::string& name : p.fields)
      r.push_back(&usable(with_context("threshold", [&]() -> const Field& { return in.fields().require(name); })));
    return r;
  }
  if (!p.field.empty()) return {&usable(with_context("threshold", [&]() -> const Field& { return in.fields().require(p.field.name); }))};
  const auto named = [&](const Field& f) {
    return f.components() == 1 && f.association != Association::whole &&
           std::any_of(in.notes().begin(), in.notes().end(), [&](const auto& n) { return n.first == "labels of " + f.name; });
  };
  if (const auto f = std::find_if(in.fields().begin(), in.fields().end(), named); !p.names.empty() && f != in.fields().end()) return {&*f};
  const Field* field = in.fields().active(1);
  if (!field) fail_usage("the mesh has no scalar field", "threshold", "name one: field=NAME");
  return {&usable(*field)};
}

// Points of a lattice in range, a bit each; without a pass over bytes for plain floats.
Bits lattice_points_in_range(const BitRows& g, const Field& field, const ThresholdParams& p, const Ranges& ranges) {
  Bits points(g.size());
  const Array& a = field.array;
  if (is_float(a.type()) && a.packed() && a.components() == 1 && p.component <= 0 && ranges.size() == 1) {
    auto rows = [&](const auto* x) {
      parallel_for(g.rows(), 64, [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row)
          range_row(x + row * g.nx, g.nx, ranges[0].first, ranges[0].second, points.data() + row * g.words);
      });
    };
    if (a.type() == ElementType::f32) rows(a.view<float>().data);
    else rows(a.view<double>().data);
    return points;
  }
  const std::vector<uint8_t> ok = in_range(field, p, ranges);
  parallel_for(g.rows(), 64, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row)
      for (size_t w = 0; w < g.words; ++w) {
        uint8_t bytes[64] = {};
        std::copy_n(ok.data() + row * g.nx + 64 * w, std::min<size_t>(64, g.nx - 64 * w), bytes);
        points[row * g.words + w] = packed_bits(bytes);
      }
  });
  return points;
}

// Which cells of a lattice have all points (or any) in range.
Bits lattice_cells_by_points(const BitRows& g, bool all, bool invert, const Bits& points) {
  Bits cells(g.size());
  parallel_for(g.rows(), 64, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const size_t j = row % g.ny, k = row / g.ny;
      for (size_t w = 0; w < g.words; ++w) {
        uint64_t& cell = cells[row * g.words + w] = 0;
        if (j + 1 >= g.ny || k + 1 >= g.nz) continue;
        uint64_t every = ~uint64_t(0), some = 0;
        for (const size_t r : {g.row(j, k), g.row(j + 1, k), g.row(j, k + 1), g.row(j + 1, k + 1)}) {
          const uint64_t here = points[r + w], next = here >> 1 | (w + 1 < g.words ? points[r + w + 1] << 63 : 0);
          every &= here & next, some |= here | next;
        }
        cell = ((all ? every : some) ^ (invert ? ~uint64_t(0) : 0)) & g.cell_mask(w);
      }
    }
  });
  return cells;
}

}  // namespace

DatasetPtr threshold(const DatasetPtr& in, const ThresholdParams& p, Context& ctx) {
  if (p.min && p.max && *p.min > *p.max)
    fail_usage(fmt::format("min {} is above max {}", short_number(*p.min), short_number(*p.max)), "threshold",
               "swap them, or use invert=true");
  std::vector<const Field*> fields = chosen_fields(*in, p);
  const Field& field = *fields[0];
  const Ranges ranges = p.names.empty() ? ranges_of(p) : labels_of_names(*in, field, p, ctx);
  auto tell = [&](const DatasetPtr& out) {
    if (out->cell_count() == 0 && (!out->as<PointCloud>() || out->point_count() == 0))
      ctx.info(fmt::format("threshold: nothing is left; '{}' ranges from {} to {}", field.name, short_number(in->range(field).lo),
                           short_number(in->range(field).hi)));
    return out;
  };
  const bool cloud = in->as<PointCloud>() != nullptr;
  std::vector<DatasetPtr> means;  // that hold the fields
  for (const Field*& f : fields)
    if (p.mean && !cloud && f->association == Association::point) {
      const std::string name = f->name;
      means.push_back(point_to_cell(in, {{name}}, ctx));
      f = &means.back()->fields().require(name, Association::cell);
    }
  const std::vector<uint8_t> states = cloud ? std::vector<uint8_t>() : cell_states(*in);
  const auto d = lattice_dims(in->mesh());
  if (is_lattice(in->mesh()) && d[0] > 1 && d[1] > 1 && d[2] > 1 && fields.size() == 1 && states.empty() &&
      fields[0]->association == Association::point && in->point_count() <= size_t(INT32_MAX))
    return tell(extract_lattice_cells(
        in, lattice_cells_by_points(BitRows(d), p.all_points, p.invert, lattice_points_in_range(BitRows(d), field, p, ranges)),
        "threshold"));
  std::vector<uint8_t> keep = in_range(*fields[0], p, ranges);
  ctx.check();
  if (!cloud && fields[0]->association == Association::point) keep = cells_by_points(*in, p.all_points, keep);
  for (size_t f = 1; f < fields.size(); ++f) {
    std::vector<uint8_t> also = in_range(*fields[f], p, ranges);
    if (!cloud && fields[f]->association == Association::point) also = cells_by_points(*in, p.all_points, also);
    for (size_t c = 0; c < keep.size(); ++c) keep[c] &= also[c];
  }
  if (p.invert || !states.empty())
    parallel_for(keep.size(), values_per_chunk, [&](size_t begin, size_t end) {
      for (size_t c = begin; c < end; ++c) keep[c] = (keep[c] != 0) != p.invert && (states.empty() || states[c] == cell_visible);
    });
  return tell(extract_marked(in, keep, "threshold"));
}

}  // namespace sg

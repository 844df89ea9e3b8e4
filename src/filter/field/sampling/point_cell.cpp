// SPDX-License-Identifier: Apache-2.0
#include "filter/field/sampling/point_cell.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/cell_reader.h"
#include "data/cells/point_cells.h"
#include "data/lattice.h"

namespace sg {

namespace {

constexpr size_t cells_per_chunk = 1 << 14;

std::vector<Field> chosen_fields(const DatasetPtr& in, const std::vector<std::string>& names, Association from) {
  std::vector<Field> chosen;
  for (const std::string& name : names) chosen.push_back(in->fields().require(name, from));
  if (names.empty())
    for (const Field& f : in->fields())
      if (f.association == from && f.role != Role::global_ids) chosen.push_back(f);
  return chosen;
}

// Runs f(out, mean) with the type of the result; mean(sum, count) of each component is written by f.
ElementType mean_type(ElementType t) {
  if (is_float(t)) return t;
  return element_size(t) >= 4 ? ElementType::f64 : ElementType::f32;
}

// Means over lists of input tuples: `lists(i, buffer)` gives the tuples behind output i. The buffers belong to the caller's chunk.
template <class MakeLists>
Array means(const Array& a, size_t n, MakeLists&& make_lists, Context& ctx) {
  std::byte* bytes = nullptr;
  const ElementType type = mean_type(a.type());
  const int m = a.components();
  Array result = Array::make_raw(type, n, m, &bytes);
  dispatch(a, [&](const auto& v) {
    parallel_for(
        n, cells_per_chunk,
        [&](size_t begin, size_t end) {
          auto lists = make_lists();
          for (size_t i = begin; i < end; ++i) {
            const auto from = lists(i);
            for (int c = 0; c < m; ++c) {
              double sum = 0;
              size_t count = 0;
              for (const auto k : from) {
                const double x = double(v(size_t(k), c));
                if (std::isnan(x)) continue;
                sum += x;
                ++count;
              }
              const double mean = count ? sum / double(count) : std::nan("");
              const size_t at = i * size_t(m) + size_t(c);
              if (type == ElementType::f32) reinterpret_cast<float*>(bytes)[at] = float(mean);
              else reinterpret_cast<double*>(bytes)[at] = mean;
            }
          }
        },
        &ctx);
  });
  return result;
}

// The cells around a point of a lattice.
struct LatticeCells {
  std::array<size_t, 3> points, cells;
  View<uint8_t> ghost;
  std::array<int64_t, 8> found{};

  std::span<const int64_t> operator()(size_t p) {
    const size_t at[3] = {p % points[0], p / points[0] % points[1], p / (points[0] * points[1])};
    size_t lo[3], hi[3], n = 0;
    for (int a = 0; a < 3; ++a) lo[a] = at[a] > 0 ? at[a] - 1 : 0, hi[a] = std::min(at[a], cells[size_t(a)] - 1);
    for (size_t k = lo[2]; k <= hi[2]; ++k)
      for (size_t j = lo[1]; j <= hi[1]; ++j)
        for (size_t i = lo[0]; i <= hi[0]; ++i) {
          const size_t c = i + cells[0] * (j + cells[1] * k);
          if (!ghost.data || !(ghost[c] & (ghost_hidden_cell | ghost_refined_cell))) found[n++] = int64_t(c);
        }
    return {found.data(), n};
  }
};

DatasetPtr with_fields(const DatasetPtr& in, std::vector<Field> fields, Association on) {
  DatasetParts parts = in->parts();
  for (Field& f : fields) {
    f.association = on;
    parts.fields.add(std::move(f));
  }
  return make_dataset(std::move(parts));
}

}  // namespace

DatasetPtr point_to_cell(const DatasetPtr& in, const PointToCellParams& p, Context& ctx) {
  std::vector<Field> fields = chosen_fields(in, p.fields, Association::point);
  const CellReader all(in);
  for (Field& f : fields)
    f.array = means(
        f.array, in->cell_count(),
        [&] {
          return [reader = all](size_t cell) mutable {
            reader.open(cell);
            return reader.ids();
          };
        },
        ctx);
  return with_fields(in, std::move(fields), Association::cell);
}

DatasetPtr cell_to_point(const DatasetPtr& in, const CellToPointParams& p, Context& ctx) {
  std::vector<Field> fields = chosen_fields(in, p.fields, Association::cell);
  if (fields.empty() || in->as<PointCloud>()) return in;  // what a cloud has lies on its points
  if (is_lattice(in->mesh())) {
    LatticeCells around{lattice_dims(in->mesh()), {}, {}};
    for (size_t a = 0; a < 3; ++a) around.cells[a] = std::max<size_t>(around.points[a], 2) - 1;
    if (!in->cell_ghost().empty()) around.ghost = in->cell_ghost().view<uint8_t>();
    for (Field& f : fields)
      f.array = means(
          f.array, in->point_count(), [&] { return around; }, ctx);
  } else {
    const PointCells cells(in);
    for (Field& f : fields)
      f.array = means(
          f.array, in->point_count(), [&] { return [&](size_t point) { return cells[point]; }; }, ctx);
  }
  return with_fields(in, std::move(fields), Association::point);
}

}  // namespace sg

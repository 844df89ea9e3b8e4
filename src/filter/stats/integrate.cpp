// SPDX-License-Identifier: Apache-2.0
#include "filter/stats/integrate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/cell_reader.h"
#include "data/cells/shape/cell_map.h"
#include "data/lattice.h"
#include "filter/stats/stats_parts.h"

namespace sg {

namespace {

constexpr size_t cells_per_chunk = 1 << 12;

struct Column {
  const Field* field;
  int component;
};

int highest_dimension(const DatasetPtr& d) {
  CellReader reader(d);
  int highest = -1;
  for (size_t c = 0; c < reader.count() && highest < 3; ++c) {
    if (reader.hidden(c)) continue;
    reader.open(c);
    highest = std::max(highest, reader.dimension());
  }
  return highest;
}

// Grids along straight axes: a cell is the image of a unit box under an affine map, where each corner has the same share of the integral of
// what is linear along each axis.
class AffineCells {
 public:
  explicit AffineCells(const Dataset& d) : lattice_(d.mesh()), v_(lattice_.view()) {
    for (size_t a = 0; a < 3; ++a) {
      cells_[a] = std::max<size_t>(v_.dims[a], 2) - 1;
      if (v_.dims[a] > 1) axes_[dimension_++] = a;
    }
    if (d.as<UniformGrid>()) even_ = measure({0, 0, 0});
  }
  static bool fits(const Dataset& d) { return d.as<UniformGrid>() || d.as<RectilinearGrid>(); }
  int dimension() const { return int(dimension_); }
  /// Places of the cell along the axes.
  std::array<size_t, 3> place(size_t cell) const { return {cell % cells_[0], cell / cells_[0] % cells_[1], cell / cells_[0] / cells_[1]}; }
  size_t first_corner(const std::array<size_t, 3>& at) const { return at[0] + v_.dims[0] * (at[1] + v_.dims[1] * at[2]); }
  /// From the id of the first corner to that of another.
  size_t offset(size_t corner) const {
    std::array<size_t, 3> to{};
    for (size_t k = 0; k < dimension_; ++k) to[axes_[k]] = corner >> k & 1;
    return first_corner(to);
  }
  double measure(const std::array<size_t, 3>& at) const {
    if (even_) return *even_;
    Vec3 edge[3];
    const Vec3 first = v_.position(at[0], at[1], at[2]);
    for (size_t k = 0; k < dimension_; ++k) {
      auto next = at;
      ++next[axes_[k]];
      edge[k] = v_.position(next[0], next[1], next[2]) - first;
    }
    switch (dimension_) {
      case 3: return std::abs(dot(edge[0], cross(edge[1], edge[2])));
      case 2: return length(cross(edge[0], edge[1]));
      case 1: return length(edge[0]);
      default: return 1;
    }
  }
  size_t corners() const { return size_t(1) << dimension_; }

 private:
  Lattice lattice_;
  LatticeView v_;
  std::array<size_t, 3> cells_{}, axes_{};
  size_t dimension_ = 0;
  std::optional<double> even_;  ///< where all cells are alike
};

// Adds the sums of cells [begin, end) of such a grid.
void add_affine(const AffineCells& cells, const CellReader& reader, const std::vector<Column>& columns, size_t begin, size_t end,
                std::vector<ExactSum>& sums) {
  struct Cell {
    size_t id, corner;
    double measure;
  };
  std::vector<Cell> open;
  open.reserve(end - begin);
  for (size_t c = begin; c < end; ++c) {
    if (reader.hidden(c)) continue;
    const auto at = cells.place(c);
    open.push_back({c, cells.first_corner(at), cells.measure(at)});
    sums.back().add(open.back().measure);
  }
  std::array<size_t, 8> offsets{};
  const size_t corners = cells.corners();
  for (size_t i = 0; i < corners; ++i) offsets[i] = cells.offset(i);
  for (size_t k = 0; k < columns.size(); ++k) {
    const int component = columns[k].component;
    const bool of_cells = columns[k].field->association == Association::cell;
    dispatch(columns[k].field->array, [&](const auto& values) {
      ExactSum sum = sums[k];
      for (const Cell& cell : open) {
        double v = 0;
        if (of_cells) v = double(values(cell.id, component));
        else
          for (size_t i = 0; i < corners; ++i) v += double(values(cell.corner + offsets[i], component)) / double(corners);
        sum.add(cell.measure * v);
      }
      sums[k] = sum;
    });
  }
}

// Sums of the columns, the measure last.
std::vector<ExactSum> sums_of(const DatasetPtr& d, int dimension, const std::vector<Column>& columns, Context& ctx) {
  const size_t n = columns.size() + 1;
  using Sums = std::vector<ExactSum>;
  std::optional<AffineCells> affine;
  if (AffineCells::fits(*d) && d->cell_count() > 0) affine.emplace(*d);
  if (affine && affine->dimension() != dimension) return Sums(n);
  const CellReader reader(d);
  return parallel_reduce(
      d->cell_count(), cells_per_chunk, Sums(n),
      [&](size_t begin, size_t end) {
        Sums sums(n);
        if (affine) {
          add_affine(*affine, reader, columns, begin, end, sums);
          return sums;
        }
        CellMap map(d);
        std::vector<double> weights;
        for (size_t c = begin; c < end; ++c) {
          if (map.reader().hidden(c)) continue;
          map.open(c);
          if (map.dimension() != dimension) continue;
          const auto ids = map.reader().ids();
          weights.resize(ids.size());
          map.integration_weights(weights);
          double measure = 0;
          for (const double w : weights) measure += w;
          sums.back().add(measure);
          for (size_t k = 0; k < columns.size(); ++k) {
            const Array& a = columns[k].field->array;
            double v = 0;
            if (columns[k].field->association == Association::cell) v = measure * a.get(c, columns[k].component);
            else
              for (size_t i = 0; i < ids.size(); ++i) v += weights[i] * a.get(size_t(ids[i]), columns[k].component);
            sums[k].add(v);
          }
        }
        return sums;
      },
      [&](Sums a, Sums b) {
        if (a.empty()) return b;
        for (size_t i = 0; i < b.size(); ++i) a[i].add(b[i]);
        return a;
      },
      &ctx);
}

struct Row {
  std::string field;
  Association association;
  int component;
  std::string unit;
  ExactSum sum, measure;
};

void add_to(std::vector<Row>& rows, const Field& f, int component, const ExactSum& sum, const ExactSum& measure) {
  for (Row& r : rows)
    if (r.field == f.name && r.association == f.association && r.component == component) {
      r.sum.add(sum), r.measure.add(measure);
      return;
    }
  rows.push_back({f.name, f.association, component, f.unit, sum, measure});
}

TablePtr table_of(const std::vector<Row>& rows, const ExactSum& whole, int dimension) {
  std::vector<std::string> names;
  std::vector<int32_t> field, association, component;
  std::vector<double> integral, mean, measure;
  auto add = [&](const std::string& name, Association a, int c, double sum, double size) {
    const auto at = std::find(names.begin(), names.end(), name);
    field.push_back(int32_t(at - names.begin()));
    if (at == names.end()) names.push_back(name);
    association.push_back(int32_t(a)), component.push_back(c), integral.push_back(sum), mean.push_back(sum / size), measure.push_back(size);
  };
  constexpr const char* kinds[4] = {"count", "length", "area", "volume"};
  add(kinds[dimension], Association::whole, 0, whole.value(), whole.value());
  for (const Row& r : rows) add(r.field, r.association, r.component, r.sum.value(), r.measure.value());
  auto t = std::make_shared<Table>();
  add_column(*t, "field", std::move(field), names);
  add_column(*t, "association", std::move(association), {"point", "cell", "whole"});
  add_column(*t, "component", std::move(component));
  add_column(*t, "integral", std::move(integral));
  add_column(*t, "mean", std::move(mean));
  add_column(*t, "measure", std::move(measure));
  return t;
}

}  // namespace

TablePtr integrate(const Data& in, const IntegrateParams& p, Context& ctx) {
  std::vector<DatasetPtr> parts;
  int dimension = -1;
  for_each_dataset(in, [&](const std::string&, const DatasetPtr& d) {
    parts.push_back(d);
    dimension = std::max(dimension, highest_dimension(d));
  });
  dimension = all_most(dimension, ctx.communicator);
  if (dimension < 0) fail_usage("has no cells to integrate over", "integrate", "hidden and duplicate cells do not count");
  std::vector<Row> rows;
  ExactSum whole;
  for (const std::string& name : p.fields) {
    bool found = false;
    for (const DatasetPtr& d : parts) found = found || d->fields().find(name);
    if (!found) (void)parts[0]->fields().require(name);  // lists what there is
  }
  for (const DatasetPtr& d : parts) {
    std::vector<Column> columns;
    for (const Field& f : d->fields()) {
      const bool asked = p.fields.empty() || std::find(p.fields.begin(), p.fields.end(), f.name) != p.fields.end();
      if (asked && f.association != Association::whole)
        for (int c = 0; c < f.components(); ++c) columns.push_back({&f, c});
    }
    std::vector<ExactSum> sums = sums_of(d, dimension, columns, ctx);
    over_all(sums, ctx);
    for (size_t k = 0; k < columns.size(); ++k) add_to(rows, *columns[k].field, columns[k].component, sums[k], sums.back());
    whole.add(sums.back());
  }
  return table_of(rows, whole, dimension);
}

}  // namespace sg

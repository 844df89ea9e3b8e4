// SPDX-License-Identifier: Apache-2.0
#include "filter/stats/integrate.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/shape/cell_map.h"
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

// Sums of the columns, the measure last.
std::vector<ExactSum> sums_of(const DatasetPtr& d, int dimension, const std::vector<Column>& columns, Context& ctx) {
  const size_t n = columns.size() + 1;
  using Sums = std::vector<ExactSum>;
  return parallel_reduce(
      d->cell_count(), cells_per_chunk, Sums(n),
      [&](size_t begin, size_t end) {
        Sums sums(n);
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

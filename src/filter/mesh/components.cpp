// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/components.h"

#include "base/error.h"
#include "data/cell_reader.h"
#include "filter/mesh/extract.h"

namespace sg {

namespace {

class UnionFind {
 public:
  explicit UnionFind(size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), size_t(0)); }
  size_t root(size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  // The smaller root stays, so that the result does not depend on the order of joins.
  void join(size_t a, size_t b) {
    a = root(a), b = root(b);
    if (a < b) parent_[b] = a;
    else parent_[a] = b;
  }

 private:
  std::vector<size_t> parent_;
};

}  // namespace

DatasetPtr components(const DatasetPtr& in, const ComponentsParams& p, Context& ctx) {
  CellReader reader(in);
  const size_t n = reader.count();
  if (p.keep > 0 && p.at) fail_usage("keep and at are two ways to choose", "components", "give one of them");
  UnionFind sets(in->point_count());
  std::vector<int64_t> first(n, -1);  // a point of each cell
  double nearest = HUGE_VAL;
  int64_t chosen = -1;
  for (size_t c = 0; c < n; ++c) {
    if (c % 65536 == 0) ctx.check();
    if (reader.hidden(c)) continue;
    reader.open(c);
    const auto ids = reader.ids();
    if (ids.empty()) continue;
    first[c] = ids[0];
    for (const int64_t id : ids) sets.join(size_t(ids[0]), size_t(id));
    if (p.at)
      for (size_t k = 0; k < ids.size(); ++k)
        if (const Vec3 d = reader.at()[k] - *p.at; dot(d, d) < nearest) nearest = dot(d, d), chosen = ids[k];
  }
  // Number the sets by size, then by first cell.
  std::vector<std::pair<size_t, size_t>> size_of;  // cells, order of first appearance
  std::vector<int64_t> number(in->point_count(), -1);
  for (size_t c = 0; c < n; ++c) {
    if (first[c] < 0) continue;
    int64_t& k = number[sets.root(size_t(first[c]))];
    if (k < 0) k = int64_t(size_of.size()), size_of.emplace_back(0, size_of.size());
    ++size_of[size_t(k)].first;
  }
  std::stable_sort(size_of.begin(), size_of.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<int32_t> rank(size_of.size());
  for (size_t i = 0; i < size_of.size(); ++i) rank[size_of[i].second] = int32_t(i);
  std::vector<int32_t> component(n, -1);
  for (size_t c = 0; c < n; ++c)
    if (first[c] >= 0) component[c] = rank[size_t(number[sets.root(size_t(first[c]))])];
  const int32_t wanted = chosen >= 0 ? rank[size_t(number[sets.root(size_t(chosen))])] : -1;

  std::vector<int64_t> cells;
  for (size_t c = 0; c < n; ++c)
    if (p.at ? component[c] == wanted && wanted >= 0 : component[c] >= 0 && component[c] < p.keep) cells.push_back(int64_t(c));
  DatasetParts parts = in->parts();
  const bool cloud = in->as<PointCloud>();
  parts.fields.add(
      {"component", cloud ? Association::point : Association::cell, Array::from_vector(std::move(component)), "", Role::labels});
  const DatasetPtr all = make_dataset(std::move(parts));
  return p.keep > 0 || p.at ? extract_cells(all, cells, "components") : all;
}

}  // namespace sg

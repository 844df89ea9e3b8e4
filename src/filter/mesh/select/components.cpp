// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/select/components.h"

#include <fmt/core.h>

#include <algorithm>
#include <tuple>

#include "base/error.h"
#include "base/union_find.h"
#include "data/cells/cell_reader.h"
#include "filter/mesh/select/extract.h"
#include "filter/mesh/surface_builder.h"

namespace sg {

namespace {

// Patches have points of their own.
void join_equal_places(const Dataset& in, UnionFind<size_t>& sets) {
  std::vector<int64_t> order(in.point_count());
  std::iota(order.begin(), order.end(), 0);
  const Points at = points_of(in.mesh(), order);
  auto key = [&](int64_t i) { return std::tuple(at.xyz.get(size_t(i), 0), at.xyz.get(size_t(i), 1), at.xyz.get(size_t(i), 2)); };
  std::stable_sort(order.begin(), order.end(), [&](int64_t a, int64_t b) { return key(a) < key(b); });
  for (size_t i = 1; i < order.size(); ++i)
    if (key(order[i]) == key(order[i - 1])) sets.join(size_t(order[i]), size_t(order[i - 1]));
}

}  // namespace

DatasetPtr components(const DatasetPtr& in, const ComponentsParams& p, Context& ctx) {
  CellReader reader(in);
  const size_t n = reader.count();
  if ((p.keep > 0) + p.at.has_value() + !p.points.empty() > 1)
    fail_usage("keep, at and points are different ways to choose", "components", "give one of them");
  for (int64_t i : p.points)
    if (i < 0 || size_t(i) >= in->point_count())
      fail_usage(fmt::format("there is no point {}", i), "components points", fmt::format("the mesh has {} points", in->point_count()));
  UnionFind<size_t> sets(in->point_count());
  if (in->as<AmrGrid>()) join_equal_places(*in, sets);
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
  std::vector<uint8_t> wanted(rank.size(), 0);
  for (int32_t k = 0; k < std::min(p.keep, int(rank.size())); ++k) wanted[size_t(k)] = 1;
  auto want = [&](int64_t point) {  // points of no visible cell choose nothing
    if (const int64_t k = number[sets.root(size_t(point))]; k >= 0) wanted[size_t(rank[size_t(k)])] = 1;
  };
  if (chosen >= 0) want(chosen);
  for (int64_t i : p.points) want(i);

  std::vector<int64_t> cells;
  for (size_t c = 0; c < n; ++c)
    if (component[c] >= 0 && wanted[size_t(component[c])]) cells.push_back(int64_t(c));
  DatasetParts parts = in->parts();
  const bool cloud = in->as<PointCloud>();
  const Association on = cloud ? Association::point : Association::cell;
  parts.fields.add({"component", on, Array::from_vector(std::move(component)), "", Role::labels, {.result = true}});
  const DatasetPtr all = make_dataset(std::move(parts));
  return p.keep > 0 || p.at || !p.points.empty() ? extract_cells(all, cells, "components") : all;
}

}  // namespace sg

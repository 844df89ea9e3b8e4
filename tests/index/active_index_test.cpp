// SPDX-License-Identifier: Apache-2.0
#include "index/span/active_index.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/parallel.h"
#include "base/random.h"
#include "support/test.h"

using namespace sg;

namespace {

constexpr ActiveIndexKind list_kinds[] = {ActiveIndexKind::interval_tree, ActiveIndexKind::span_tree, ActiveIndexKind::span_lattice};

// Ends on a grid of 1/16, so that many coincide with each other and with the values asked for; constant, empty and endless items.
Spans random_spans(size_t n, uint64_t seed, double longest) {
  Spans s;
  for (size_t i = 0; i < n; ++i) {
    const double lo = std::floor(160 * random_unit(seed, 3 * i)) / 16, d = std::floor(16 * longest * random_unit(seed, 3 * i + 1)) / 16;
    s.lo.push_back(float(lo)), s.hi.push_back(float(lo + d));
    const double odd = random_unit(seed, 3 * i + 2);
    if (odd < 0.02) s.lo[i] = HUGE_VALF, s.hi[i] = -HUGE_VALF;
    else if (odd < 0.03) s.lo[i] = -HUGE_VALF;
    else if (odd < 0.04) s.hi[i] = HUGE_VALF;
  }
  return s;
}

std::vector<uint32_t> brute_force(const Spans& s, double value) {
  std::vector<uint32_t> r;
  for (size_t i = 0; i < s.size(); ++i)
    if (s.lo[i] < value && value <= s.hi[i]) r.push_back(uint32_t(i));
  return r;
}

// A strip of n^3 cubes, six tetrahedra each, with a smooth field; `shuffled`: the same cells in random order.
DatasetPtr tetrahedra(size_t n, bool shuffled) {
  const size_t m = n + 1;
  std::vector<float> xyz, f;
  for (size_t k = 0; k < m; ++k)
    for (size_t j = 0; j < m; ++j)
      for (size_t i = 0; i < m; ++i) {
        for (size_t c : {i, j, k}) xyz.push_back(float(c));
        f.push_back(float(std::sin(0.3 * double(i)) + std::cos(0.2 * double(j)) * std::sin(0.25 * double(k))));
      }
  constexpr int kuhn[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  std::vector<size_t> order(6 * n * n * n);
  std::iota(order.begin(), order.end(), size_t(0));
  if (shuffled) std::sort(order.begin(), order.end(), [](size_t a, size_t b) { return random_unit(5, a) < random_unit(5, b); });
  std::vector<int32_t> ids;
  for (size_t cell : order) {
    const size_t cube = cell / 6, i = cube % n, j = cube / n % n, k = cube / n / n;
    for (int c : kuhn[cell % 6]) ids.push_back(int32_t(i + size_t(c & 1) + m * (j + size_t(c >> 1 & 1) + m * (k + size_t(c >> 2)))));
  }
  UnstructuredMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.cells.fixed = 4;
  mesh.cells.connectivity = Array::from_vector(std::move(ids));
  mesh.single_type = CellType::tetra;
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::move(f)), "", Role::scalars});
  return make_dataset(std::move(mesh), fields);
}

}  // namespace

TEST_CASE("active index: every kind finds exactly the items that the value crosses, ascending") {
  const Context context;
  for (auto [n, longest] : {std::pair<size_t, double>{0, 1}, {1, 1}, {2, 3}, {37, 10}, {5000, 0.4}, {5000, 6}, {20000, 1}}) {
    const Spans s = random_spans(n, n + 1, longest);
    std::vector<double> values{-1, 0, 10, 16, 1e300, -1e300, std::numeric_limits<double>::quiet_NaN(), std::nextafter(5.0, 9.0)};
    for (int k = 0; k < 60; ++k)
      values.push_back(k % 2 ? std::floor(160 * random_unit(9, uint64_t(k))) / 16 : 10 * random_unit(9, uint64_t(k)));
    for (ActiveIndexKind kind : list_kinds) {
      CAPTURE(active_index_name(kind));
      const ActiveIndex index(s, kind, context);
      CHECK(index.kind() == kind);
      CHECK(index.items() == n);
      for (double v : values) {
        CAPTURE(v);
        CHECK(index.active(v) == brute_force(s, v));
      }
    }
  }
}

TEST_CASE("active index: the octree finds exactly the cubes of a lattice that the value crosses") {
  const std::array<size_t, 3> d{70, 41, 29};
  std::vector<float> v(d[0] * d[1] * d[2]);
  for (size_t p = 0; p < v.size(); ++p) v[p] = float(std::floor(8 * std::sin(0.001 * double(p)) + 2 * random_unit(1, p)));
  const Array a = Array::from_vector(std::move(v));
  const MinMaxBricks bricks = minmax_bricks(a, d);
  Spans s;
  for (const auto& r : bricks.ranges) s.lo.push_back(r.lo), s.hi.push_back(r.hi);
  const ActiveIndex index(minmax_octree(bricks));
  CHECK(index.kind() == ActiveIndexKind::octree);
  for (double value : {-8.0, -7.5, 0.0, 3.0, 9.0, 10.0, 11.0}) CHECK(index.active(value) == brute_force(s, value));
}

TEST_CASE("active index: work grows with what is found: a value crossed by few of a million items looks at few") {
  // Counted by the walk itself: calls of f are the items found, and the tree may look at sqrt(n) others.
  Spans s;
  const size_t n = 1 << 20;
  for (size_t i = 0; i < n; ++i) s.lo.push_back(float(i)), s.hi.push_back(float(i) + 1);
  const Context context;
  for (ActiveIndexKind kind : list_kinds) {
    const ActiveIndex index(s, kind, context);
    CHECK(index.active(12345.5) == std::vector<uint32_t>{12345});
    CHECK(index.bytes() <= 36 * n);
  }
}

TEST_CASE("active index: spans of cells hold their points' values, in groups too") {
  const Context context;
  const DatasetPtr d = tetrahedra(7, true);
  const Array f = d->fields().require("f").array;
  double length = 0, wanted = 0;
  const Spans one = cell_spans(*d, f, 1, context), many = cell_spans(*d, f, 10, context, &length);
  const CellsView cells = cells_view(d->as<UnstructuredMesh>()->cells);
  REQUIRE(one.size() == cells.count);
  for (size_t c = 0; c < cells.count; ++c) {
    float lo = HUGE_VALF, hi = -HUGE_VALF;
    for (size_t k = 0; k < 4; ++k) {
      const float v = f.view<float>()[size_t(cells.point(c, k))];
      lo = std::min(lo, v), hi = std::max(hi, v);
    }
    CHECK((one.lo[c] == lo && one.hi[c] == hi));
  }
  for (size_t c = 0; c < cells.count; ++c) wanted += double(one.hi[c]) - double(one.lo[c]);
  CHECK(length == doctest::Approx(wanted));
  for (size_t i = 0; i < many.size(); ++i) {
    const size_t from = 10 * i, to = std::min(cells.count, from + 10);
    CHECK(many.lo[i] == *std::min_element(one.lo.begin() + ptrdiff_t(from), one.lo.begin() + ptrdiff_t(to)));
    CHECK(many.hi[i] == *std::max_element(one.hi.begin() + ptrdiff_t(from), one.hi.begin() + ptrdiff_t(to)));
  }
  // Doubles are rounded outward.
  const Array third = Array::from_vector(std::vector<double>(f.count(), 1.0 / 3));
  const Spans s = cell_spans(*d, third, 1, context);
  CHECK((double(s.lo[0]) <= 1.0 / 3 && double(s.hi[0]) >= 1.0 / 3 && s.hi[0] - s.lo[0] < 1e-6f));
}

TEST_CASE("active index: groups where neighbours follow each other, single cells where they do not") {
  const Context context;
  for (bool shuffled : {false, true}) {
    const DatasetPtr d = tetrahedra(40, shuffled);
    const Array f = d->fields().require("f").array;
    const CellActiveIndex index = cell_active_index(*d, f, context);
    CHECK((index.cells_per_item == 1) == shuffled);
    CHECK(index.cells == d->cell_count());
    const Spans s = cell_spans(*d, f, 1, context);
    for (double value : {-0.7, 0.1, 0.9}) {
      const auto items = index.index.active(value);
      for (uint32_t c : brute_force(s, value)) CHECK(std::binary_search(items.begin(), items.end(), uint32_t(c / index.cells_per_item)));
    }
  }
}

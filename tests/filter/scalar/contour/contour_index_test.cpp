// SPDX-License-Identifier: Apache-2.0
// Contours asked for again and again: an index answers, and nobody can tell from the result.
#include <algorithm>
#include <cstring>

#include "base/parallel.h"
#include "base/random.h"
#include "data/memory/memo.h"
#include "filter/mesh/to_unstructured.h"
#include "filter/scalar/contour/contour_support.h"
#include "support/test.h"

using namespace sg;
using test::same_bytes;

namespace {

template <class T>
DatasetPtr grid(std::array<size_t, 3> dims, double factor, bool holes, bool ghosts) {
  std::vector<T> v;
  for (size_t k = 0; k < dims[2]; ++k)
    for (size_t j = 0; j < dims[1]; ++j)
      for (size_t i = 0; i < dims[0]; ++i) {
        const double f = 3 + std::sin(0.09 * double(i)) + std::cos(0.12 * double(j)) * std::sin(0.1 * double(k) + 1) +
                         (i > 60 ? 0.3 * random_unit(3, v.size()) : 0);
        v.push_back(T(factor * f));
        if constexpr (std::is_floating_point_v<T>)
          // A wall of NaN three samples thick: the field may be on different sides of it.
          if (holes && ((i >= 15 && i <= 17 && j > 4) || random_unit(4, v.size()) < 0.001)) v.back() = T(NAN);
      }
  UniformGrid g;
  g.dims = dims;
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({"f", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  if (ghosts) {
    std::vector<uint8_t> cells(cell_count(parts.mesh), 0);
    for (size_t c = 0; c < cells.size(); ++c) cells[c] = random_unit(6, c) < 0.01 ? ghost_hidden_cell : 0;
    parts.cell_ghost = Array::from_vector(std::move(cells));
  }
  return make_dataset(std::move(parts));
}

void check_equal(const DatasetPtr& a, const DatasetPtr& b) {
  const auto &m = *a->as<SurfaceMesh>(), &n = *b->as<SurfaceMesh>();
  CHECK(same_bytes(m.points.xyz, n.points.xyz));
  CHECK(same_bytes(m.polygons.connectivity, n.polygons.connectivity));
  CHECK(same_bytes(m.lines.connectivity, n.lines.connectivity));
  REQUIRE(a->fields().size() == b->fields().size());
  for (const Field& f : a->fields()) CHECK(same_bytes(f.array, b->fields().require(f.name).array));
}

DatasetPtr at(const DatasetPtr& d, std::vector<double> values) {
  Context context;
  ContourParams p;
  p.values = std::move(values);
  const DatasetPtr r = contour(d, p, context);
  validate(r->mesh());
  return r;
}

// The same data that knows nothing yet.
DatasetPtr fresh(const DatasetPtr& d) { return make_dataset(d->parts()); }

void check_repeats(const DatasetPtr& d, std::initializer_list<double> values) {
  CHECK(d->memo().bytes() == 0);
  at(d, {*values.begin()});
  CHECK(d->memo().bytes() == 0);  // one contour alone pays for no index
  for (double v : values) {
    CAPTURE(v);
    const DatasetPtr again = at(d, {v});
    CHECK(d->memo().bytes() > 0);
    check_equal(again, at(fresh(d), {v}));
  }
}

}  // namespace

TEST_CASE("contour again: grids of all kinds of samples give the same bytes with their index as without") {
  const auto types = [](auto&& check) {
    check(grid<float>({131, 37, 21}, 1, false, false), 1);
    check(grid<double>({64, 37, 21}, 1, false, false), 1);
    check(grid<uint8_t>({70, 20, 30}, 40, false, false), 40);
    check(grid<int16_t>({65, 17, 9}, 1000, false, false), 1000);
    check(grid<uint16_t>({9, 9, 9}, 1000, false, false), 1000);
    check(grid<int32_t>({40, 8, 24}, 1e6, false, false), 1e6);
  };
  types([](const DatasetPtr& d, double s) { check_repeats(d, {3 * s, 2.5 * s, 4.25 * s, 1e9, -5}); });
}

TEST_CASE("contour again: missing samples, hidden cells, flat grids and rounded values change nothing") {
  check_repeats(grid<float>({131, 37, 21}, 1, true, false), {3, 2.5, 4.25});
  check_repeats(grid<float>({80, 37, 21}, 1, true, true), {3, 2.5, 4.25});
  check_repeats(grid<double>({80, 37, 21}, 1, true, true), {3, 2.5, 4.25});
  check_repeats(grid<float>({200, 90, 1}, 1, true, true), {3, 2.5, 4.25});
  // Samples on a few levels: the value is a sample's own, and whole cubes are constant.
  const DatasetPtr steps = grid<uint8_t>({90, 40, 33}, 3, false, false);
  check_repeats(steps, {9, 10, 8.5, 11, 12});
}

TEST_CASE("contour again: many values in one request, with the index or without, for any number of threads") {
  const DatasetPtr d = grid<float>({131, 67, 41}, 1, true, false);
  const std::vector<double> values{2.2, 2.6, 3, 3.4, 3.8};
  at(d, {3.3});
  const DatasetPtr many = at(d, values);
  CHECK(d->memo().bytes() > 0);
  set_thread_count(8);
  const DatasetPtr eight = at(fresh(d), values);
  set_thread_count(1);
  const DatasetPtr one = at(fresh(d), values);
  set_thread_count(0);
  check_equal(many, eight);
  check_equal(many, one);
  size_t cells = 0;
  for (double v : values) cells += at(fresh(d), {v})->cell_count();
  CHECK(many->cell_count() == cells);
}

TEST_CASE("contour again: cells of all kinds, in file order and at random, give the same bytes with their index as without") {
  Context context;
  for (bool shuffled : {false, true}) {
    const DatasetPtr grid24 = grid<double>({25, 20, 17}, 1, true, true);
    DatasetPtr mesh = to_unstructured(grid24, {}, context);
    if (shuffled) {
      std::vector<int64_t> order(mesh->cell_count());
      for (size_t c = 0; c < order.size(); ++c) order[c] = int64_t(c);
      std::sort(order.begin(), order.end(), [](int64_t a, int64_t b) { return random_unit(8, uint64_t(a)) < random_unit(8, uint64_t(b)); });
      UnstructuredMesh m = *mesh->as<UnstructuredMesh>();
      const CellsView cells = cells_view(m.cells);
      std::vector<int64_t> ids;
      for (int64_t c : order)
        for (size_t k = 0; k < cells.size(size_t(c)); ++k) ids.push_back(cells.point(size_t(c), k));
      REQUIRE(cells.fixed == 8);
      m.cells.connectivity = Array::from_vector(std::move(ids));
      DatasetParts parts = mesh->parts();
      parts.mesh = std::move(m);
      parts.cell_ghost = {};
      mesh = make_dataset(std::move(parts));
    }
    check_repeats(mesh, {3, 2.5, 4.25, 1e9});
  }
  // A surface: its lines come before its polygons in the numbering of cells.
  SurfaceMesh s;
  std::vector<float> xyz, f;
  for (int j = 0; j < 40; ++j)
    for (int i = 0; i < 40; ++i) {
      for (double x : {double(i), double(j), 0.0}) xyz.push_back(float(x));
      f.push_back(float(std::sin(0.2 * i) + std::cos(0.3 * j)));
    }
  std::vector<int32_t> quads, lines;
  for (int j = 0; j + 1 < 40; ++j)
    for (int i = 0; i + 1 < 40; ++i)
      for (int p : {i + 40 * j, i + 1 + 40 * j, i + 41 + 40 * j, i + 40 + 40 * j}) quads.push_back(p);
  for (int i = 0; i + 1 < 40; ++i) lines.push_back(i), lines.push_back(i + 1);
  s.points.xyz = Array::from_vector(std::move(xyz), 3);
  s.polygons.connectivity = Array::from_vector(std::move(quads)), s.polygons.fixed = 4;
  s.lines.connectivity = Array::from_vector(std::move(lines)), s.lines.fixed = 2;
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::move(f)), "", Role::scalars});
  check_repeats(make_dataset(s, fields), {0.1, -0.5, 1.2});
}

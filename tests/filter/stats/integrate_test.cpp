// SPDX-License-Identifier: Apache-2.0
#include "filter/stats/integrate.h"

#include "base/parallel.h"
#include "data/cells/point_positions.h"
#include "filter/mesh/to_unstructured.h"
#include "support/test.h"

using namespace sg;

namespace {

// The field 2 + x - 3 y + z on the points, 5 on the cells.
DatasetPtr with_linear(Mesh mesh) {
  const Array at = point_positions(mesh);
  std::vector<double> v;
  for (size_t i = 0; i < at.count(); ++i) v.push_back(2 + at.get(i, 0) - 3 * at.get(i, 1) + at.get(i, 2));
  FieldSet f;
  f.add({"p", Association::point, Array::from_vector(v), "", Role::scalars});
  f.add({"c", Association::cell, Array::from_vector(std::vector<float>(cell_count(mesh), 5.f)), "", Role::none});
  return make_dataset(std::move(mesh), std::move(f));
}

double value(const TablePtr& t, const char* column, size_t row) {
  for (const Field& f : t->columns)
    if (f.name == column) return f.array.get(row);
  FAIL("no column");
  return 0;
}

UniformGrid box() {
  UniformGrid g;
  g.dims = {5, 4, 3};
  g.spacing = {0.5, 1, 2};  // 2 x 3 x 4 from the origin
  return g;
}

}  // namespace

TEST_CASE("integrate: volume and a linear field over a box, on grids and their cells") {
  Context ctx;
  const double volume = 2 * 3 * 4, mean = 2 + 1 - 3 * 1.5 + 2;
  for (const DatasetPtr& d : {with_linear(box()), to_unstructured(with_linear(box()))}) {
    const TablePtr t = integrate(d, {}, ctx);
    CHECK((*t->words(0))[0] == "volume");
    CHECK(value(t, "integral", 0) == doctest::Approx(volume).epsilon(1e-13));
    CHECK(value(t, "integral", 1) == doctest::Approx(volume * mean).epsilon(1e-13));
    CHECK(value(t, "mean", 1) == doctest::Approx(mean).epsilon(1e-13));
    CHECK(value(t, "integral", 2) == doctest::Approx(5 * volume).epsilon(1e-13));
  }
}

TEST_CASE("integrate: a surface gives its area, lines their length; hidden cells do not count") {
  Context ctx;
  UniformGrid flat = box();
  flat.dims = {5, 4, 1};
  CHECK(value(integrate(with_linear(flat), {}, ctx), "integral", 0) == doctest::Approx(6).epsilon(1e-14));
  flat.dims = {5, 1, 1};
  DatasetParts line = with_linear(flat)->parts();
  line.cell_ghost = Array::from_vector(std::vector<uint8_t>{0, ghost_hidden_cell, ghost_duplicate, 0});
  const TablePtr t = integrate(make_dataset(line), {}, ctx);
  CHECK((*t->words(0))[0] == "length");
  CHECK(value(t, "integral", 0) == doctest::Approx(1).epsilon(1e-14));
  CHECK(value(t, "integral", 1) == doctest::Approx(0.5 * (2.25 + 3.75)).epsilon(1e-14));
}

TEST_CASE("integrate: a collection is one integral; unknown fields are refused") {
  Context ctx;
  auto parts = std::make_shared<Collection>();
  parts->parts.push_back({"a", with_linear(box())});
  parts->parts.push_back({"b", with_linear(box())});
  const TablePtr t = integrate(CollectionPtr(parts), {{"c"}}, ctx);
  CHECK(t->columns[0].array.count() == 2);
  CHECK(value(t, "integral", 0) == doctest::Approx(48).epsilon(1e-13));
  CHECK(value(t, "integral", 1) == doctest::Approx(240).epsilon(1e-13));
  CHECK(test::error_of([&] { integrate(CollectionPtr(parts), {{"d"}}, ctx); }).find("'d'") != std::string::npos);
  CHECK(test::error_of([&] { integrate(make_dataset(Mesh(UnstructuredMesh{})), {}, ctx); }).find("no cell") != std::string::npos);
}

TEST_CASE("integrate: the same numbers for any number of threads") {
  UniformGrid g;
  g.dims = {40, 40, 40};
  Context ctx;
  const DatasetPtr d = to_unstructured(with_linear(g));
  set_thread_count(1);
  const double one = value(integrate(d, {}, ctx), "integral", 1);
  set_thread_count(8);
  CHECK(value(integrate(d, {}, ctx), "integral", 1) == one);
  set_thread_count(0);
}

// SPDX-License-Identifier: Apache-2.0
#include "filter/field/sampling/point_cell.h"

#include "data/cells/cell_reader.h"
#include "data/cells/point_cells.h"
#include "data/lattice.h"
#include "filter/mesh/to_unstructured.h"
#include "support/test.h"

using namespace sg;

namespace {

DatasetPtr grid(std::array<size_t, 3> n) {
  UniformGrid g;
  g.dims = n;
  g.spacing = {1, 0.5, 2};
  std::vector<double> at_points;
  const LatticeView v = Lattice(Mesh(g)).view();
  auto linear = [](Vec3 p) { return 3 + p.x - 2 * p.y + 0.5 * p.z; };
  for (size_t k = 0; k < n[2]; ++k)
    for (size_t j = 0; j < n[1]; ++j)
      for (size_t i = 0; i < n[0]; ++i) at_points.push_back(linear(v.position(i, j, k)));
  FieldSet f;
  f.add({"f", Association::point, Array::from_vector(at_points), "K", Role::scalars});
  return make_dataset(g, std::move(f));
}

}  // namespace

TEST_CASE("point_to_cell: a linear field gives its value at the middle of each cell") {
  Context ctx;
  const DatasetPtr c = point_to_cell(grid({5, 4, 3}), {}, ctx);
  const Field& f = c->fields().require("f", Association::cell);
  CHECK(f.unit == "K");
  CHECK(f.array.type() == ElementType::f64);
  CHECK(f.array.get(0) == doctest::Approx(3 + 0.5 - 2 * 0.25 + 0.5 * 1).epsilon(1e-14));
  CHECK(c->fields().find("f", Association::point));
}

TEST_CASE("cell_to_point: exact inside a grid for a linear field, and grids and their cells agree") {
  Context ctx;
  const DatasetPtr there = point_to_cell(grid({5, 4, 4}), {}, ctx);
  DatasetParts only = there->parts();
  only.fields.remove("f", Association::point);
  const DatasetPtr back = cell_to_point(make_dataset(only), {}, ctx);
  const Array &f = back->fields().require("f", Association::point).array, &exact = there->fields().require("f", Association::point).array;
  for (size_t k = 1; k < 3; ++k)
    for (size_t j = 1; j < 3; ++j)
      for (size_t i = 1; i < 4; ++i) CHECK(f.get(i + 5 * (j + 4 * k)) == doctest::Approx(exact.get(i + 5 * (j + 4 * k))).epsilon(1e-14));
  const DatasetPtr listed = cell_to_point(to_unstructured(make_dataset(only)), {}, ctx);
  const Array& g = listed->fields().require("f", Association::point).array;
  REQUIRE(g.count() == f.count());
  for (size_t i = 0; i < f.count(); ++i) CHECK(g.get(i) == doctest::Approx(f.get(i)).epsilon(1e-14));
}

TEST_CASE("cell_to_point: NaN and hidden cells do not count, a point without a cell has no value") {
  UniformGrid g;
  g.dims = {4, 1, 1};
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({"c", Association::cell, Array::from_vector(std::vector<float>{1, NAN, 5}), "", Role::none});
  parts.fields.add({"n", Association::cell, Array::from_vector(std::vector<int32_t>{1, 2, 4}), "", Role::none});
  parts.cell_ghost = Array::from_vector(std::vector<uint8_t>{ghost_hidden_cell, 0, 0});
  Context ctx;
  for (const DatasetPtr& d : {make_dataset(parts), to_unstructured(make_dataset(parts))}) {
    const DatasetPtr r = cell_to_point(d, {}, ctx);
    const Array& c = r->fields().require("c", Association::point).array;
    CHECK(std::isnan(c.get(0)));
    CHECK(std::isnan(c.get(1)));
    CHECK(c.get(2) == 5);
    const Array& n = r->fields().require("n", Association::point).array;
    CHECK(n.type() == ElementType::f64);
    CHECK(n.get(2) == 3);
  }
  CHECK(test::error_of([&] { cell_to_point(make_dataset(parts), {{"d"}}, ctx); }).find("'d'") != std::string::npos);
}

TEST_CASE("point cells: every cell of a point, ascending") {
  const DatasetPtr d = to_unstructured(grid({3, 3, 1}));
  const PointCells cells(d);
  REQUIRE(cells.points() == 9);
  CHECK(std::vector<uint32_t>(cells[4].begin(), cells[4].end()) == std::vector<uint32_t>{0, 1, 2, 3});
  CHECK(std::vector<uint32_t>(cells[2].begin(), cells[2].end()) == std::vector<uint32_t>{1});
}

TEST_CASE("cell_to_point: a cloud passes as it is, with empty fields of the cells that it does not have") {
  Context ctx;
  FieldSet fields;
  fields.add({"c", Association::cell, Array::from_vector(std::vector<float>()), "", Role::none});
  const DatasetPtr cloud =
      make_dataset(Mesh(PointCloud{{Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0}, 3), Vec3()}}), std::move(fields));
  CHECK(cell_to_point(cloud, {}, ctx) == cloud);
}

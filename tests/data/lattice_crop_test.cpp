// SPDX-License-Identifier: Apache-2.0
#include "data/lattice_crop.h"

#include "data/lattice.h"
#include "support/test.h"

using namespace sg;

namespace {

// A grid whose point value is 1 + i + 10 j + 100 k, cell value the same of its lowest point.
DatasetParts numbered(std::array<size_t, 3> n) {
  DatasetParts parts;
  UniformGrid g;
  g.dims = n;
  g.origin = {5, 6, 7};
  g.spacing = {1, 2, 3};
  parts.mesh = g;
  std::vector<float> p, c;
  for (size_t k = 0; k < n[2]; ++k)
    for (size_t j = 0; j < n[1]; ++j)
      for (size_t i = 0; i < n[0]; ++i) {
        p.push_back(float(1 + i + 10 * j + 100 * k));
        if ((i + 1 < n[0] || n[0] == 1) && (j + 1 < n[1] || n[1] == 1) && (k + 1 < n[2] || n[2] == 1)) c.push_back(p.back());
      }
  parts.fields.add({"p", Association::point, Array::from_vector(p), "K", Role::scalars});
  parts.fields.add({"c", Association::cell, Array::from_vector(c), "", Role::none});
  return parts;
}

}  // namespace

TEST_CASE("crop: points, cells, positions and extent of an index box") {
  const DatasetPtr d = make_dataset(numbered({6, 5, 4}));
  const DatasetPtr c = crop_lattice(*d, {1, 2, 1}, {3, 4, SIZE_MAX});
  const auto* g = c->as<UniformGrid>();
  REQUIRE(g);
  CHECK(g->dims == std::array<size_t, 3>{3, 3, 3});
  CHECK(g->origin == Vec3{6, 10, 10});
  CHECK(g->extent_start == std::array<long long, 3>{1, 2, 1});
  const Field& p = c->fields().require("p");
  CHECK(p.unit == "K");
  CHECK(p.array.get(0) == 1 + 1 + 20 + 100);
  CHECK(p.array.get(26) == 1 + 3 + 40 + 300);
  const Field& cell = c->fields().require("c", Association::cell);
  REQUIRE(cell.array.count() == 8);
  CHECK(cell.array.get(0) == 122);
  CHECK(cell.array.get(7) == 1 + 2 + 30 + 200);
}

TEST_CASE("crop: a stride takes every n-th point and drops cell fields with a note") {
  const DatasetPtr c = crop_lattice(*make_dataset(numbered({7, 5, 4})), {0, 0, 0}, {SIZE_MAX, SIZE_MAX, SIZE_MAX}, {3, 2, 2});
  const auto* g = c->as<UniformGrid>();
  REQUIRE(g);
  CHECK(g->dims == std::array<size_t, 3>{3, 3, 2});
  CHECK(g->spacing == Vec3{3, 4, 6});
  CHECK(c->fields().require("p").array.get(4) == 1 + 3 + 20);
  CHECK_FALSE(c->fields().find("c", Association::cell));
  CHECK(c->notes().size() == 1);
}

TEST_CASE("crop: a single layer at the far end takes the cells before it") {
  const DatasetPtr c = crop_lattice(*make_dataset(numbered({4, 4, 4})), {0, 0, 3}, {3, 3, 3});
  CHECK(c->cell_count() == 9);
  CHECK(c->fields().require("c", Association::cell).array.get(0) == 1 + 200);
}

TEST_CASE("crop: rectilinear and curvilinear grids keep their coordinates") {
  DatasetParts r;
  r.mesh = RectilinearGrid{Array::from_vector(std::vector<double>{0, 1, 4, 9}),
                           Array::from_vector(std::vector<float>{0, 2}),
                           Array::from_vector(std::vector<float>{5}),
                           {10, 0, 0}};
  const DatasetPtr c = crop_lattice(*make_dataset(r), {1, 0, 0}, {3, 1, 0}, {2, 1, 1});
  const auto* g = c->as<RectilinearGrid>();
  REQUIRE(g);
  CHECK(g->x.count() == 2);
  CHECK(g->x.get(0) == 1);
  CHECK(g->x.get(1) == 9);
  CurvilinearGrid cu;
  cu.dims = {2, 2, 1};
  cu.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 3, 4}, 3);
  const DatasetPtr k = crop_lattice(*make_dataset(Mesh(cu)), {1, 1, 0}, {1, 1, 0});
  CHECK(k->as<CurvilinearGrid>()->points.at(0) == Vec3{2, 3, 4});
}

TEST_CASE("crop: an empty box, a stride of 0 and other meshes are refused") {
  const DatasetPtr d = make_dataset(numbered({4, 4, 4}));
  CHECK(test::error_of([&] { crop_lattice(*d, {4, 0, 0}, {9, 3, 3}); }).find("0 to 3") != std::string::npos);
  CHECK(test::error_of([&] { crop_lattice(*d, {0, 0, 0}, {3, 3, 3}, {1, 0, 1}); }).find("stride") != std::string::npos);
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0}, 3);
  CHECK(test::error_of([&] { crop_lattice(*make_dataset(Mesh(cloud)), {0, 0, 0}, {0, 0, 0}); }).find("points") != std::string::npos);
}

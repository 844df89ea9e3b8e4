// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/select/piece.h"

#include <numeric>
#include <set>

#include "data/lattice.h"
#include "support/test.h"

using namespace sg;

namespace {

DatasetPtr with_cell_ids(Mesh mesh) {
  std::vector<int64_t> ids(cell_count(mesh));
  std::iota(ids.begin(), ids.end(), 0);
  FieldSet fields;
  fields.add({"id", Association::cell, Array::from_vector(std::move(ids)), "", Role::labels});
  return make_dataset(std::move(mesh), std::move(fields));
}

// A strip of n quads.
UnstructuredMesh strip(size_t n) {
  UnstructuredMesh m;
  std::vector<float> xyz;
  std::vector<int32_t> quads;
  for (size_t i = 0; i <= n; ++i)
    for (const float y : {0.f, 1.f}) xyz.insert(xyz.end(), {float(i), y, 0});
  for (size_t i = 0; i < n; ++i)
    for (const size_t k : {2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1}) quads.push_back(int32_t(k));
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.cells.connectivity = Array::from_vector(std::move(quads));
  m.cells.fixed = 4;
  m.single_type = CellType::quad;
  return m;
}

// Own cells of all pieces: each once; ghosts: those next to own ones.
void check_partition(const DatasetPtr& whole, int pieces, int levels) {
  Context ctx;
  std::multiset<int64_t> own;
  for (int p = 0; p < pieces; ++p) {
    const DatasetPtr part = take_piece(whole, p, pieces, levels, ctx);
    for (size_t c = 0; c < part->cell_count(); ++c)
      if (part->cell_ghost().empty() || !(uint8_t(part->cell_ghost().get(c)) & ghost_duplicate))
        own.insert(int64_t(part->fields().require("id").array.get(c)));
  }
  CHECK(own.size() == whole->cell_count());
  CHECK(std::set<int64_t>(own.begin(), own.end()).size() == whole->cell_count());
}

}  // namespace

TEST_CASE("piece: the own cells of all pieces are the cells of the mesh, each once") {
  UniformGrid g;
  g.dims = {5, 9, 4};
  for (const int pieces : {2, 3, 8, 11})
    for (const int levels : {0, 1, 2}) {
      CAPTURE(pieces);
      CAPTURE(levels);
      check_partition(with_cell_ids(g), pieces, levels);
      check_partition(with_cell_ids(strip(10)), pieces, levels);
    }
}

TEST_CASE("piece: a ghost layer holds the neighbours that share a point") {
  Context ctx;
  const DatasetPtr part = take_piece(with_cell_ids(strip(9)), 1, 3, 2, ctx);
  CHECK(part->cell_count() == 7);  // 3 own, 2 on each side
  int ghosts = 0;
  for (size_t c = 0; c < 7; ++c) ghosts += part->cell_ghost().get(c) != 0;
  CHECK(ghosts == 4);
  UniformGrid g;
  g.dims = {10, 3, 3};
  const DatasetPtr box = take_piece(with_cell_ids(g), 2, 3, 1, ctx);
  CHECK(lattice_dims(box->mesh())[0] == 5);  // 3 own cells and one ghost
  CHECK(box->cell_ghost().get(0) == ghost_duplicate);
  CHECK(box->cell_ghost().get(1) == 0);
}

TEST_CASE("piece: a piece that is not there is refused, a single piece is the mesh itself") {
  Context ctx;
  const DatasetPtr d = with_cell_ids(strip(3));
  CHECK(test::error_of([&] { take_piece(d, 3, 3, 0, ctx); }).find("no piece 3 of 3") != std::string::npos);
  CHECK(take_piece(d, 0, 1, 0, ctx) == d);
}

TEST_CASE("piece: point clouds are cut by points") {
  std::vector<float> xyz(30);
  std::iota(xyz.begin(), xyz.end(), 0.f);
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(xyz, 3);
  const DatasetPtr d = make_dataset(cloud);
  Context ctx;
  size_t n = 0;
  for (int k = 0; k < 3; ++k) {
    const DatasetPtr part = take_piece(d, k, 3, 1, ctx);
    REQUIRE(part->as<PointCloud>());
    for (size_t i = 0; i < part->point_count(); ++i, ++n) CHECK(part->as<PointCloud>()->points.at(i) == cloud.points.at(n));
  }
  CHECK(n == 10);
}

TEST_CASE("pieces: data are a collection of pieces that hold something, whatever they are") {
  Context ctx;
  const DatasetPtr d = with_cell_ids(strip(5));
  CHECK(std::get<DatasetPtr>(in_pieces(d, 1, ctx)) == d);
  const CollectionPtr three = std::get<CollectionPtr>(in_pieces(d, 3, ctx));
  REQUIRE(three->parts.size() == 3);
  CHECK(three->parts[2].name == "2");
  CHECK(std::get<CollectionPtr>(in_pieces(d, 9, ctx))->parts.size() == 5);  // one cell each
  UniformGrid g;
  g.dims = {4, 2, 2};
  const CollectionPtr grids = std::get<CollectionPtr>(in_pieces(with_cell_ids(g), 9, ctx));
  REQUIRE(grids->parts.size() == 3);
  CHECK(std::get<DatasetPtr>(grids->parts[1].data)->as<UniformGrid>()->extent_start[0] == 1);
  auto both = std::make_shared<Collection>();
  both->parts = {{"a", d}, {"t", std::make_shared<const Table>()}};
  const CollectionPtr cut = std::get<CollectionPtr>(in_pieces(CollectionPtr(both), 2, ctx));
  CHECK(std::get<CollectionPtr>(cut->parts[0].data)->parts.size() == 2);
  CHECK(std::holds_alternative<TablePtr>(cut->parts[1].data));
  CHECK(test::error_of([&] { in_pieces(d, 0, ctx); }).find("at least 1") != std::string::npos);
}

// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "samples.h"

using namespace sg;

namespace {

void write(const std::string& path, const DatasetPtr& d, const char* compression = "none") {
  Context context;
  WriteOptions o;
  o.compression = value_of_word<Compression>(compression);
  write_data(path, d, o, context);
}

Array ramp(size_t n, int components, double from) {
  std::vector<double> v(n * size_t(components));
  for (size_t i = 0; i < v.size(); ++i) v[i] = from + std::sin(double(i));
  return Array::from_vector(std::move(v), components);
}

void check_same_fields(const Dataset& a, const Dataset& b) {
  CHECK(a.fields().size() == b.fields().size());
  for (const Field& f : a.fields()) {
    CAPTURE(f.name);
    const Field* g = b.fields().find(f.name, f.association);
    REQUIRE(g);
    CHECK(test::same_array(f.array, g->array));
    CHECK(f.unit == g->unit);
    CHECK(f.role == g->role);
  }
  CHECK(test::same_array(a.cell_ghost(), b.cell_ghost()));
  CHECK(a.time() == b.time());
}

DatasetPtr uniform() {
  UniformGrid g;
  g.dims = {17, 9, 13};
  g.origin = {1, 2, 3}, g.spacing = {0.5, 0.25, 2}, g.extent_start = {3, 0, -2};
  DatasetParts p;
  p.mesh = g;
  p.fields.add({"p", Association::point, ramp(17 * 9 * 13, 1, 0), "K", Role::scalars});
  p.fields.add({"v", Association::point, ramp(17 * 9 * 13, 3, 5), {}, Role::vectors});
  p.fields.add({"c", Association::cell, ramp(16 * 8 * 12, 1, 9), "m/s", Role::none});
  p.fields.add({"w", Association::whole, ramp(4, 2, 1), {}, Role::none});
  std::vector<uint8_t> ghost(16 * 8 * 12, 0);
  ghost[7] = ghost_hidden_cell;
  p.cell_ghost = Array::from_vector(std::move(ghost));
  p.time = 2.5;
  return make_dataset(std::move(p));
}

DatasetPtr cells() {
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}, 3);
  m.points.origin = {1e7, 0, 0};
  m.cells.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2, 3, 1, 2, 3, 4, 0, 1});
  m.cells.offsets = Array::from_vector(std::vector<int32_t>{0, 4, 8, 10});
  m.types = Array::from_vector(std::vector<uint8_t>{10, 42, 3});
  m.faces.connectivity = Array::from_vector(std::vector<int64_t>{1, 2, 3, 1, 4, 2, 2, 4, 3, 3, 4, 1});
  m.faces.offsets = Array::from_vector(std::vector<int64_t>{0, 3, 6, 9, 12});
  m.polyhedron_faces = Array::from_vector(std::vector<int64_t>{0, 0, 4, 4});
  FieldSet f;
  f.add({"a/b", Association::cell, ramp(3, 1, 0), {}, Role::none});
  return make_dataset(Mesh(m), f);
}

DatasetPtr surface() {
  SurfaceMesh m;
  m.points.xyz = ramp(6, 3, 0);
  m.vertices = {Array::from_vector(std::vector<int32_t>{5}), {}, 1};
  m.lines = {Array::from_vector(std::vector<int32_t>{0, 1, 2}), Array::from_vector(std::vector<int32_t>{0, 3}), 0};
  m.polygons = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 3, 4, 5}), {}, 3};
  m.strips = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 3}), Array::from_vector(std::vector<int32_t>{0, 4}), 0};
  FieldSet f;
  f.add({"c", Association::cell, ramp(5, 2, 0), {}, Role::none});
  f.add({"p", Association::point, ramp(6, 9, 0), {}, Role::tensors});
  return make_dataset(Mesh(m), f);
}

DatasetPtr amr(int dimension) {
  AmrGrid g;
  g.dimension = dimension;
  g.origin = {1, 2, 3};
  const long long top = dimension == 2 ? 0 : 3;
  g.levels.resize(2);
  g.levels[0].ratio = {1, 1, 1};
  g.levels[0].patches = {{{0, 0, 0}, {3, 3, top}, 0, 0}};
  g.levels[1].spacing = {0.5, 0.5, dimension == 2 ? 1 : 0.5};
  if (dimension == 2) g.levels[1].ratio = {2, 2, 1};
  g.levels[1].patches = {{{0, 0, 0}, {1, 1, dimension == 2 ? 0 : 1}, 0, 0}, {{4, 4, 0}, {5, 7, dimension == 2 ? 0 : 1}, 0, 0}};
  size_t cells = 0, points = 0;
  for (auto& l : g.levels)
    for (auto& p : l.patches) {
      p.cell_offset = cells, p.point_offset = points;
      const auto c = p.cells();
      cells += c[0] * c[1] * c[2], points += (c[0] + 1) * (c[1] + 1) * (dimension == 2 ? 1 : c[2] + 1);
    }
  DatasetParts p;
  p.mesh = g;
  p.fields.add({"c", Association::cell, ramp(cells, 1, 0), {}, Role::none});
  p.fields.add({"p", Association::point, ramp(points, 1, 0), {}, Role::none});
  std::vector<uint8_t> ghost(cells, 0);
  ghost[0] = ghost_refined_cell;
  p.cell_ghost = Array::from_vector(std::move(ghost));
  return make_dataset(std::move(p));
}

}  // namespace

TEST_CASE("vtkhdf: what is written is read back, packed or not, the same bytes every time") {
  for (const char* compression : {"none", "zlib"}) {
    CAPTURE(compression);
    int n = 0;
    for (const DatasetPtr& d : {uniform(), cells(), surface(), amr(3), amr(2)}) {
      CAPTURE(summary(*d));
      const std::string path = test::temp_folder() + fmt::format("written{}.vtkhdf", n++);
      write(path, d, compression);
      const std::string once = test::bytes_of(path);
      const DatasetPtr r = test::read_file(path);
      CHECK(r->kind() == d->kind());
      CHECK(r->point_count() == d->point_count());
      CHECK(r->cell_count() == d->cell_count());
      CHECK(r->bounds() == d->bounds());
      CHECK(cell_type_counts(r->mesh()) == cell_type_counts(d->mesh()));
      if (d->as<UnstructuredMesh>()) {
        CHECK(r->fields().require("a_b").array.get(2) == d->fields()[0].array.get(2));
        CHECK(cells_view(r->as<UnstructuredMesh>()->faces).point(3, 1) == 4);
      } else {
        check_same_fields(*d, *r);
      }
      if (const auto* g = d->as<UniformGrid>()) CHECK(r->as<UniformGrid>()->extent_start == g->extent_start);
      test::with_threads(1, [&] { return write(path, d, compression), 0; });
      CHECK(test::bytes_of(path) == once);
    }
  }
}

TEST_CASE("vtkhdf: packed files are read the same by one and by many threads") {
  UniformGrid g;
  g.dims = {64, 64, 64};
  FieldSet f;
  f.add({"p", Association::point, ramp(64 * 64 * 64, 1, 0), {}, Role::none});
  const DatasetPtr d = make_dataset(Mesh(g), f);
  const std::string path = test::temp_folder() + "packed.vtkhdf";
  write(path, d, "zlib");
  CHECK(test::bytes_of(path).size() < d->fields()[0].array.bytes());
  const Array one = test::with_threads(1, [&] { return test::read_file(path)->fields()[0].array; });
  const Array many = test::with_threads(8, [&] { return test::read_file(path)->fields()[0].array; });
  CHECK(test::same_array(one, many));
  CHECK(test::same_array(one, f[0].array));
}

TEST_CASE("vtkhdf: unpacked numbers stay in the mapped file") {
  const std::string path = test::temp_folder() + "mapped.vtkhdf";
  write(path, uniform());
  const DatasetPtr a = test::read_file(path);
  ReadOptions quick;
  quick.header_only = true;
  CHECK(test::read_file(path, quick)->fields().find("p"));
  write(path, uniform(), "zlib");
  CHECK(!test::read_file(path, quick)->fields().find("p"));
  CHECK(a->fields().require("p").array.get(3) == uniform()->fields().require("p").array.get(3));
}

TEST_CASE("vtkhdf: what cannot be written says so and leaves nothing") {
  RectilinearGrid r;
  r.x = r.y = r.z = Array::from_vector(std::vector<double>{0, 1, 3});
  const std::string path = test::temp_folder() + "never.vtkhdf";
  CHECK(test::contains(test::error_of([&] { write(path, make_dataset(Mesh(r))); }), "no grids of kind rectilinear"));
  CHECK(test::contains(test::error_of([&] { write(path, uniform(), "lz4"); }), "use zlib or none"));
  CHECK(test::contains(test::error_of([&] { write("/no/such/folder/x.vtkhdf", uniform()); }), "cannot be written"));
  CHECK(!file_exists(path));
  for (const std::string& name : folder_entries(test::temp_folder())) CHECK(!test::contains(name, "partial"));
}

TEST_CASE("vtkhdf: weights and orders of high-order cells come back into the mesh, and clouds as clouds") {
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0.5, 0, 0, 0.5, 0.5, 0, 0, 0.5, 0}, 3);
  m.cells.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2, 3, 4, 5}), m.cells.fixed = 6;
  m.single_type = CellType::bezier_triangle;
  m.weights = Array::from_vector(std::vector<double>{1, 1, 1, 0.7, 0.7, 0.7});
  m.degrees = Array::from_vector(std::vector<uint8_t>{2, 2, 2}, 3);
  const std::string path = test::temp_folder() + "shaped.vtkhdf";
  write(path, make_dataset(m));
  Context context;
  DatasetPtr back = std::get<DatasetPtr>(read_data(path, {}, context));
  REQUIRE(back->as<UnstructuredMesh>());
  CHECK(test::same_array(back->as<UnstructuredMesh>()->weights, m.weights));
  CHECK(test::same_array(back->as<UnstructuredMesh>()->degrees, m.degrees));
  write(path, back);  // as fields now
  back = std::get<DatasetPtr>(read_data(path, {}, context));
  CHECK(test::same_array(back->as<UnstructuredMesh>()->weights, m.weights));
  CHECK(back->fields().size() == 2);

  DatasetParts p;
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  p.mesh = cloud;
  p.fields.add({"T", Association::point, Array::from_vector(std::vector<float>{1, 2, 3}), {}, Role::scalars});
  const std::string points = test::temp_folder() + "cloud.vtkhdf";
  write(points, make_dataset(p));
  back = std::get<DatasetPtr>(read_data(points, {}, context));
  REQUIRE(back->as<PointCloud>());
  check_same_fields(*make_dataset(p), *back);
  CHECK(test::same_array(back->as<PointCloud>()->points.xyz, cloud.points.xyz));
}

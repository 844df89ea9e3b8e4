// SPDX-License-Identifier: Apache-2.0
// components, merge_points, append: how cells hang together.
#include <numeric>

#include "filter/mesh/append.h"
#include "filter/mesh/merge_points.h"
#include "filter/mesh/select/components.h"
#include "filter/mesh/to_unstructured.h"
#include "support/test.h"

using namespace sg;

namespace {

// n separate triangles in a row, sharing places but no points: triangle soup of a strip.
DatasetPtr soup(size_t n, double gap = 0, double x0 = 0) {
  SurfaceMesh s;
  std::vector<double> xyz;
  std::vector<int32_t> ids;
  std::vector<float> value;
  for (size_t i = 0; i < n; ++i) {
    const double x = x0 + double(i / 2) * 1.0;
    if (i % 2 == 0) xyz.insert(xyz.end(), {x, 0, 0, x + 1, gap, 0, x, 1, 0});
    else xyz.insert(xyz.end(), {x + 1, 0, 0, x + 1, 1, 0, x, 1 - gap, 0});
    for (int k = 0; k < 3; ++k) ids.push_back(int32_t(ids.size())), value.push_back(float(ids.size()));
  }
  s.points.xyz = Array::from_vector(xyz, 3);
  s.polygons = {Array::from_vector(ids), {}, 3};
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(value), "", Role::scalars});
  std::vector<int32_t> id(n);
  std::iota(id.begin(), id.end(), 0);
  f.add({"id", Association::cell, Array::from_vector(id), "", Role::none});
  return make_dataset(Mesh(s), std::move(f));
}

}  // namespace

TEST_CASE("merge_points: a soup becomes a strip, the first point at a place stays") {
  Context ctx;
  const DatasetPtr m = merge_points(soup(6), {}, ctx);
  CHECK(m->cell_count() == 6);
  CHECK(m->point_count() == 8);  // 2 x 4
  CHECK(m->fields().require("v").array.get(0) == 1);
  CHECK(m->fields().require("v").array.get(1) == 2);
  CHECK(merge_points(soup(6, 1e-4), {}, ctx)->point_count() > 8);
  CHECK(merge_points(soup(6, 1e-4), {1e-3}, ctx)->point_count() == 8);
}

TEST_CASE("merge_points: cells that fall together go, with a note") {
  Context ctx;
  std::string said;
  ctx.on_log = [&](LogLevel, std::string_view t) { said = t; };
  CHECK(merge_points(soup(4), {10}, ctx)->cell_count() == 0);
  CHECK(said.find("4 cells collapsed") != std::string::npos);
  CHECK(test::error_of([&] { merge_points(soup(4), {1e-30}, ctx); }).find("below the precision of the coordinates") != std::string::npos);
}

TEST_CASE("components: numbered by size, kept by number or by place") {
  Context ctx;
  const DatasetPtr two = append({soup(2), soup(6, 0, 100)}, {}, ctx);
  const DatasetPtr merged = merge_points(two, {}, ctx);
  const DatasetPtr c = components(merged, {}, ctx);
  const Array& n = c->fields().require("component", Association::cell).array;
  CHECK(n.get(0) == 1);
  CHECK(n.get(1) == 1);
  CHECK(n.get(2) == 0);
  CHECK(n.get(7) == 0);
  CHECK(components(merged, {1, {}}, ctx)->cell_count() == 6);
  CHECK(components(merged, {0, Vec3{0, 0, 5}}, ctx)->cell_count() == 2);
  CHECK(components(two, {}, ctx)->fields().require("component", Association::cell).array.get(7) == 7);  // a soup: nothing hangs together
  CHECK(test::error_of([&] { components(two, {1, Vec3{0, 0, 0}}, ctx); }).find("one of them") != std::string::npos);
}

TEST_CASE("components: a hidden cell joins nothing") {
  UniformGrid g;
  g.dims = {4, 2, 2};
  DatasetParts parts;
  parts.mesh = g;
  parts.cell_ghost = Array::from_vector(std::vector<uint8_t>{0, ghost_hidden_cell, 0});
  Context ctx;
  const Array n = components(make_dataset(parts), {}, ctx)->fields().require("component").array;
  CHECK(n.get(0) == 0);
  CHECK(n.get(1) == -1);
  CHECK(n.get(2) == 1);
}

TEST_CASE("append: surfaces stay a surface, mixed kinds become unstructured, nothing is lost") {
  Context ctx;
  const DatasetPtr both = append({soup(2), soup(3)}, {}, ctx);
  CHECK(both->as<SurfaceMesh>());
  CHECK(both->cell_count() == 5);
  CHECK(both->point_count() == 15);
  CHECK(both->fields().require("part").array.get(2) == 1);
  CHECK(both->fields().require("id").array.get(3) == 1);
  UniformGrid g;
  g.dims = {2, 2, 2};
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(std::vector<double>(8, 7.0)), "", Role::scalars});
  const DatasetPtr mixed = append({soup(2), make_dataset(g, std::move(f))}, {}, ctx);
  const auto* u = mixed->as<UnstructuredMesh>();
  REQUIRE(u);
  CHECK(u->type(0) == CellType::triangle);
  CHECK(u->type(2) == CellType::voxel);
  CHECK(mixed->fields().require("v").array.type() == ElementType::f64);
  CHECK(mixed->fields().require("v").array.get(13) == 7);
  CHECK_FALSE(mixed->fields().find("id"));  // the grid has none
  const DatasetPtr all = append({soup(2), make_dataset(g)}, {true, false}, ctx);
  CHECK(std::isnan(all->fields().require("v").array.get(13)));
  CHECK(all->fields().require("id").array.get(2) == 0);
  CHECK_FALSE(all->fields().find("part"));
}

TEST_CASE("append: cell fields follow the order of a surface: vertices, lines, polygons") {
  SurfaceMesh s;
  s.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  s.vertices = {Array::from_vector(std::vector<int32_t>{0}), {}, 1};
  s.polygons = {Array::from_vector(std::vector<int32_t>{0, 1, 2}), {}, 3};
  FieldSet f;
  f.add({"id", Association::cell, Array::from_vector(std::vector<int32_t>{10, 20}), "", Role::none});
  const DatasetPtr one = make_dataset(Mesh(s), std::move(f));
  Context ctx;
  const Array id = append({one, one}, {}, ctx)->fields().require("id").array;
  CHECK(id.get(0) == 10);
  CHECK(id.get(1) == 10);
  CHECK(id.get(2) == 20);
}

TEST_CASE("append: far apart origins keep their places") {
  Context ctx;
  PointCloud a, b;
  a.points = {Array::from_vector(std::vector<float>{1, 2, 3}, 3), {1e7, 0, 0}};
  b.points = {Array::from_vector(std::vector<float>{1, 2, 3}, 3), {0, 0, 0}};
  const DatasetPtr r = append({make_dataset(Mesh(a)), make_dataset(Mesh(b))}, {}, ctx);
  CHECK(r->as<PointCloud>()->points.at(0) == Vec3{1e7 + 1, 2, 3});
  CHECK(r->as<PointCloud>()->points.at(1) == Vec3{1, 2, 3});
}

TEST_CASE("append: inputs without points add nothing and take nothing away, wherever they stand") {
  Context ctx;
  const DatasetPtr plain = soup(4), far = [] {
    DatasetParts p = soup(4)->parts();
    std::get<SurfaceMesh>(p.mesh).points.origin = {1e7, 0, 0};
    return make_dataset(std::move(p));
  }();
  FieldSet narrow;  // the same names, other components, no tuples
  narrow.add({"v", Association::point, Array(Buffer{}, ElementType::i32, 0, 2), "", Role::none});
  narrow.add({"id", Association::cell, Array(Buffer{}, ElementType::u8, 0, 1), "", Role::none});
  const DatasetPtr nothing[] = {make_dataset(SurfaceMesh{}), make_dataset(UnstructuredMesh{}), make_dataset(PointCloud{}),
                                make_dataset(SurfaceMesh{}, narrow)};
  for (const DatasetPtr& none : nothing)
    for (const DatasetPtr& some : {plain, far})
      for (const std::vector<Data>& inputs : {std::vector<Data>{none, some}, {some, none}, {none, none, some, none}}) {
        const DatasetPtr both = append(inputs, {}, ctx);
        REQUIRE(both->point_count() == some->point_count());
        CHECK(both->cell_count() == some->cell_count());
        const bool solid = none->as<UnstructuredMesh>() || none->as<PointCloud>();
        CHECK(bool(both->as<UnstructuredMesh>()) == solid);
        const DatasetPtr whole = to_unstructured(both), alone = to_unstructured(some);
        for (size_t i = 0; i < some->point_count(); ++i)
          REQUIRE(whole->as<UnstructuredMesh>()->points.at(i) == alone->as<UnstructuredMesh>()->points.at(i));
        for (const Field& f : some->fields()) {
          const Field* g = both->fields().find(f.name, f.association);
          REQUIRE(g);
          CHECK(g->array.type() == f.array.type());
          for (size_t i = 0; i < f.array.count(); ++i) CHECK(g->array.get(i) == f.array.get(i));
        }
      }
  const DatasetPtr none = append({make_dataset(SurfaceMesh{}, narrow), make_dataset(SurfaceMesh{})}, {}, ctx);
  CHECK(none->point_count() == 0);
  CHECK(none->fields().find("v", Association::point));
}

TEST_CASE("unstructured: a cloud becomes vertices, and loses fields on cells that it did not have") {
  DatasetParts parts;
  parts.mesh = PointCloud{{Array::from_vector(std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0}, 3), {}}};
  parts.fields.add({"p", Association::point, Array::from_vector(std::vector<float>{1, 2, 3}), "", Role::none});
  parts.fields.add({"c", Association::cell, Array::from_vector(std::vector<float>{}), "", Role::none});
  const DatasetPtr cells = to_unstructured(make_dataset(std::move(parts)));
  CHECK(cells->cell_count() == 3);
  CHECK(cells->fields().names() == std::vector<std::string>{"p"});
}

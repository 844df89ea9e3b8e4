// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/faces/faces.h"

#include <cstring>

#include "base/parallel.h"
#include "filter/mesh/mesh_meshes.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::meshes;

namespace {

std::vector<CellType> all_solids() {
  std::vector<CellType> types{CellType::tetra, CellType::hexahedron, CellType::voxel,
                              CellType::wedge, CellType::pyramid,    CellType::polyhedron};
  types.insert(types.end(), curved_solids().begin(), curved_solids().end());
  return types;
}

DatasetPtr ghosted(const DatasetPtr& in, size_t cell, uint8_t bits) {
  DatasetParts p = in->parts();
  std::vector<uint8_t> g(in->cell_count());
  g[cell] = bits;
  p.cell_ghost = Array::from_vector(g);
  return make_dataset(p);
}

// Reorders the corners of every hexahedron so that it is inside out.
DatasetPtr mirrored(const DatasetPtr& in) {
  DatasetParts p = in->parts();
  auto& m = std::get<UnstructuredMesh>(p.mesh);
  std::vector<int64_t> ids;
  const CellsView v = cells_view(m.cells);
  for (size_t c = 0; c < v.count; ++c)
    for (size_t k = 0; k < 8; ++k) ids.push_back(v.point(c, (k + 4) % 8));
  m.cells.connectivity = Array::from_vector(ids);
  return make_dataset(p);
}

}  // namespace

TEST_CASE("faces: a box of any solid cells has the box's surface, closed and outward, fields carried") {
  Context ctx;
  for (CellType type : all_solids())
    for (int order : {2, 3}) {
      if (order == 3 && type < CellType::lagrange_curve) continue;
      CAPTURE(cell_type_info(type).name);
      CAPTURE(order);
      const DatasetPtr box = solid_box(type, 3, order);
      const DatasetPtr skin = faces(box, {.original_point = true}, ctx);
      const SurfaceMesh& s = *skin->as<SurfaceMesh>();
      const SurfaceFacts facts = measure(s);
      CHECK(facts.closed);
      CHECK(facts.area == doctest::Approx(6).epsilon(1e-12));
      CHECK(facts.volume == doctest::Approx(1).epsilon(1e-12));
      CHECK(linear_error(*skin, s.points) < 1e-6);
      const Field &cell = skin->fields().require("original_cell"), &c = skin->fields().require("c", Association::cell);
      const Field& point = skin->fields().require("original_point");
      CHECK(cell.array.type() == ElementType::i64);
      CHECK(cell.array.count() == s.polygons.size());
      for (size_t i = 0; i < skin->cell_count(); ++i) REQUIRE(cell.array.get(i) == c.array.get(i));
      for (size_t i = 1; i < s.points.count(); ++i) REQUIRE(point.array.get(i) > point.array.get(i - 1));
      CHECK(length(box->as<UnstructuredMesh>()->points.at(size_t(point.array.get(5))) - s.points.at(5)) < 1e-15);
    }
}

TEST_CASE("faces: counts of polygons are exact for linear cells") {
  Context ctx;
  const std::pair<CellType, size_t> want[] = {
      {CellType::tetra, 6 * 2 * 16}, {CellType::hexahedron, 6 * 16}, {CellType::wedge, 16 * 4 + 2 * 32}, {CellType::pyramid, 6 * 16}};
  for (auto [type, n] : want) CHECK(faces(solid_box(type, 4), {}, ctx)->cell_count() == n);
  const DatasetPtr skin = faces(solid_box(CellType::hexahedron, 4), {}, ctx);
  CHECK(skin->as<SurfaceMesh>()->polygons.fixed == 4);
  CHECK(skin->point_count() == 98);
}

TEST_CASE("faces: inside-out cells still have outward faces") {
  Context ctx;
  const DatasetPtr skin = faces(mirrored(solid_box(CellType::hexahedron, 2)), {}, ctx);
  CHECK(measure(*skin->as<SurfaceMesh>()).volume == doctest::Approx(1));
}

TEST_CASE("faces: grids of all three kinds have the box's surface") {
  Context ctx;
  const DatasetPtr box = uniform_box(4, 3, 5);
  const DatasetPtr skin = faces(box, {}, ctx);
  SurfaceFacts facts = measure(*skin->as<SurfaceMesh>());
  CHECK(facts.closed);
  CHECK(facts.area == doctest::Approx(6));
  CHECK(facts.volume == doctest::Approx(1));
  CHECK(skin->cell_count() == 2 * (12 + 20 + 15));
  CHECK(linear_error(*skin, skin->as<SurfaceMesh>()->points) < 1e-12);
  const Field &cell = skin->fields().require("original_cell"), &c = skin->fields().require("c", Association::cell);
  for (size_t i = 0; i < skin->cell_count(); ++i) REQUIRE(cell.array.get(i) == c.array.get(i));

  RectilinearGrid r;
  r.x = Array::from_vector(std::vector<double>{2, 1.5, 0});  // descending: a mirrored grid
  r.y = Array::from_vector(std::vector<float>{0, 1, 4});
  r.z = Array::from_vector(std::vector<double>{0, 3});
  facts = measure(*faces(make_dataset(r), {}, ctx)->as<SurfaceMesh>());
  CHECK(facts.closed);
  CHECK(facts.volume == doctest::Approx(24));

  CurvilinearGrid g;
  g.dims = {5, 4, 3};
  std::vector<float> xyz;
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 5; ++i) xyz.insert(xyz.end(), {float(i), float(k), float(j)});  // left-handed
  g.points = {Array::from_vector(xyz, 3), {1e7, 0, 0}};
  const DatasetPtr curved = faces(make_dataset(g), {}, ctx);
  facts = measure(*curved->as<SurfaceMesh>());
  CHECK(facts.closed);
  CHECK(facts.volume == doctest::Approx(24).epsilon(1e-6));
  CHECK(curved->as<SurfaceMesh>()->points.origin.x == 1e7);
  CHECK(curved->as<SurfaceMesh>()->points.xyz.type() == ElementType::f32);
}

TEST_CASE("faces: lattices of two, one and no dimensions show all their cells") {
  Context ctx;
  for (auto [a, b, c] : {std::array<size_t, 3>{4, 3, 0}, {0, 4, 3}, {4, 0, 3}}) {
    const DatasetPtr flat = faces(uniform_box(a, b, c), {}, ctx);
    CHECK(flat->as<SurfaceMesh>()->polygons.size() == 12);
    CHECK(measure(*flat->as<SurfaceMesh>()).area == doctest::Approx(1));
  }
  CHECK(faces(uniform_box(0, 5, 0), {}, ctx)->as<SurfaceMesh>()->lines.size() == 5);
  CHECK(faces(uniform_box(0, 0, 0), {}, ctx)->as<SurfaceMesh>()->vertices.size() == 1);
}

TEST_CASE("faces: hidden cells leave a hole, duplicates neither show nor open one") {
  Context ctx;
  const size_t middle = 1 + 3 * (1 + 3 * 1);
  for (const DatasetPtr& box : {uniform_box(3, 3, 3), solid_box(CellType::hexahedron, 3)}) {
    const double before = 6, side = 1.0 / 9;
    const DatasetPtr hole = faces(ghosted(box, middle, ghost_hidden_cell), {}, ctx);
    SurfaceFacts facts = measure(*hole->as<SurfaceMesh>());
    CHECK(facts.area == doctest::Approx(before + 6 * side));
    CHECK(facts.volume == doctest::Approx(26.0 / 27));
    CHECK(facts.closed);
    CHECK(measure(*faces(ghosted(box, middle, ghost_refined_cell), {}, ctx)->as<SurfaceMesh>()).area == doctest::Approx(facts.area));
    facts = measure(*faces(ghosted(box, middle, ghost_duplicate), {}, ctx)->as<SurfaceMesh>());
    CHECK(facts.area == doctest::Approx(before));
    // A duplicate at the corner: its three outer sides are another piece's, and nothing opens behind it.
    facts = measure(*faces(ghosted(box, 0, ghost_duplicate), {}, ctx)->as<SurfaceMesh>());
    CHECK(facts.area == doctest::Approx(before - 3 * side));
    const DatasetPtr corner = faces(ghosted(box, 0, ghost_hidden_cell), {}, ctx);
    CHECK(measure(*corner->as<SurfaceMesh>()).volume == doctest::Approx(26.0 / 27));
    for (size_t i = 0; i < corner->cell_count(); ++i) REQUIRE(corner->fields().require("original_cell").array.get(i) != 0);
  }
}

TEST_CASE("faces: a hidden point hides the cells that touch it") {
  Context ctx;
  for (const DatasetPtr& box : {uniform_box(2, 2, 2), solid_box(CellType::hexahedron, 2)}) {
    DatasetParts p = box->parts();
    std::vector<uint8_t> g(box->point_count());
    g[0] = ghost_hidden_point;
    p.point_ghost = Array::from_vector(g);
    CHECK(measure(*faces(make_dataset(p), {}, ctx)->as<SurfaceMesh>()).volume == doctest::Approx(7.0 / 8));
  }
}

TEST_CASE("faces: cells of lower dimension pass, mixed with solids") {
  Context ctx;
  UnstructuredMesh m;
  std::vector<double> xyz;
  for (int i = 0; i < 20; ++i) xyz.insert(xyz.end(), {double(i % 4), double(i / 4), i * 0.1});
  m.points.xyz = Array::from_vector(xyz, 3);
  const std::vector<std::vector<int64_t>> cells = {
      {0, 1, 2, 7},       {3},       {4, 5}, {4, 5, 6, 8}, {9, 10, 11}, {9, 10, 11, 12}, {13, 14, 15, 16}, {0, 1, 2},
      {17, 18, 19, 0, 1}, {2, 4, 3}, {}};
  const std::vector<uint8_t> types = {10, 1, 3, 4, 5, 8, 6, 2, 7, 21, 0};
  std::vector<int64_t> ids, offsets{0};
  for (const auto& c : cells) ids.insert(ids.end(), c.begin(), c.end()), offsets.push_back(int64_t(ids.size()));
  m.cells = {Array::from_vector(ids), Array::from_vector(offsets), 0};
  m.types = Array::from_vector(types);
  const DatasetPtr skin = faces(make_dataset(m), {}, ctx);
  const SurfaceMesh& s = *skin->as<SurfaceMesh>();
  CHECK(s.vertices.size() == 2);
  CHECK(s.lines.size() == 3);
  CHECK(s.polygons.size() == 4 + 1 + 1 + 2 + 1);
  const Array& cell = skin->fields().require("original_cell").array;
  std::vector<double> source;
  for (size_t i = 0; i < cell.count(); ++i) source.push_back(cell.get(i));
  CHECK(source == std::vector<double>{1, 7, 2, 3, 9, 0, 0, 0, 0, 4, 5, 6, 6, 8});
  CHECK(cells_view(s.lines).size(2) == 33);  // the quadratic edge bends sharply
}

TEST_CASE("faces: points become vertices, surfaces pass unchanged unless they hold ghosts") {
  Context ctx;
  PointCloud cloud{{Array::from_vector(std::vector<float>(30), 3), {}}};
  const DatasetPtr points = faces(make_dataset(cloud), {}, ctx);
  CHECK(points->as<SurfaceMesh>()->vertices.size() == 10);
  const DatasetPtr skin = faces(solid_box(CellType::hexahedron, 2), {}, ctx);
  CHECK(faces(skin, {}, ctx) == skin);
  CHECK(surface_of(skin, ctx) == skin);
  const DatasetPtr less = faces(ghosted(skin, 3, ghost_hidden_cell), {}, ctx);
  CHECK(less->cell_count() == skin->cell_count() - 1);
  CHECK(measure(*less->as<SurfaceMesh>()).area == doctest::Approx(6 - 0.25));
}

TEST_CASE("faces: an AMR grid shows each leaf once and no walls between levels") {
  Context ctx;
  AmrGrid g;
  g.levels.resize(2);
  g.levels[0].ratio = {1, 1, 1};
  g.levels[0].spacing = {0.25, 0.25, 0.25};
  g.levels[0].patches = {{{0, 0, 0}, {1, 3, 3}, 0, 0}, {{2, 0, 0}, {3, 3, 3}, 32, 75}};
  g.levels[1].spacing = {0.125, 0.125, 0.125};
  g.levels[1].patches = {{{2, 0, 2}, {5, 3, 5}, 64, 150}, {{4, 0, 2}, {5, 3, 5}, 128, 275}};  // the second repeats half of the first
  std::vector<uint8_t> ghost(160);
  for (int k = 1; k < 3; ++k)
    for (int j = 0; j < 2; ++j) ghost[size_t(1 + 2 * (j + 4 * k))] = ghost[size_t(32 + 0 + 2 * (j + 4 * k))] = ghost_refined_cell;
  DatasetParts p;
  p.mesh = g;
  p.cell_ghost = Array::from_vector(ghost);
  std::vector<double> number(160);
  for (size_t i = 0; i < 160; ++i) number[i] = double(i);
  p.fields.add(make_field("c", Association::cell, number));
  const DatasetPtr skin = faces(make_dataset(p), {}, ctx);
  SurfaceFacts facts = measure(*skin->as<SurfaceMesh>());
  CHECK(facts.area == doctest::Approx(6));  // walls between levels or patches would add to it
  CHECK(facts.volume == doctest::Approx(1));
  CHECK(length(facts.vector_area) < 1e-12);
  for (size_t i = 0; i < skin->cell_count(); ++i)
    REQUIRE(skin->fields().require("c").array.get(i) == skin->fields().require("original_cell").array.get(i));

  g.dimension = 2;
  g.levels.resize(1);
  g.levels[0].patches = {{{0, 0, 0}, {3, 3, 0}, 0, 0}};
  const DatasetPtr flat = faces(make_dataset(g), {}, ctx);
  CHECK(measure(*flat->as<SurfaceMesh>()).vector_area.z == doctest::Approx(1));
}

TEST_CASE("faces: Bezier control points move onto the surface") {
  // A quarter of a circle as a rational quadratic curve, and a parabola as a plain one.
  Context ctx;
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(std::vector<double>{1, 0, 0, 0, 1, 0, 1, 1, 0}, 3);
  m.cells = {Array::from_vector(std::vector<int32_t>{0, 1, 2}), {}, 3};
  m.single_type = CellType::bezier_curve;
  FieldSet fields;
  fields.add(make_field("f", Association::point, {0, 0, 1}));
  DatasetPtr arc = faces(make_dataset(m, fields), {}, ctx);
  CHECK(length(arc->as<SurfaceMesh>()->points.at(2) - Vec3(0.75, 0.75, 0)) < 1e-14);
  CHECK(arc->fields().require("f").array.get(2) == doctest::Approx(0.5));
  fields.add(make_field("RationalWeights", Association::point, {1, 1, std::sqrt(0.5)}));
  arc = faces(make_dataset(m, fields), {}, ctx);
  CHECK(length(arc->as<SurfaceMesh>()->points.at(2)) == doctest::Approx(1).epsilon(1e-14));
  // The mesh's own weights do the same.
  fields.remove("RationalWeights", Association::point);
  m.weights = Array::from_vector(std::vector<double>{1, 1, std::sqrt(0.5)});
  arc = faces(make_dataset(m, fields), {}, ctx);
  CHECK(length(arc->as<SurfaceMesh>()->points.at(2)) == doctest::Approx(1).epsilon(1e-14));
  CHECK(arc->fields().require("f").array.get(2) == doctest::Approx(std::sqrt(2.0) - 1).epsilon(1e-14));
}

TEST_CASE("faces: the same bytes for one and eight threads") {
  Context ctx;
  for (const DatasetPtr& box : {solid_box(CellType::tetra, 13), solid_box(CellType::lagrange_wedge, 5, 2), uniform_box(40, 30, 20)}) {
    set_thread_count(1);
    const DatasetPtr one = faces(box, {.original_point = true}, ctx);
    const auto edges = edges_of(*one->as<SurfaceMesh>());
    set_thread_count(8);
    const DatasetPtr eight = faces(box, {.original_point = true}, ctx);
    CHECK(same_surface(*one, *eight));
    CHECK(edges == edges_of(*eight->as<SurfaceMesh>()));
    set_thread_count(0);
  }
}

TEST_CASE("surface: triangles name their cells, edges come once") {
  Context ctx;
  SurfaceMesh s;
  s.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 0, 0, 2, 1, 0}, 3);
  s.vertices = {Array::from_vector(std::vector<int32_t>{0}), {}, 1};
  s.polygons = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 3}), {}, 4};
  s.strips = {Array::from_vector(std::vector<int32_t>{1, 4, 2, 5}), {}, 4};
  const Triangles t = triangles_of(s);
  CHECK(t.count() == 4);
  CHECK(t.cells == std::vector<uint32_t>{1, 1, 2, 2});
  CHECK(measure(s).vector_area == Vec3(0, 0, 2));
  CHECK(edges_of(s) == std::vector<uint32_t>{0, 1, 0, 3, 1, 2, 1, 4, 2, 3, 2, 4, 2, 5, 4, 5});
  s.strips = {};
  s.vertices = {};
  s.polygons = {Array::from_vector(std::vector<int64_t>{0, 1, 2, 0, 2, 3}), {}, 3};
  const Triangles plain = triangles_of(s);
  CHECK(plain.cells.empty());
  CHECK(plain.cell(1) == 1);
  CHECK(plain.indices == std::vector<uint32_t>{0, 1, 2, 0, 2, 3});
  CHECK(triangles_of(SurfaceMesh{}).count() == 0);
  CHECK(edges_of(SurfaceMesh{}).empty());
}

TEST_CASE("faces: random cells that share faces any number of times agree with counting") {
  Context ctx;
  uint64_t seed = 7;
  auto random = [&](int n) { return int((seed = seed * 6364136223846793005u + 1442695040888963407u) >> 33) % n; };
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(std::vector<double>(3 * 9), 3);
  std::vector<int64_t> ids, offsets{0};
  std::vector<uint8_t> types;
  std::map<std::vector<int64_t>, int> count;
  for (int c = 0; c < 60; ++c) {
    const CellType type = c % 3 == 0 ? CellType::pyramid : c % 3 == 1 ? CellType::tetra : CellType::hexahedron;
    std::vector<int64_t> p{0, 1, 2, 3, 4, 5, 6, 7, 8};
    for (int i = 8; i > 0; --i) std::swap(p[size_t(i)], p[size_t(random(i + 1))]);
    const LinearTopology& t = *linear_topology(type);
    ids.insert(ids.end(), p.begin(), p.begin() + t.corners);
    offsets.push_back(int64_t(ids.size()));
    types.push_back(uint8_t(type));
    for (size_t f = 0; f < t.face_count(); ++f) {
      std::vector<int64_t> face;
      for (uint8_t k : t.face(f)) face.push_back(p[k]);
      std::sort(face.begin(), face.end());
      ++count[face];
    }
  }
  m.cells = {Array::from_vector(ids), Array::from_vector(offsets), 0};
  m.types = Array::from_vector(types);
  std::vector<std::vector<int64_t>> want, have;
  int many = 0;
  for (const auto& [face, n] : count) {
    if (n == 1) want.push_back(face);
    many += n > 2;
  }
  CHECK(many > 5);
  const DatasetPtr skin = faces(make_dataset(m), {.original_point = true}, ctx);
  const Array& point = skin->fields().require("original_point").array;
  const CellsView v = cells_view(skin->as<SurfaceMesh>()->polygons);
  for (size_t c = 0; c < v.count; ++c) {
    std::vector<int64_t> face;
    for (size_t k = 0; k < v.size(c); ++k) face.push_back(int64_t(point.get(size_t(v.point(c, k)))));
    std::sort(face.begin(), face.end());
    have.push_back(face);
  }
  std::sort(have.begin(), have.end());
  CHECK(have == want);
}

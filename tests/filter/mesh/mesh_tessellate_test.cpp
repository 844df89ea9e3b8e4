// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/tessellate_cells.h"

#include <numeric>
#include <set>

#include "data/cells/shape/cell_map.h"
#include "data/cells/shape/cell_shape.h"
#include "support/test.h"

using namespace sg;

namespace {

// One cell whose nodes are its reference nodes moved by `bend`.
template <class F>
DatasetPtr one_cell(CellType type, size_t nodes, F&& bend) {
  const CellShape* shape = CellShape::find(type, nodes);
  REQUIRE(shape);
  std::vector<double> xyz, v;
  std::vector<int32_t> ids;
  for (size_t k = 0; k < nodes; ++k) {
    const Vec3 p = bend(shape->node(k));
    xyz.insert(xyz.end(), {p.x, p.y, p.z});
    v.push_back(1 + 2 * p.x - p.y + 3 * p.z);
    ids.push_back(int32_t(k));
  }
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(xyz, 3);
  m.cells = {Array::from_vector(ids), {}, int(nodes)};
  m.single_type = type;
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(v), "", Role::scalars});
  f.add({"c", Association::cell, Array::from_vector(std::vector<int32_t>{7}), "", Role::none});
  return make_dataset(Mesh(m), std::move(f));
}

double measure_of_cells(const DatasetPtr& d, bool& all_positive) {
  CellMap map(d);
  double sum = 0;
  all_positive = true;
  for (size_t c = 0; c < d->cell_count(); ++c) {
    map.open(c);
    const double m = map.measure();
    all_positive = all_positive && m > 0;
    sum += m;
  }
  return sum;
}

const std::vector<std::pair<CellType, size_t>> types = {
    {CellType::quadratic_edge, 3},     {CellType::quadratic_triangle, 6},   {CellType::quadratic_quad, 8},
    {CellType::biquadratic_quad, 9},   {CellType::quadratic_tetra, 10},     {CellType::quadratic_hexahedron, 20},
    {CellType::quadratic_wedge, 15},   {CellType::quadratic_pyramid, 13},   {CellType::triquadratic_hexahedron, 27},
    {CellType::lagrange_tetra, 20},    {CellType::lagrange_hexahedron, 64}, {CellType::lagrange_wedge, 40},
    {CellType::lagrange_triangle, 10}, {CellType::lagrange_quad, 16},       {CellType::lagrange_curve, 5},
};

}  // namespace

TEST_CASE("tessellate: parts of a straight cell fill it, none inside out; fields are carried exactly") {
  for (const auto& [type, nodes] : types) {
    CAPTURE(int(type));
    // Straight, but a smaller tolerance than the distance of a bent field forces two halvings: v is linear, so bend one cubic field.
    const DatasetPtr d = one_cell(type, nodes, [](Vec3 p) { return Vec3{2 * p.x + 0.1 * p.y, p.y, 3 * p.z + 0.2 * p.x}; });
    Context ctx;
    CHECK(tessellate(d, {}, ctx)->cell_count() == 1);  // straight already
    DatasetParts bent = d->parts();
    const CellShape* shape = CellShape::find(type, nodes);
    std::vector<double> w;
    for (size_t k = 0; k < nodes; ++k) w.push_back(std::pow(shape->node(k).x, 2));
    bent.fields.add({"w", Association::point, Array::from_vector(w), "", Role::none});
    const DatasetPtr t = tessellate(make_dataset(bent), {0.02, 2}, ctx);
    CHECK(t->cell_count() > 3);
    bool before = false, after = false;
    CHECK(measure_of_cells(t, after) == doctest::Approx(measure_of_cells(d, before)).epsilon(1e-12));
    CHECK(after);
    const auto* m = t->as<UnstructuredMesh>();
    const Array& v = t->fields().require("v").array;
    for (size_t i = 0; i < t->point_count(); ++i) {
      const Vec3 p = m->points.at(i);
      CHECK(v.get(i) == doctest::Approx(1 + 2 * p.x - p.y + 3 * p.z).epsilon(1e-12));
    }
    CHECK(t->fields().require("c").array.get(t->cell_count() - 1) == 7);
    std::set<std::array<double, 3>> places;
    for (size_t i = 0; i < t->point_count(); ++i) places.insert({m->points.at(i).x, m->points.at(i).y, m->points.at(i).z});
    CHECK(places.size() == t->point_count());
  }
}

TEST_CASE("tessellate: a curved cell's area converges with second order in the edges") {
  const DatasetPtr d = one_cell(CellType::biquadratic_quad, 9, [](Vec3 p) {
    return Vec3{p.x + 0.2 * p.x * p.y * (1 - p.y), p.y + 0.3 * p.x * (1 - p.x) * p.y, 0};
  });
  bool ok = false;
  const double exact = measure_of_cells(d, ok);
  std::vector<double> h, e;
  for (const int level : {1, 2, 3, 4}) {
    Context ctx;
    const DatasetPtr t = tessellate(d, {1e-12, level}, ctx);
    CHECK(t->cell_count() == size_t(1) << (2 * level));
    h.push_back(1.0 / (1 << level));
    e.push_back(std::fabs(measure_of_cells(t, ok) - exact));
  }
  CHECK(test::observed_order(h.data(), e.data(), 4) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("tessellate: neighbours share the points of their edges and faces, also of different kinds") {
  // A quadratic hexahedron with a quadratic pyramid on its top face (13 nodes, 8 of them shared).
  const CellShape* hex = CellShape::find(CellType::quadratic_hexahedron, 20);
  std::vector<double> xyz;
  for (size_t k = 0; k < 20; ++k) {
    const Vec3 p = hex->node(k);
    xyz.insert(xyz.end(), {p.x, p.y, p.z + 0.2 * p.x * (1 - p.x)});
  }
  for (const Vec3 p : {Vec3{0.5, 0.5, 2}, Vec3{0.25, 0.25, 1.5}, Vec3{0.75, 0.25, 1.5}, Vec3{0.75, 0.75, 1.5}, Vec3{0.25, 0.75, 1.5}})
    xyz.insert(xyz.end(), {p.x, p.y, p.z});
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(xyz, 3);
  std::vector<int32_t> ids(20);
  std::iota(ids.begin(), ids.end(), 0);
  for (const int k : {4, 5, 6, 7, 20, 12, 13, 14, 15, 21, 22, 23, 24}) ids.push_back(k);
  m.cells = {Array::from_vector(ids), Array::from_vector(std::vector<int32_t>{0, 20, 33}), 0};
  m.types = Array::from_vector(std::vector<uint8_t>{uint8_t(CellType::quadratic_hexahedron), uint8_t(CellType::quadratic_pyramid)});
  Context ctx;
  const DatasetPtr t = tessellate(make_dataset(Mesh(m)), {1e-9, 1}, ctx);
  CHECK(t->cell_count() == 8 + 6 + 4);
  CHECK(t->point_count() == 27 + 5);  // the pyramid adds its apex and four middles of edges; its base is shared
  CHECK(t->fields().require("original_cell").array.get(8) == 1);
}

TEST_CASE("tessellate: linear cells and polyhedra pass through, other meshes come back as they are") {
  UniformGrid g;
  g.dims = {3, 3, 3};
  Context ctx;
  const DatasetPtr d = make_dataset(g);
  CHECK(tessellate(d, {}, ctx) == d);
  std::string said;
  ctx.on_log = [&](LogLevel, std::string_view s) { said = s; };
  const DatasetPtr bent = one_cell(CellType::biquadratic_quad, 9, [](Vec3 p) { return Vec3{p.x, p.y + p.x * (1 - p.x), 0}; });
  CHECK(tessellate(bent, {1e-6, 1}, ctx)->cell_count() == 4);
  CHECK(said.find("times the tolerance") != std::string::npos);
}

TEST_CASE("tessellate: noise is divided as often as there is room for, and a note tells") {
  for (const auto& [type, nodes] : {std::pair{CellType::quadratic_tetra, size_t(10)}, {CellType::lagrange_hexahedron, size_t(64)}}) {
    CAPTURE(int(type));
    DatasetParts parts = one_cell(type, nodes, [](Vec3 p) { return p; })->parts();
    // Many cells of their own, and fields of noise, NaN and numbers near the largest.
    UnstructuredMesh& m = std::get<UnstructuredMesh>(parts.mesh);
    const size_t cells = 200;
    std::vector<int32_t> ids;
    for (size_t c = 0; c < cells; ++c)
      for (size_t k = 0; k < nodes; ++k) ids.push_back(int32_t(k));
    m.cells = {Array::from_vector(ids), {}, int(nodes)};
    std::vector<double> noise(nodes * 9), huge(nodes), none(nodes, NAN);
    for (size_t i = 0; i < noise.size(); ++i) noise[i] = std::sin(1e4 * double(i * i));
    for (size_t i = 0; i < nodes; ++i) huge[i] = i % 2 ? 1.7e308 : -1.7e308;
    parts.fields = {};
    parts.fields.add({"m", Association::point, Array::from_vector(noise, 9), "", Role::none});
    parts.fields.add({"huge", Association::point, Array::from_vector(huge), "", Role::none});
    parts.fields.add({"none", Association::point, Array::from_vector(none), "", Role::none});
    Context ctx;
    std::string said;
    ctx.on_log = [&](LogLevel, std::string_view s) { said += s; };
    const DatasetPtr t = tessellate(make_dataset(std::move(parts)), {1e-6, 7}, ctx);
    CHECK(said.find("the most that fit") != std::string::npos);
    CHECK(t->cell_count() * nodes <= size_t(1) << 23);
    CHECK(t->cell_count() * nodes * 8 > size_t(1) << 23);
  }
}

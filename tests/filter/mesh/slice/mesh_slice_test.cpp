// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/slice/slice.h"

#include <cstring>

#include "base/parallel.h"
#include "base/random.h"
#include "filter/mesh/mesh_meshes.h"
#include "support/params.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::meshes;

namespace {

const SurfaceMesh& surface(const DatasetPtr& d) { return *d->as<SurfaceMesh>(); }

// Edges of polygons without an opposite, as pairs of positions.
std::vector<std::pair<Vec3, Vec3>> rim(const SurfaceMesh& m) {
  std::map<std::pair<int64_t, int64_t>, int> edges;
  const CellsView v = cells_view(m.polygons);
  for (size_t c = 0; c < v.count; ++c)
    for (size_t k = 0; k < v.size(c); ++k) ++edges[{v.point(c, k), v.point(c, (k + 1) % v.size(c))}];
  std::vector<std::pair<Vec3, Vec3>> r;
  for (const auto& [e, n] : edges) {
    CHECK(n == 1);
    if (!edges.count({e.second, e.first})) r.emplace_back(m.points.at(size_t(e.first)), m.points.at(size_t(e.second)));
  }
  return r;
}

bool on_box(Vec3 p, double tolerance) {
  for (int a = 0; a < 3; ++a)
    if (std::abs(p[a]) < tolerance || std::abs(p[a] - 1) < tolerance) return true;
  return false;
}

struct Plane {
  Vec3 origin, normal;
  double area;  // of its cut through the unit cube
};
const Plane planes[] = {{{0.5, 0.5, 0.5}, {1, 1, 1}, 0.75 * std::sqrt(3.0)},
                        {{1, 0, 0}, {1, 1, 1}, 0.5 * std::sqrt(3.0)},
                        {{0.5, 0.5, 0.5}, {1, 2, 3}, std::sqrt(14.0) / 3},
                        {{0.3, 0.1, 0.37}, {0, 0, -2}, 1},
                        {{0, 0, 0.5}, {0, 0, 1}, 1},
                        {{0, 0, 0}, {0, 0, 1}, 1},
                        {{1, 1, 1}, {0, 1e-200, 0}, 1},
                        {{0.5, 0.5, 0}, {1, -1, 0}, std::sqrt(2.0)}};

void check_cut(const DatasetPtr& box, const Plane& p, double tolerance = 1e-12) {
  Context ctx;
  const DatasetPtr cut = slice(box, {.origin = p.origin, .normal = p.normal}, ctx);
  const SurfaceMesh& m = surface(cut);
  const SurfaceFacts facts = measure(m);
  const Vec3 n = normalize(p.normal * (p.normal.y == 1e-200 ? 1e200 : 1));
  CHECK(std::abs(facts.area - p.area) < tolerance * 4);
  CHECK(length(facts.vector_area - n * facts.area) < tolerance * 4);  // all face along the normal
  double off = 0;
  for (size_t i = 0; i < m.points.count(); ++i) off = std::max(off, std::abs(dot(n, m.points.at(i) - p.origin)));
  CHECK(off < tolerance);
  for (const auto& [a, b] : rim(m)) REQUIRE((on_box(a, 1e-9) && on_box(b, 1e-9)));
  CHECK(linear_error(*cut, m.points) < 1e-6);
  const Field &cell = cut->fields().require("original_cell"), &c = cut->fields().require("c", Association::cell);
  REQUIRE(cell.array.count() == cut->cell_count());
  for (size_t i = 0; i < cut->cell_count(); ++i) REQUIRE(cell.array.get(i) == c.array.get(i));
}

}  // namespace

TEST_CASE("slice: planes through a box of any cells have the exact area, and the polygons fit together") {
  const CellType types[] = {CellType::tetra,   CellType::hexahedron, CellType::voxel,           CellType::wedge,
                            CellType::pyramid, CellType::polyhedron, CellType::quadratic_tetra, CellType::lagrange_hexahedron};
  for (const Plane& p : planes) {
    CAPTURE(p.normal.x);
    CAPTURE(p.area);
    for (CellType t : types) {
      CAPTURE(cell_type_info(t).name);
      check_cut(solid_box(t, 4, 2), p);
      check_cut(solid_box(t, 3, 2), p);
    }
    check_cut(uniform_box(4, 6, 3), p);
    check_cut(uniform_box(7, 1, 10), p);
  }
}

TEST_CASE("slice: prisms of five and six sides") {
  Context ctx;
  for (int n : {5, 6}) {
    UnstructuredMesh m;
    std::vector<double> xyz;
    std::vector<int64_t> ids;
    for (int k = 0; k < 2; ++k)
      for (int i = 0; i < n; ++i)
        xyz.insert(xyz.end(), {std::cos(2 * M_PI * i / n), std::sin(2 * M_PI * i / n), double(k)}), ids.push_back(int64_t(ids.size()));
    m.points.xyz = Array::from_vector(xyz, 3);
    m.cells = {Array::from_vector(ids), {}, 2 * n};
    m.single_type = n == 5 ? CellType::pentagonal_prism : CellType::hexagonal_prism;
    const DatasetPtr d = make_dataset(m);
    const double base = 0.5 * n * std::sin(2 * M_PI / n);
    CHECK(measure(surface(slice(d, {}, ctx))).area == doctest::Approx(base).epsilon(1e-14));
    // A slanted plane that stays between top and bottom: area / cosine.
    CHECK(measure(surface(slice(d, {.origin = Vec3(0, 0, 0.5), .normal = {0.3, 0.2, 1}}, ctx))).area ==
          doctest::Approx(base * std::sqrt(1.13)).epsilon(1e-13));
  }
}

TEST_CASE("slice: a non-convex polyhedron gives several polygons of the right area") {
  // A U-shaped prism: the plane y = 2 crosses both arms.
  const std::vector<Vec3> u{{0, 0, 0}, {5, 0, 0}, {5, 3, 0}, {4, 3, 0}, {4, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};
  const auto n = int64_t(u.size());
  UnstructuredMesh m;
  std::vector<double> xyz;
  std::vector<int64_t> ids, faces, offsets{0};
  for (int k = 0; k < 2; ++k)
    for (Vec3 p : u) xyz.insert(xyz.end(), {p.x, p.y, double(k)}), ids.push_back(int64_t(ids.size()));
  for (int64_t i = 0; i < n; ++i) faces.push_back(n - 1 - i);
  offsets.push_back(int64_t(faces.size()));
  for (int64_t i = 0; i < n; ++i) faces.push_back(n + i);
  offsets.push_back(int64_t(faces.size()));
  for (int64_t i = 0; i < n; ++i) {
    for (int64_t k : {i, (i + 1) % n, n + (i + 1) % n, n + i}) faces.push_back(k);
    offsets.push_back(int64_t(faces.size()));
  }
  m.points.xyz = Array::from_vector(xyz, 3);
  m.cells = {Array::from_vector(ids), Array::from_vector(std::vector<int64_t>{0, 2 * n}), 0};
  m.single_type = CellType::polyhedron;
  m.polyhedron_faces = Array::from_vector(std::vector<int64_t>{0, int64_t(offsets.size()) - 1});
  m.faces = {Array::from_vector(faces), Array::from_vector(offsets), 0};
  const DatasetPtr d = make_dataset(m);
  Context ctx;
  const DatasetPtr two = slice(d, {.axis = CutAxis::y, .position = 2}, ctx);
  CHECK(two->cell_count() == 2);
  CHECK(measure(surface(two)).vector_area.y == doctest::Approx(2));
  const DatasetPtr whole = slice(d, {.axis = CutAxis::z, .position = 0.25}, ctx);
  CHECK(whole->cell_count() == 1);
  CHECK(measure(surface(whole)).area == doctest::Approx(9));
  CHECK(measure(surface(slice(d, {.origin = Vec3(2.5, 2, 0.5), .normal = {0, 1, 0.1}}, ctx))).area == doctest::Approx(2 * std::sqrt(1.01)));
}

TEST_CASE("slice: warped hexahedra fit together without gaps") {
  DatasetParts p = solid_box(CellType::hexahedron, 5)->parts();
  auto& m = std::get<UnstructuredMesh>(p.mesh);
  std::vector<double> xyz;
  uint64_t seed = 1;
  for (size_t i = 0; i < m.points.count(); ++i) {
    const Vec3 at = m.points.at(i);
    for (int a = 0; a < 3; ++a) {
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      xyz.push_back(on_box(at, 1e-9) ? at[a] : at[a] + 0.16 * (double(seed >> 40) / double(1 << 24) - 0.5));
    }
  }
  m.points.xyz = Array::from_vector(xyz, 3);
  p.fields = {};
  Context ctx;
  const DatasetPtr box = make_dataset(p);
  for (double z : {0.2, 0.35, 0.4, 0.5, 0.61})
    for (Vec3 n : {Vec3(0, 0, 1), Vec3(0.05, 0.1, 1)}) {
      const DatasetPtr cut = slice(box, {.origin = Vec3(0.5, 0.5, z), .normal = n}, ctx);
      for (const auto& [a, b] : rim(surface(cut))) REQUIRE((on_box(a, 1e-9) && on_box(b, 1e-9)));
      CHECK(length(measure(surface(cut)).vector_area) == doctest::Approx(length(n)).epsilon(1e-12));
    }
}

TEST_CASE("slice: curvilinear and rotated grids agree with the plain one") {
  Context ctx;
  UniformGrid g;
  g.dims = {6, 5, 7};
  g.spacing = {0.2, 0.25, -1.0 / 6};
  g.origin = {10, 0, 1};
  const double s = std::sqrt(0.5);
  g.direction.m[0][0] = s, g.direction.m[0][1] = -s, g.direction.m[1][0] = s, g.direction.m[1][1] = s;
  const DatasetPtr rotated = make_dataset(g);
  for (const Plane& p : planes) {
    auto turn = [&](Vec3 v) { return Vec3(s * v.x - s * v.y, s * v.x + s * v.y, v.z); };
    const DatasetPtr cut = slice(rotated, {.origin = turn(p.origin) + Vec3(10, 0, 0), .normal = turn(p.normal)}, ctx);
    CHECK(std::abs(measure(surface(cut)).area - p.area) < 1e-12);
    CHECK(length(measure(surface(cut)).vector_area) == doctest::Approx(p.area).epsilon(1e-12));
    CurvilinearGrid c;
    c.dims = {3, 4, 5};
    std::vector<double> xyz;
    for (int k = 0; k < 5; ++k)
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 3; ++i) xyz.insert(xyz.end(), {i / 2.0, j / 3.0, k / 4.0});
    c.points.xyz = Array::from_vector(xyz, 3);
    CHECK(std::abs(measure(surface(slice(make_dataset(c), {.origin = p.origin, .normal = p.normal}, ctx))).area - p.area) < 1e-12);
  }
}

TEST_CASE("slice: flat cells give lines, curves give vertices") {
  Context ctx;
  const DatasetPtr flat = slice(uniform_box(4, 4, 0), {.origin = Vec3(0.3, 0.3, 0), .normal = {1, 1, 0}}, ctx);
  double total = 0;
  const CellsView v = cells_view(surface(flat).lines);
  for (size_t c = 0; c < v.count; ++c)
    total += length(surface(flat).points.at(size_t(v.point(c, 1))) - surface(flat).points.at(size_t(v.point(c, 0))));
  CHECK(total == doctest::Approx(0.6 * std::sqrt(2.0)));
  CHECK(linear_error(*flat, surface(flat).points) < 1e-6);
  CHECK(flat->fields().require("original_cell").array.count() == flat->cell_count());
  const DatasetPtr dots = slice(uniform_box(5, 0, 0), {.axis = CutAxis::x}, ctx);
  CHECK(surface(dots).vertices.size() == 1);
  CHECK(surface(dots).points.at(0).x == doctest::Approx(0.5));
  SurfaceMesh s;
  s.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 0, 0, 2, 1, 0}, 3);
  s.lines = {Array::from_vector(std::vector<int32_t>{0, 4, 3}), {}, 3};
  s.polygons = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 3}), {}, 4};
  s.strips = {Array::from_vector(std::vector<int32_t>{1, 4, 2, 5}), {}, 4};
  const DatasetPtr mixed = slice(make_dataset(s), {.axis = CutAxis::y, .position = 0.5}, ctx);
  CHECK(surface(mixed).vertices.size() == 1);
  CHECK(surface(mixed).lines.size() == 3);
}

TEST_CASE("slice: AMR leaves are cut once, ghost cells never") {
  Context ctx;
  AmrGrid g;
  g.levels.resize(2);
  g.levels[0].ratio = {1, 1, 1};
  g.levels[0].spacing = {0.25, 0.25, 0.25};
  g.levels[0].patches = {{{0, 0, 0}, {3, 3, 3}, 0, 0}};
  g.levels[1].spacing = {0.125, 0.125, 0.125};
  g.levels[1].patches = {{{2, 2, 2}, {5, 5, 5}, 64, 125}};
  std::vector<uint8_t> ghost(128);
  for (int k = 1; k < 3; ++k)
    for (int j = 1; j < 3; ++j)
      for (int i = 1; i < 3; ++i) ghost[size_t(i + 4 * (j + 4 * k))] = ghost_refined_cell;
  DatasetParts p;
  p.mesh = g;
  p.cell_ghost = Array::from_vector(ghost);
  const DatasetPtr amr = make_dataset(p);
  for (const Plane& plane : planes) {
    const DatasetPtr cut = slice(amr, {.origin = plane.origin, .normal = plane.normal}, ctx);
    CHECK(std::abs(measure(surface(cut)).area - plane.area) < 1e-12);
  }
  const DatasetPtr middle = slice(amr, {.axis = CutAxis::z, .position = 0.4}, ctx);
  CHECK(middle->cell_count() == 12 + 16);
  CHECK(middle->fields().require("original_cell").array.get(27) >= 64);

  DatasetParts hidden = uniform_box(3, 3, 3)->parts();
  std::vector<uint8_t> h(27);
  h[13] = ghost_hidden_cell, h[12] = ghost_duplicate;
  hidden.cell_ghost = Array::from_vector(h);
  CHECK(measure(surface(slice(make_dataset(hidden), {}, ctx))).area == doctest::Approx(7.0 / 9));
}

TEST_CASE("slice: far from zero the cut is as sharp as at zero") {
  Context ctx;
  DatasetParts p = solid_box(CellType::tetra, 3)->parts();
  std::get<UnstructuredMesh>(p.mesh).points.origin = {1e7, -1e7, 1e7};
  const DatasetPtr cut = slice(make_dataset(p), {.normal = {1, 1, 1}}, ctx);
  CHECK(measure(surface(cut)).area == doctest::Approx(0.75 * std::sqrt(3.0)).epsilon(1e-8));
}

TEST_CASE("slice: the same bytes for one and eight threads") {
  Context ctx;
  for (const DatasetPtr& box : {solid_box(CellType::tetra, 12), uniform_box(60, 50, 40)}) {
    set_thread_count(1);
    const DatasetPtr one = slice(box, {.normal = {1, 2, 3}}, ctx);
    set_thread_count(8);
    CHECK(same_surface(*one, *slice(box, {.normal = {1, 2, 3}}, ctx)));
    set_thread_count(0);
  }
}

TEST_CASE("slice: a plane beside the mesh gives an empty surface with its fields and a note") {
  Context ctx;
  std::string note;
  ctx.on_log = [&](LogLevel, std::string_view t) { note = t; };
  const DatasetPtr cut = slice(uniform_box(2, 2, 2), {.axis = CutAxis::z, .position = 7}, ctx);
  CHECK(cut->cell_count() == 0);
  CHECK(cut->fields().find("f", Association::point) != nullptr);
  CHECK(cut->fields().find("c", Association::cell) != nullptr);
  CHECK(note.find("cuts no cell") != std::string::npos);
  slice(solid_box(CellType::lagrange_tetra, 1, 2), {}, ctx);
  CHECK(note.find("curved cells") != std::string::npos);
}

TEST_CASE("slice: mistakes say what would be right") {
  Context ctx;
  const DatasetPtr box = uniform_box(2, 2, 2);
  CHECK(error_of([&] { slice(box, {.normal = {0, 0, 0}}, ctx); }).find("normal is zero") != std::string::npos);
  CHECK(error_of([&] { slice(box, {.normal = {NAN, 0, 0}}, ctx); }).find("not finite") != std::string::npos);
  CHECK(error_of([&] { slice(box, {.position = 1}, ctx); }).find("position needs an axis") != std::string::npos);
  CHECK(error_of([&] { slice(box, {.origin = Vec3(), .axis = CutAxis::x}, ctx); }).find("both given") != std::string::npos);
  CHECK(error_of([&] { test::params_of<SliceParams>({"axis=w"}); }).find("x, y") != std::string::npos);
  const DatasetPtr cloud = make_dataset(PointCloud{{Array::from_vector(std::vector<float>(3), 3), {}}});
  CHECK(error_of([&] { slice(cloud, {}, ctx); }).find("point cloud") != std::string::npos);
}

// SPDX-License-Identifier: Apache-2.0
// Outer faces of cells of higher order: drawn as curved as they are, closed, with the edges of the cells.
#include <cstring>

#include "base/parallel.h"
#include "data/cells/shape/cell_map.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/mesh_meshes.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::meshes;

namespace {

template <class F>
DatasetPtr moved(const DatasetPtr& in, F f) {
  DatasetParts p = in->parts();
  auto& points = std::get<UnstructuredMesh>(p.mesh).points;
  double* to = nullptr;
  const Points old = points;
  points.xyz = Array::make<double>(old.count(), 3, &to);
  for (size_t i = 0; i < old.count(); ++i) {
    const Vec3 q = f(old.at(i));
    *to++ = q.x, *to++ = q.y, *to++ = q.z;
  }
  return make_dataset(p);
}

// Bends one corner of the box much more than the rest, so that neighbours are split unequally.
Vec3 bent(Vec3 p) {
  const double w = p.x * p.x * p.x * (1 + p.y);
  return p + 0.15 * w * Vec3(std::sin(5 * p.y), std::sin(5 * p.z + 1), std::sin(5 * p.y + 2));
}

// The box [0,1]^3 as a ball of radius 1: shells of the cube become shells of the ball.
Vec3 ball(Vec3 p) {
  const Vec3 q = p * 2.0 - Vec3(1, 1, 1);
  const double r = std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z)});
  const Vec3 tangent(std::tan(q.x * M_PI / 4), std::tan(q.y * M_PI / 4), std::tan(q.z * M_PI / 4));
  return r == 0 ? q : tangent * (r / length(tangent));
}

double volume_of_cells(const DatasetPtr& d) {
  CellMap map(d);
  double sum = 0;
  for (size_t c = 0; c < d->cell_count(); ++c) map.open(c), sum += std::abs(map.measure());
  return sum;
}

DatasetPtr without_fields(const DatasetPtr& d) { return make_dataset(d->mesh()); }

// A disc as one rational biquadratic Bezier quad: its outline is four quarters of the unit circle.
DatasetPtr rational_disc(bool weights_as_field = false) {
  const double c = std::sqrt(0.5), s = std::sqrt(2.0);
  UnstructuredMesh m;
  m.points.xyz =
      Array::from_vector(std::vector<double>{-c, -c, 0, c, -c, 0, c, c, 0, -c, c, 0, 0, -s, 0, s, 0, 0, 0, s, 0, -s, 0, 0, 0, 0, 0}, 3);
  m.cells = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8}), {}, 9};
  m.single_type = CellType::bezier_quad;
  const std::vector<double> w{1, 1, 1, 1, c, c, c, c, 1};
  if (!weights_as_field) {
    m.weights = Array::from_vector(w);
    return make_dataset(m);
  }
  FieldSet fields;
  fields.add(make_field("RationalWeights", Association::point, w));
  return make_dataset(m, fields);
}

// A ring between the radii 0.5 and 1 as four Lagrange quads of an order with their nodes on circles.
DatasetPtr lagrange_ring(int order) {
  UnstructuredMesh m;
  std::vector<double> xyz;
  const int around = 4 * order;
  for (int j = 0; j <= order; ++j)
    for (int i = 0; i < around; ++i) {
      const double a = 2 * M_PI * i / around, r = 0.5 + 0.5 * j / order;
      xyz.insert(xyz.end(), {r * std::cos(a), r * std::sin(a), 0});
    }
  std::vector<int64_t> ids;
  for (int c = 0; c < 4; ++c) {
    std::vector<int64_t> nodes(size_t((order + 1) * (order + 1)));
    for (int j = 0; j <= order; ++j)
      for (int i = 0; i <= order; ++i)
        nodes[lattice_node(CellType::lagrange_quad, order, j, i)] = (c * order + i) % around + int64_t(around) * j;
    ids.insert(ids.end(), nodes.begin(), nodes.end());
  }
  m.points.xyz = Array::from_vector(xyz, 3);
  m.cells = {Array::from_vector(ids), {}, (order + 1) * (order + 1)};
  m.single_type = CellType::lagrange_quad;
  return make_dataset(m);
}

// Largest distance from the circle of radius r of the points and of the middles of the segments of the outline that lie near it.
double off_circle(const SurfaceMesh& s, double r) {
  const Triangles t = triangles_of(s);
  std::map<std::pair<uint32_t, uint32_t>, int> count;
  for (size_t i = 0; i < t.indices.size(); ++i) {
    const uint32_t a = t.indices[i], b = t.indices[i % 3 == 2 ? i - 2 : i + 1];
    ++count[{std::min(a, b), std::max(a, b)}];
  }
  double worst = 0;
  for (const auto& [e, n] : count) {
    if (n > 1) continue;
    const Vec3 a = s.points.at(e.first), b = s.points.at(e.second);
    for (Vec3 p : {a, b, (a + b) * 0.5})
      if (std::abs(length(p) - r) < 0.2) worst = std::max(worst, std::abs(length(p) - r));
  }
  return worst;
}

double length_of_lines(const SurfaceMesh& s) {
  const CellsView v = cells_view(s.lines);
  double sum = 0;
  for (size_t c = 0; c < v.count; ++c)
    for (size_t k = 1; k < v.size(c); ++k) sum += length(s.points.at(size_t(v.point(c, k))) - s.points.at(size_t(v.point(c, k - 1))));
  return sum;
}

}  // namespace

TEST_CASE("curved faces: no crack opens where neighbours are split unequally, and the volume is that of the cells") {
  Context ctx;
  for (CellType type : curved_solids())
    for (int order : {2, 4}) {
      if (order == 4 && type < CellType::lagrange_curve) continue;
      CAPTURE(cell_type_info(type).name);
      CAPTURE(order);
      const DatasetPtr box = without_fields(moved(solid_box(type, 2, order), bent));
      const double want = volume_of_cells(box);
      const SurfaceFacts coarse = measure(*faces(box, {.tolerance = 0.1}, ctx)->as<SurfaceMesh>());
      const SurfaceFacts fine = measure(*faces(box, {.tolerance = 5e-4}, ctx)->as<SurfaceMesh>());
      CHECK(coarse.closed);
      CHECK(fine.closed);
      CHECK(fine.triangles > coarse.triangles + 100);
      CHECK(std::abs(fine.volume - want) < 2e-3);
      CHECK(std::abs(fine.volume - want) <= std::abs(coarse.volume - want) + 1e-4);
      // Some cells are split, some are not: the split ones are near the bent side.
      const size_t uniform = size_t(32 / order * 32 / order) * coarse.triangles;
      CHECK(fine.triangles < uniform);
    }
}

TEST_CASE("curved faces: a disc of one rational Bezier quad is round") {
  Context ctx;
  for (bool as_field : {false, true}) {
    const DatasetPtr disc = rational_disc(as_field);
    const double diagonal = length(disc->bounds().hi - disc->bounds().lo);
    double before = 1;
    for (double tolerance : {3e-2, 3e-3, 3e-4}) {
      const DatasetPtr skin = faces(disc, {.tolerance = tolerance}, ctx);
      const SurfaceMesh& s = *skin->as<SurfaceMesh>();
      CHECK(off_circle(s, 1) < 1.01 * tolerance * diagonal);
      const double missing = M_PI - measure(s).area;
      CHECK(missing > 0);  // chords
      CHECK(missing < 2 * M_PI * tolerance * diagonal);
      CHECK(missing < 0.5 * before);
      before = missing;
      for (size_t p = 0; p < s.points.count(); ++p) REQUIRE(length(s.points.at(p)) < 1 + 1e-12);
    }
  }
}

TEST_CASE("curved faces: a ring of quads of order 7 is round, its area converges") {
  Context ctx;
  const double area = M_PI * 0.75;
  for (int order : {2, 3, 7, 10}) {
    CAPTURE(order);
    const DatasetPtr ring = lagrange_ring(order);
    const DatasetPtr skin = faces(ring, {.tolerance = 5e-4}, ctx);
    const SurfaceMesh& s = *skin->as<SurfaceMesh>();
    const double own = order == 2 ? 0.025 : order == 3 ? 3e-3 : 1e-6;  // how well polynomials of that order follow a quarter circle
    CHECK(off_circle(s, 1) < own + 1.5e-3);
    CHECK(off_circle(s, 0.5) < own + 1.5e-3);
    CHECK(std::abs(measure(s).area - area) < 2 * own + 5e-3);
    CHECK(measure(s).vector_area.z == doctest::Approx(measure(s).area));  // no triangle is turned over
  }
}

TEST_CASE("curved faces: the area of a ball of quadratic cells converges with order 4") {
  Context ctx;
  for (CellType type : {CellType::triquadratic_hexahedron, CellType::quadratic_tetra, CellType::lagrange_wedge}) {
    CAPTURE(cell_type_info(type).name);
    double error[2];
    for (int k = 0; k < 2; ++k) {
      const DatasetPtr d = without_fields(moved(solid_box(type, k == 0 ? 2 : 4, 2), ball));
      // Splitting to the last leaves what the cells themselves are off: extrapolate the chords away.
      const SurfaceFacts one = measure(*faces(d, {.tolerance = 1e-7}, ctx)->as<SurfaceMesh>());
      CHECK(one.closed);
      error[k] = std::abs(one.volume - 4 * M_PI / 3);
    }
    CHECK(error[1] < error[0] / 8);
    CHECK(error[1] < 0.006);
  }
}

TEST_CASE("curved faces: fields follow the functions of the cell at new points") {
  Context ctx;
  auto quadratic = [](Vec3 p) { return 3 * p.x * p.x - 2 * p.x * p.y + p.z * p.z + p.y; };
  for (CellType type : {CellType::triquadratic_hexahedron, CellType::quadratic_tetra, CellType::lagrange_wedge, CellType::lagrange_tetra}) {
    CAPTURE(cell_type_info(type).name);
    DatasetParts p = without_fields(solid_box(type, 2, 2))->parts();
    const Points points = std::get<UnstructuredMesh>(p.mesh).points;
    std::vector<double> f;
    std::vector<int32_t> side;
    for (size_t i = 0; i < points.count(); ++i) f.push_back(quadratic(points.at(i))), side.push_back(points.at(i).x < 0.51 ? 7 : 8);
    p.fields.add(make_field("q", Association::point, f));
    p.fields.add({"side", Association::point, Array::from_vector(side), {}, Role::none});
    const DatasetPtr skin = faces(make_dataset(p), {.tolerance = 1e-3, .original_point = true}, ctx);
    const SurfaceMesh& s = *skin->as<SurfaceMesh>();
    const Array &q = skin->fields().require("q").array, &from = skin->fields().require("original_point").array;
    const Array& nearest = skin->fields().require("side").array;
    CHECK(nearest.type() == ElementType::i32);
    size_t made = 0;
    double worst = 0;
    for (size_t i = 0; i < s.points.count(); ++i) {
      worst = std::max(worst, std::abs(q.get(i) - quadratic(s.points.at(i))));
      REQUIRE((nearest.get(i) == 7 || nearest.get(i) == 8));
      made += from.get(i) == -1;
      if (from.get(i) >= 0) REQUIRE(length(points.at(size_t(from.get(i))) - s.points.at(i)) == 0);
    }
    CHECK(made > s.points.count() / 2);
    CHECK(worst < 1e-12);
    CHECK(measure(s).area == doctest::Approx(6).epsilon(1e-12));
    // Flat faces with a linear field stay at their nodes.
    const DatasetPtr plain = faces(solid_box(type, 2, 2), {.original_point = true}, ctx);
    for (size_t i = 0; i < plain->point_count(); ++i) REQUIRE(plain->fields().require("original_point").array.get(i) >= 0);
  }
}

TEST_CASE("curved faces: every triangle names its cell and lies in it") {
  Context ctx;
  const DatasetPtr box = moved(solid_box(CellType::quadratic_hexahedron, 3), bent);
  const DatasetPtr skin = faces(box, {}, ctx);
  const Array &cell = skin->fields().require("original_cell").array, &number = skin->fields().require("c", Association::cell).array;
  const Triangles t = triangles_of(*skin->as<SurfaceMesh>());
  REQUIRE(t.count() == cell.count());
  CellReader reader(box);
  size_t out = 0;
  for (size_t i = 0; i < t.count(); ++i) {
    REQUIRE(cell.get(i) == number.get(i));
    reader.open(size_t(cell.get(i)));
    Vec3 middle;
    for (int k = 0; k < 3; ++k) middle += skin->as<SurfaceMesh>()->points.at(t.indices[3 * i + size_t(k)]) / 3.0;
    const Box3 b = reader.box();
    for (int a = 0; a < 3; ++a) out += middle[a] < b.lo[a] || middle[a] > b.hi[a];
  }
  CHECK(out == 0);
}

TEST_CASE("curved faces: edges are those of the cells, each once") {
  Context ctx;
  for (CellType type : {CellType::triquadratic_hexahedron, CellType::quadratic_tetra, CellType::bezier_hexahedron}) {
    CAPTURE(cell_type_info(type).name);
    const int n = 3;
    const DatasetPtr box = moved(solid_box(type, n, 2), bent);
    const Skin skin = faces_and_edges(box, {}, ctx);
    REQUIRE(skin.edges);
    const SurfaceMesh &s = *skin.surface->as<SurfaceMesh>(), &e = *skin.edges->as<SurfaceMesh>();
    CHECK(e.lines.size() == size_t((type == CellType::quadratic_tetra ? 18 : 12) * n * n));
    CHECK(e.polygons.size() == 0);
    CHECK(same_bytes(s.points.xyz, e.points.xyz));
    // Each piece of a line is the edge of triangles, so that lines lie on the surface.
    const std::vector<uint32_t> all = edges_of(s);
    std::vector<std::pair<uint32_t, uint32_t>> known;
    for (size_t i = 0; i < all.size(); i += 2) known.emplace_back(all[i], all[i + 1]);
    const CellsView v = cells_view(e.lines);
    size_t pieces = 0, missing = 0;
    for (size_t c = 0; c < v.count; ++c)
      for (size_t k = 1; k < v.size(c); ++k, ++pieces) {
        const auto a = uint32_t(v.point(c, k - 1)), b = uint32_t(v.point(c, k));
        missing += !std::binary_search(known.begin(), known.end(), std::pair(std::min(a, b), std::max(a, b)));
      }
    CHECK(missing == 0);
    CHECK(pieces < known.size());
    CHECK(same_surface(*skin.surface, *faces(box, {}, ctx)));
  }
  // The outline of the disc and nothing inside.
  const Skin disc = faces_and_edges(rational_disc(), {}, ctx);
  REQUIRE(disc.edges);
  CHECK(length_of_lines(*disc.edges->as<SurfaceMesh>()) == doctest::Approx(2 * M_PI).epsilon(5e-3));
  // Cells without curves have the edges of their polygons.
  CHECK(!faces_and_edges(solid_box(CellType::hexahedron, 2), {}, ctx).edges);
  CHECK(!faces_and_edges(uniform_box(2, 2, 2), {}, ctx).edges);
}

TEST_CASE("curved faces: polygons, quads with straight sides and curves beside linear cells") {
  Context ctx;
  UnstructuredMesh m;
  std::vector<double> xyz;
  auto point = [&](double x, double y) { xyz.insert(xyz.end(), {x, y, 0}); };
  for (int i = 0; i < 3; ++i) point(std::cos(2 * M_PI * i / 3), std::sin(2 * M_PI * i / 3));                // 0..2: a round triangle,
  for (int i = 0; i < 3; ++i) point(std::cos(2 * M_PI * (i + .5) / 3), std::sin(2 * M_PI * (i + .5) / 3));  // as a quadratic polygon
  point(3, 0), point(5, 0), point(5, 1), point(3, 1), point(4, -0.3), point(4, 1.3);                        // 6..11: two sides bent
  point(7, 0), point(8, 0), point(8, 1), point(7, 1);                                                       // 12..15: a plain quad
  point(10, 0), point(12, 0), point(11, 1);                                                                 // 16..18: an arc
  m.points.xyz = Array::from_vector(xyz, 3);
  m.cells = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18}),
             Array::from_vector(std::vector<int32_t>{0, 6, 12, 16, 19}), 0};
  m.types = Array::from_vector(std::vector<uint8_t>{36, 30, 9, 21});
  const Skin skin = faces_and_edges(make_dataset(m), {.tolerance = 1e-4}, ctx);
  const SurfaceMesh& s = *skin.surface->as<SurfaceMesh>();
  const Array& cell = skin.surface->fields().require("original_cell").array;
  const Triangles t = triangles_of(s);
  double area[4] = {};
  for (size_t i = 0; i < t.count(); ++i) {
    const Vec3 a = s.points.at(t.indices[3 * i]), b = s.points.at(t.indices[3 * i + 1]), c = s.points.at(t.indices[3 * i + 2]);
    const double twice = cross(b - a, c - a).z;
    CHECK(twice > -1e-12);
    area[size_t(cell.get(t.cell(i)))] += twice / 2;
  }
  const double parabola = 2.0 / 3;  // of the box around it
  CHECK(area[0] == doctest::Approx(std::sqrt(27.0) / 4 + 3 * parabola * std::sqrt(3.0) * 0.5).epsilon(2e-3));
  CHECK(area[1] == doctest::Approx(2 + 2 * parabola * 2 * 0.3).epsilon(2e-3));
  CHECK(area[2] == 1);
  CHECK(s.lines.size() == 1);
  CHECK(cell.get(0) == 3);
  CHECK(length_of_lines(s) == doctest::Approx(std::sqrt(5.0) + std::asinh(2.0) / 2).epsilon(2e-3));  // of the parabola
  REQUIRE(skin.edges);
  CHECK(skin.edges->as<SurfaceMesh>()->lines.size() == 3 + 4 + 4);
}

TEST_CASE("curved faces: hidden cells leave a hole, duplicates none, as with linear ones") {
  Context ctx;
  const DatasetPtr box = without_fields(moved(solid_box(CellType::triquadratic_hexahedron, 3), bent));
  const size_t middle = 13;
  auto ghosted = [&](size_t cell, uint8_t bits) {
    DatasetParts p = box->parts();
    std::vector<uint8_t> g(27);
    g[cell] = bits;
    p.cell_ghost = Array::from_vector(g);
    return measure(*faces(make_dataset(p), {}, ctx)->as<SurfaceMesh>());
  };
  const SurfaceFacts whole = measure(*faces(box, {}, ctx)->as<SurfaceMesh>());
  CellMap map(box);
  map.open(middle);
  const SurfaceFacts hole = ghosted(middle, ghost_hidden_cell), same = ghosted(middle, ghost_duplicate);
  CHECK(hole.closed);
  CHECK(std::abs(whole.volume - hole.volume - std::abs(map.measure())) < 1e-3);
  CHECK(same.area == whole.area);
  CHECK(ghosted(0, ghost_duplicate).triangles < whole.triangles);
}

TEST_CASE("curved faces: the same bytes for one and eight threads") {
  Context ctx;
  for (const DatasetPtr& d : {moved(solid_box(CellType::quadratic_tetra, 10), bent),
                              moved(solid_box(CellType::bezier_hexahedron, 5, 3), bent), rational_disc(), lagrange_ring(7)}) {
    set_thread_count(1);
    const Skin one = faces_and_edges(d, {.original_point = true}, ctx);
    set_thread_count(8);
    const Skin eight = faces_and_edges(d, {.original_point = true}, ctx);
    set_thread_count(0);
    CHECK(same_surface(*one.surface, *eight.surface));
    CHECK(same_surface(*one.edges, *eight.edges));
  }
}

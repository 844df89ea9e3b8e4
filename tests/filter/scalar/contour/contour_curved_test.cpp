// SPDX-License-Identifier: Apache-2.0
// Contours of quadratic, Lagrange and Bezier cells: a sphere is a sphere, closed, within the tolerance.
#include "base/parallel.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/scalar/contour/contour_support.h"

using namespace sg;
using namespace sg::test;

namespace {

const Vec3 middle(0.47, 0.52, 0.5);

// A box of solid cells, its points moved by `bend`, with f at them.
template <class F, class Map>
DatasetPtr with_function(const DatasetPtr& box, F&& f, Map&& bend) {
  DatasetParts parts = box->parts();
  auto& m = std::get<UnstructuredMesh>(parts.mesh);
  std::vector<double> xyz, v;
  for (size_t p = 0; p < m.points.count(); ++p) {
    const Vec3 x = bend(m.points.at(p));
    xyz.insert(xyz.end(), {x.x, x.y, x.z});
    v.push_back(f(x));
  }
  m.points = {Array::from_vector(std::move(xyz), 3), {}};
  parts.fields = {};
  parts.fields.add({"f", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  return make_dataset(std::move(parts));
}

DatasetPtr curved_contour(const DatasetPtr& d, double value, double tolerance) {
  Context context;
  ContourParams p;
  p.values = {value};
  p.tolerance = tolerance;
  return contour(d, p, context);
}

double square(Vec3 p) { return dot(p - middle, p - middle); }
Vec3 straight(Vec3 p) { return p; }

}  // namespace

TEST_CASE("contour: the sphere in a quadratic field is exact in its points, closed, and flat to the tolerance, in all curved solids") {
  const std::pair<CellType, int> kinds[] = {{CellType::quadratic_tetra, 2},         {CellType::quadratic_hexahedron, 2},
                                            {CellType::triquadratic_hexahedron, 2}, {CellType::quadratic_wedge, 2},
                                            {CellType::lagrange_tetra, 3},          {CellType::lagrange_hexahedron, 4},
                                            {CellType::lagrange_wedge, 3}};
  for (const auto& [type, order] : kinds) {
    const std::string kind(cell_type_info(type).name);
    CAPTURE(kind);
    const auto d = with_function(meshes::solid_box(type, 3, order), square, straight);
    for (double tolerance : {1e-2, 1e-3}) {
      CAPTURE(tolerance);
      const auto c = curved_contour(d, 0.16, tolerance);
      const Surface s(c);
      CHECK(s.faults() == 0);
      CHECK(s.euler() == 2);
      CHECK(s.volume() < 0);
      double off = 0, flat = 0, turned = 0;
      for (Vec3 p : s.points) off = std::max(off, std::abs(length(p - middle) - 0.4));
      for (const auto& t : s.triangles) {
        const Vec3 x = (s.points[size_t(t[0])] + s.points[size_t(t[1])] + s.points[size_t(t[2])]) / 3.0;
        flat = std::max(flat, 0.4 - length(x - middle));
      }
      const Field& n = c->fields().require("Normals", Association::point);
      for (size_t i = 0; i < n.array.count(); ++i)
        turned = std::max(turned, length(Vec3(n.array.get(i, 0), n.array.get(i, 1), n.array.get(i, 2)) + normalize(s.points[i] - middle)));
      CHECK(off < 1e-6);
      CHECK(flat < tolerance * std::sqrt(3.0));
      CHECK(turned < 1e-5);
    }
  }
}

TEST_CASE("contour: bent cells of different kinds of nodes stay joined, and finer where they bend more") {
  auto bend = [](Vec3 p) { return p + 0.05 * Vec3(std::sin(4 * p.y), std::sin(5 * p.z), std::cos(4 * p.x + p.y)); };
  auto sharp = [](Vec3 p) { return length(p - middle) + 0.1 * std::exp(-40 * dot(p - Vec3(.9, .5, .5), p - Vec3(.9, .5, .5))) - 0.36; };
  for (const auto& [type, order] :
       {std::pair{CellType::quadratic_tetra, 2}, {CellType::lagrange_hexahedron, 5}, {CellType::lagrange_wedge, 4}}) {
    const auto d = with_function(meshes::solid_box(type, 4, order), sharp, bend);
    const Surface s(curved_contour(d, 0, 1e-3));
    CHECK(s.faults() == 0);
    CHECK(s.euler() == 2);
    CHECK(s.components() == 1);
  }
}

TEST_CASE("contour: a sphere of order 7 shells and a circle of order 7 quads are round to the tolerance") {
  // A quarter turn and a half of latitude of a shell, radius 1 to 2, in two hexahedra; the field is the radius.
  auto shell = [](Vec3 p) {
    const double a = 0.5 * M_PI * p.x, b = 1.2 * (p.y - 0.5), r = 1 + p.z;
    return Vec3(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)) * r;
  };
  auto radius = [](Vec3 p) { return length(p); };
  const auto d = with_function(meshes::solid_box(CellType::lagrange_hexahedron, 1, 7), radius, shell);
  const Surface s(curved_contour(d, 1.5, 1e-3));
  CHECK(s.triangles.size() > 100);
  double off = 0, flat = 0;
  for (Vec3 p : s.points) off = std::max(off, std::abs(length(p) - 1.5));
  for (const auto& t : s.triangles)
    flat = std::max(flat, 1.5 - length((s.points[size_t(t[0])] + s.points[size_t(t[1])] + s.points[size_t(t[2])]) / 3.0));
  CHECK(off < 1e-4);  // as near as order 7 comes to a quarter of a circle
  CHECK(flat < 1e-3 * d->bounds().diagonal());
  CHECK(s.area() == doctest::Approx(1.5 * 1.5 * 0.5 * M_PI * 2 * std::sin(0.6)).epsilon(2e-3));

  // Four quads of order 7 around a ring.
  constexpr int o = 7;
  std::vector<double> xyz, v;
  std::vector<int64_t> ids;
  for (int q = 0; q < 4; ++q)
    for (int j = 0; j <= o; ++j)
      for (int i = 0; i <= o; ++i) {
        const double a = 0.5 * M_PI * (q + double(i) / o), r = 1 + double(j) / o;
        xyz.insert(xyz.end(), {r * std::cos(a), r * std::sin(a), 0.0});
        v.push_back(r);
      }
  auto id = [&](int q, int i, int j) {  // columns shared by neighbours
    if (i == o) q = (q + 1) % 4, i = 0;
    return int64_t(i + (o + 1) * (j + (o + 1) * q));
  };
  for (int q = 0; q < 4; ++q) {
    std::vector<int64_t> nodes(size_t((o + 1) * (o + 1)));
    for (int j = 0; j <= o; ++j)
      for (int i = 0; i <= o; ++i) nodes[lattice_node(CellType::lagrange_quad, o, i, j)] = id(q, i, j);
    ids.insert(ids.end(), nodes.begin(), nodes.end());
  }
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(xyz, 3);
  m.cells.connectivity = Array::from_vector(ids);
  m.cells.fixed = (o + 1) * (o + 1);
  m.single_type = CellType::lagrange_quad;
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(v), "", Role::scalars});
  const auto ring = make_dataset(m, fields);
  const Surface lines(curved_contour(ring, 1.5, 1e-3));
  double around = 0;
  std::map<int, int> ends;
  for (const auto& l : lines.lines) {
    ++ends[l[0]], --ends[l[1]];
    const Vec3 a = lines.points[size_t(l[0])], b = lines.points[size_t(l[1])];
    around += length(b - a);
    CHECK(std::abs(length((a + b) * 0.5) - 1.5) < 1e-3 * ring->bounds().diagonal());
    CHECK(std::abs(length(a) - 1.5) < 1e-5);
    CHECK(cross(a, b).z >= 0);  // the larger values on the left, seen from the side from which the cells turn counterclockwise
  }
  for (const auto& [p, n] : ends) CHECK(n == 0);
  CHECK(lines.lines.size() == lines.points.size());
  CHECK(around == doctest::Approx(3 * M_PI).epsilon(1e-3));
}

TEST_CASE("contour: rational Bezier cells make an exact circle; fields are evaluated in the cell") {
  // A quarter ring, radius 1 to 2: quadratic arcs with weight cos 45 degrees in the middle; f is the radius, g = 2 f.
  const double w = std::sqrt(0.5);
  std::vector<double> xyz(27), v(9), g(9), weights(9);
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      const uint32_t k = lattice_node(CellType::bezier_quad, 2, i, j);
      const double r = 1 + 0.5 * j;
      const Vec3 at[3] = {{r, 0, 0}, {r, r, 0}, {0, r, 0}};
      xyz[3 * k] = at[i].x, xyz[3 * k + 1] = at[i].y, xyz[3 * k + 2] = 0;
      v[k] = r, g[k] = 2 * r, weights[k] = i == 1 ? w : 1;
    }
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(xyz, 3);
  m.cells.connectivity = Array::from_vector(std::vector<int64_t>{0, 1, 2, 3, 4, 5, 6, 7, 8});
  m.cells.fixed = 9;
  m.single_type = CellType::bezier_quad;
  m.weights = Array::from_vector(weights);
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(v), "", Role::scalars});
  fields.add({"g", Association::point, Array::from_vector(g), "", Role::none});
  const auto c = curved_contour(make_dataset(m, fields), 1.3, 1e-4);
  const Surface s(c);
  CHECK(s.lines.size() > 10);
  for (Vec3 p : s.points) CHECK(std::abs(length(p) - 1.3) < 1e-6);
  const Field& carried = c->fields().require("g", Association::point);
  for (size_t i = 0; i < carried.array.count(); ++i) CHECK(carried.array.get(i) == doctest::Approx(2.6));
}

TEST_CASE("contour: curved cells give the same bytes for any number of threads, and clean empty results") {
  auto bend = [](Vec3 p) { return p + 0.05 * Vec3(std::sin(4 * p.y), std::sin(5 * p.z), std::cos(4 * p.x + p.y)); };
  const auto d = with_function(meshes::solid_box(CellType::quadratic_tetra, 5), square, bend);
  set_thread_count(1);
  const auto one = curved_contour(d, 0.1, 1e-3);
  set_thread_count(8);
  const auto eight = curved_contour(d, 0.1, 1e-3);
  set_thread_count(0);
  CHECK(same_surface(one, eight));
  CHECK(
      same_bytes(one->fields().require("Normals", Association::point).array, eight->fields().require("Normals", Association::point).array));
  const auto none = curved_contour(d, 99, 1e-3);
  CHECK(none->cell_count() == 0);
  CHECK(none->fields().find("f", Association::point));
  auto holes = [](Vec3 p) { return p.x > 0.7 ? std::nan("") : square(p); };
  for (Vec3 p :
       Surface(curved_contour(with_function(meshes::solid_box(CellType::quadratic_hexahedron, 4), holes, straight), 0.1, 1e-3)).points)
    CHECK(std::isfinite(p.x + p.y + p.z));
}

TEST_CASE("contour: noise on curved cells is divided no further than smooth fields need, and a note tells") {
  const auto noise = [](Vec3 p) { return std::sin(1e5 * (p.x + 2.3 * p.y * p.y + 3.7 * p.z)); };
  const auto d = with_function(meshes::solid_box(CellType::quadratic_tetra, 3, 2), noise, [](Vec3 p) { return p; });
  Context ctx;
  std::string said;
  ctx.on_log = [&](LogLevel, std::string_view s) { said += s; };
  ContourParams p;
  p.field.name = "f", p.values = {0.1}, p.tolerance = 1e-4;
  const DatasetPtr c = contour(d, p, ctx);
  CHECK(said.find("not subdivided further") != std::string::npos);
  CHECK(c->cell_count() > 1000);
  CHECK(c->cell_count() < 2'000'000);
}

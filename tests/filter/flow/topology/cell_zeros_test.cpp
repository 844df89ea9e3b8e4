// SPDX-License-Identifier: Apache-2.0
// Several zeros in one cell, on every type of cell.
#include "filter/flow/topology/zeros/cell_zeros.h"

#include "base/random.h"
#include "data/cells/shape/cell_map.h"
#include "filter/flow/topology/topology_support.h"
#include "filter/flow/topology/zeros/winding.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test::topology;

namespace {

using enum CellType;

struct Kind {
  CellType type;
  size_t nodes;
};
const std::vector<Kind>& flat_kinds() {
  static const std::vector<Kind> all{{triangle, 3},
                                     {quad, 4},
                                     {pixel, 4},
                                     {quadratic_triangle, 6},
                                     {quadratic_quad, 8},
                                     {biquadratic_quad, 9},
                                     {lagrange_quad, 16},
                                     {lagrange_triangle, 10},
                                     {bezier_quad, 9},
                                     {bezier_triangle, 6},
                                     {quadratic_linear_quad, 6},
                                     {biquadratic_triangle, 7}};
  return all;
}
const std::vector<Kind>& solid_kinds_of_cells() {
  static const std::vector<Kind> all{{tetra, 4},
                                     {voxel, 8},
                                     {hexahedron, 8},
                                     {wedge, 6},
                                     {pyramid, 5},
                                     {quadratic_tetra, 10},
                                     {quadratic_hexahedron, 20},
                                     {triquadratic_hexahedron, 27},
                                     {biquadratic_quadratic_hexahedron, 24},
                                     {quadratic_wedge, 15},
                                     {biquadratic_quadratic_wedge, 18},
                                     {quadratic_linear_wedge, 12},
                                     {quadratic_pyramid, 13},
                                     {triquadratic_pyramid, 19},
                                     {lagrange_tetra, 10},
                                     {lagrange_hexahedron, 27},
                                     {lagrange_wedge, 18},
                                     {bezier_hexahedron, 27}};
  return all;
}

double random_part(uint64_t s, uint64_t i) { return 2 * random_unit(s, i) - 1; }

/// One cell with random velocities; places of the nodes by `place` of the reference ones.
template <class P, class V>
DatasetPtr one_cell(Kind kind, P&& place, V&& velocity) {
  const CellShape* shape = CellShape::find(kind.type, kind.nodes);
  REQUIRE(shape);
  std::vector<double> xyz, v;
  std::vector<int64_t> ids;
  for (size_t k = 0; k < kind.nodes; ++k) {
    const Vec3 p = place(shape->node(k)), u = velocity(k, p);
    xyz.insert(xyz.end(), {p.x, p.y, p.z}), v.insert(v.end(), {u.x, u.y, u.z});
    ids.push_back(int64_t(k));
  }
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.cells.connectivity = Array::from_vector(std::move(ids));
  m.cells.offsets = Array::from_vector(std::vector<int64_t>{0, int64_t(kind.nodes)});
  m.single_type = kind.type;
  FieldSet fields;
  fields.add({"velocity", Association::point, Array::from_vector(std::move(v), 3), "", Role::vectors});
  return make_dataset(std::move(m), std::move(fields));
}

/// Newton's method with differences from a dense grid of starts in the box of the cell: slow, and it misses little.
std::vector<Vec3> brute_force(const DatasetPtr& d, int dimension, int n) {
  CellMap map(d);
  map.open(0);
  Context context;
  const FlowField flow(d, "", context);
  std::vector<double> w(map.reader().ids().size());
  const bool mapped = CellShape::find(map.reader().type(), w.size(), map.reader().orders());
  auto value = [&](Vec3 u) {
    CellPlace place;
    place.rst = place.nearest = u;
    map.weights(place, w);
    Vec3 f;
    for (size_t k = 0; k < w.size(); ++k) f += w[k] * flow.at_point(k);
    return f;
  };
  const Box3 box = mapped ? Box3{{0, 0, 0}, {1, 1, 1}} : d->bounds();
  const Vec3 size = box.hi - box.lo;
  std::vector<Vec3> found;
  for (int s = 0; s < (dimension == 3 ? n * n * n : n * n); ++s) {
    Vec3 u = box.lo + size * Vec3((s % n + 0.37) / n, (s / n % n + 0.41) / n, dimension == 3 ? (s / n / n + 0.33) / n : 0);
    bool good = false;
    for (int round = 0; round < 40; ++round) {
      Vec3 g[3] = {{}, {}, {0, 0, dimension == 2 ? 1.0 : 0.0}};
      const Vec3 f = value(u);
      for (int a = 0; a < dimension; ++a) {
        Vec3 h;
        h[a] = 1e-6;
        g[a] = (value(u + h) - value(u - h)) / 2e-6;
      }
      const Vec3 bc = cross(g[1], g[2]);
      const double det = dot(g[0], bc);
      if (!(std::abs(det) > 0)) break;
      const Vec3 move(-dot(f, bc) / det, -dot(g[0], cross(f, g[2])) / det, dimension == 3 ? -dot(g[0], cross(g[1], f)) / det : 0);
      u += move;
      if (!(length(u) < 10)) break;
      if (length(move) < 1e-12) {
        good = true;
        break;
      }
    }
    if (!good) continue;
    CellPlace place;
    if (mapped) {
      place.rst = u;
      if (CellShape::find(map.reader().type(), w.size(), map.reader().orders())->outside(u) > -1e-7) continue;
      u = map.position(u);
    } else if (!map.locate(u, place, 0) || (dimension == 3 && place.outside > -1e-7)) {
      continue;
    }
    if (std::none_of(found.begin(), found.end(), [&](Vec3 p) { return length(p - u) < 1e-8; })) found.push_back(u);
  }
  return found;
}

/// Each zero of the oracle is found, and only zeros; returns how many.
size_t compare(const DatasetPtr& d, int dimension, int starts) {
  const auto expected = brute_force(d, dimension, starts);
  const CriticalPoints found = zeros_of(d);
  size_t missed = 0;
  for (const Vec3 e : expected)
    missed += std::none_of(found.points.begin(), found.points.end(), [&](const CriticalPoint& c) { return length(c.at - e) < 1e-9; });
  CHECK(missed == 0);
  CHECK(found.points.size() >= expected.size());
  Context context;
  const FlowField flow(d, "", context);
  FlowCursor ask(flow);
  for (const CriticalPoint& c : found.points) {
    Vec3 v;
    if (ask(c.at, v)) CHECK(length(v) < 1e-9);
  }
  return expected.size();
}

template <class F>
void check_planted(Kind kind, F&& f, const std::vector<Vec3>& zeros) {
  // Skewed and moved, so that nothing is by luck of the axes.
  const bool upright = kind.type == voxel || kind.type == pixel, flat = CellShape::find(kind.type, kind.nodes)->dimension() == 2;
  auto place = [&](Vec3 u) {
    if (upright) return Vec3(3 + 2 * u.x, -1 + 0.5 * u.y, flat ? 0 : 2 + u.z);
    return Vec3(3 + 2 * u.x + 0.3 * u.y, -1 + 0.2 * u.x + 0.5 * u.y + 0.1 * u.z, flat ? 0 : 2 + u.z - 0.2 * u.x);
  };
  const CellShape& shape = *CellShape::find(kind.type, kind.nodes);
  const CriticalPoints found = zeros_of(one_cell(kind, place, [&](size_t k, Vec3) { return f(shape.node(k)); }));
  CAPTURE(int(kind.type));
  CHECK(found.points.size() == zeros.size());
  for (const Vec3 z : zeros)
    CHECK(std::any_of(found.points.begin(), found.points.end(), [&](const CriticalPoint& c) { return length(c.at - place(z)) < 1e-10; }));
}

/// A cell of given corners (and faces) without a reference map.
DatasetPtr polygon_cell(const std::vector<Vec3>& at, const std::vector<Vec3>& v) {
  std::vector<double> xyz, u;
  std::vector<int64_t> ids;
  for (size_t k = 0; k < at.size(); ++k) {
    xyz.insert(xyz.end(), {at[k].x, at[k].y, at[k].z}), u.insert(u.end(), {v[k].x, v[k].y, v[k].z});
    ids.push_back(int64_t(k));
  }
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.polygons.connectivity = Array::from_vector(std::move(ids));
  m.polygons.offsets = Array::from_vector(std::vector<int64_t>{0, int64_t(at.size())});
  FieldSet fields;
  fields.add({"velocity", Association::point, Array::from_vector(std::move(u), 3), "", Role::vectors});
  return make_dataset(std::move(m), std::move(fields));
}

/// A prism over a polygon as a polyhedron.
DatasetPtr prism_cell(const std::vector<Vec3>& ring, const std::vector<Vec3>& v) {
  const size_t n = ring.size();
  std::vector<double> xyz, u;
  std::vector<int64_t> ids, faces, face_offsets{0};
  for (size_t k = 0; k < 2 * n; ++k) {
    const Vec3 p = ring[k % n] + Vec3(k < n ? 0 : 0.2, 0, k < n ? 0 : 1);
    xyz.insert(xyz.end(), {p.x, p.y, p.z}), u.insert(u.end(), {v[k].x, v[k].y, v[k].z});
    ids.push_back(int64_t(k));
  }
  for (size_t k = n; k-- > 0;) faces.push_back(int64_t(k));
  face_offsets.push_back(int64_t(faces.size()));
  for (size_t k = 0; k < n; ++k) faces.push_back(int64_t(n + k));
  face_offsets.push_back(int64_t(faces.size()));
  for (size_t k = 0; k < n; ++k) {
    const size_t next = (k + 1) % n;
    for (const size_t i : {k, next, n + next, n + k}) faces.push_back(int64_t(i));
    face_offsets.push_back(int64_t(faces.size()));
  }
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.cells.connectivity = Array::from_vector(std::move(ids));
  m.cells.offsets = Array::from_vector(std::vector<int64_t>{0, int64_t(2 * n)});
  const auto face_count = int64_t(face_offsets.size()) - 1;
  m.faces.connectivity = Array::from_vector(std::move(faces));
  m.faces.offsets = Array::from_vector(std::move(face_offsets));
  m.polyhedron_faces = Array::from_vector(std::vector<int64_t>{0, face_count});
  m.single_type = polyhedron;
  FieldSet fields;
  fields.add({"velocity", Association::point, Array::from_vector(std::move(u), 3), "", Role::vectors});
  return make_dataset(std::move(m), std::move(fields));
}

std::vector<Vec3> random_vectors(size_t n, uint64_t seed, int d) {
  std::vector<Vec3> v;
  for (uint64_t k = 0; k < n; ++k)
    v.emplace_back(random_part(seed, 3 * k), random_part(seed, 3 * k + 1), d == 3 ? random_part(seed, 3 * k + 2) : 0);
  return v;
}

}  // namespace

TEST_CASE("cell zeros: products of linear functions have as many zeros as their degrees allow, each to 1e-10") {
  // Of (x - a_i)(y - b_i) two.
  for (const Kind kind : {Kind{quad, 4}, {pixel, 4}, {biquadratic_quad, 9}, {lagrange_quad, 16}, {quadratic_quad, 8}}) {
    check_planted(kind, [](Vec3 u) { return Vec3((u.x - 0.2) * (u.y - 0.7), (u.x - 0.9) * (u.y - 0.4), 0); },
                  {{0.2, 0.4, 0}, {0.9, 0.7, 0}});
  }
  // Of (x - a_i)(y - b_i)(z - c_i) six: each coordinate from another factor.
  const double a[3] = {0.2, 0.5, 0.83}, b[3] = {0.61, 0.15, 0.34}, c[3] = {0.77, 0.4, 0.12};
  std::vector<Vec3> six;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (i != j) six.emplace_back(a[i], b[j], c[3 - i - j]);
  for (const Kind kind :
       {Kind{hexahedron, 8}, {voxel, 8}, {triquadratic_hexahedron, 27}, {lagrange_hexahedron, 27}, {quadratic_hexahedron, 20}})
    check_planted(
        kind,
        [&](Vec3 u) {
          return Vec3((u.x - a[0]) * (u.y - b[0]) * (u.z - c[0]), (u.x - a[1]) * (u.y - b[1]) * (u.z - c[1]),
                      (u.x - a[2]) * (u.y - b[2]) * (u.z - c[2]));
        },
        six);
  // Wedges: l_i(x, y) (z - c_i), three.
  for (const Kind kind : {Kind{wedge, 6}, {quadratic_wedge, 15}, {lagrange_wedge, 18}, {biquadratic_quadratic_wedge, 18}})
    check_planted(kind, [](Vec3 u) { return Vec3((u.x - 0.2) * (u.z - 0.1), (u.y - 0.3) * (u.z - 0.5), (u.x + u.y - 0.7) * (u.z - 0.8)); },
                  {{0.4, 0.3, 0.1}, {0.2, 0.5, 0.5}, {0.2, 0.3, 0.8}});
  // Quadratic triangles and tetrahedra: four and eight, here as many as lie inside.
  for (const Kind kind : {Kind{quadratic_triangle, 6}, {lagrange_triangle, 10}, {biquadratic_triangle, 7}})
    check_planted(kind, [](Vec3 u) { return Vec3((u.x - 0.1) * (u.x - 0.3), (u.y - 0.2) * (u.y - 0.5), 0); },
                  {{0.1, 0.2, 0}, {0.1, 0.5, 0}, {0.3, 0.2, 0}, {0.3, 0.5, 0}});
  for (const Kind kind : {Kind{quadratic_tetra, 10}, {lagrange_tetra, 10}})
    check_planted(kind, [](Vec3 u) { return Vec3((u.x - 0.1) * (u.x - 0.3), (u.y - 0.12) * (u.y - 0.25), (u.z - 0.08) * (u.z - 0.31)); },
                  {{0.1, 0.12, 0.08},
                   {0.1, 0.12, 0.31},
                   {0.1, 0.25, 0.08},
                   {0.1, 0.25, 0.31},
                   {0.3, 0.12, 0.08},
                   {0.3, 0.12, 0.31},
                   {0.3, 0.25, 0.08},
                   {0.3, 0.25, 0.31}});
}

TEST_CASE("cell zeros: all zeros of random velocities, as by brute force, on every type of flat cell") {
  auto bent = [](Vec3 u) { return Vec3(u.x + 0.1 * u.y * u.y, u.y + 0.08 * u.x * u.y, 0); };
  size_t several = 0;
  for (const Kind kind : flat_kinds()) {
    CAPTURE(int(kind.type));
    size_t zeros = 0;
    for (uint64_t s = 0; s < 25; ++s) {
      const auto v = random_vectors(kind.nodes, s, 2);
      const DatasetPtr d = one_cell(
          kind, [&](Vec3 u) { return kind.type == pixel ? u : bent(u); }, [&](size_t k, Vec3) { return v[k]; });
      const size_t n = compare(d, 2, 13);
      zeros += n, several += n > 1;
    }
    CHECK(zeros > 0);
  }
  CHECK(several > 20);
}

TEST_CASE("cell zeros: all zeros of random velocities, as by brute force, on every type of solid cell") {
  auto bent = [](Vec3 u) { return Vec3(u.x + 0.1 * u.y * u.z, u.y + 0.08 * u.x * u.y, u.z - 0.07 * u.x * u.z); };
  size_t several = 0, zeros = 0;
  for (const Kind kind : solid_kinds_of_cells()) {
    CAPTURE(int(kind.type));
    for (uint64_t s = 0; s < 8; ++s) {
      const auto v = random_vectors(kind.nodes, s, 3);
      const DatasetPtr d = one_cell(
          kind, [&](Vec3 u) { return kind.type == voxel ? u : bent(u); }, [&](size_t k, Vec3) { return v[k]; });
      const size_t n = compare(d, 3, 5);
      zeros += n, several += n > 1;
    }
  }
  CHECK(zeros > 30);
  CHECK(several > 5);
}

TEST_CASE("cell zeros: all zeros of polygons, convex or not, and their indices sum to the turning around them") {
  const std::vector<std::vector<Vec3>> shapes{
      {{0, 0, 0}, {1, 0, 0}, {1.3, 0.8, 0}, {0.5, 1.2, 0}, {-0.2, 0.7, 0}},
      {{0, 0, 0}, {0.6, -0.2, 0}, {1.2, 0.1, 0}, {1.3, 0.7, 0}, {0.8, 1.2, 0}, {0.2, 1.1, 0}, {-0.2, 0.6, 0}},
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0.5, 0.3, 0}, {0, 1, 0}}};  // a notch
  size_t several = 0, zeros = 0;
  for (const auto& at : shapes)
    for (uint64_t s = 0; s < 60; ++s) {
      CAPTURE(s);
      const auto v = random_vectors(at.size(), s, 2);
      const DatasetPtr d = polygon_cell(at, v);
      const size_t n = compare(d, 2, 13);
      zeros += n, several += n > 1;
      std::vector<Vec2> loop;
      for (const Vec3 u : v) loop.push_back({u.x, u.y});
      CHECK(index_sum(zeros_of(d)) == winding_index(loop).value());
    }
  CHECK(zeros > 40);
  CHECK(several > 5);
}

TEST_CASE("cell zeros: all zeros of polyhedra, as by brute force") {
  const std::vector<std::vector<Vec3>> rings{{{0, 0, 0}, {1, 0, 0}, {1.2, 0.8, 0}, {0.4, 1.2, 0}, {-0.2, 0.7, 0}},
                                             {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                                             {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0.5, 0.3, 0}, {0, 1, 0}}};
  size_t several = 0, zeros = 0;
  for (const auto& ring : rings)
    for (uint64_t s = 0; s < 12; ++s) {
      CAPTURE(s);
      const auto v = random_vectors(2 * ring.size(), s, 3);
      const size_t n = compare(prism_cell(ring, v), 3, 4);
      zeros += n, several += n > 1;
    }
  CHECK(zeros > 10);
  CHECK(several > 0);
}

// SPDX-License-Identifier: Apache-2.0
// Critical points that lie exactly on a vertex, an edge or a face of the mesh are found, and once.
#include "data/cells/cell_topology.h"
#include "filter/every_mesh.h"
#include "filter/flow/topology/balls.h"
#include "filter/smooth_distortion.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::topology;

namespace {

DatasetPtr turned(const DatasetPtr& d, const Mat3& turn) {
  DatasetParts parts = d->parts();
  const Points moved{at_points(parts.mesh, [&](Vec3 p) { return turn * p; }), {}};
  if (auto* s = std::get_if<SurfaceMesh>(&parts.mesh)) s->points = moved;
  else std::get<UnstructuredMesh>(parts.mesh).points = moved;
  return make_dataset(std::move(parts));
}

// A vertex of the mesh, the middle of an edge of one of its cells, the middle of a cell, or any place in one.
Vec3 random_place(const DatasetPtr& d, Random& random, int where) {
  CellReader cell(d);
  cell.open(size_t(random.whole(0, int(cell.count()) - 1)));
  const auto at = cell.at();
  const size_t corners = cell.dimension() == 2 && at.size() > 4 ? 3 : at.size();
  size_t a = size_t(random.whole(0, int(corners) - 1)), b = (a + 1) % corners;
  // What lies between other corners of a solid, the ends of a bent face's diagonal say, may be outside.
  const LinearTopology* solid = cell.dimension() == 3 ? linear_topology(linear_type(cell.type())) : nullptr;
  if (where == 1 && solid) {
    const auto& edge = solid->edges[size_t(random.whole(0, int(solid->edges.size()) - 1))];
    a = edge[0], b = edge[1];
  }
  if (where == 0) return at[a];
  if (where == 1) return 0.5 * (at[a] + at[b]);
  Vec3 sum;
  for (const Vec3& p : at) sum += p;
  const Vec3 middle = sum / double(at.size());
  return where == 2 ? middle : middle * 0.6 + at[a] * 0.3 + at[b] * 0.1;
}

}  // namespace

TEST_CASE("critical points: a flow about an axis through a vertex or the middle of an edge of a sphere has two, indices sum to 2") {
  for (int levels = 1; levels < 4; ++levels)
    for (const Vec3 axis : {Vec3(0, 0, 1), Vec3(1, 0, 0), normalize(Vec3(1, 1, 0)), normalize(Vec3(1, 1, 1))}) {
      const DatasetPtr ball = shapes::sphere(levels).dataset();
      for (const double out : {0.0, 0.1}) {
        const CriticalPoints found = zeros_of(with_velocity(ball, [&](Vec3 p) { return cross(axis, p) + out * p; }));
        CAPTURE(levels);
        CHECK(found.points.size() == 2);
        CHECK(index_sum(found) == 2);
        CHECK(found.faces_index == 2);
      }
    }
}

TEST_CASE("property: on spheres of any cells critical points at vertices, on edges and in faces are found once, indices sum to 2") {
  for (const uint64_t seed : property_seeds(150)) {
    CAPTURE(seed);
    Random random(seed);
    const std::string kind = random.one_of(
        {"octahedron", "triangles", "quads", "mixed", "polygons", "quadratic triangles", "quadratic quads", "biquadratic quads"});
    CAPTURE(kind);
    const DatasetPtr straight = kind == "octahedron" ? shapes::sphere(3).dataset() : ball_of(kind);
    const int where = random.whole(0, 3);
    CAPTURE(where);
    const Vec3 axis = normalize(random_place(straight, random, where));
    Vec3 other = cross(axis, random_place(straight, random, where));
    if (length(other) < 0.1) other = cross(axis, std::abs(axis.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0));
    other = normalize(other);
    const Vec3 third = cross(axis, other);
    const Mat3 turn = random.chance(0.7) ? distorted::random_rotation(random) : Mat3();
    const DatasetPtr ball = turned(straight, turn);
    const bool rotation = random.chance(0.5);
    const double spiral = random.one_of({0.0, 0.3, -2.0});
    const Vec3 a = turn * axis, b = turn * other, c = turn * third;
    // About an axis: two. The gradient of 3 (b.p)^2 - (a.p)^2, which has an extremum or a saddle at each end of a, b and c: six.
    const auto flow = [&](Vec3 p) {
      const Vec3 u = rotation ? cross(a, p) + spiral * (a - p * dot(a, p)) : b * (3 * dot(b, p)) - a * dot(a, p);
      return u - p * (dot(u, p) / dot(p, p));
    };
    const CriticalPoints found = zeros_of(with_velocity(ball, flow));
    CHECK(found.faces_index == 2);
    CHECK(index_sum(found) == 2);
    CHECK(found.points.size() == (rotation ? 2 : 6));
    for (const Vec3 e : rotation ? std::vector{a} : std::vector{a, b, c})
      for (const double side : {-1.0, 1.0}) {
        double off = 2;  // cells of high order are their triangles here, of a few to a quarter of the sphere
        for (const CriticalPoint& p : found.points) off = std::min(off, length(normalize(p.at) - side * e));
        CHECK(off < 0.6);
      }
  }
}

TEST_CASE("property: the zero of a linear flow at a vertex, on an edge or a face, or inside a cell of any kind is found once") {
  for (const uint64_t seed : property_seeds(200)) {
    CAPTURE(seed);
    Random random(seed);
    const auto& kinds = every_mesh();
    const MeshKind& kind = kinds[size_t(random.whole(0, int(kinds.size()) - 1))];
    CAPTURE(kind.name);
    DatasetPtr mesh = kind.make(random.whole(3, 5), random.one_of({1.0, 0.7, 1000.0}));
    const Mat3 turn = distorted::random_rotation(random);
    const bool turnable = mesh->as<UnstructuredMesh>() || mesh->as<SurfaceMesh>();
    const bool turns = turnable && random.chance(0.6);
    int where = random.whole(0, 3);
    if (where == 1 && kind.name == "curved hexahedron") where = 2;  // half way between nodes may be outside
    CAPTURE(where);
    const Vec3 zero = random_place(mesh, random, where);
    Mat3 m;
    double det = 0;
    while (std::abs(det) < 0.1) {
      for (auto& row : m.m)
        for (double& e : row) e = random.chance(0.2) ? 0.0 : random.in(-1, 1);
      if (kind.flat) m.m[0][2] = m.m[1][2] = m.m[2][0] = m.m[2][1] = 0, m.m[2][2] = 1;
      const Vec3 r[3] = {{m.m[0][0], m.m[0][1], m.m[0][2]}, {m.m[1][0], m.m[1][1], m.m[1][2]}, {m.m[2][0], m.m[2][1], m.m[2][2]}};
      det = dot(r[0], cross(r[1], r[2]));
    }
    DatasetPtr d = with_velocity(mesh, [&](Vec3 p) { return m * (p - zero); });
    if (mesh->cell_ghost().count() > 0) {
      DatasetParts parts = d->parts();
      parts.cell_ghost = mesh->cell_ghost();
      d = make_dataset(std::move(parts));
    }
    Vec3 expected = zero;
    if (turns) {
      const DatasetPtr there = turned(mesh, turn);
      expected = turn * zero;
      const Array at = point_positions(mesh->mesh());
      size_t i = 0;
      d = with_velocity(there, [&](Vec3) {
        const Vec3 p(at.get(i, 0), at.get(i, 1), at.get(i, 2));
        ++i;
        return turn * (m * (p - zero));
      });
    }
    const CriticalPoints found = zeros_of(d);
    CHECK(found.points.size() == 1);
    CHECK(found.spread == 0);
    if (found.points.size() != 1) continue;
    CHECK(length(found.points[0].at - expected) < 1e-6 * found.points[0].size);
    CHECK(found.points[0].index == (det > 0 ? 1 : -1));
  }
}

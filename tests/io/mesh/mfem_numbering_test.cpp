// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>

#include "base/vec.h"
#include "io/mfem/topology.h"
#include "support/test.h"

using namespace sg;
using namespace sg::mfem;

namespace {

// Where the nodes of each element lie when its corners are moved affinely; nodes of one number must lie at one place, of two numbers at
// two. Returns the number of different nodes.
size_t check_consistent(const Topology& t, const std::vector<Vec3>& vertices, int p) {
  Numbering numbering(t, p, "here");
  std::map<int64_t, Vec3> place;
  for (size_t e = 0; e < t.size(); ++e) {
    const auto v = t.element(e);
    const GeometryInfo& g = info(t.geometry[e]);
    // Corners along the axes of the reference element: the places (1,0,0), (0,1,0), (0,0,1).
    Vec3 axis[3];
    for (size_t a = 0; a < 3; ++a)
      for (int c = 0; c < g.corners; ++c) {
        std::array<int, 3> unit{0, 0, 0};
        unit[a] = 1;
        if (g.corner_place[size_t(c)] == unit) axis[a] = vertices[size_t(v[size_t(c)])] - vertices[size_t(v[0])];
      }
    const auto nodes = local_nodes(t.geometry[e], p);
    const auto ids = numbering.element(e);
    REQUIRE(ids.size() == nodes.size());
    for (size_t k = 0; k < nodes.size(); ++k) {
      Vec3 at = vertices[size_t(v[0])];
      for (size_t a = 0; a < 3; ++a) at += axis[a] * (double(nodes[k].place[a]) / p);
      const auto [it, fresh] = place.try_emplace(ids[k], at);
      REQUIRE(ids[k] >= 0);
      REQUIRE(size_t(ids[k]) < numbering.size());
      if (!fresh) REQUIRE(length(it->second - at) < 1e-12);
    }
  }
  std::vector<std::array<double, 3>> all;
  for (const auto& [id, at] : place) all.push_back({std::round(at.x * 1e6), std::round(at.y * 1e6), std::round(at.z * 1e6)});
  std::sort(all.begin(), all.end());
  REQUIRE(std::adjacent_find(all.begin(), all.end()) == all.end());
  return place.size();
}

void add(Topology& t, Geometry g, std::vector<int64_t> v) {
  t.geometry.push_back(g);
  t.attribute.push_back(1);
  t.corners.insert(t.corners.end(), v.begin(), v.end());
  t.begin.push_back(t.corners.size());
}

}  // namespace

TEST_CASE("mfem: neighbours agree on the nodes of a face, however their corners are listed") {
  const std::vector<Vec3> tets{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  std::vector<int64_t> second{1, 2, 3, 4};
  do {
    Topology t;
    t.dimension = 3, t.vertices = 5;
    add(t, Geometry::tetrahedron, {0, 1, 2, 3});
    add(t, Geometry::tetrahedron, second);
    CHECK(check_consistent(t, tets, 6) == 2 * 84 - 28);
  } while (std::next_permutation(second.begin(), second.end()));

  // Two cubes; the second one turned in all 24 ways.
  std::vector<Vec3> points;
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 3; ++i) points.emplace_back(i, j, k);
  auto id = [](int i, int j, int k) { return int64_t(i + 3 * (j + 2 * k)); };
  int turns = 0;
  std::array<int, 3> axes{0, 1, 2};
  do {
    for (int flips = 0; flips < 8; ++flips) {
      std::vector<int64_t> corners;
      for (const auto& place : info(Geometry::cube).corner_place) {
        std::array<int, 3> at{};
        for (size_t a = 0; a < 3; ++a) at[size_t(axes[a])] = (flips >> a & 1) ? 1 - place[a] : place[a];
        corners.push_back(id(1 + at[0], at[1], at[2]));
      }
      Topology t;
      t.dimension = 3, t.vertices = 12;
      add(t, Geometry::cube, {id(0, 0, 0), id(1, 0, 0), id(1, 1, 0), id(0, 1, 0), id(0, 0, 1), id(1, 0, 1), id(1, 1, 1), id(0, 1, 1)});
      add(t, Geometry::cube, corners);
      CHECK(check_consistent(t, points, 4) == 2 * 125 - 25);
      ++turns;
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
  CHECK(turns == 48);  // mirrored ones too
}

TEST_CASE("mfem: prisms, cubes and tetrahedra share their faces") {
  // A prism on a tetrahedron's face and beside a cube.
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0},  {0, 1, 0},  {0, 0, 1},  {1, 0, 1}, {0, 1, 1},
                                 {0, 0, 2}, {0, -1, 0}, {1, -1, 0}, {0, -1, 1}, {1, -1, 1}};
  for (const std::vector<int64_t>& tet : {std::vector<int64_t>{3, 4, 5, 6}, {5, 3, 4, 6}, {6, 5, 4, 3}, {4, 6, 3, 5}}) {
    Topology t;
    t.dimension = 3, t.vertices = 11;
    add(t, Geometry::prism, {0, 1, 2, 3, 4, 5});
    add(t, Geometry::tetrahedron, tet);
    add(t, Geometry::cube, {7, 8, 1, 0, 9, 10, 4, 3});
    CHECK(check_consistent(t, points, 5) == 6 * 21 + 56 - 21 + 216 - 36);
  }
}

TEST_CASE("mfem: nodes are numbered vertices first, then edges, faces and insides") {
  Topology t;
  t.dimension = 2, t.vertices = 6;
  add(t, Geometry::square, {0, 1, 4, 3});
  add(t, Geometry::square, {1, 2, 5, 4});
  Numbering n(t, 3, "here");
  CHECK(t.edges == 7);
  CHECK(n.size() == 6 + 7 * 2 + 2 * 4);
  const auto second = n.element(1);
  // Edge 4-1 of the second square is edge 1-4 of the first: it runs from vertex 1.
  CHECK(second[4 + 3 * 2] == 6 + 1 * 2 + 1);
  CHECK(second[4 + 3 * 2 + 1] == 6 + 1 * 2);
  CHECK(second[12] == 6 + 14 + 4);
  CHECK(t.numbered);
  Topology line;
  line.dimension = 1, line.vertices = 3;
  add(line, Geometry::segment, {0, 1});
  add(line, Geometry::segment, {2, 1});
  CHECK(Numbering(line, 4, "here").size() == 3 + 2 * 3);
}

TEST_CASE("mfem: a face whose corners its neighbour lists crosswise is refused") {
  Topology t;
  t.dimension = 3, t.vertices = 12;
  add(t, Geometry::cube, {0, 1, 2, 3, 4, 5, 6, 7});
  add(t, Geometry::cube, {4, 6, 5, 7, 8, 9, 10, 11});  // 4 5 6 7 twisted
  Numbering n(t, 3, "here");
  n.element(0);
  CHECK(test::error_of([&] { n.element(1); }).find("does not match") != std::string::npos);
}

// SPDX-License-Identifier: Apache-2.0
// Poincare and Hopf: indices sum to the Euler number of closed surfaces, and in boxes to the turning along the border.
#include <array>
#include <map>

#include "base/random.h"
#include "data/cells/cell_reader.h"
#include "filter/flow/topology/balls.h"
#include "filter/flow/topology/zeros/winding.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test::topology;

namespace {

Vec3 wavy(Vec3 x, uint64_t s) {
  Vec3 k[4];
  for (uint64_t c = 0; c < 12; ++c) k[c / 3][int(c % 3)] = 2 * random_unit(s, c) - 1;
  return Vec3(std::sin(2 * dot(k[0], x) + 0.3), std::cos(2 * dot(k[1], x)), std::sin(3 * dot(k[2], x) + 1)) + cross(k[3], x);
}

}  // namespace

TEST_CASE("index: sums to 2 on spheres of triangles, quads, both, polygons and curved cells, whatever the flow is") {
  for (const std::string kind :
       {"triangles", "quads", "mixed", "polygons", "quadratic triangles", "quadratic quads", "biquadratic quads"}) {
    CAPTURE(kind);
    const DatasetPtr mesh = ball_of(kind);
    for (uint64_t s = 0; s < 6; ++s) {
      CAPTURE(s);
      const CriticalPoints found = zeros_of(with_velocity(mesh, [&](Vec3 x) { return s == 0 ? Vec3(-x.y, x.x, 0.01 * x.z) : wavy(x, s); }));
      CHECK(found.faces_index == 2);
      CHECK(index_sum(found) == 2);
    }
  }
}

TEST_CASE("index: in flat meshes of every kind the indices sum to the turning of the velocity along the border") {
  const int n = 9;
  int sums[3] = {};
  for (uint64_t s = 0; s < 12; ++s) {
    const auto flow = [&](Vec3 x) {
      const Vec3 v = wavy(1.7 * x + Vec3(0, 0, 0.4), s + 40);
      return Vec3(v.x, v.y, 0);
    };
    for (const auto& [type, nodes] : std::vector<std::pair<CellType, size_t>>{
             {CellType::triangle, 3}, {CellType::quad, 4}, {CellType::pixel, 4}, {CellType::polygon, 4}, {CellType::triangle_strip, 4}}) {
      CAPTURE(int(type));
      std::vector<Vec2> loop;
      auto push = [&](double x, double y) {
        const Vec3 v = flow({x, y, 0});
        loop.push_back({v.x, v.y});
      };
      for (int i = 0; i < n; ++i) push(-1 + 2.0 * i / n, -1);
      for (int i = 0; i < n; ++i) push(1, -1 + 2.0 * i / n);
      for (int i = 0; i < n; ++i) push(1 - 2.0 * i / n, 1);
      for (int i = 0; i < n; ++i) push(-1, 1 - 2.0 * i / n);
      const int expected = winding_index(loop).value();
      const DatasetPtr d = with_velocity(plane_cells(type, nodes, n, [](Vec3 p) { return p; }), flow);
      CHECK(index_sum(zeros_of(d)) == expected);
      ++sums[std::clamp(expected, -1, 1) + 1];
    }
  }
  CHECK(sums[0] + sums[2] > 10);
}

TEST_CASE("index: in a box of tetrahedra the indices sum to how often the velocity on the border covers the sphere") {
  const DatasetPtr mesh = sg::test::meshes::solid_box(CellType::tetra, 3);
  size_t zeros = 0;
  for (uint64_t s = 0; s < 16; ++s) {
    const DatasetPtr d = with_velocity(mesh, [&](Vec3 x) { return wavy(4 * x, s); });
    // Sides that one cell has, seen from outside.
    std::map<std::array<int64_t, 3>, std::array<uint32_t, 3>> once;
    CellReader cell(d);
    for (size_t c = 0; c < cell.count(); ++c) {
      cell.open(c);
      for (size_t f = 0; f < 4; ++f) {
        const auto face = cell.face(f);
        std::array<int64_t, 3> key{cell.ids()[face[0]], cell.ids()[face[1]], cell.ids()[face[2]]};
        std::array<uint32_t, 3> t{uint32_t(key[0]), uint32_t(key[1]), uint32_t(key[2])};
        const Vec3 a = cell.at()[face[0]], across = cross(cell.at()[face[1]] - a, cell.at()[face[2]] - a);
        Vec3 mid;
        for (const Vec3 p : cell.at()) mid += p / 4.0;
        if (dot(across, mid - a) > 0) std::swap(t[1], t[2]);
        std::sort(key.begin(), key.end());
        if (!once.try_emplace(key, t).second) once.erase(key);
      }
    }
    std::vector<std::array<uint32_t, 3>> triangles;
    for (const auto& [key, t] : once) triangles.push_back(t);
    Context context;
    const FlowField flow(d, "", context);
    std::vector<Vec3> v;
    for (size_t i = 0; i < d->point_count(); ++i) v.push_back(flow.at_point(i));
    const CriticalPoints found = zeros_of(d);
    CHECK(index_sum(found) == covering_index(v, triangles).value());
    zeros += found.points.size();
  }
  CHECK(zeros > 3);
}

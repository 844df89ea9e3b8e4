// SPDX-License-Identifier: Apache-2.0
#include "data/cells/cell_neighbors.h"

#include <map>
#include <set>

#include "base/parallel.h"
#include "base/random.h"
#include "data/cells/cell_topology.h"
#include "support/test.h"

using namespace sg;

namespace {

// A box of n^3 cubes: by `kind` of the cube a hexahedron, six pyramids' worth of tetrahedra (five), two wedges or a polyhedron.
// The types change in slabs along z so that quads meet quads; tetrahedra fill a slab of their own apart.
struct Builder {
  std::vector<double> xyz;
  std::vector<int64_t> ids, offsets{0}, faces, face_offsets{0}, polyhedron{0};
  std::vector<uint8_t> types;

  void add(CellType type, std::vector<int64_t> cell) {
    ids.insert(ids.end(), cell.begin(), cell.end());
    offsets.push_back(int64_t(ids.size()));
    types.push_back(uint8_t(type));
    polyhedron.push_back(polyhedron.back());
  }
  void add_polyhedron(std::vector<int64_t> cell, const LinearTopology& t) {
    add(CellType::polyhedron, cell);
    for (size_t f = 0; f < t.face_count(); ++f) {
      // Started elsewhere and turned the other way than the table: corners are what counts.
      const auto c = t.face(f);
      for (size_t i = c.size(); i-- > 0;) faces.push_back(cell[c[i]]);
      face_offsets.push_back(int64_t(faces.size()));
      ++polyhedron.back();
    }
  }
  UnstructuredMesh mesh() const {
    UnstructuredMesh m;
    m.points.xyz = Array::from_vector(xyz, 3);
    m.cells = {Array::from_vector(ids), Array::from_vector(offsets), 0};
    m.types = Array::from_vector(types);
    m.faces = {Array::from_vector(faces), Array::from_vector(face_offsets), 0};
    m.polyhedron_faces = Array::from_vector(polyhedron);
    return m;
  }
};

UnstructuredMesh mixed_mesh(int n) {
  Builder b;
  auto id = [&](int i, int j, int k) { return int64_t(i) + (n + 1) * (int64_t(j) + (n + 1) * k); };
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) b.xyz.insert(b.xyz.end(), {double(i), double(j), double(k)});
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const std::vector<int64_t> c{id(i, j, k),     id(i + 1, j, k),     id(i + 1, j + 1, k),     id(i, j + 1, k),
                                     id(i, j, k + 1), id(i + 1, j, k + 1), id(i + 1, j + 1, k + 1), id(i, j + 1, k + 1)};
        switch (random_bits(3, b.types.size()) % 4) {
          case 0: b.add_polyhedron(c, *linear_topology(CellType::hexahedron)); break;
          case 1:
            b.add(CellType::wedge, {c[0], c[1], c[3], c[4], c[5], c[7]}), b.add(CellType::wedge, {c[1], c[2], c[3], c[5], c[6], c[7]});
            break;
          case 2: b.add(CellType::voxel, {c[0], c[1], c[3], c[2], c[4], c[5], c[7], c[6]}); break;
          default: b.add(CellType::hexahedron, c);
        }
      }
  return b.mesh();
}

// By a map from corner sets to cells, one after the other.
CellNeighbors slow_neighbors(const UnstructuredMesh& m) {
  CellNeighbors out;
  CellFaceReader reader(m);
  std::map<std::set<int64_t>, std::vector<std::pair<size_t, size_t>>> owners;
  out.begin.push_back(0);
  for (size_t c = 0; c < m.cells.size(); ++c) {
    const size_t n = reader.open(c);
    for (size_t f = 0; f < n; ++f) {
      const auto ids = reader.corners(f);
      owners[{ids.begin(), ids.end()}].push_back({c, out.begin.back() + f});
    }
    out.begin.push_back(out.begin.back() + n);
  }
  out.across.assign(out.begin.back(), -1);
  for (const auto& [ids, list] : owners)
    for (size_t i = 0; i < list.size() && list.size() > 1; ++i) out.across[list[i].second] = int32_t(list[i == 0].first);
  return out;
}

}  // namespace

TEST_CASE("cell neighbours: hexahedra, voxels, wedges and polyhedra find each other as a plain search does, with any threads") {
  const UnstructuredMesh m = mixed_mesh(24);
  const CellNeighbors want = slow_neighbors(m);
  CHECK(want.across.size() > 16384);  // several chunks and partitions
  for (int threads : {1, 8}) {
    set_thread_count(threads);
    const CellNeighbors got = cell_neighbors(m);
    CHECK(got.begin == want.begin);
    CHECK(got.across == want.across);
  }
  set_thread_count(0);
  size_t inner = 0;
  for (int32_t c : want.across) inner += c >= 0;
  CHECK(inner > want.across.size() / 2);
}

TEST_CASE("cell neighbours: two tetrahedra share the face opposite to their tips; quadratic cells match by their corners") {
  Builder b;
  b.xyz.assign(3 * 14, 0.0);
  b.add(CellType::tetra, {0, 1, 2, 3});
  b.add(CellType::tetra, {1, 2, 3, 4});
  b.add(CellType::quadratic_tetra, {4, 2, 1, 5, 6, 7, 8, 9, 10, 11});
  const CellNeighbors n = cell_neighbors(b.mesh());
  CHECK(n.fixed == 4);
  // Faces 013, 123, 203, 021.
  CHECK(n.across == std::vector<int32_t>{-1, 1, -1, -1, 2, -1, -1, 0, -1, -1, -1, 1});
  CHECK(n(2, 3) == 1);
}

TEST_CASE("cell neighbours: where three cells meet each names the smallest other; collapsed faces have none") {
  Builder b;
  b.xyz.assign(3 * 12, 0.0);
  b.add(CellType::tetra, {0, 1, 2, 3});
  b.add(CellType::tetra, {0, 1, 2, 4});
  b.add(CellType::tetra, {0, 2, 1, 5});
  // A hexahedron collapsed to a wedge: its side x+ is a line, its bottom the triangle 0 1 2.
  b.add(CellType::hexahedron, {0, 1, 1, 2, 6, 7, 7, 8});
  b.add(CellType::wedge, {6, 7, 8, 9, 10, 11});
  const CellNeighbors n = cell_neighbors(b.mesh());
  CHECK(n(0, 3) == 1);
  CHECK(n(1, 3) == 0);
  CHECK(n(2, 3) == 0);
  CHECK(n.count(3) == 6);
  CHECK(n(3, 1) == -1);
  CHECK(n(3, 4) == 0);
  CHECK(n(3, 5) == 4);
  CHECK(n(4, 0) == 3);
}

TEST_CASE("cell neighbours: triangles, quads and polygons are neighbours across edges, also in surface meshes") {
  Builder b;
  b.xyz.assign(3 * 8, 0.0);
  b.add(CellType::triangle, {0, 1, 2});
  b.add(CellType::pixel, {1, 3, 2, 4});
  b.add(CellType::polygon, {3, 5, 6, 7, 4});
  b.add(CellType::line, {0, 1});
  const CellNeighbors n = cell_neighbors(b.mesh());
  CHECK(n.across == std::vector<int32_t>{-1, 1, -1, -1, 2, -1, 0, -1, -1, -1, -1, 1});
  CHECK(n.count(3) == 0);
  SurfaceMesh s;
  s.points.xyz = Array::from_vector(std::vector<double>(12), 3);
  s.vertices = {Array::from_vector(std::vector<int32_t>{0}), {}, 1};
  s.polygons = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 2, 1, 3}), {}, 3};
  const CellNeighbors surface = cell_neighbors(s);
  CHECK(surface.count(0) == 0);
  CHECK(surface(1, 1) == 2);
  CHECK(surface(2, 0) == 1);
  CHECK(cell_neighbors(UnstructuredMesh{}).across.empty());
  CHECK(test::error_of([] { cell_neighbors(UniformGrid{}); }).find("follow from the indices") != std::string::npos);
}

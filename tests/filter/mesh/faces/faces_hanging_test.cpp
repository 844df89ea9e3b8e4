// SPDX-License-Identifier: Apache-2.0
// Faces of non-conforming meshes: hanging faces are inside. Octrees of bent hexahedra are counted cell by cell on their finest grid.
#include <algorithm>
#include <map>

#include "data/cells/shape/cell_map.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/select/extract.h"
#include "support/property.h"
#include "support/test.h"

using namespace sg;
using test::Random;

namespace {

struct Solid {
  std::vector<double> xyz;
  std::vector<int64_t> ids, offsets{0};
  std::vector<uint8_t> types;
  std::map<std::array<int64_t, 3>, int64_t> known;

  int64_t point(Vec3 p) {
    const std::array<int64_t, 3> key{std::llround(p.x * 1e6), std::llround(p.y * 1e6), std::llround(p.z * 1e6)};
    const auto [it, fresh] = known.try_emplace(key, int64_t(xyz.size() / 3));
    if (fresh) xyz.insert(xyz.end(), {p.x, p.y, p.z});
    return it->second;
  }
  void cell(CellType type, const std::vector<Vec3>& corners) {
    for (const Vec3& c : corners) ids.push_back(point(c));
    offsets.push_back(int64_t(ids.size()));
    types.push_back(uint8_t(type));
  }
  DatasetPtr dataset(bool narrow = false) const {
    UnstructuredMesh m;
    m.points.xyz = Array::from_vector(xyz, 3);
    if (narrow) m.points.xyz = m.points.xyz.converted(ElementType::f32);
    m.cells = {Array::from_vector(ids), Array::from_vector(offsets), 0};
    m.types = Array::from_vector(types);
    return make_dataset(Mesh(m));
  }
};

constexpr int corner_place[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

// n^3 boxes of random corners, each divided at random down to `depth` times; `leaf` is the finest grid with the leaf of each place.
struct Octree {
  int n, depth, size;  // size: places of the finest grid along an axis
  std::vector<Vec3> roots;
  std::vector<int> leaf;
  struct Leaf {
    std::array<int, 3> at;
    int edge;
  };
  std::vector<Leaf> leaves;

  Octree(Random& random, int n, int depth, double bend, double share) : n(n), depth(depth), size(n << depth) {
    for (int k = 0; k <= n; ++k)
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) roots.push_back(Vec3(i, j, k) + Vec3(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)) * bend);
    leaf.assign(size_t(size) * size_t(size) * size_t(size), -1);
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) divide(random, {i << depth, j << depth, k << depth}, 1 << depth, share);
  }
  void divide(Random& random, std::array<int, 3> at, int edge, double share) {
    if (edge > 1 && random.chance(share)) {
      for (const auto& c : corner_place)
        divide(random, {at[0] + c[0] * edge / 2, at[1] + c[1] * edge / 2, at[2] + c[2] * edge / 2}, edge / 2, share);
      return;
    }
    for (int k = 0; k < edge; ++k)
      for (int j = 0; j < edge; ++j)
        for (int i = 0; i < edge; ++i) leaf[place(at[0] + i, at[1] + j, at[2] + k)] = int(leaves.size());
    leaves.push_back({at, edge});
  }
  size_t place(int i, int j, int k) const { return size_t(i) + size_t(size) * (size_t(j) + size_t(size) * size_t(k)); }
  // The trilinear image of a corner of the finest grid, in the box of the leaf.
  Vec3 position(const Leaf& l, const int* c) const {
    const int box = 1 << depth;
    int root[3];
    double f[3];
    for (size_t a = 0; a < 3; ++a) root[a] = l.at[a] / box, f[a] = double(l.at[a] + c[a] * l.edge - root[a] * box) / box;
    Vec3 p;
    for (const auto& r : corner_place) {
      const double w = (r[0] ? f[0] : 1 - f[0]) * (r[1] ? f[1] : 1 - f[1]) * (r[2] ? f[2] : 1 - f[2]);
      p += roots[size_t(root[0] + r[0] + (n + 1) * (root[1] + r[1] + (n + 1) * (root[2] + r[2])))] * w;
    }
    return p;
  }
  DatasetPtr mesh(bool narrow) const {
    Solid s;
    for (const Leaf& l : leaves) {
      std::vector<Vec3> corners;
      for (const auto& c : corner_place) corners.push_back(position(l, c));
      s.cell(CellType::hexahedron, corners);
    }
    return s.dataset(narrow);
  }
  // How many faces each leaf shows: those behind which something is missing.
  std::vector<int> shown(const std::vector<uint8_t>& there) const {
    std::vector<int> count(leaves.size());
    for (size_t e = 0; e < leaves.size(); ++e) {
      if (!there[e]) continue;
      const Leaf& l = leaves[e];
      for (size_t axis = 0; axis < 3; ++axis)
        for (const int side : {-1, l.edge}) {
          bool all = true;
          for (int u = 0; u < l.edge; ++u)
            for (int v = 0; v < l.edge; ++v) {
              std::array<int, 3> at = l.at;
              at[axis] += side, at[(axis + 1) % 3] += u, at[(axis + 2) % 3] += v;
              const bool in = at[axis] >= 0 && at[axis] < size;
              all = all && in && there[size_t(leaf[place(at[0], at[1], at[2])])];
            }
          count[e] += !all;
        }
    }
    return count;
  }
};

std::vector<int> faces_of_cells(const DatasetPtr& skin, size_t cells) {
  std::vector<int> count(cells);
  const Field& from = skin->fields().require("original_cell");
  for (size_t i = 0; i < skin->cell_count(); ++i) ++count[size_t(from.array.get(i))];
  return count;
}

size_t skin_faces(const Solid& s) {
  Context ctx;
  return faces(s.dataset(), {}, ctx)->cell_count();
}

}  // namespace

TEST_CASE("faces: a cell beside the eight parts of another shows only what is outside, of every shape") {
  {
    Solid s;  // hexahedra
    const auto box = [&](Vec3 o, double h) {
      std::vector<Vec3> c;
      for (const auto& p : corner_place) c.push_back(o + Vec3(p[0], p[1], p[2]) * h);
      s.cell(CellType::hexahedron, c);
    };
    box({0, 0, 0}, 1);
    for (const auto& p : corner_place) box(Vec3(1, 0, 0) + Vec3(p[0], p[1], p[2]) * 0.5, 0.5);
    CHECK(skin_faces(s) == 5 + 5 * 4);
  }
  {
    Solid s;  // tetrahedra: red refinement of the second
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), d(0.2, 0.1, 1), e(0.3, 0.3, -1);
    s.cell(CellType::tetra, {a, b, c, d});
    const Vec3 ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2, ae = (a + e) / 2, be = (b + e) / 2, ce = (c + e) / 2;
    for (const auto& t : std::vector<std::vector<Vec3>>{{a, ca, ab, ae},
                                                        {ab, bc, b, be},
                                                        {ca, c, bc, ce},
                                                        {ae, ce, be, e},
                                                        {ab, ca, bc, ae},
                                                        {ab, bc, be, ae},
                                                        {bc, ca, ce, ae},
                                                        {bc, ce, be, ae}})
      s.cell(CellType::tetra, t);
    CHECK(skin_faces(s) == 3 + 3 * 4);
  }
  {
    Solid s;  // a wedge on the four triangles and beside two halves of its quad
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), up(0, 0, 1), down(0, 0, -1);
    s.cell(CellType::wedge, {a, b, c, a + up, b + up, c + up});
    const Vec3 ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2;
    for (const auto& t : std::vector<std::vector<Vec3>>{{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
      s.cell(CellType::wedge, {t[0] + down, t[1] + down, t[2] + down, t[0], t[1], t[2]});
    const Vec3 out(0.2, -1, 0);
    for (const auto& [l, r] : {std::pair(a, ab), std::pair(ab, b)})  // halves of the quad a b b+up a+up
      s.cell(CellType::hexahedron, {l + out, r + out, r, l, l + out + up, r + out + up, r + up, l + up});
    // Wedge: its top and two of its quads. Below: four triangles and six quads. Halves: outer, top, bottom each, and two ends.
    CHECK(skin_faces(s) == 3 + 10 + 2 * 3 + 2);
  }
  {
    Solid s;  // a quad against two triangles
    std::vector<Vec3> c;
    for (const auto& p : corner_place) c.emplace_back(p[0], p[1], p[2]);
    s.cell(CellType::hexahedron, c);
    const Vec3 apex(2, 0.5, 0.5);
    s.cell(CellType::tetra, {c[1], c[2], c[6], apex});
    s.cell(CellType::tetra, {c[1], c[6], c[5], apex});
    CHECK(skin_faces(s) == 5 + 4);
  }
}

TEST_CASE("faces: cells that touch without sharing points stay apart, smaller ones too") {
  for (const double h : {1.0, 0.5}) {
    std::vector<double> xyz;
    std::vector<int64_t> ids;
    for (const auto& [o, edge] : {std::pair(Vec3(0, 0, 0), 1.0), std::pair(Vec3(1, 0, 0), h)})
      for (const auto& p : corner_place) {
        ids.push_back(int64_t(xyz.size() / 3));
        xyz.insert(xyz.end(), {o.x + p[0] * edge, o.y + p[1] * edge, o.z + p[2] * edge});
      }
    UnstructuredMesh m;
    m.points.xyz = Array::from_vector(xyz, 3);
    m.cells = {Array::from_vector(ids), {}, 8};
    m.single_type = CellType::hexahedron;
    Context ctx;
    CHECK(faces(make_dataset(Mesh(m)), {}, ctx)->cell_count() == 12);
  }
}

TEST_CASE("faces: finer cells in the notch of a polyhedron hide its ground, and are hidden by its walls") {
  // A U of one cell, and two boxes on the ground between its arms. The mean of its corners lies above that ground.
  std::vector<double> xyz;
  const std::array<std::array<double, 2>, 8> outline{{{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}};
  for (const double z : {0.0, 1.0})
    for (const auto& [x, y] : outline) xyz.insert(xyz.end(), {x, y, z});
  // 16 to 23: half way along the ground, and the boxes' tops.
  for (const double z : {0.0, 1.0}) xyz.insert(xyz.end(), {1.5, 1, z, 1, 2, z, 1.5, 2, z, 2, 2, z});
  const std::vector<std::vector<int64_t>> boxes{{5, 16, 18, 17, 13, 20, 22, 21}, {16, 4, 19, 18, 20, 12, 23, 22}};
  std::vector<int64_t> ids(16), face_ids, face_offsets{0};
  for (size_t i = 0; i < 16; ++i) ids[i] = int64_t(i);
  const auto face = [&](const std::vector<int64_t>& f) {
    face_ids.insert(face_ids.end(), f.begin(), f.end());
    face_offsets.push_back(int64_t(face_ids.size()));
  };
  face({7, 6, 5, 4, 3, 2, 1, 0}), face({8, 9, 10, 11, 12, 13, 14, 15});
  for (int64_t k = 0; k < 8; ++k) face({k, (k + 1) % 8, (k + 1) % 8 + 8, k + 8});
  const auto ends = int64_t(face_offsets.size()) - 1;
  for (const auto& box : boxes) ids.insert(ids.end(), box.begin(), box.end());
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(xyz, 3);
  m.cells = {Array::from_vector(ids), Array::from_vector(std::vector<int64_t>{0, 16, 24, 32}), 0};
  m.types =
      Array::from_vector(std::vector<uint8_t>{uint8_t(CellType::polyhedron), uint8_t(CellType::hexahedron), uint8_t(CellType::hexahedron)});
  m.faces = {Array::from_vector(face_ids), Array::from_vector(face_offsets), 0};
  m.polyhedron_faces = Array::from_vector(std::vector<int64_t>{0, ends, ends, ends});
  Context ctx;
  CHECK(faces_of_cells(faces(make_dataset(Mesh(m)), {}, ctx), 3) == std::vector<int>{9, 3, 3});
}

TEST_CASE("faces: a sliver that lies a little off a larger face is another cell's, and no finer part of it") {
  for (const double gap : {5e-5, 0.0}) {
    Solid s;
    s.cell(CellType::tetra, {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.3, 0.3, -1)});
    s.cell(CellType::tetra, {Vec3(0, 0, 0), Vec3(0.5, 0.2, gap), Vec3(0.5, 0.2003, gap), Vec3(0.4, 0.2, 1)});
    CHECK(skin_faces(s) == (gap > 0 ? 8 : 7));
  }
}

TEST_CASE("property: faces of octrees of bent hexahedra are those behind which nothing is") {
  Context ctx;
  for (const uint64_t seed : test::property_seeds(24)) {
    CAPTURE(seed);
    Random random(seed);
    const int n = random.whole(1, 3), depth = random.whole(1, n == 1 ? 3 : 2);
    const Octree tree(random, n, depth, random.chance(0.3) ? 0 : random.in(0, 0.2), random.in(0.2, 0.8));
    const bool narrow = random.chance(0.5);
    const DatasetPtr whole = tree.mesh(narrow);
    const size_t cells = tree.leaves.size();
    const DatasetPtr skin = faces(whole, {}, ctx);
    REQUIRE(faces_of_cells(skin, cells) == tree.shown(std::vector<uint8_t>(cells, 1)));
    // Closed: the vectors of its faces add up to nothing, and it holds what the cells hold.
    const auto& s = *skin->as<SurfaceMesh>();
    const CellsView quads = cells_view(s.polygons);
    Vec3 sum;
    double area = 0;
    for (size_t q = 0; q < quads.count; ++q) {
      const Vec3 d = s.points.at(size_t(quads.point(q, 2))) - s.points.at(size_t(quads.point(q, 0))),
                 e = s.points.at(size_t(quads.point(q, 3))) - s.points.at(size_t(quads.point(q, 1)));
      sum += cross(d, e) * 0.5, area += length(cross(d, e)) * 0.5;
    }
    CHECK(length(sum) < (narrow ? 1e-5 : 1e-12) * area);

    if (depth > 1) continue;  // one level: every small face has a corner of the large one
    std::vector<uint8_t> there(cells), ghost(cells);
    for (size_t c = 0; c < cells; ++c) there[c] = uint8_t(random.chance(0.8)), ghost[c] = there[c] ? 0 : uint8_t(ghost_hidden_cell);
    DatasetParts parts = whole->parts();
    parts.cell_ghost = Array::from_vector(ghost);
    REQUIRE(faces_of_cells(faces(make_dataset(std::move(parts)), {}, ctx), cells) == tree.shown(there));
  }
}

TEST_CASE("property: faces of random parts of conforming meshes close, of any type of cell") {
  Context ctx;
  for (const uint64_t seed : test::property_seeds(24)) {
    CAPTURE(seed);
    Random random(seed);
    const int n = random.whole(1, 4), kind = random.whole(0, 2);
    Solid s;
    std::vector<Vec3> roots;
    for (int k = 0; k <= n; ++k)
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) roots.push_back(Vec3(i, j, k) + Vec3(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)) * 0.2);
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          if (random.chance(0.3)) continue;
          std::vector<Vec3> c;
          for (const auto& p : corner_place) c.push_back(roots[size_t(i + p[0] + (n + 1) * (j + p[1] + (n + 1) * (k + p[2])))]);
          if (kind == 0) s.cell(CellType::hexahedron, c);
          if (kind == 1)
            s.cell(CellType::wedge, {c[0], c[1], c[2], c[4], c[5], c[6]}), s.cell(CellType::wedge, {c[0], c[2], c[3], c[4], c[6], c[7]});
          if (kind == 2)
            for (const auto& t : {std::array{0, 1, 2, 6}, std::array{0, 5, 1, 6}, std::array{0, 4, 5, 6}, std::array{0, 2, 3, 6},
                                  std::array{0, 3, 7, 6}, std::array{0, 7, 4, 6}})
              s.cell(CellType::tetra, {c[size_t(t[0])], c[size_t(t[1])], c[size_t(t[2])], c[size_t(t[3])]});
        }
    if (s.types.empty()) continue;
    const DatasetPtr skin = faces(s.dataset(), {.original_point = true}, ctx);
    const CellsView cells = cells_view(skin->as<SurfaceMesh>()->polygons);
    std::map<std::pair<int64_t, int64_t>, int> edges;  // each way counted apart: as many there as back
    for (size_t c = 0; c < cells.count; ++c)
      for (size_t k = 0; k < cells.size(c); ++k) {
        const int64_t a = cells.point(c, k), b = cells.point(c, (k + 1) % cells.size(c));
        edges[std::minmax(a, b)] += a < b ? 1 : -1;
      }
    CHECK(std::all_of(edges.begin(), edges.end(), [](const auto& e) { return e.second == 0; }));
  }
}

// SPDX-License-Identifier: Apache-2.0
// How single cells of unstructured and surface meshes are cut. Inside filter/scalar only.
#pragma once
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "filter/scalar/contour/cells/cell_cases.h"
#include "filter/scalar/contour/cells/contour_cell_scan.h"
#include "filter/scalar/contour/cells/trilinear_cell.h"
#include "filter/scalar/contour/contour_parts.h"

namespace sg::contouring {

/// The name of an edge: its lower point number above the higher one.
inline uint64_t edge_key(int64_t a, int64_t b) { return a < b ? uint64_t(a) << 32 | uint64_t(b) : uint64_t(b) << 32 | uint64_t(a); }

/// A point inside a hexahedron or voxel: its corners in the order of lattices, and (u,v,w).
struct CellPoint {
  std::array<uint32_t, 8> corners;
  std::array<double, 3> at;
};

/// Triangles and lines as names of cut edges; inner_key + i names inner[i].
struct Found {
  static constexpr uint64_t inner_key = uint64_t(1) << 63;
  std::vector<uint64_t> lines, triangles;
  std::vector<uint32_t> line_cells, triangle_cells;
  std::vector<CellPoint> inner;
  void clear() { lines.clear(), triangles.clear(), line_cells.clear(), triangle_cells.clear(), inner.clear(); }
};

/// Looks at one cell at a time.
struct Finder {
  const Job& job;
  Positions points;
  double value;
  Sample f{job.samples};
  View<uint8_t> point_ghost = job.input.point_ghost().empty() ? View<uint8_t>{} : job.input.point_ghost().view<uint8_t>();
  View<uint8_t> cell_ghost = job.input.cell_ghost().empty() ? View<uint8_t>{} : job.input.cell_ghost().view<uint8_t>();

  bool skipped(size_t cell) const {
    return cell_ghost.count && (cell_ghost[cell] & (ghost_duplicate | ghost_refined_cell | ghost_hidden_cell));
  }
  // A tetrahedron, whose triangles are few: one point, or pairs of points.
  void tetra(const CellsView& cells, size_t cell, Found& out) const {
    static constexpr uint8_t side[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    static constexpr uint8_t edge[4][4] = {{0, 0, 1, 2}, {0, 0, 3, 4}, {1, 3, 0, 5}, {2, 4, 5, 0}};
    // For a single corner k, the other three, counterclockwise as seen from the side opposite k.
    static constexpr uint8_t others[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    int64_t p[4];
    uint32_t in = 0;
    for (size_t k = 0; k < 4; ++k) {
      p[k] = cells.point(cell, k);
      in |= uint32_t(f(size_t(p[k])) >= value) << k;
    }
    const Vec3 o = points.at(size_t(p[0])), x = points.at(size_t(p[1])) - o, y = points.at(size_t(p[2])) - o,
               z = points.at(size_t(p[3])) - o;
    bool flip = dot(x, cross(y, z)) < 0;
    auto key = [&](uint8_t a, uint8_t b) {
      const uint8_t* s = side[edge[a][b]];
      return edge_key(p[s[0]], p[s[1]]);
    };
    auto triangle = [&](uint64_t a, uint64_t b, uint64_t c) {
      if (flip) std::swap(b, c);
      out.triangles.insert(out.triangles.end(), {a, b, c});
      out.triangle_cells.push_back(uint32_t(cell));
    };
    const int n = std::popcount(in);
    if (n == 2) {
      const auto a = uint8_t(std::countr_zero(in)), b = uint8_t(std::countr_zero(in & (in - 1)));
      const uint32_t rest = 15 ^ in;
      auto c = uint8_t(std::countr_zero(rest)), d = uint8_t(std::countr_zero(rest & (rest - 1)));
      // An even order (a, b, c, d) turns like (0, 1, 2, 3).
      if ((a == 0 && b == 2) || (a == 1 && b == 3)) std::swap(c, d);
      triangle(key(a, c), key(b, d), key(b, c));
      triangle(key(a, c), key(a, d), key(b, d));
      return;
    }
    const bool one_in = n == 1;
    const auto k = uint8_t(std::countr_zero(one_in ? in : 15 ^ in));
    const uint8_t* q = others[k];
    flip = flip != one_in;
    triangle(key(k, q[0]), key(k, q[2]), key(k, q[1]));
  }

  bool bad(int64_t p) const { return std::isnan(f(size_t(p))) || (point_ghost.count && (point_ghost[size_t(p)] & ghost_hidden_point)); }

  // Six times the volume when the faces, as listed, turn outwards; negative for a mirrored cell.
  double volume(const CaseShape& shape, const int64_t* p) const {
    const Vec3 base = points.at(size_t(p[0]));
    auto at = [&](uint8_t c) { return points.at(size_t(p[c])) - base; };
    double v = 0;
    for (const auto& face : shape.faces)
      for (size_t k = 1; k + 1 < face.size(); ++k) v += dot(at(face[0]), cross(at(face[k]), at(face[k + 1])));
    return v;
  }

  // Hexahedra are taken in the order of lattices, so that the same cells give the same triangles whatever they are called.
  void solid(CellType type, const CellsView& cells, size_t cell, Found& out) const {
    const bool hexahedron = type == CellType::hexahedron;
    const CaseTable& table = hexahedron ? lattice_cases() : *cell_cases(type);
    std::array<int64_t, 16> p;
    for (size_t c = 0; c < size_t(table.shape().corners); ++c) p[hexahedron ? hexahedron_corner[c] : c] = cells.point(cell, c);
    solid(table, p, cell, out);
  }

  void solid(const CaseTable& table, std::array<int64_t, 16> p, size_t cell, Found& out) const {
    const CaseShape& shape = table.shape();
    // The rules for segments and diagonals look at cells from outside, so mirrored ones are turned into proper ones.
    if (volume(shape, p.data()) < 0) {
      const auto given = p;
      for (size_t c = 0; c < size_t(shape.corners); ++c) p[c] = given[shape.mirror[c]];
    }
    uint32_t pattern = 0;
    for (int c = 0; c < shape.corners; ++c) pattern |= uint32_t(f(size_t(p[size_t(c)])) >= value) << c;
    if (job.trilinear && &table == &lattice_cases() && trilinear(p.data(), cell, out)) return;
    uint32_t joined = 0;
    for (uint32_t m = table.ambiguous(pattern); m; m &= m - 1) {
      const auto& face = shape.faces[size_t(std::countr_zero(m))];
      double v[4];
      for (size_t c = 0; c < 4; ++c) v[c] = f(size_t(p[face[c]])) - value;
      joined |= uint32_t(joined_inside(v[0], v[1], v[2], v[3])) << std::countr_zero(m);
    }
    const auto edges = table.triangles(pattern, joined);
    for (uint8_t e : edges) out.triangles.push_back(edge_key(p[shape.edges[e][0]], p[shape.edges[e][1]]));
    out.triangle_cells.insert(out.triangle_cells.end(), edges.size() / 3, uint32_t(cell));
  }

  // A hexahedron or voxel whose surface depends on more than the signs; false when the tables will do.
  bool trilinear(const int64_t* p, size_t cell, Found& out) const {
    uint32_t q[8], pattern = 0;
    double v[8];
    for (size_t c = 0; c < 8; ++c) {
      q[c] = uint32_t(p[c]);
      v[c] = f(size_t(p[c])) - value;
      pattern |= uint32_t(v[c] >= 0) << c;
    }
    if (!needs_trilinear(pattern)) return false;
    for (double x : v)
      if (!std::isfinite(x)) return false;
    TrilinearCell t;
    cut_trilinear(v, t);
    const auto& edges = lattice_cases().shape().edges;
    for (int i = 0; i < t.triangle_count; ++i)
      for (uint8_t name : t.triangles[size_t(i)]) {
        if (name < TrilinearCell::first_inner) out.triangles.push_back(edge_key(q[edges[name][0]], q[edges[name][1]]));
        else out.triangles.push_back(Found::inner_key + out.inner.size() + name - TrilinearCell::first_inner);
      }
    out.triangle_cells.insert(out.triangle_cells.end(), size_t(t.triangle_count), uint32_t(cell));
    for (int i = 0; i < t.inner_count; ++i) {
      CellPoint& point = out.inner.emplace_back();
      std::copy(q, q + 8, point.corners.begin());
      point.at = t.inner[size_t(i)];
    }
    return true;
  }

  // A polygon: a line from where the boundary leaves the inside to where it came in, so that the inside lies on the left.
  void polygon(std::span<const int64_t> p, size_t number, Found& out) const {
    const size_t n = p.size();
    bool any = false, every = true;
    for (int64_t q : p) {
      const bool in = f(size_t(q)) >= value;
      any = any || in, every = every && in;
    }
    if (!any || every) return;
    for (int64_t q : p)
      if (bad(q)) return;
    auto in = [&](size_t k) { return f(size_t(p[k % n])) >= value; };
    size_t start = 0;
    while (in(start) || !in(start + 1)) ++start;
    uint64_t first_entry = 0, entry = 0, exit = 0;
    const bool four = n == 4 && in(0) == in(2) && in(1) == in(3);
    const bool join =
        four && joined_inside(f(size_t(p[0])) - value, f(size_t(p[1])) - value, f(size_t(p[2])) - value, f(size_t(p[3])) - value);
    auto line = [&](uint64_t a, uint64_t b) {
      out.lines.push_back(a), out.lines.push_back(b);
      out.line_cells.push_back(uint32_t(number));
    };
    for (size_t s = 0; s < n; ++s) {
      const size_t k = start + s;
      const uint64_t key = edge_key(p[k % n], p[(k + 1) % n]);
      if (!in(k) && in(k + 1)) {
        entry = key;
        if (s == 0) first_entry = key;
        else if (join) line(exit, entry);
      } else if (in(k) && !in(k + 1)) {
        exit = key;
        if (!join) line(exit, entry);
      }
    }
    if (join) line(exit, first_entry);
  }
};

/// Faces as lists of point ids.
using PolyhedronFaces = std::vector<std::vector<int64_t>>;
/// The faces of a polyhedron, counterclockwise seen from outside also where the file does not keep to that.
PolyhedronFaces outward_faces(const UnstructuredMesh& mesh, size_t cell);

/// The triangles of polyhedron `cell`, whose corners are good and lie on both sides.
void cut_polyhedron(const Finder& finder, const UnstructuredMesh& mesh, size_t cell, Found& out);

}  // namespace sg::contouring

// SPDX-License-Identifier: Apache-2.0
// How single cells of unstructured and surface meshes are cut. Inside filter/scalar only.
#pragma once
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "filter/scalar/cell_cases.h"
#include "filter/scalar/contour_parts.h"

namespace sg::contouring {

/// The name of an edge: its lower point number above the higher one.
inline uint64_t edge_key(int64_t a, int64_t b) { return a < b ? uint64_t(a) << 32 | uint64_t(b) : uint64_t(b) << 32 | uint64_t(a); }

/// Triangles and lines as names of cut edges.
struct Found {
  std::vector<uint64_t> lines, triangles;
  std::vector<uint32_t> line_cells, triangle_cells;
};

/// Looks at one cell at a time.
struct Finder {
  const Job& job;
  const Points& points;
  double value;
  Sample f{job.samples};
  View<uint8_t> point_ghost = job.input.point_ghost().empty() ? View<uint8_t>{} : job.input.point_ghost().view<uint8_t>();
  View<uint8_t> cell_ghost = job.input.cell_ghost().empty() ? View<uint8_t>{} : job.input.cell_ghost().view<uint8_t>();

  bool skipped(size_t cell) const {
    return cell_ghost.count && (cell_ghost[cell] & (ghost_duplicate | ghost_refined_cell | ghost_hidden_cell));
  }
  bool bad(int64_t p) const { return std::isnan(f(size_t(p))) || (point_ghost.count && (point_ghost[size_t(p)] & ghost_hidden_point)); }

  // Six times the volume when the faces, as listed, turn outwards; negative for a mirrored cell.
  double volume(const CellShape& shape, const CellsView& cells, size_t cell) const {
    const Vec3 base = points.at(size_t(cells.point(cell, 0)));
    auto at = [&](uint8_t c) { return points.at(size_t(cells.point(cell, c))) - base; };
    double v = 0;
    for (const auto& face : shape.faces)
      for (size_t k = 1; k + 1 < face.size(); ++k) v += dot(at(face[0]), cross(at(face[k]), at(face[k + 1])));
    return v;
  }

  void solid(const CaseTable& table, const CellsView& cells, size_t cell, Found& out) const {
    const CellShape& shape = table.shape();
    std::array<int64_t, 16> p;
    uint32_t any = 0, every = 1;
    for (size_t c = 0; c < size_t(shape.corners); ++c) {
      p[c] = cells.point(cell, c);
      const uint32_t in = f(size_t(p[c])) >= value;
      any |= in, every &= in;
    }
    if (!any || every) return;
    // The rules for segments and diagonals look at cells from outside, so mirrored ones are turned into proper ones.
    if (volume(shape, cells, cell) < 0)
      for (size_t c = 0; c < size_t(shape.corners); ++c) p[c] = cells.point(cell, shape.mirror[c]);
    uint32_t pattern = 0;
    for (int c = 0; c < shape.corners; ++c) {
      if (bad(p[size_t(c)])) return;
      pattern |= uint32_t(f(size_t(p[size_t(c)])) >= value) << c;
    }
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

/// The triangles of polyhedron `cell`, whose corners are good and lie on both sides.
void cut_polyhedron(const Finder& finder, const UnstructuredMesh& mesh, size_t cell, Found& out);

}  // namespace sg::contouring

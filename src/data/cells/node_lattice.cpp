// SPDX-License-Identifier: Apache-2.0
// Numbering of the nodes of Lagrange and Bezier cells, as VTK files hold them since file version 2.
#include <fmt/core.h>

#include "base/error.h"
#include "data/cells/cell_topology.h"

namespace sg {

namespace {

using Orders = std::array<int, 3>;

// A triangle of order n lists its corners, its edges (each from corner to corner), then an inner triangle of order n-3.
uint32_t triangle_node(int n, int i, int j) {
  uint32_t offset = 0;
  for (;;) {
    const int l = n - i - j;
    if (n == 0) return offset;
    if (l == n) return offset;
    if (i == n) return offset + 1;
    if (j == n) return offset + 2;
    if (j == 0) return offset + 3 + uint32_t(i - 1);
    if (l == 0) return offset + 3 + uint32_t(n - 1) + uint32_t(j - 1);
    if (i == 0) return offset + 3 + 2 * uint32_t(n - 1) + uint32_t(l - 1);
    offset += 3 * uint32_t(n);
    --i, --j, n -= 3;
  }
}

// Corners, edges 01 12 32 03 (all along +i or +j), interior with i fastest.
uint32_t quad_node(Orders n, int i, int j) {
  const uint32_t a = uint32_t(n[0] - 1), b = uint32_t(n[1] - 1);
  const bool ib = i == 0 || i == n[0], jb = j == 0 || j == n[1];
  if (ib && jb) return i ? (j ? 2 : 1) : (j ? 3 : 0);
  if (jb) return 4 + uint32_t(i - 1) + (j ? a + b : 0);
  if (ib) return 4 + uint32_t(j - 1) + (i ? a : 2 * a + b);
  return 4 + 2 * (a + b) + uint32_t(i - 1) + a * uint32_t(j - 1);
}

// Corners, the 12 edges (bottom ring, top ring, uprights), faces x- x+ y- y+ z- z+, interior with i fastest.
uint32_t hexahedron_node(Orders n, int i, int j, int k) {
  const uint32_t a = uint32_t(n[0] - 1), b = uint32_t(n[1] - 1), c = uint32_t(n[2] - 1);
  const bool ib = i == 0 || i == n[0], jb = j == 0 || j == n[1], kb = k == 0 || k == n[2];
  const int on = int(ib) + int(jb) + int(kb);
  if (on == 3) return uint32_t((i ? (j ? 2 : 1) : (j ? 3 : 0)) + (k ? 4 : 0));
  if (on == 2) {
    const uint32_t ring = 8 + (k ? 2 * (a + b) : 0);
    if (!ib) return ring + uint32_t(i - 1) + (j ? a + b : 0);
    if (!jb) return ring + uint32_t(j - 1) + (i ? a : 2 * a + b);
    return 8 + 4 * (a + b) + uint32_t(k - 1) + c * uint32_t(i ? (j ? 2 : 1) : (j ? 3 : 0));
  }
  const uint32_t faces = 8 + 4 * (a + b + c);
  if (on == 1) {
    if (ib) return faces + uint32_t(j - 1) + b * uint32_t(k - 1) + (i ? b * c : 0);
    if (jb) return faces + 2 * b * c + uint32_t(i - 1) + a * uint32_t(k - 1) + (j ? a * c : 0);
    return faces + 2 * (b + a) * c + uint32_t(i - 1) + a * uint32_t(j - 1) + (k ? a * b : 0);
  }
  return faces + 2 * (b * c + a * c + a * b) + uint32_t(i - 1) + a * (uint32_t(j - 1) + b * uint32_t(k - 1));
}

// Corners, edges 01 12 20 34 45 53 03 14 25, the two triangles (rows along i), the quads 0143 1254 2035, interior.
uint32_t wedge_node(Orders orders, int i, int j, int k) {
  const int n = orders[0];
  const uint32_t a = uint32_t(n - 1), c = uint32_t(orders[2] - 1);
  const int l = n - i - j;
  const bool kb = k == 0 || k == orders[2];
  const int on = int(i == 0) + int(j == 0) + int(l == 0);
  const uint32_t corner = i == n ? 1 : j == n ? 2 : 0;
  if (on == 2 && kb) return corner + (k ? 3 : 0);
  if (on == 2) return 6 + 6 * a + c * corner + uint32_t(k - 1);
  if (on == 1 && kb) {
    const uint32_t base = 6 + (k ? 3 * a : 0);
    return j == 0 ? base + uint32_t(i - 1) : l == 0 ? base + a + uint32_t(j - 1) : base + 2 * a + uint32_t(l - 1);
  }
  const uint32_t faces = 6 + 6 * a + 3 * c, inner = n > 2 ? uint32_t((n - 1) * (n - 2) / 2) : 0;
  auto row_place = [&] { return uint32_t(i - 1 + (j - 1) * (n - 1) - j * (j - 1) / 2); };
  if (on == 0 && kb) return faces + (k ? inner : 0) + row_place();
  if (on == 1) {
    const uint32_t base = faces + 2 * inner + a * uint32_t(k - 1);
    return j == 0 ? base + uint32_t(i - 1) : l == 0 ? base + a * c + uint32_t(j - 1) : base + 2 * a * c + uint32_t(l - 1);
  }
  return faces + 2 * inner + 3 * a * c + inner * uint32_t(k - 1) + row_place();
}

// Corners, edges 01 12 20 03 13 23, faces 013 231 032 021 (inner nodes as an inner triangle of order n-3), inner tetra of order n-4.
uint32_t tetra_node(int n, int i, int j, int k) {
  uint32_t offset = 0;
  for (;;) {
    if (n == 0) return offset;
    const int w[4] = {n - i - j - k, i, j, k};  // weight of each corner
    for (uint32_t c = 0; c < 4; ++c)
      if (w[c] == n) return offset + c;
    const uint32_t m = uint32_t(n - 1);
    constexpr int edge_corner[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
    for (uint32_t e = 0; e < 6; ++e)
      if (w[edge_corner[e][0]] + w[edge_corner[e][1]] == n) return offset + 4 + e * m + uint32_t(w[edge_corner[e][1]] - 1);
    constexpr int face_corner[4][3] = {{0, 1, 3}, {2, 3, 1}, {0, 3, 2}, {0, 2, 1}};
    const uint32_t inner = uint32_t((n - 1) * (n - 2) / 2);
    for (uint32_t f = 0; f < 4; ++f) {
      const int* c = face_corner[f];
      if (w[c[0]] + w[c[1]] + w[c[2]] == n) return offset + 4 + 6 * m + f * inner + triangle_node(n - 3, w[c[1]] - 1, w[c[2]] - 1);
    }
    offset += 4 + 6 * m + 4 * inner;
    --i, --j, --k, n -= 4;
  }
}

}  // namespace

uint32_t lattice_node(CellType type, std::array<int, 3> n, int i, int j, int k) {
  switch (linear_type(type)) {
    case CellType::line: return i == 0 ? 0 : i == n[0] ? 1 : uint32_t(i + 1);
    case CellType::triangle: return triangle_node(n[0], i, j);
    case CellType::quad: return quad_node(n, i, j);
    case CellType::tetra: return tetra_node(n[0], i, j, k);
    case CellType::hexahedron: return hexahedron_node(n, i, j, k);
    case CellType::wedge: return wedge_node(n, i, j, k);
    default: fail_internal(fmt::format("{} has no node lattice", cell_type_info(type).name));
  }
}

uint32_t lattice_node(CellType type, int n, int i, int j, int k) { return lattice_node(type, std::array<int, 3>{n, n, n}, i, j, k); }

size_t lattice_nodes(CellType type, std::array<int, 3> n) {
  const auto a = size_t(n[0] + 1), b = size_t(n[1] + 1), c = size_t(n[2] + 1);
  switch (linear_type(type)) {
    case CellType::line: return a;
    case CellType::triangle: return a * (a + 1) / 2;
    case CellType::quad: return a * b;
    case CellType::tetra: return a * (a + 1) * (a + 2) / 6;
    case CellType::hexahedron: return a * b * c;
    case CellType::wedge: return a * (a + 1) / 2 * c;
    default: return 0;
  }
}

}  // namespace sg

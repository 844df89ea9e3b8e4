// SPDX-License-Identifier: Apache-2.0
// Shape functions of the linear cells, in closed form: they are what most meshes are made of.
#include <fmt/core.h>

#include "base/error.h"
#include "data/cells/shape/cell_basis.h"

namespace sg::basis {

namespace {

// Bit a of box[k] says at which end of axis a node k lies.
constexpr uint8_t ring_places[8] = {0, 1, 3, 2, 4, 5, 7, 6};
constexpr uint8_t box_places[8] = {0, 1, 2, 3, 4, 5, 6, 7};

void box_functions(const uint8_t* places, int dimension, Vec3 p, double* n, Vec3* dn) {
  const double x[2] = {1 - p.x, p.x}, y[2] = {1 - p.y, p.y}, z[2] = {1 - p.z, p.z};
  const double sign[2] = {-1, 1};
  for (int k = 0; k < 1 << dimension; ++k) {
    const int a = places[k] & 1, b = places[k] >> 1 & 1, c = places[k] >> 2;
    if (dimension == 3) {
      if (n) n[k] = x[a] * y[b] * z[c];
      if (dn) dn[k] = {sign[a] * y[b] * z[c], x[a] * sign[b] * z[c], x[a] * y[b] * sign[c]};
    } else {
      if (n) n[k] = x[a] * y[b];
      if (dn) dn[k] = {sign[a] * y[b], x[a] * sign[b], 0};
    }
  }
}

// With u, v in [-1,1] across the section at height t: N = (1-t)(1 -+ u)(1 -+ v)/4, apex t. In the reference pyramid's own
// coordinates u = (2r-1)/(1-t), so the derivatives along t are (u v - 1)/4 and its like: bounded up to the apex.
void pyramid_functions(Vec3 p, double* n, Vec3* dn) {
  const double w = 1 - p.z;
  const double u = w != 0 ? (2 * p.x - 1) / w : 0, v = w != 0 ? (2 * p.y - 1) / w : 0;
  constexpr double su[4] = {-1, 1, 1, -1}, sv[4] = {-1, -1, 1, 1};
  for (int k = 0; k < 4; ++k) {
    const double a = 1 + su[k] * u, b = 1 + sv[k] * v;
    if (n) n[k] = w * a * b / 4;
    if (dn) dn[k] = {su[k] * b / 2, sv[k] * a / 2, (su[k] * sv[k] * u * v - 1) / 4};
  }
  if (n) n[4] = p.z;
  if (dn) dn[4] = {0, 0, 1};
}

}  // namespace

void linear_functions(CellType type, Vec3 p, double* n, Vec3* dn) {
  switch (type) {
    case CellType::vertex:
      if (n) n[0] = 1;
      if (dn) dn[0] = {0, 0, 0};
      return;
    case CellType::line:
      if (n) n[0] = 1 - p.x, n[1] = p.x;
      if (dn) dn[0] = {-1, 0, 0}, dn[1] = {1, 0, 0};
      return;
    case CellType::triangle:
      if (n) n[0] = 1 - p.x - p.y, n[1] = p.x, n[2] = p.y;
      if (dn) dn[0] = {-1, -1, 0}, dn[1] = {1, 0, 0}, dn[2] = {0, 1, 0};
      return;
    case CellType::tetra:
      if (n) n[0] = 1 - p.x - p.y - p.z, n[1] = p.x, n[2] = p.y, n[3] = p.z;
      if (dn) dn[0] = {-1, -1, -1}, dn[1] = {1, 0, 0}, dn[2] = {0, 1, 0}, dn[3] = {0, 0, 1};
      return;
    case CellType::pixel: return box_functions(box_places, 2, p, n, dn);
    case CellType::quad: return box_functions(ring_places, 2, p, n, dn);
    case CellType::voxel: return box_functions(box_places, 3, p, n, dn);
    case CellType::hexahedron: return box_functions(ring_places, 3, p, n, dn);
    case CellType::wedge: {
      const double l[3] = {1 - p.x - p.y, p.x, p.y};
      constexpr double dr[3] = {-1, 1, 0}, ds[3] = {-1, 0, 1};
      for (int k = 0; k < 6; ++k) {
        const int c = k % 3;
        const double h = k < 3 ? 1 - p.z : p.z;
        if (n) n[k] = l[c] * h;
        if (dn) dn[k] = {dr[c] * h, ds[c] * h, k < 3 ? -l[c] : l[c]};
      }
      return;
    }
    case CellType::pyramid: return pyramid_functions(p, n, dn);
    default: fail_internal(fmt::format("{} is not a linear cell with a reference map", cell_type_info(type).name));
  }
}

std::vector<Vec3> reference_corners(CellType linear) {
  auto box = [](const uint8_t* places, int count) {
    std::vector<Vec3> at;
    for (int k = 0; k < count; ++k) at.push_back({double(places[k] & 1), double(places[k] >> 1 & 1), double(places[k] >> 2)});
    return at;
  };
  switch (linear) {
    case CellType::vertex: return {{0, 0, 0}};
    case CellType::line: return {{0, 0, 0}, {1, 0, 0}};
    case CellType::triangle: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    case CellType::tetra: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    case CellType::pixel: return box(box_places, 4);
    case CellType::quad: return box(ring_places, 4);
    case CellType::voxel: return box(box_places, 8);
    case CellType::hexahedron: return box(ring_places, 8);
    case CellType::wedge: return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    case CellType::pyramid: return {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}};
    default: return {};
  }
}

}  // namespace sg::basis

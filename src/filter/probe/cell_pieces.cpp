// SPDX-License-Identifier: Apache-2.0
#include "filter/probe/cell_pieces.h"

#include <algorithm>

#include "data/cells/cell_topology.h"

namespace sg {

uint32_t CellPieces::add(Vec3 p, std::span<const double> row) {
  at.push_back(p);
  rows.insert(rows.end(), row.begin(), row.end());
  return uint32_t(at.size() - 1);
}

uint32_t CellPieces::add_mean(std::span<const uint32_t> of) {
  Vec3 p;
  row_.assign(nodes, 0);
  for (uint32_t c : of) {
    p += at[c];
    for (size_t k = 0; k < nodes; ++k) row_[k] += rows[c * nodes + k];
  }
  for (double& w : row_) w /= double(of.size());
  return add(p / double(of.size()), row_);
}

void CellPieces::make_fans(CellMap& map) {
  const CellReader& reader = map.reader();
  std::vector<uint32_t> all(nodes);
  for (uint32_t k = 0; k < nodes; ++k) {
    row_.assign(nodes, 0);
    row_[k] = 1;
    all[k] = add(reader.at()[k], row_);
  }
  const uint32_t middle = add_mean(all);
  auto fan = [&](std::span<const uint32_t> face) {
    const size_t n = face.size();
    if (n < 3) return;
    if (n == 3) return void(corners.insert(corners.end(), {face[0], face[1], face[2], middle}));
    const uint32_t center = add_mean(face);
    for (size_t i = 0; i < n; ++i) corners.insert(corners.end(), {face[i], face[(i + 1) % n], center, middle});
  };
  if (reader.type() == CellType::polyhedron) {
    CellReader faces = reader;
    for (size_t f = 0; f < faces.face_count(); ++f) fan(faces.face(f));
  } else {
    const CellFaces& faces = cell_faces(reader.type(), nodes, reader.orders());
    for (size_t f = 0; f < faces.size(); ++f) fan(faces.face(f));
  }
}

// The unit cube of `divisions`^3 cubes, each of six tetrahedra around its diagonal, laid onto the reference element by drawing sides
// together.
void CellPieces::make_divided(CellMap& map, int divisions) {
  const CellType base = linear_type(map.reader().type());
  const int n = divisions, s = n + 1;
  row_.resize(nodes);
  for (int k = 0; k < s; ++k)
    for (int j = 0; j < s; ++j)
      for (int i = 0; i < s; ++i) {
        const Vec3 c = Vec3(i, j, k) / double(n);
        CellPlace place;
        switch (base) {
          case CellType::tetra: place.rst = {c.x, c.y * (1 - c.x), c.z * (1 - c.x) * (1 - c.y)}; break;
          case CellType::wedge: place.rst = {c.x, c.y * (1 - c.x), c.z}; break;
          case CellType::pyramid: place.rst = {0.5 + (c.x - 0.5) * (1 - c.z), 0.5 + (c.y - 0.5) * (1 - c.z), c.z}; break;
          default: place.rst = c;
        }
        place.nearest = map.position(place.rst);
        map.weights(place, row_);
        add(place.nearest, row_);
      }
  constexpr int around[] = {1, 3, 2, 6, 4, 5};  // corners of a cube by bits x, y, z: a way around the diagonal 0-7
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        auto id = [&](int c) { return uint32_t((i + (c & 1)) + s * ((j + (c >> 1 & 1)) + s * (k + (c >> 2)))); };
        for (int t = 0; t < 6; ++t) corners.insert(corners.end(), {id(0), id(around[t]), id(around[(t + 1) % 6]), id(7)});
      }
}

// The largest difference of a node's integral, in parts of the volume; sets `correction`.
double CellPieces::compare(CellMap& map) {
  integral_.resize(nodes);
  map.integration_weights(integral_);
  sum_.assign(nodes, 0);
  double volume = 0, exact = 0, worst = 0;
  for (size_t i = 0; i + 3 < corners.size(); i += 4) {
    const uint32_t* c = &corners[i];
    const double v = std::abs(dot(at[c[1]] - at[c[0]], cross(at[c[2]] - at[c[0]], at[c[3]] - at[c[0]]))) / 6;
    volume += v;
    for (size_t k = 0; k < nodes; ++k)
      sum_[k] += v / 4 * (rows[c[0] * nodes + k] + rows[c[1] * nodes + k] + rows[c[2] * nodes + k] + rows[c[3] * nodes + k]);
  }
  correction.assign(nodes, 0);
  for (double w : integral_) exact += w;
  if (!(volume > 0) || !(exact > 0)) return 0;
  for (size_t k = 0; k < nodes; ++k) {
    correction[k] = (integral_[k] - sum_[k]) / volume;
    worst = std::max(worst, std::abs(integral_[k] - sum_[k]) / exact);
  }
  return worst;
}

void CellPieces::make(CellMap& map, double tolerance) {
  const CellReader& reader = map.reader();
  nodes = reader.ids().size();
  auto clear = [&] { at.clear(), rows.clear(), corners.clear(); };
  clear();
  if (!is_high_order(reader.type())) {
    make_fans(map);
    compare(map);
    return;
  }
  int order = 2;
  for (int o : reader.orders()) order = std::max(order, o);
  for (int divisions = order; divisions <= 4 * order; divisions *= 2) {
    clear();
    make_divided(map, divisions);
    if (compare(map) <= tolerance) return;
  }
}

}  // namespace sg

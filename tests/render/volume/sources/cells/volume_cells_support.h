// SPDX-License-Identifier: Apache-2.0
// Cubes of every kind of cell, and what rays through them gather.
#pragma once
#include <doctest/doctest.h>

#include <functional>

#include "data/cells/cell_topology.h"
#include "data/cells/shape/cell_map.h"
#include "render/volume/sources/cells/cell_source.h"

namespace sg::test {

using Function = std::function<double(Vec3)>;
using Warp = std::function<Vec3(Vec3)>;
inline Vec3 straight(Vec3 p) { return p; }
/// Keeps the faces of the unit cube.
inline Vec3 bent(Vec3 p) {
  const double w = 0.6 * p.x * (1 - p.x) * p.y * (1 - p.y) * p.z * (1 - p.z);
  return p + Vec3(std::sin(5 * p.y + 3 * p.z), std::sin(5 * p.z + 3 * p.x), std::sin(5 * p.x + 3 * p.y)) * (6 * w);
}

inline double linear(Vec3 p) { return 1 + p.x + 2 * p.y + 3 * p.z; }

inline DatasetPtr with_field(DatasetParts parts, const Function& f, bool by_cell = false) {
  const DatasetPtr bare = make_dataset(parts);
  std::vector<double> v;
  if (by_cell) {
    CellMap map(bare);
    for (size_t c = 0; c < bare->cell_count(); ++c) map.open(c), v.push_back(f(map.center()));
  } else {
    const Points* points = bare->as<UnstructuredMesh>() ? &bare->as<UnstructuredMesh>()->points : &bare->as<CurvilinearGrid>()->points;
    for (size_t i = 0; i < points->count(); ++i) v.push_back(f(points->at(i)));
  }
  // f32 where that is exact enough for the tests: stored values then are the values
  std::vector<float> narrow(v.begin(), v.end());
  parts.fields.add({"f", by_cell ? Association::cell : Association::point, Array::from_vector(std::move(narrow)), "", Role::scalars});
  return make_dataset(std::move(parts));
}

/// The unit cube as n^3 little cubes, each cut into cells of the kind: tetra (6), voxel, hexahedron, wedge (2), pyramid (6, with a point
/// in the middle), polyhedron, quadratic_tetra (6), triquadratic_hexahedron, lagrange_hexahedron (order 2).
inline DatasetParts cube(CellType kind, size_t n, const Warp& warp = straight) {
  const bool quadratic =
      kind == CellType::quadratic_tetra || kind == CellType::triquadratic_hexahedron || kind == CellType::lagrange_hexahedron;
  const size_t step = quadratic || kind == CellType::pyramid ? 2 : 1, m = step * n + 1;
  std::vector<double> xyz;
  for (size_t k = 0; k < m; ++k)
    for (size_t j = 0; j < m; ++j)
      for (size_t i = 0; i < m; ++i) {
        const Vec3 p = warp(Vec3(double(i), double(j), double(k)) / double(m - 1));
        xyz.insert(xyz.end(), {p.x, p.y, p.z});
      }
  std::vector<int64_t> ids, offsets{0}, faces, face_offsets{0}, cell_faces{0};
  auto end_cell = [&] { offsets.push_back(int64_t(ids.size())); };
  constexpr int kuhn[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  constexpr int sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (size_t k = 0; k < n; ++k)
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i) {
        const auto id = [&](size_t a, size_t b, size_t c) { return int64_t(step * i + a + m * (step * j + b + m * (step * k + c))); };
        const auto corner = [&](int bits) { return id(step * size_t(bits & 1), step * size_t(bits >> 1 & 1), step * size_t(bits >> 2)); };
        const auto middle = [&](int a, int b) {
          return id(size_t((a & 1) + (b & 1)), size_t((a >> 1 & 1) + (b >> 1 & 1)), size_t((a >> 2) + (b >> 2)));
        };
        if (kind == CellType::tetra || kind == CellType::quadratic_tetra) {
          for (const auto& t : kuhn) {
            for (int c : t) ids.push_back(corner(c));
            if (quadratic)
              for (auto [a, b] : {std::pair{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}) ids.push_back(middle(t[a], t[b]));
            end_cell();
          }
        } else if (kind == CellType::wedge) {
          for (const auto& t : {std::array{0, 1, 3, 4, 5, 7}, std::array{0, 3, 2, 4, 7, 6}}) {
            for (int c : t) ids.push_back(corner(c));
            end_cell();
          }
        } else if (kind == CellType::pyramid) {
          for (const auto& s : sides) {
            for (int c : s) ids.push_back(corner(c));
            ids.push_back(id(1, 1, 1));
            end_cell();
          }
        } else if (kind == CellType::polyhedron || kind == CellType::voxel) {
          for (int c = 0; c < 8; ++c) ids.push_back(corner(c));
          end_cell();
          for (const auto& s : sides) {
            if (kind == CellType::voxel) break;
            for (int c : s) faces.push_back(corner(c));
            face_offsets.push_back(int64_t(faces.size()));
          }
          cell_faces.push_back(int64_t(face_offsets.size()) - 1);
        } else if (kind == CellType::hexahedron) {
          for (int c : {0, 1, 3, 2, 4, 5, 7, 6}) ids.push_back(corner(c));
          end_cell();
        } else {
          const size_t at = ids.size();
          const CellShape& shape = *CellShape::find(kind, 27);
          ids.resize(at + 27);
          for (size_t v = 0; v < 27; ++v) {
            const Vec3 r = shape.node(v) * 2.0;
            ids[at + v] = id(size_t(std::lround(r.x)), size_t(std::lround(r.y)), size_t(std::lround(r.z)));
          }
          end_cell();
        }
      }
  UnstructuredMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.cells = {Array::from_vector(std::move(ids)), Array::from_vector(std::move(offsets)), 0};
  mesh.single_type = kind;
  if (kind == CellType::polyhedron) {
    mesh.faces = {Array::from_vector(std::move(faces)), Array::from_vector(std::move(face_offsets)), 0};
    mesh.polyhedron_faces = Array::from_vector(std::move(cell_faces));
  }
  DatasetParts parts;
  parts.mesh = std::move(mesh);
  return parts;
}

inline const std::vector<CellType>& linear_kinds() {
  static const std::vector<CellType> kinds{CellType::tetra, CellType::voxel,   CellType::hexahedron,
                                           CellType::wedge, CellType::pyramid, CellType::polyhedron};
  return kinds;
}
inline const std::vector<CellType>& all_kinds() {
  static const std::vector<CellType> kinds{CellType::tetra,
                                           CellType::voxel,
                                           CellType::hexahedron,
                                           CellType::wedge,
                                           CellType::pyramid,
                                           CellType::polyhedron,
                                           CellType::quadratic_tetra,
                                           CellType::triquadratic_hexahedron,
                                           CellType::lagrange_hexahedron};
  return kinds;
}

inline VolumeItem item_of(DatasetPtr data, Association a = Association::point) {
  VolumeItem item;
  item.data = std::move(data);
  item.field = "f", item.association = a;
  return item;
}

struct RaySum {
  double length = 0, integral = 0, first = HUGE_VAL, last = -HUGE_VAL, gap = 0;
  size_t stretches = 0;
  float lowest = HUGE_VALF, highest = -HUGE_VALF;
};

/// Walks all of it, checks the order, and integrates each cubic exactly.
inline RaySum gather(const volume::RaySource& source, volume::RayField& walker, Vec3 o, Vec3 d, double from = -100, double to = 100) {
  RaySum r;
  walker.start(o, d, from, to);
  volume::Stretch s[5];
  double at = -HUGE_VAL;
  while (const size_t n = walker.next(s)) {
    REQUIRE(n <= 5);
    for (size_t i = 0; i < n; ++i) {
      REQUIRE(s[i].from < s[i].to);
      REQUIRE(s[i].from >= at);
      REQUIRE(s[i].from >= from);
      REQUIRE(s[i].to <= to);
      if (r.stretches > 0) r.gap += s[i].from - at;
      at = s[i].to;
      const double h = s[i].to - s[i].from;
      r.length += h;
      r.integral += h * (double(s[i].b[0]) + double(s[i].b[1]) + double(s[i].b[2]) + double(s[i].b[3])) / 4 + h * double(source.base);
      r.first = std::min(r.first, s[i].from), r.last = std::max(r.last, s[i].to);
      r.lowest = std::min(r.lowest, s[i].lowest()), r.highest = std::max(r.highest, s[i].highest());
      ++r.stretches;
    }
    REQUIRE(r.stretches < 1000000);
  }
  return r;
}
inline RaySum gather(const VolumeItem& item, Vec3 o, Vec3 d, double from = -100, double to = 100) {
  Context context;
  const auto source = volume::cell_source(item, context);
  return gather(*source, *source->walker(), o, d, from, to);
}

/// Chord of the unit cube.
inline std::pair<double, double> chord(Vec3 o, Vec3 d) {
  double a = -HUGE_VAL, b = HUGE_VAL;
  for (int i = 0; i < 3; ++i) {
    if (d[i] == 0) {
      if (o[i] < 0 || o[i] > 1) return {0, 0};
      continue;
    }
    const double p = -o[i] / d[i], q = (1 - o[i]) / d[i];
    a = std::max(a, std::min(p, q)), b = std::min(b, std::max(p, q));
  }
  return a < b ? std::pair{a, b} : std::pair{0.0, 0.0};
}

struct TestRay {
  Vec3 o, d;
};
/// Through the cube in all directions, the same ones each time.
inline std::vector<TestRay> some_rays(size_t n) {
  std::vector<TestRay> r;
  uint64_t state = 12345;
  const auto random = [&] {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return double(state >> 11) / 9007199254740992.0;
  };
  for (size_t i = 0; i < n; ++i) {
    const Vec3 through(random(), random(), random());
    const Vec3 d = normalize(Vec3(random() - 0.5, random() - 0.5, random() - 0.5));
    r.push_back({through - d * 3.0, d});
  }
  return r;
}

}  // namespace sg::test

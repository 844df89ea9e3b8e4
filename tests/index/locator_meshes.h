// SPDX-License-Identifier: Apache-2.0
// One small mesh of each kind for searching, and the search that looks at every cell.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/random.h"
#include "data/dataset.h"
#include "index/cell_probe.h"

namespace sg::test {

struct CellList {
  std::vector<double> xyz;
  std::vector<int64_t> ids, offsets{0};
  std::vector<uint8_t> types;
  std::vector<int64_t> face_ids, face_offsets{0}, cell_faces{0};
  int64_t point(Vec3 p) {
    xyz.insert(xyz.end(), {p.x, p.y, p.z});
    return int64_t(xyz.size() / 3 - 1);
  }
  void cell(CellType t, const std::vector<int64_t>& p, const std::vector<std::vector<int>>& faces = {}) {
    ids.insert(ids.end(), p.begin(), p.end());
    offsets.push_back(int64_t(ids.size()));
    types.push_back(uint8_t(t));
    for (const auto& f : faces) {
      for (int k : f) face_ids.push_back(p[size_t(k)]);
      face_offsets.push_back(int64_t(face_ids.size()));
    }
    cell_faces.push_back(int64_t(face_offsets.size()) - 1);
  }
  Vec3 at(int64_t p) const { return {xyz[size_t(3 * p)], xyz[size_t(3 * p + 1)], xyz[size_t(3 * p + 2)]}; }
  DatasetPtr dataset(Vec3 origin = {0, 0, 0}) const {
    UnstructuredMesh m;
    m.points.xyz = Array::from_vector(xyz, 3);
    m.points.origin = origin;
    m.cells.connectivity = Array::from_vector(ids);
    m.cells.offsets = Array::from_vector(offsets);
    m.types = Array::from_vector(types);
    if (!face_ids.empty()) {
      m.faces.connectivity = Array::from_vector(face_ids);
      m.faces.offsets = Array::from_vector(face_offsets);
      m.polyhedron_faces = Array::from_vector(cell_faces);
    }
    return make_dataset(std::move(m));
  }
};

/// [-1,1]^3 in n^3 blocks whose inner points are moved by up to `jitter` of a block; what: tetra, hexahedron, mixed (hexahedra,
/// wedges, pyramids, tetrahedra), polyhedron, curved (quadratic tetrahedra, bent).
inline CellList block_cells(const std::string& what, int n, double jitter) {
  CellList m;
  const int s = n + 1;
  const double h = 2.0 / n;
  auto grid = [&](double i, double j, double k) { return Vec3(-1 + h * i, -1 + h * j, -1 + h * k); };
  for (int k = 0; k < s; ++k)
    for (int j = 0; j < s; ++j)
      for (int i = 0; i < s; ++i) {
        Vec3 p = grid(i, j, k);
        const int c[3] = {i, j, k};
        for (int a = 0; a < 3; ++a)
          if (c[a] > 0 && c[a] < n) p[a] += jitter * h * (2 * random_unit(11, m.xyz.size() + size_t(a)) - 1);
        m.point(p);
      }
  auto bend = [](Vec3 p) { return p + 0.06 * Vec3(std::sin(3 * p.y), std::sin(3 * p.z + 1), std::sin(3 * p.x + 2)); };
  if (what == "curved")
    for (int64_t p = 0; p < int64_t(m.xyz.size() / 3); ++p) {
      const Vec3 q = bend(m.at(p));
      for (int a = 0; a < 3; ++a) m.xyz[size_t(3 * p + a)] = q[a];
    }
  constexpr int kuhn[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
  const std::vector<std::vector<int>> box_faces{{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 4, 7, 3}, {1, 2, 6, 5}};
  std::vector<std::pair<std::array<int64_t, 2>, int64_t>> middles;
  auto middle = [&](int64_t a, int64_t b) {
    const std::array<int64_t, 2> key{std::min(a, b), std::max(a, b)};
    for (const auto& [e, p] : middles)
      if (e == key) return p;
    const Vec3 q = (m.at(a) + m.at(b)) * 0.5;
    middles.emplace_back(key, m.point(q + 0.03 * Vec3(std::sin(9 * q.y), std::sin(9 * q.z), std::sin(9 * q.x))));
    return middles.back().second;
  };
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const int64_t a = i + s * (j + s * k), y = s, z = s * s;
        const std::vector<int64_t> c{a, a + 1, a + 1 + y, a + y, a + z, a + 1 + z, a + 1 + y + z, a + y + z};
        const int pick = (i + 2 * j + 3 * k) % 4;
        if (what == "hexahedron" || (what == "mixed" && pick == 0)) m.cell(CellType::hexahedron, c);
        else if (what == "polyhedron") m.cell(CellType::polyhedron, c, box_faces);
        else if (what == "mixed" && pick == 1) {
          m.cell(CellType::wedge, {c[0], c[1], c[2], c[4], c[5], c[6]});
          m.cell(CellType::wedge, {c[0], c[2], c[3], c[4], c[6], c[7]});
        } else if (what == "mixed" && pick == 2) {
          const int64_t top = m.point(grid(i + .5, j + .5, k + .5));
          for (const auto& f : box_faces)
            m.cell(CellType::pyramid, {c[size_t(f[3])], c[size_t(f[2])], c[size_t(f[1])], c[size_t(f[0])], top});
        } else {
          for (const auto& t : kuhn) {
            std::vector<int64_t> v;
            for (int x : t) v.push_back(c[size_t(x)]);
            if (what == "curved") {
              constexpr int edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
              for (const auto& e : edges) v.push_back(middle(v[size_t(e[0])], v[size_t(e[1])]));
              m.cell(CellType::quadratic_tetra, v);
            } else {
              m.cell(CellType::tetra, v);
            }
          }
        }
      }
  return m;
}

/// A ball of triangles (and, with `more`, quads, a pentagon, a strip, lines and points).
inline DatasetPtr ball(int n, bool more, double radius = 0.8) {
  SurfaceMesh m;
  std::vector<double> xyz;
  std::vector<int64_t> polygons, offsets{0};
  auto id = [&](int i, int j) { return int64_t(j == 0 ? 0 : j == n ? 1 : 2 + (i % (2 * n)) + 2 * n * (j - 1)); };
  auto point = [&](Vec3 p) { xyz.insert(xyz.end(), {p.x, p.y, p.z}); };
  point({0, 0, radius}), point({0, 0, -radius});
  for (int j = 1; j < n; ++j)
    for (int i = 0; i < 2 * n; ++i) {
      const double u = M_PI * i / n, v = M_PI * j / n;
      point(Vec3(std::cos(u) * std::sin(v), std::sin(u) * std::sin(v), std::cos(v)) * radius);
    }
  auto cell = [&](std::vector<int64_t> p) {
    polygons.insert(polygons.end(), p.begin(), p.end());
    offsets.push_back(int64_t(polygons.size()));
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < 2 * n; ++i) {
      const int64_t a = id(i, j), b = id(i + 1, j), c = id(i + 1, j + 1), d = id(i, j + 1);
      if (j == 0) cell({a, d, c});
      else if (j == n - 1) cell({a, c, b});
      else if (more && (i + j) % 3 == 0) cell({a, d, c, b});
      else cell({a, d, c}), cell({a, c, b});
    }
  if (more) {
    const int64_t p = int64_t(xyz.size() / 3);
    for (int i = 0; i < 5; ++i) point({0.3 * std::cos(1.2566 * i), 0.3 * std::sin(1.2566 * i), 0.1});
    cell({p, p + 1, p + 2, p + 3, p + 4});
    for (int i = 0; i < 6; ++i) point({-0.9 + 0.2 * i, i % 2 ? 0.9 : 0.95, 0.2});
    m.strips.connectivity = Array::from_vector(std::vector<int64_t>{p + 5, p + 6, p + 7, p + 8, p + 9, p + 10});
    m.strips.offsets = Array::from_vector(std::vector<int64_t>{0, 6});
    m.lines.connectivity = Array::from_vector(std::vector<int64_t>{0, 1, p, p + 7, p + 9});
    m.lines.offsets = Array::from_vector(std::vector<int64_t>{0, 2, 5});
    m.vertices.connectivity = Array::from_vector(std::vector<int64_t>{p + 3, p + 10});
    m.vertices.fixed = 1;
  }
  m.points.xyz = Array::from_vector(xyz, 3);
  m.polygons.connectivity = Array::from_vector(polygons);
  if (more) m.polygons.offsets = Array::from_vector(offsets);
  else m.polygons.fixed = 3;
  return make_dataset(std::move(m));
}

inline DatasetPtr curvilinear(std::array<size_t, 3> dims, bool blanked) {
  CurvilinearGrid g;
  g.dims = dims;
  std::vector<float> xyz;
  for (size_t k = 0; k < dims[2]; ++k)
    for (size_t j = 0; j < dims[1]; ++j)
      for (size_t i = 0; i < dims[0]; ++i) {
        auto part = [](size_t c, size_t n) { return n > 1 ? 2 * double(c) / double(n - 1) - 1 : 0.0; };
        const Vec3 p(part(i, dims[0]), part(j, dims[1]), part(k, dims[2]));
        const Vec3 q = p + 0.1 * Vec3(std::sin(2 * p.y + p.z), std::sin(2 * p.x - p.z), std::sin(p.x + 2 * p.y));
        xyz.insert(xyz.end(), {float(q.x), float(q.y), float(q.z)});
      }
  g.points.xyz = Array::from_vector(xyz, 3);
  DatasetParts parts;
  parts.mesh = std::move(g);
  if (blanked) {
    std::vector<uint8_t> ghost(cell_count(parts.mesh), 0);
    for (size_t c = 0; c < ghost.size(); c += 7) ghost[c] = ghost_hidden_cell;
    parts.cell_ghost = Array::from_vector(ghost);
  }
  return make_dataset(std::move(parts));
}

inline DatasetPtr uniform(std::array<size_t, 3> dims, bool turned, bool blanked = false) {
  UniformGrid g;
  g.dims = dims;
  g.origin = {-1, -0.9, -0.8};
  g.spacing = {0.2, 0.17, 0.21};
  if (turned) {
    const double c = std::cos(0.4), s = std::sin(0.4);
    g.direction = Mat3{{{c, -s, 0}, {s, c, 0}, {0, 0, -1}}};
  }
  DatasetParts parts;
  parts.mesh = g;
  if (blanked) {
    std::vector<uint8_t> ghost(cell_count(parts.mesh), 0);
    for (size_t c = 0; c < ghost.size(); c += 5) ghost[c] = ghost_hidden_cell;
    parts.cell_ghost = Array::from_vector(ghost);
  }
  return make_dataset(std::move(parts));
}

inline DatasetPtr rectilinear() {
  RectilinearGrid g;
  g.x = Array::from_vector(std::vector<double>{-1, -0.8, -0.75, -0.2, 0, 0.5, 0.9});
  g.y = Array::from_vector(std::vector<float>{1, 0.7f, 0.1f, -0.3f, -0.9f});  // descending
  g.z = Array::from_vector(std::vector<double>{-1, -0.5, 0.25, 1});
  return make_dataset(std::move(g));
}

/// Level 0: 8^3 cells in two patches; level 1 (ratio 2) and 2 (ratio 2) in the middle; what they cover is marked.
inline DatasetPtr amr(int dimension = 3) {
  AmrGrid g;
  g.dimension = dimension;
  g.origin = {-1, -1, dimension == 3 ? -1.0 : 0.0};
  auto patch = [&](long long x0, long long x1, long long y0, long long y1) {
    AmrGrid::Patch p;
    p.lo = {x0, y0, dimension == 3 ? y0 : 0};
    p.hi = {x1, y1, dimension == 3 ? y1 : 0};
    return p;
  };
  g.levels.resize(3);
  for (int l = 0; l < 3; ++l) {
    g.levels[size_t(l)].spacing = Vec3(0.25, 0.25, 0.25) / double(1 << l);
    g.levels[size_t(l)].ratio = l ? std::array<int, 3>{2, 2, 2} : std::array<int, 3>{1, 1, 1};
  }
  g.levels[0].patches = {patch(0, 3, 0, 7), patch(4, 7, 0, 7)};
  g.levels[1].patches = {patch(4, 11, 4, 9)};
  g.levels[2].patches = {patch(10, 15, 10, 13), patch(16, 21, 10, 13)};
  size_t cell = 0, point = 0;
  std::vector<uint8_t> ghost;
  for (size_t l = 0; l < 3; ++l)
    for (auto& p : g.levels[l].patches) {
      p.cell_offset = cell, p.point_offset = point;
      const auto n = p.cells();
      cell += n[0] * n[1] * n[2], point += (n[0] + 1) * (n[1] + 1) * (dimension == 3 ? n[2] + 1 : 1);
      for (size_t c = 0; c < n[0] * n[1] * n[2]; ++c) {
        const long long at[3] = {p.lo[0] + (long long)(c % n[0]), p.lo[1] + (long long)(c / n[0] % n[1]),
                                 p.lo[2] + (long long)(c / n[0] / n[1])};
        bool covered = false;
        if (l < 2)
          for (const auto& q : g.levels[l + 1].patches) {
            bool in = true;
            for (int a = 0; a < dimension; ++a) in = in && 2 * at[a] >= q.lo[size_t(a)] && 2 * at[a] + 1 <= q.hi[size_t(a)];
            covered = covered || in;
          }
        ghost.push_back(covered ? ghost_refined_cell : 0);
      }
    }
  DatasetParts parts;
  parts.mesh = std::move(g);
  parts.cell_ghost = Array::from_vector(ghost);
  return make_dataset(std::move(parts));
}

/// 27 coarse cells whose middle one is refined by a patch of 8.
inline DatasetPtr amr_small() {
  AmrGrid g;
  g.origin = {-1, -1, -1};
  g.levels.resize(2);
  g.levels[0] = {Vec3(2, 2, 2) / 3.0, {1, 1, 1}, {{{0, 0, 0}, {2, 2, 2}, 0, 0}}};
  g.levels[1] = {Vec3(1, 1, 1) / 3.0, {2, 2, 2}, {{{2, 2, 2}, {3, 3, 3}, 27, 64}}};
  DatasetParts parts;
  parts.mesh = std::move(g);
  std::vector<uint8_t> ghost(35, 0);
  ghost[13] = ghost_refined_cell;
  parts.cell_ghost = Array::from_vector(ghost);
  return make_dataset(std::move(parts));
}

inline DatasetPtr cloud(size_t n) {
  std::vector<float> xyz;
  for (size_t i = 0; i < 3 * n; ++i) xyz.push_back(float(2 * random_unit(5, i) - 1));
  PointCloud c;
  c.points.xyz = Array::from_vector(xyz, 3);
  return make_dataset(std::move(c));
}

/// A bent quadratic tetrahedron in each octant of [-1,1]^3.
inline DatasetPtr curved_tets() {
  CellList m;
  auto bend = [](Vec3 p) { return p + 0.05 * Vec3(std::sin(4 * p.y), std::sin(4 * p.z + 1), std::sin(4 * p.x + 2)); };
  for (int c = 0; c < 8; ++c) {
    const Vec3 corner(c & 1 ? 0.0 : -1.0, c & 2 ? 0.0 : -1.0, c & 4 ? 0.0 : -1.0);
    const Vec3 at[4] = {corner, corner + Vec3(1, 0.1, 0), corner + Vec3(0.2, 1, 0.1), corner + Vec3(0.3, 0.2, 1)};
    std::vector<int64_t> nodes;
    for (const Vec3& p : at) nodes.push_back(m.point(bend(p)));
    constexpr int edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
    for (const auto& e : edges) nodes.push_back(m.point(bend((at[e[0]] + at[e[1]]) * 0.5)));
    m.cell(CellType::quadratic_tetra, nodes);
  }
  return m.dataset();
}

/// Two bent quadratic edges and a bent quadratic triangle.
inline DatasetPtr curved_flat() {
  CellList m;
  for (int i = 0; i < 2; ++i) {
    const double y = -0.8 + 0.9 * i;
    m.cell(CellType::quadratic_edge, {m.point({-1, y, -0.5}), m.point({0.1 * i, y, 0.6}), m.point({-0.7, y + 0.4, 0.1 * i})});
  }
  const int64_t a = m.point({0.6, 0.4, 0}), b = m.point({1, 0.4, 0.4}), c = m.point({1, 1, 0});
  m.cell(CellType::quadratic_triangle, {a, b, c, m.point({0.8, 0.4, 0.4}), m.point({1.1, 0.7, 0.3}), m.point({0.8, 0.8, -0.2})});
  return m.dataset();
}

struct NamedMesh {
  std::string name;
  DatasetPtr data;
  size_t finds = 5000, nearest = 300, rays = 2000;  ///< queries
};

/// One small mesh of each kind gets 100,000 queries of each sort. Curved cells: solid ones are searched and met by rays, flat ones give the
/// nearest points (of a solid it takes a tenth of a millisecond).
inline std::vector<NamedMesh> small_meshes() {
  constexpr size_t n = 100000;
  return {{"small uniform", uniform({5, 4, 4}, true), n, n, n},
          {"small rectilinear", rectilinear(), n, n, n},
          {"small curvilinear", curvilinear({4, 3, 3}, false), n, n, n},
          {"small unstructured", block_cells("tetra", 2, 0.3).dataset(), n, n, n},
          {"small surface", ball(4, true), n, n, n},
          {"small amr", amr_small(), n, n, n},
          {"small points", cloud(60), n, n, 0},
          {"small polyhedra", block_cells("polyhedron", 2, 0.1).dataset(), n, n, n},
          {"small curved", curved_tets(), n, 1000, n},
          {"small curved, flat", curved_flat(), 5000, n, 5000}};
}

/// Meshes of hundreds to thousands of cells, for depth.
inline std::vector<NamedMesh> search_meshes() {
  return {{"uniform", uniform({11, 12, 9}, false), 20000, 3000},
          {"uniform, turned", uniform({11, 12, 9}, true)},
          {"uniform, blanked", uniform({11, 12, 9}, true, true)},
          {"uniform, flat", uniform({13, 1, 12}, true)},
          {"rectilinear", rectilinear()},
          {"curvilinear", curvilinear({9, 8, 7}, false)},
          {"curvilinear, blanked", curvilinear({9, 8, 7}, true)},
          {"curvilinear, flat", curvilinear({15, 14, 1}, false)},
          {"tetrahedra", block_cells("tetra", 6, 0.3).dataset(), 20000, 1000, 4000},
          {"tetrahedra, far away", block_cells("tetra", 5, 0.3).dataset({1e7, -2e7, 3e6})},
          {"hexahedra", block_cells("hexahedron", 8, 0.2).dataset()},
          {"mixed", block_cells("mixed", 6, 0.15).dataset()},
          {"polyhedra", block_cells("polyhedron", 6, 0.1).dataset()},
          {"curved", block_cells("curved", 3, 0.1).dataset(), 1000, 30, 500},
          {"triangles", ball(16, false), 20000, 1000, 4000},
          {"surface", ball(12, true)},
          {"amr", amr(), 10000, 1000},
          {"amr, flat", amr(2)},
          {"points", cloud(3000), 10000}};
}
inline std::vector<NamedMesh> all_meshes() {
  std::vector<NamedMesh> all = small_meshes();
  for (NamedMesh& m : search_meshes()) all.push_back(std::move(m));
  return all;
}

/// Looks at every cell. Boxes are only used to pass over those that cannot be the answer.
class EveryCell {
 public:
  explicit EveryCell(DatasetPtr data)
      : data_(std::move(data)), none_(), slack_(locate_slack(*data_)), probe_(CellMap(data_), none_, slack_) {
    CellReader reader(data_);
    for (size_t c = 0; c < reader.count(); ++c) {
      reader.open(c);
      Box3 b = reader.box();
      const double extent = b.diagonal(), grow = is_high_order(reader.type()) ? 0.02 * extent : 1e-6 * extent + 2 * slack_;
      b.lo += Vec3(-grow, -grow, -grow), b.hi += Vec3(grow, grow, grow);
      boxes_.push_back(b);
      hidden_.push_back(reader.hidden(c));
      level_.push_back(0);
    }
    if (const auto* g = data_->as<AmrGrid>())
      for (size_t l = 0, c = 0; l < g->levels.size(); ++l)
        for (const auto& p : g->levels[l].patches)
          for (size_t i = 0, n = p.cells()[0] * p.cells()[1] * p.cells()[2]; i < n; ++i) level_[c++] = int(l);
  }
  EveryCell(const EveryCell& o) : EveryCell(o.data_) {}

  int64_t find(Vec3 x) {
    int64_t best = -1;
    if (const auto* c = data_->as<PointCloud>()) {
      double least = HUGE_VAL;
      const auto v = c->points.xyz.view<float>();
      for (size_t p = 0; p < v.count; ++p) {
        const Vec3 d = Vec3(v(p, 0), v(p, 1), v(p, 2)) - x;
        if (const double d2 = dot(d, d); d2 < least) least = d2, best = int64_t(p);
      }
      return best;
    }
    for (size_t c = 0; c < boxes_.size(); ++c) {
      const Box3& b = boxes_[c];
      if (hidden_[c] || !(x.x >= b.lo.x && x.x <= b.hi.x && x.y >= b.lo.y && x.y <= b.hi.y && x.z >= b.lo.z && x.z <= b.hi.z)) continue;
      if (best >= 0 && level_[c] <= level_[size_t(best)]) continue;
      CellMap& m = probe_.open(c);
      CellPlace place;
      const bool inside = m.locate(x, place, locate_tolerance);
      if (m.dimension() == 3 ? inside : place.distance2 <= slack_ * slack_) best = int64_t(c);
    }
    return best;
  }
  std::pair<int64_t, double> nearest(Vec3 x) {
    std::pair<int64_t, double> best{-1, HUGE_VAL};
    order_.clear();
    for (size_t c = 0; c < boxes_.size(); ++c) {
      if (hidden_[c]) continue;
      double d2 = 0;
      for (int a = 0; a < 3; ++a) {
        const double d = std::max({boxes_[c].lo[a] - x[a], x[a] - boxes_[c].hi[a], 0.0});
        d2 += d * d;
      }
      order_.emplace_back(d2, c);
    }
    std::make_heap(order_.begin(), order_.end(), std::greater<>());
    while (!order_.empty() && order_.front().first <= best.second) {
      const size_t c = order_.front().second;
      std::pop_heap(order_.begin(), order_.end(), std::greater<>());
      order_.pop_back();
      Vec3 at;
      const double d2 = probe_.nearest(c, x, at);
      if (d2 < best.second || (d2 == best.second && int64_t(c) < best.first)) best = {int64_t(c), d2};
    }
    return best;
  }
  std::pair<int64_t, double> hit(Vec3 x, Vec3 d, double t0, double t1) {
    std::pair<int64_t, double> best{-1, t1};
    for (size_t c = 0; c < boxes_.size(); ++c) {
      if (hidden_[c]) continue;
      double enter = t0, leave = best.second;
      for (int a = 0; a < 3; ++a) {
        double p = (boxes_[c].lo[a] - x[a]) / d[a], q = (boxes_[c].hi[a] - x[a]) / d[a];
        if (d[a] == 0) p = x[a] >= boxes_[c].lo[a] && x[a] <= boxes_[c].hi[a] ? -HUGE_VAL : HUGE_VAL, q = HUGE_VAL;
        if (p > q) std::swap(p, q);
        enter = std::max(enter, p), leave = std::min(leave, q);
      }
      if (enter > leave + 1e-9) continue;
      Vec3 normal;
      const double t = probe_.hit(c, x, d, t0, t1, normal);
      if (t < best.second || (t == best.second && best.first < 0)) best = {int64_t(c), t};
    }
    return best;
  }
  double slack() const { return slack_; }
  CellProbe& probe() { return probe_; }

 private:
  DatasetPtr data_;
  SimplexArrays none_;
  double slack_;
  CellProbe probe_;
  std::vector<Box3> boxes_;
  std::vector<char> hidden_;
  std::vector<int> level_;
  std::vector<std::pair<double, size_t>> order_;
};

}  // namespace sg::test

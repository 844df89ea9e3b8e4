// SPDX-License-Identifier: Apache-2.0
#include "data/cells/cell_topology.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <tuple>

#include "base/error.h"

namespace sg {

namespace {

using Edge = std::array<uint8_t, 2>;

// Edges come in the order in which VTK lists the mid-edge nodes of the quadratic cell of that shape.
constexpr Edge line_edges[] = {{0, 1}};
constexpr Edge triangle_edges[] = {{0, 1}, {1, 2}, {2, 0}};
constexpr Edge quad_edges[] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
constexpr Edge pixel_edges[] = {{0, 1}, {1, 3}, {3, 2}, {2, 0}};
constexpr Edge tetra_edges[] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
constexpr Edge hexahedron_edges[] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
constexpr Edge voxel_edges[] = {{0, 1}, {1, 3}, {3, 2}, {2, 0}, {4, 5}, {5, 7}, {7, 6}, {6, 4}, {0, 4}, {1, 5}, {3, 7}, {2, 6}};
constexpr Edge wedge_edges[] = {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}};
constexpr Edge pyramid_edges[] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}};
constexpr Edge pentagonal_edges[] = {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 0}, {5, 6}, {6, 7}, {7, 8},
                                     {8, 9}, {9, 5}, {0, 5}, {1, 6}, {2, 7}, {3, 8}, {4, 9}};
constexpr Edge hexagonal_edges[] = {{0, 1},  {1, 2},   {2, 3},  {3, 4}, {4, 5}, {5, 0}, {6, 7}, {7, 8},  {8, 9},
                                    {9, 10}, {10, 11}, {11, 6}, {0, 6}, {1, 7}, {2, 8}, {3, 9}, {4, 10}, {5, 11}};

constexpr uint8_t four_triangles[] = {0, 3, 6, 9, 12};
constexpr uint8_t six_quads[] = {0, 4, 8, 12, 16, 20, 24};
constexpr uint8_t tetra_faces[] = {0, 1, 3, 1, 2, 3, 2, 0, 3, 0, 2, 1};
// Hexahedra: x-, x+, y-, y+, z-, z+: the order of the mid-face nodes.
constexpr uint8_t hexahedron_faces[] = {0, 4, 7, 3, 1, 2, 6, 5, 0, 1, 5, 4, 3, 7, 6, 2, 0, 3, 2, 1, 4, 5, 6, 7};
constexpr uint8_t voxel_faces[] = {0, 4, 6, 2, 1, 3, 7, 5, 0, 1, 5, 4, 2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6};
constexpr uint8_t wedge_begin[] = {0, 3, 6, 10, 14, 18};
constexpr uint8_t wedge_faces[] = {0, 2, 1, 3, 4, 5, 0, 1, 4, 3, 1, 2, 5, 4, 2, 0, 3, 5};
constexpr uint8_t pyramid_begin[] = {0, 4, 7, 10, 13, 16};
constexpr uint8_t pyramid_faces[] = {0, 3, 2, 1, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4};
constexpr uint8_t pentagonal_begin[] = {0, 5, 10, 14, 18, 22, 26, 30};
constexpr uint8_t pentagonal_faces[] = {0, 4, 3, 2, 1, 5, 6, 7, 8, 9, 0, 1, 6, 5, 1, 2, 7, 6, 2, 3, 8, 7, 3, 4, 9, 8, 4, 0, 5, 9};
constexpr uint8_t hexagonal_begin[] = {0, 6, 12, 16, 20, 24, 28, 32, 36};
constexpr uint8_t hexagonal_faces[] = {0, 5, 4, 3, 2, 1, 6, 7, 8,  9, 10, 11, 0,  1,  7, 6, 1, 2,
                                       8, 7, 2, 3, 9, 8, 3, 4, 10, 9, 4,  5,  11, 10, 5, 0, 6, 11};

constexpr LinearTopology line_topology{2, line_edges, {}, {}};
constexpr LinearTopology triangle_topology{3, triangle_edges, {}, {}};
constexpr LinearTopology pixel_topology{4, pixel_edges, {}, {}};
constexpr LinearTopology quad_topology{4, quad_edges, {}, {}};
constexpr LinearTopology tetra_topology{4, tetra_edges, four_triangles, tetra_faces};
constexpr LinearTopology voxel_topology{8, voxel_edges, six_quads, voxel_faces};
constexpr LinearTopology hexahedron_topology{8, hexahedron_edges, six_quads, hexahedron_faces};
constexpr LinearTopology wedge_topology{6, wedge_edges, wedge_begin, wedge_faces};
constexpr LinearTopology pyramid_topology{5, pyramid_edges, pyramid_begin, pyramid_faces};
constexpr LinearTopology pentagonal_topology{10, pentagonal_edges, pentagonal_begin, pentagonal_faces};
constexpr LinearTopology hexagonal_topology{12, hexagonal_edges, hexagonal_begin, hexagonal_faces};

}  // namespace

const LinearTopology* linear_topology(CellType type) {
  switch (type) {
    case CellType::line: return &line_topology;
    case CellType::triangle: return &triangle_topology;
    case CellType::pixel: return &pixel_topology;
    case CellType::quad: return &quad_topology;
    case CellType::tetra: return &tetra_topology;
    case CellType::voxel: return &voxel_topology;
    case CellType::hexahedron: return &hexahedron_topology;
    case CellType::wedge: return &wedge_topology;
    case CellType::pyramid: return &pyramid_topology;
    case CellType::pentagonal_prism: return &pentagonal_topology;
    case CellType::hexagonal_prism: return &hexagonal_topology;
    default: return nullptr;
  }
}

CellType linear_type(CellType type) {
  using enum CellType;
  switch (type) {
    case quadratic_edge:
    case cubic_line:
    case lagrange_curve:
    case bezier_curve: return line;
    case quadratic_triangle:
    case biquadratic_triangle:
    case lagrange_triangle:
    case bezier_triangle: return triangle;
    case quadratic_quad:
    case biquadratic_quad:
    case quadratic_linear_quad:
    case lagrange_quad:
    case bezier_quad: return quad;
    case quadratic_polygon: return polygon;
    case quadratic_tetra:
    case lagrange_tetra:
    case bezier_tetra: return tetra;
    case quadratic_hexahedron:
    case triquadratic_hexahedron:
    case biquadratic_quadratic_hexahedron:
    case lagrange_hexahedron:
    case bezier_hexahedron: return hexahedron;
    case quadratic_wedge:
    case quadratic_linear_wedge:
    case biquadratic_quadratic_wedge:
    case lagrange_wedge:
    case bezier_wedge: return wedge;
    case quadratic_pyramid:
    case triquadratic_pyramid:
    case lagrange_pyramid:
    case bezier_pyramid: return pyramid;
    default: return type;
  }
}

bool is_high_order(CellType type) { return linear_type(type) != type; }
bool is_bezier(CellType type) { return type >= CellType::bezier_curve && type <= CellType::bezier_pyramid; }

int high_order_of(CellType type, size_t nodes) {
  const CellType shape = linear_type(type);
  for (size_t n = 1; n < 64; ++n) {
    const size_t m = n + 1;
    size_t want = 0;
    switch (shape) {
      case CellType::line: want = m; break;
      case CellType::triangle: want = m * (m + 1) / 2; break;
      case CellType::quad: want = m * m; break;
      case CellType::tetra: want = m * (m + 1) * (m + 2) / 6; break;
      case CellType::hexahedron: want = m * m * m; break;
      case CellType::wedge: want = m * m * (m + 1) / 2; break;
      case CellType::pyramid: want = m * (m + 1) * (2 * m + 1) / 6; break;
      default: return 0;
    }
    if (want == nodes) return int(n);
    if (want > nodes) return 0;
  }
  return 0;
}

// ---- faces of solid cells -----------------------------------------------------------------------------------------------

namespace {

void add_face(CellFaces& out, CellType type, std::span<const uint32_t> nodes, size_t corners) {
  out.type.push_back(type);
  out.nodes.insert(out.nodes.end(), nodes.begin(), nodes.end());
  out.begin.push_back(uint32_t(out.nodes.size()));
  out.corners.push_back(uint8_t(corners));
  out.orders.push_back({0, 0, 0});
}

CellFaces linear_faces(const LinearTopology& t) {
  CellFaces out;
  for (size_t f = 0; f < t.face_count(); ++f) {
    const auto c = t.face(f);
    const std::vector<uint32_t> nodes(c.begin(), c.end());
    add_face(out, nodes.size() == 3 ? CellType::triangle : nodes.size() == 4 ? CellType::quad : CellType::polygon, nodes, nodes.size());
  }
  return out;
}

// `edge_nodes` of the edges have a middle node (numbered after the corners); face f has a centre when centre(f) >= 0.
template <class Centre>
CellFaces quadratic_faces(const LinearTopology& t, size_t edge_nodes, Centre centre) {
  CellFaces out;
  for (size_t f = 0; f < t.face_count(); ++f) {
    const auto c = t.face(f);
    std::vector<uint32_t> nodes(c.begin(), c.end());
    size_t middles = 0;
    for (size_t i = 0; i < c.size(); ++i)
      for (size_t e = 0; e < edge_nodes; ++e) {
        const uint8_t a = c[i], b = c[(i + 1) % c.size()];
        if ((t.edges[e][0] == a && t.edges[e][1] == b) || (t.edges[e][0] == b && t.edges[e][1] == a))
          nodes.push_back(uint32_t(t.corners) + uint32_t(e)), ++middles;
      }
    const bool triangle = c.size() == 3;
    CellType type = triangle ? CellType::quadratic_triangle : middles == 2 ? CellType::quadratic_linear_quad : CellType::quadratic_quad;
    if (const int at = centre(int(f)); at >= 0) {
      nodes.push_back(uint32_t(at));
      type = triangle ? CellType::biquadratic_triangle : CellType::biquadratic_quad;
    }
    add_face(out, type, nodes, c.size());
  }
  return out;
}

struct Place {
  int i, j, k;
};
using Orders = std::array<int, 3>;

Place corner_place(CellType shape, Orders n, int corner) {
  if (shape == CellType::tetra) return {corner == 1 ? n[0] : 0, corner == 2 ? n[0] : 0, corner == 3 ? n[0] : 0};
  if (shape == CellType::wedge) return {corner % 3 == 1 ? n[0] : 0, corner % 3 == 2 ? n[0] : 0, corner >= 3 ? n[2] : 0};
  return {corner % 4 == 1 || corner % 4 == 2 ? n[0] : 0, corner % 4 >= 2 ? n[1] : 0, corner >= 4 ? n[2] : 0};
}

CellFaces lattice_faces(CellType type, Orders n) {
  const CellType shape = linear_type(type);
  const LinearTopology& t = *linear_topology(shape);
  CellFaces out;
  for (size_t f = 0; f < t.face_count(); ++f) {
    const auto c = t.face(f);
    const bool triangle = c.size() == 3;
    const CellType face_type = is_bezier(type) ? (triangle ? CellType::bezier_triangle : CellType::bezier_quad)
                                               : (triangle ? CellType::lagrange_triangle : CellType::lagrange_quad);
    // u runs from the first corner to the second, v from the first to the last.
    const Place a = corner_place(shape, n, c[0]), b = corner_place(shape, n, c[1]), d = corner_place(shape, n, c[c.size() - 1]);
    auto steps = [&](Place q) { return std::max({std::abs(q.i - a.i), std::abs(q.j - a.j), std::abs(q.k - a.k)}); };
    const int nu = steps(b), nv = steps(d);
    std::vector<uint32_t> nodes(lattice_nodes(face_type, {nu, nv, 1}));
    for (int v = 0; v <= nv; ++v)
      for (int u = 0; u <= (triangle ? nu - v : nu); ++u) {
        auto mix = [&](int p, int q, int r) { return p + u * (q - p) / nu + v * (r - p) / nv; };
        nodes[lattice_node(face_type, {nu, nv, 1}, u, v)] =
            lattice_node(type, n, mix(a.i, b.i, d.i), mix(a.j, b.j, d.j), mix(a.k, b.k, d.k));
      }
    add_face(out, face_type, nodes, c.size());
    out.orders.back() = {nu, nv, 0};
  }
  return out;
}

// Corner numbers of a face place of the cells that have a node in the middle of each face: 15-node tetra, 21-node wedge.
CellFaces centred_faces(CellType type, size_t nodes) {
  if (nodes == 15) return quadratic_faces(tetra_topology, 6, [](int f) { return 10 + (f + 1) % 4; });
  CellFaces out = quadratic_faces(wedge_topology, 9, [](int f) { return 15 + f; });
  (void)type;
  return out;
}

CellFaces make_cell_faces(CellType type, size_t nodes, Orders orders) {
  using enum CellType;
  auto none = [](int) { return -1; };
  switch (type) {
    case quadratic_tetra: return quadratic_faces(tetra_topology, 6, none);
    case quadratic_hexahedron: return quadratic_faces(hexahedron_topology, 12, none);
    case quadratic_wedge: return quadratic_faces(wedge_topology, 9, none);
    case quadratic_pyramid: return quadratic_faces(pyramid_topology, 8, none);
    case triquadratic_hexahedron: return quadratic_faces(hexahedron_topology, 12, [](int f) { return 20 + f; });
    case biquadratic_quadratic_hexahedron: return quadratic_faces(hexahedron_topology, 12, [](int f) { return f < 4 ? 20 + f : -1; });
    case quadratic_linear_wedge: return quadratic_faces(wedge_topology, 6, none);
    case biquadratic_quadratic_wedge: return quadratic_faces(wedge_topology, 9, [](int f) { return f < 2 ? -1 : 13 + f; });
    case triquadratic_pyramid: return quadratic_faces(pyramid_topology, 8, [](int f) { return 13 + f; });
    default: break;
  }
  const CellType shape = linear_type(type);
  if (shape == type && !linear_topology(type)) return {};
  if (type == lagrange_pyramid && (nodes == 13 || nodes == 14 || nodes == 19))
    return quadratic_faces(pyramid_topology, 8, [&](int f) { return nodes == 19 || (nodes == 14 && f == 0) ? 13 + f : -1; });
  if (shape != type) {
    if ((shape == tetra && nodes == 15) || (shape == wedge && nodes == 21)) return centred_faces(type, nodes);
    if (orders[0] < 1 || orders[1] < 1 || orders[2] < 1 || lattice_nodes(type, orders) != nodes) orders.fill(high_order_of(type, nodes));
    if (shape != pyramid && std::max({orders[0], orders[1], orders[2]}) > 1) return lattice_faces(type, orders);
  }
  const LinearTopology* t = linear_topology(shape);
  return t ? linear_faces(*t) : CellFaces{};
}

}  // namespace

const CellFaces& cell_faces(CellType type, size_t nodes, std::array<int, 3> orders) {
  static std::mutex mutex;
  static std::map<std::tuple<CellType, size_t, Orders>, CellFaces> known;
  std::lock_guard lock(mutex);
  const auto key = std::make_tuple(type, nodes, orders);
  auto it = known.find(key);
  if (it == known.end()) it = known.emplace(key, make_cell_faces(type, nodes, orders)).first;
  return it->second;
}

std::array<int, 3> cell_orders(const UnstructuredMesh& mesh, size_t cell) {
  if (mesh.degrees.empty()) return {0, 0, 0};
  const CellType type = mesh.type(cell), form = linear_type(type);
  if (type < CellType::lagrange_curve) return {0, 0, 0};
  if (form != CellType::quad && form != CellType::hexahedron && form != CellType::wedge) return {0, 0, 0};
  const auto v = mesh.degrees.view<uint8_t>();
  return {v(cell, 0), v(cell, 1), v(cell, 2)};
}

CellFaceReader::CellFaceReader(const UnstructuredMesh& mesh) : mesh_(mesh), cells_(cells_view(mesh.cells)), faces_(cells_view(mesh.faces)) {
  if (!mesh.polyhedron_faces.empty()) polyhedron_faces_ = mesh.polyhedron_faces.view<int64_t>().data;
}

size_t CellFaceReader::open(size_t cell) {
  const CellType type = mesh_.type(cell);
  if (type == CellType::polyhedron) {
    table_ = nullptr;
    first_face_ = size_t(polyhedron_faces_[cell]);
    return size_t(polyhedron_faces_[cell + 1]) - first_face_;
  }
  begin_ = cells_.begin(cell);
  const size_t n = cells_.size(cell);
  const auto orders = cell_orders(mesh_, cell);
  if (!table_ || type != known_type_ || n != known_nodes_ || orders != known_orders_) {
    table_ = &cell_faces(type, n, orders);
    known_type_ = type, known_nodes_ = n, known_orders_ = orders;
  }
  return table_->size();
}

CellType CellFaceReader::face_type(size_t f) const { return table_ ? table_->type[f] : CellType::polygon; }
std::array<int, 3> CellFaceReader::face_orders(size_t f) const { return table_ ? table_->orders[f] : std::array<int, 3>{0, 0, 0}; }
std::span<const int64_t> CellFaceReader::nodes(size_t f) { return read(f, false); }
std::span<const int64_t> CellFaceReader::corners(size_t f) { return read(f, true); }

std::span<const int64_t> CellFaceReader::read(size_t f, bool corners_only) {
  ids_.clear();
  if (!table_) {
    for (size_t i = faces_.begin(first_face_ + f); i < faces_.end(first_face_ + f); ++i) ids_.push_back(faces_.connectivity[i]);
  } else {
    for (uint32_t local : corners_only ? table_->face_corners(f) : table_->face(f)) ids_.push_back(cells_.connectivity[begin_ + local]);
  }
  return ids_;
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/transform/mirror_cells.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/cell_topology.h"
#include "data/cells/shape/cell_shape.h"
#include "data/field_ops.h"
#include "filter/mesh/transform/mirror_lattice.h"

namespace sg {

namespace {

constexpr size_t cells_per_chunk = 1 << 14;

// places[k]: which of the old nodes becomes node k; empty: the cell stays.
using Places = std::vector<uint32_t>;

// Boxes and pyramids: r -> 1-r, which keeps the orders along the axes. Simplices and wedges: r and s change places.
Places reflected(const CellShape& shape) {
  const bool box = shape.base() != CellType::triangle && shape.base() != CellType::tetra && shape.base() != CellType::wedge;
  Places places(shape.nodes());
  for (size_t k = 0; k < shape.nodes(); ++k) {
    const Vec3 p = shape.node(k), q = box ? Vec3(1 - p.x, p.y, p.z) : Vec3(p.y, p.x, p.z);
    size_t j = 0;
    while (j < shape.nodes() && !(length(shape.node(j) - q) < 1e-6)) ++j;
    if (j == shape.nodes()) fail_internal("the nodes of a cell are not symmetric");
    places[k] = uint32_t(j);
  }
  return places;
}

// Around one way or the other, from the same first node; with_middles: then the nodes in the middle of the sides.
Places reversed_ring(size_t corners, bool with_middles) {
  Places places(corners);
  for (size_t k = 0; k < corners; ++k) places[k] = uint32_t((corners - k) % corners);
  if (with_middles)
    for (size_t k = 0; k < corners; ++k) places.push_back(uint32_t(2 * corners - 1 - k));
  return places;
}

Places prism(size_t corners) {
  Places places = reversed_ring(corners, false);
  for (size_t k = 0; k < corners; ++k) places.push_back(places[k] + uint32_t(corners));
  return places;
}

// A strip of an odd number of triangles: backwards. Of two: the other two corners of the common side change places.
Places strip(size_t n) {
  Places places(n);
  std::iota(places.rbegin(), places.rend(), 0u);
  if (n == 4) places = {0, 2, 1, 3};
  return places;
}

// `known` is false for a curved cell whose number of nodes fits no order.
Places places_of(CellType type, size_t n, std::array<int, 3> orders, bool& known) {
  known = true;
  if (cell_type_info(type).dimension < 2) return {};
  switch (type) {
    case CellType::polyhedron: return {};
    case CellType::polygon: return reversed_ring(n, false);
    case CellType::quadratic_polygon: return reversed_ring(n / 2, true);
    case CellType::triangle_strip: return strip(n);
    case CellType::pentagonal_prism: return prism(5);
    case CellType::hexagonal_prism: return prism(6);
    default: break;
  }
  const CellShape* shape = CellShape::find(type, n, orders);
  known = shape != nullptr;
  return shape ? reflected(*shape) : Places();
}

void put(std::byte* out, bool wide, size_t i, int64_t id) {
  if (wide) reinterpret_cast<int64_t*>(out)[i] = id;
  else reinterpret_cast<int32_t*>(out)[i] = int32_t(id);
}

// places(c, n) gives a Places for cell c of n points, by pointer; null or empty: it stays.
template <class PlacesOf>
CellArray permuted(const CellArray& a, PlacesOf&& places_for) {
  const CellsView v = cells_view(a);
  CellArray r = a;
  std::byte* out = nullptr;
  r.connectivity = Array::make_raw(a.connectivity.type(), a.connectivity.count(), 1, &out);
  parallel_for(v.count, cells_per_chunk, [&](size_t begin, size_t end) {
    auto places = places_for();
    for (size_t c = begin; c < end; ++c) {
      const size_t first = v.begin(c), n = v.size(c);
      const Places* p = places(c, n);
      for (size_t k = 0; k < n; ++k) put(out, v.connectivity.wide, first + k, v.connectivity[first + (p && !p->empty() ? (*p)[k] : k)]);
    }
  });
  return r;
}

// All of one kind: made once for each number of points.
template <class Make>
CellArray permuted_alike(const CellArray& a, Make&& make) {
  return permuted(a, [&make] {
    return [&make, known = std::map<size_t, Places>()](size_t, size_t n) mutable {
      auto [at, fresh] = known.try_emplace(n);
      if (fresh) at->second = make(n);
      return &at->second;
    };
  });
}

bool even_strip(size_t n) { return n >= 6 && n % 2 == 0; }

// The cells with each even strip in two: its first triangle, then the rest from its other end, which has an odd number of triangles.
// Both face the same side as before. source: the old cell of each.
CellArray split_strips(const CellArray& a, const std::function<bool(size_t)>& splits, std::vector<int64_t>& source) {
  const CellsView v = cells_view(a);
  std::vector<int64_t> ids, offsets{0};
  const auto close = [&](size_t c) { offsets.push_back(int64_t(ids.size())), source.push_back(int64_t(c)); };
  for (size_t c = 0; c < v.count; ++c) {
    const size_t n = v.size(c);
    const bool split = splits(c);
    for (size_t k = 0; k < (split ? 3 : n); ++k) ids.push_back(v.point(c, k));
    close(c);
    if (!split) continue;
    for (size_t k = n; k-- > 1;) ids.push_back(v.point(c, k));
    close(c);
  }
  return {Array::from_vector(std::move(ids)), Array::from_vector(std::move(offsets)), 0};
}

void carry_cells(DatasetParts& parts, const std::vector<int64_t>& source) {
  FieldSet fields;
  for (const Field& f : parts.fields) fields.add(f.association == Association::cell ? f.with(gather(f.array, source)) : f);
  parts.fields = std::move(fields);
  if (!parts.cell_ghost.empty()) parts.cell_ghost = gather(parts.cell_ghost, source);
}

void split_even_strips(UnstructuredMesh& m, DatasetParts& parts) {
  const CellsView v = cells_view(m.cells);
  const auto splits = [&](size_t c) { return m.type(c) == CellType::triangle_strip && even_strip(v.size(c)); };
  bool any = false;
  for (size_t c = 0; c < v.count && !any; ++c) any = splits(c);
  if (!any) return;
  std::vector<int64_t> source;
  CellArray cells = split_strips(m.cells, splits, source);
  std::vector<uint8_t> types;
  std::vector<int64_t> faces{0};
  const bool polyhedra = !m.polyhedron_faces.empty();
  for (size_t i = 0; i < source.size(); ++i) {
    const auto c = size_t(source[i]);
    types.push_back(uint8_t(m.type(c)));
    if (polyhedra) faces.push_back(m.polyhedron_faces.view<int64_t>()[c + 1]);
  }
  m.cells = std::move(cells), m.types = Array::from_vector(std::move(types));
  if (polyhedra) m.polyhedron_faces = Array::from_vector(std::move(faces));
  if (!m.degrees.empty()) m.degrees = gather(m.degrees, source);
  carry_cells(parts, source);
}

void turn(UnstructuredMesh& m, DatasetParts& parts, Context& ctx) {
  split_even_strips(m, parts);
  using Key = std::tuple<CellType, size_t, std::array<int, 3>>;
  const CellsView v = cells_view(m.cells);
  std::map<Key, Places> known;
  size_t unknown = 0;
  for (size_t c = 0; c < v.count; ++c) {  // few kinds, so that this loop only compares
    const Key key{m.type(c), v.size(c), cell_orders(m, c)};
    if (c > 0 && m.degrees.empty() && m.type(c) == m.type(c - 1) && v.size(c) == v.size(c - 1)) continue;
    const auto [at, fresh] = known.try_emplace(key);
    bool fits = true;
    if (fresh) at->second = places_of(std::get<0>(key), std::get<1>(key), std::get<2>(key), fits);
    unknown += !fits;
  }
  if (unknown > 0) ctx.warn("transform: curved cells whose number of nodes fits no order keep their node order and are inside out");
  m.cells = permuted(m.cells, [&] { return [&](size_t c, size_t n) { return &known.at({m.type(c), n, cell_orders(m, c)}); }; });
  if (m.faces.size() > 0) m.faces = permuted_alike(m.faces, [](size_t n) { return reversed_ring(n, false); });
}

void turn(SurfaceMesh& m, DatasetParts& parts) {
  const CellsView strips = cells_view(m.strips);
  const auto splits = [&](size_t c) { return even_strip(strips.size(c)); };
  bool any = false;
  for (size_t c = 0; c < strips.count && !any; ++c) any = splits(c);
  if (any) {
    std::vector<int64_t> source(m.cell_count() - m.strips.size());
    std::iota(source.begin(), source.end(), 0);
    const auto before = int64_t(source.size());
    m.strips = split_strips(m.strips, splits, source);
    for (size_t i = size_t(before); i < source.size(); ++i) source[i] += before;
    carry_cells(parts, source);
  }
  if (m.strips.size() > 0) m.strips = permuted_alike(m.strips, strip);
  if (m.polygons.size() > 0) m.polygons = permuted_alike(m.polygons, [](size_t n) { return reversed_ring(n, false); });
}

}  // namespace

void turn_mirrored_cells(DatasetParts& parts, Context& ctx) {
  // The mesh is taken out while its cells and the fields change together.
  Mesh mesh = std::move(parts.mesh);
  if (auto* u = std::get_if<UnstructuredMesh>(&mesh)) turn(*u, parts, ctx);
  else if (auto* s = std::get_if<SurfaceMesh>(&mesh)) turn(*s, parts);
  parts.mesh = std::move(mesh);
  turn_mirrored_lattice(parts);
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Exodus II: the cells of blocks and sets, on the nodes that they use.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/parallel.h"
#include "data/fields/label_names.h"
#include "io/plugins/netcdf/exodus.h"

namespace sg::nc {

namespace {

constexpr size_t elements_per_chunk = 1 << 15;

}  // namespace

const BlockCells& ExodusMesh::cells_of(const ExodusObject& o) {
  const auto key = std::pair(o.kind, o.number);
  if (const auto known = cells_.find(key); known != cells_.end()) return known->second;
  BlockCells c;
  const Variable* v = file_.find(fmt::format("{}{}", o.kind->connect, o.number));
  const Variable* of_faces = o.kind == &element_blocks ? file_.find(fmt::format("facconn{}", o.number)) : nullptr;
  std::string name = v ? file_.text(v, "elem_type") : std::string();
  if (name.empty() && of_faces) name = file_.text(of_faces, "elem_type");
  std::string capital = name.substr(0, 3);
  for (char& k : capital) k = k >= 'a' && k <= 'z' ? char(k - 32) : k;
  const bool polyhedra = capital == "NFA";
  if (polyhedra) v = of_faces;
  if (!v || !v->is_number()) file_.fail(fmt::format("block {} has no elements", o.number), v ? v->name : std::string_view());
  const ElementType type = v->element() == ElementType::i64 ? ElementType::i64 : ElementType::i32;
  // Elements of different sizes are stored one after the other, with a list of their sizes.
  const Variable* sizes = file_.find(fmt::format("{}epecnt{}",
                                                 o.kind == &face_blocks   ? "fb"
                                                 : o.kind == &edge_blocks ? "ed"
                                                                          : "eb",
                                                 o.number));
  if (sizes && (polyhedra || capital == "NSI" || v->shape.size() == 1)) {
    if (!sizes->is_number() || sizes->shape.size() != 1 || sizes->shape[0] != o.size)
      file_.fail(fmt::format("must hold {} sizes", o.size), sizes->name);
    const Array n = file_.read(*sizes, ElementType::i64);
    const size_t ids = v->count();
    c.offsets.push_back(0);
    for (size_t e = 0; e < o.size; ++e) {
      const int64_t k = n.view<int64_t>().data[e];
      if (k < 0 || uint64_t(k) > ids - uint64_t(c.offsets.back()))
        file_.fail(fmt::format("element {} has {} numbers, but {} holds only {}", e, k, v->name, ids), sizes->name);
      c.offsets.push_back(c.offsets.back() + k);
    }
    c.shape.kind = polyhedra ? ShapeKind::polyhedra : ShapeKind::polygons;
    c.shape.type = polyhedra ? CellType::polyhedron : CellType::polygon;
    c.shape.dimension = polyhedra ? 3 : 2;
  } else {
    if (v->shape.empty() || v->shape.size() > 2 || v->shape[0] != o.size)
      file_.fail(fmt::format("must list the nodes of {} elements", o.size), v->name);
    c.per = v->shape.size() == 2 ? v->shape[1] : 1;
    if (polyhedra || c.per == 0) file_.fail("the elements have no list of sizes", v->name);
    try {
      c.shape = exodus_shape(name, c.per, o.kind == &edge_blocks ? 1 : space_);
    } catch (const Error& e) {
      file_.fail(e.problem(), v->name, e.hint());
    }
  }
  c.ids = file_.read(*v, type);
  return cells_.emplace(key, std::move(c)).first->second;
}

namespace {

// The cells of elements of one shape, VTK's nodes in VTK's order, node numbers from 0. Wrong ones stay wrong (-1 or too large).
template <class T>
void ordered_cells(const T* from, size_t elements, size_t per, std::span<const uint8_t> order, std::vector<int64_t>& out) {
  const size_t n = order.size();
  out.resize(elements * n);
  parallel_for(elements, elements_per_chunk, [&](size_t begin, size_t end) {
    for (size_t e = begin; e < end; ++e)
      for (size_t k = 0; k < n; ++k) out[e * n + k] = zero_based(from[e * per + order[k]]);
  });
}

}  // namespace

std::vector<std::pair<const BlockCells*, size_t>> ExodusMesh::all_faces() {
  std::vector<std::pair<const BlockCells*, size_t>> all;
  for (const ExodusObject& f : faces) {
    if (f.size == 0) continue;
    const BlockCells& c = cells_of(f);
    for (size_t i = 0; i < f.size; ++i) all.emplace_back(&c, i);
  }
  return all;
}

void ExodusMesh::add_polyhedra(const BlockCells& c, const ExodusObject& o, UnstructuredMesh& mesh, std::vector<int64_t>& ids) {
  const auto all = all_faces();
  const IndexView list = index_view(c.ids);
  std::vector<int64_t> offsets{0}, face_ids, face_offsets{0}, of_cells{0};
  for (size_t e = 0; e < o.size; ++e) {
    const auto first = ptrdiff_t(ids.size());
    for (size_t i = c.begin(e); i < c.end(e); ++i) {
      const int64_t f = list[i];
      if (f < 1 || size_t(f) > all.size())
        file_.fail(fmt::format("polyhedron {} has the face {} of {}", e, f, all.size()), fmt::format("facconn{}", o.number));
      const auto& [block, place] = all[size_t(f) - 1];
      const IndexView nodes = index_view(block->ids);
      for (size_t k = block->begin(place); k < block->end(place); ++k) {
        const int64_t node = zero_based(nodes[k]);
        if (node < 0 || size_t(node) >= nodes_) file_.fail(fmt::format("face {} has the node {} of {}", f, nodes[k], nodes_));
        face_ids.push_back(node);
        ids.push_back(node);
      }
      face_offsets.push_back(int64_t(face_ids.size()));
    }
    std::sort(ids.begin() + first, ids.end());
    ids.erase(std::unique(ids.begin() + first, ids.end()), ids.end());
    offsets.push_back(int64_t(ids.size()));
    of_cells.push_back(int64_t(face_offsets.size()) - 1);
    // A hostile file repeats one large face in every element: no more than it could list itself.
    if (face_ids.size() > (size_t(1) << 34)) file_.fail("its polyhedra have more than 2^34 nodes");
  }
  mesh.cells.offsets = Array::from_vector(std::move(offsets));
  mesh.types = Array::from_vector(std::vector<uint8_t>(o.size, uint8_t(CellType::polyhedron)));
  mesh.faces.connectivity = Array::from_vector(std::move(face_ids));
  mesh.faces.offsets = Array::from_vector(std::move(face_offsets));
  mesh.polyhedron_faces = Array::from_vector(std::move(of_cells));
}

DatasetPtr ExodusMesh::block(const ExodusObject& o) {
  const BlockCells& c = cells_of(o);
  UnstructuredMesh mesh;
  std::vector<int64_t> ids;
  const auto copy = [&](std::span<const uint8_t> order) {
    if (c.ids.type() == ElementType::i64) ordered_cells(c.ids.view<int64_t>().data, o.size, c.per, order, ids);
    else ordered_cells(c.ids.view<int32_t>().data, o.size, c.per, order, ids);
  };
  mesh.single_type = c.shape.type;
  if (c.shape.kind == ShapeKind::polyhedra) {
    add_polyhedra(c, o, mesh, ids);
  } else if (c.per > 0) {
    std::vector<uint8_t> order = c.shape.order;
    if (order.empty()) {  // points
      if (c.per > 255) file_.fail(fmt::format("elements have {} nodes", c.per));
      for (size_t k = 0; k < c.per; ++k) order.push_back(uint8_t(k));
    }
    copy(order);
    mesh.cells.fixed = int(order.size());
  } else {
    const IndexView list = index_view(c.ids);
    ids.resize(size_t(c.offsets.back()));
    for (size_t i = 0; i < ids.size(); ++i) ids[i] = zero_based(list[i]);
    mesh.cells.offsets = Array::from_vector(c.offsets);
  }
  return finish(std::move(mesh), std::move(ids), object_fields(o, o.size), o, o.size);
}

DatasetPtr ExodusMesh::node_set(const ExodusObject& o) {
  const Variable& v = file_.require(fmt::format("node_ns{}", o.number));
  if (!v.is_number() || v.shape.size() != 1 || v.shape[0] != o.size) file_.fail(fmt::format("must list {} nodes", o.size), v.name);
  const Array list = file_.read(v, ElementType::i64);
  const int64_t* p = list.view<int64_t>().data;
  std::vector<int64_t> ids(p, p + list.count());
  for (int64_t& id : ids) id = zero_based(id);
  UnstructuredMesh mesh;
  mesh.single_type = CellType::vertex;
  mesh.cells.fixed = 1;
  return finish(std::move(mesh), std::move(ids), object_fields(o, o.size), o, o.size);
}

namespace {

// ids that occur, ascending; empty optional when all of 0..n-1 do. `bad` receives the first place of an id outside.
std::optional<std::vector<int64_t>> distinct(const std::vector<int64_t>& ids, size_t n, size_t& bad) {
  bad = SIZE_MAX;
  for (size_t i = 0; i < ids.size() && bad == SIZE_MAX; ++i)
    if (uint64_t(ids[i]) >= n) bad = i;
  if (bad != SIZE_MAX) return {};
  std::vector<int64_t> used;
  if (ids.size() < n / 16) {
    used = ids;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
  } else {
    std::vector<uint8_t> seen(n, 0);
    for (const int64_t id : ids) seen[size_t(id)] = 1;
    for (size_t i = 0; i < n; ++i)
      if (seen[i]) used.push_back(int64_t(i));
  }
  if (used.size() == n) return {};
  return used;
}

}  // namespace

DatasetPtr ExodusMesh::finish(UnstructuredMesh mesh, std::vector<int64_t> ids, FieldSet cell_fields, const ExodusObject& o, size_t cells) {
  size_t bad = 0;
  const std::optional<std::vector<int64_t>> used = distinct(ids, nodes_, bad);
  if (bad != SIZE_MAX)
    file_.fail(fmt::format("'{}' uses the node {} (entry {}), which is not in 1..{}", o.name, int64_t(uint64_t(ids[bad]) + 1), bad, nodes_),
               fmt::format("{}{}", o.kind->connect, o.number));
  std::vector<int64_t> place;
  if (used && ids.size() >= nodes_ / 16) {
    place.assign(nodes_, 0);
    for (size_t i = 0; i < used->size(); ++i) place[size_t((*used)[i])] = int64_t(i);
  }
  const auto renumbered = [&](const int64_t* from, size_t n) {
    int32_t* narrow = nullptr;
    int64_t* wide = nullptr;
    Array a = nodes_ <= size_t(INT32_MAX) ? Array::make<int32_t>(n, 1, &narrow) : Array::make<int64_t>(n, 1, &wide);
    parallel_for(n, elements_per_chunk, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        int64_t id = from[i];
        if (used) id = place.empty() ? std::lower_bound(used->begin(), used->end(), id) - used->begin() : place[size_t(id)];
        if (narrow) narrow[i] = int32_t(id);
        else wide[i] = id;
      }
    });
    return a;
  };
  mesh.cells.connectivity = renumbered(ids.data(), ids.size());
  if (!mesh.faces.connectivity.empty()) {
    const Array all = mesh.faces.connectivity;
    mesh.faces.connectivity = renumbered(all.view<int64_t>().data, all.count());
  }
  if (cells == 0) return nullptr;
  DatasetParts parts;
  mesh.points = points_of(used ? &*used : nullptr);
  parts.mesh = std::move(mesh);
  add_point_fields(parts.fields, used ? &*used : nullptr);
  for (const Field& f : cell_fields) parts.fields.add(f);
  for (const Field& f : whole_) parts.fields.add(f);
  parts.notes = notes_;
  // The names of all objects of the kind, so that one legend fits all parts.
  LabelNames names("ObjectId");
  for (const auto* kind : {&elements, &faces, &edges, &sides, &node_lists})
    for (const ExodusObject& other : *kind)
      if (other.kind == o.kind) names.add(other.id, other.name);
  parts.notes.push_back(names.note());
  parts.time = time_;
  return make_dataset(std::move(parts));
}

}  // namespace sg::nc

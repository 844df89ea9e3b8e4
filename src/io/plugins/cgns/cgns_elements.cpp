// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/cgns/cgns_elements.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/parallel.h"
#include "io/mesh/node_order.h"

namespace sg::cg {

namespace {

enum : int { type_mixed = 20, type_pyra13 = 21, type_ngon = 22, type_nface = 23 };

// The SIDS numbers of the element types up to quadratic.
struct ElementKind {
  int dimension = -1;
  size_t nodes = 0;
  CellType type = CellType::empty;
  std::vector<uint8_t> order;  // node k of the VTK type is node order[k] of the element
};

constexpr NodeMask m(std::initializer_list<int> corners) {
  int bits = 0;
  for (const int c : corners) bits |= 1 << (c - 1);
  return NodeMask(bits);
}

// Nodes beyond the corners, by the corners around them, in SIDS order (corners counted from 1, as there).
const std::vector<NodeMask> tri_nodes = {1, 2, 4, m({1, 2}), m({2, 3}), m({3, 1})};
const std::vector<NodeMask> quad_nodes = {1, 2, 4, 8, m({1, 2}), m({2, 3}), m({3, 4}), m({4, 1}), m({1, 2, 3, 4})};
const std::vector<NodeMask> tetra_nodes = {1, 2, 4, 8, m({1, 2}), m({2, 3}), m({3, 1}), m({1, 4}), m({2, 4}), m({3, 4})};
const std::vector<NodeMask> pyramid_nodes = {1,         2,         4,         8,         16,        m({1, 2}), m({2, 3}),
                                             m({3, 4}), m({4, 1}), m({1, 5}), m({2, 5}), m({3, 5}), m({4, 5}), m({1, 2, 3, 4})};
const std::vector<NodeMask> wedge_nodes = {
    1,         2,         4,         8,         16,        32,        m({1, 2}),       m({2, 3}),       m({3, 1}),
    m({1, 4}), m({2, 5}), m({3, 6}), m({4, 5}), m({5, 6}), m({6, 4}), m({1, 2, 5, 4}), m({2, 3, 6, 5}), m({3, 1, 4, 6})};
const std::vector<NodeMask> hexa_nodes = {1,
                                          2,
                                          4,
                                          8,
                                          16,
                                          32,
                                          64,
                                          128,
                                          m({1, 2}),
                                          m({2, 3}),
                                          m({3, 4}),
                                          m({4, 1}),
                                          m({1, 5}),
                                          m({2, 6}),
                                          m({3, 7}),
                                          m({4, 8}),
                                          m({5, 6}),
                                          m({6, 7}),
                                          m({7, 8}),
                                          m({8, 5}),
                                          m({1, 4, 3, 2}),
                                          m({1, 2, 6, 5}),
                                          m({2, 3, 7, 6}),
                                          m({3, 4, 8, 7}),
                                          m({1, 5, 8, 4}),
                                          m({5, 6, 7, 8}),
                                          255};

ElementKind made(int dimension, size_t nodes, CellType type, const std::vector<NodeMask>& list) {
  return {dimension, nodes, type, node_order(type, std::span<const NodeMask>(list).first(nodes))};
}

const ElementKind* element_kind(int64_t type) {
  static const std::vector<ElementKind> kinds = [] {
    std::vector<ElementKind> k(type_pyra13 + 1);
    const std::vector<NodeMask> bar = {1, 2, 3};
    k[2] = made(0, 1, CellType::vertex, bar);
    k[3] = made(1, 2, CellType::line, bar);
    k[4] = made(1, 3, CellType::quadratic_edge, bar);
    k[5] = made(2, 3, CellType::triangle, tri_nodes);
    k[6] = made(2, 6, CellType::quadratic_triangle, tri_nodes);
    k[7] = made(2, 4, CellType::quad, quad_nodes);
    k[8] = made(2, 8, CellType::quadratic_quad, quad_nodes);
    k[9] = made(2, 9, CellType::biquadratic_quad, quad_nodes);
    k[10] = made(3, 4, CellType::tetra, tetra_nodes);
    k[11] = made(3, 10, CellType::quadratic_tetra, tetra_nodes);
    k[12] = made(3, 5, CellType::pyramid, pyramid_nodes);
    k[13] = made(3, 14, CellType::quadratic_pyramid, pyramid_nodes);  // the node in the middle of the base is left out
    k[14] = made(3, 6, CellType::wedge, wedge_nodes);
    k[15] = made(3, 15, CellType::quadratic_wedge, wedge_nodes);
    k[16] = made(3, 18, CellType::biquadratic_quadratic_wedge, wedge_nodes);
    k[17] = made(3, 8, CellType::hexahedron, hexa_nodes);
    k[18] = made(3, 20, CellType::quadratic_hexahedron, hexa_nodes);
    k[19] = made(3, 27, CellType::triquadratic_hexahedron, hexa_nodes);
    k[type_pyra13] = made(3, 13, CellType::quadratic_pyramid, pyramid_nodes);
    return k;
  }();
  return type >= 2 && type <= type_pyra13 && kinds[size_t(type)].dimension >= 0 ? &kinds[size_t(type)] : nullptr;
}

// Only version 3.0 put PYRA_13 before PYRA_14.
int64_t numbered(int64_t type, double version) {
  if (std::fabs(version - 3.0) > 0.005 || type < 13 || type > 21) return type;
  return type == 13 ? int64_t(type_pyra13) : type - 1;
}

// Numbers in the file count from 1. The smallest wraps around, so that it stays wrong.
int64_t zero_based(int64_t number) { return int64_t(uint64_t(number) - 1); }

struct Section {
  const Node* node = nullptr;
  int64_t type = 0, first = 0, count = 0;
  Array ids;                     // connectivity as stored
  std::vector<int64_t> offsets;  // of elements of different sizes: count + 1 places in ids
  int dimension = -1;            // of its highest elements
};

class Zone {
 public:
  Zone(const CgFile& file, double version) : file_(file), version_(version) {}

  UnstructuredMesh read(const std::vector<Node>& zone, int cell_dimension) {
    for (const Node& n : zone)
      if (n.label == "Elements_t") load(n);
    std::stable_sort(sections_.begin(), sections_.end(), [](const Section& a, const Section& b) { return a.first < b.first; });
    int dimension = -1;
    for (const Section& s : sections_)
      if (s.dimension <= cell_dimension) dimension = std::max(dimension, s.dimension);
    UnstructuredMesh mesh;
    if (dimension < 0) return mesh;
    if (uniform(dimension, mesh)) return mesh;
    for (const Section& s : sections_)
      if (s.dimension == dimension) append(s, dimension);
    finish(mesh);
    return mesh;
  }

 private:
  void load(const Node& n) {
    Section s;
    s.node = &n;
    const std::vector<int64_t> head = file_.integers(n);
    const std::vector<Node> parts = file_.children(n);
    const Node* range = CgFile::named(parts, "ElementRange");
    const Node* ids = CgFile::named(parts, "ElementConnectivity");
    const Node* starts = CgFile::named(parts, "ElementStartOffset");
    if (head.empty() || !range || !ids) file_.fail("has no type, range or connectivity", n);
    const std::vector<int64_t> r = file_.integers(*range);
    if (r.size() != 2 || r[0] < 1 || r[1] < r[0] || r[1] - r[0] >= int64_t(ids->count()))
      file_.fail("its range of element numbers does not match", n);
    s.type = numbered(head[0], version_);
    s.first = r[0], s.count = r[1] - r[0] + 1;
    s.ids = file_.numbers(*ids);
    if (s.ids.type() != ElementType::i32 && s.ids.type() != ElementType::i64) s.ids = s.ids.converted(ElementType::i64);
    if (s.type == type_mixed || s.type == type_ngon || s.type == type_nface) find_offsets(s, starts);
    else {
      const ElementKind* kind = element_kind(s.type);
      if (!kind)
        file_.fail(fmt::format("elements of type {} are not supported", s.type), n,
                   "supported: linear and quadratic elements, MIXED, NGON_n, NFACE_n");
      if (s.ids.count() / kind->nodes < size_t(s.count))
        file_.fail(fmt::format("{} elements of {} nodes need more than {} ids", s.count, kind->nodes, s.ids.count()), n);
      s.dimension = kind->dimension;
    }
    sections_.push_back(std::move(s));
  }

  // Where each element begins. Old files (before 4.0) put the size before each polygon instead of giving the places.
  void find_offsets(Section& s, const Node* starts) {
    const IndexView ids = index_view(s.ids);
    const auto n = int64_t(s.ids.count());
    if (starts) {
      s.offsets = file_.integers(*starts);
      if (s.offsets.size() != size_t(s.count) + 1)
        file_.fail(fmt::format("has {} offsets for {} elements", s.offsets.size(), s.count), *starts);
      for (size_t i = 0; i < s.offsets.size(); ++i)
        if (s.offsets[i] < (i ? s.offsets[i - 1] : 0) || s.offsets[i] > n)
          file_.fail(fmt::format("offset {} is {}", i, s.offsets[i]), *starts);
    }
    s.dimension = s.type == type_ngon ? 2 : s.type == type_nface ? 3 : -1;
    if (s.type == type_mixed) {
      int64_t at = 0;
      const bool known = !s.offsets.empty();
      if (!known) s.offsets.push_back(0);
      for (int64_t e = 0; e < s.count; ++e) {
        if (known) at = s.offsets[size_t(e)];
        if (at >= n) file_.fail(fmt::format("its list ends before element {}", s.first + e), *s.node);
        const size_t size = mixed_size(s, ids[size_t(at)]);
        if (int64_t(size) > n - at - 1) file_.fail(fmt::format("its list ends within element {}", s.first + e), *s.node);
        s.dimension = std::max(s.dimension, mixed_dimension(ids[size_t(at)]));
        at += int64_t(size) + 1;
        if (!known) s.offsets.push_back(at);
        else if (at > s.offsets[size_t(e) + 1]) file_.fail(fmt::format("element {} is longer than its entry", s.first + e), *s.node);
      }
    } else if (!starts) {
      std::vector<int64_t> packed, ends{0};
      int64_t at = 0;
      for (int64_t e = 0; e < s.count; ++e) {
        const int64_t size = at < n ? ids[size_t(at)] : -1;
        if (size < 0 || size > n - at - 1) file_.fail(fmt::format("its list ends within element {}", s.first + e), *s.node);
        for (int64_t k = 1; k <= size; ++k) packed.push_back(ids[size_t(at + k)]);
        ends.push_back(int64_t(packed.size()));
        at += size + 1;
      }
      s.ids = Array::from_vector(std::move(packed));
      s.offsets = std::move(ends);
    }
  }

  // In MIXED sections of old files a polygon of n nodes is of type NGON_n + n.
  size_t mixed_size(const Section& s, int64_t type) const {
    type = numbered(type, version_);
    if (const ElementKind* kind = element_kind(type)) return kind->nodes;
    if (version_ < 3.2 && type > type_ngon && type < type_ngon + 10000) return size_t(type - type_ngon);
    file_.fail(fmt::format("has an element of type {}, which is not supported", type), *s.node);
  }
  int mixed_dimension(int64_t type) const {
    const ElementKind* kind = element_kind(numbered(type, version_));
    return kind ? kind->dimension : 2;
  }

  // The common case: one type, all cells of one size, copied in parallel.
  bool uniform(int dimension, UnstructuredMesh& mesh) const {
    const ElementKind* kind = nullptr;
    size_t cells = 0;
    for (const Section& s : sections_) {
      if (s.dimension != dimension) continue;
      if (!s.offsets.empty() || (kind && element_kind(s.type) != kind)) return false;
      kind = element_kind(s.type);
      cells += size_t(s.count);
    }
    if (!kind) return false;
    const size_t n = kind->order.size();
    int64_t* out = nullptr;
    mesh.cells.connectivity = Array::make<int64_t>(cells * n, 1, &out);
    mesh.cells.fixed = int(n);
    mesh.single_type = kind->type;
    for (const Section& s : sections_) {
      if (s.dimension != dimension) continue;
      const IndexView ids = index_view(s.ids);
      parallel_for(size_t(s.count), 1 << 14, [&](size_t begin, size_t end) {
        for (size_t e = begin; e < end; ++e)
          for (size_t k = 0; k < n; ++k) out[e * n + k] = zero_based(ids[e * kind->nodes + kind->order[k]]);
      });
      out += size_t(s.count) * n;
    }
    return true;
  }

  void append(const Section& s, int dimension) {
    const IndexView ids = index_view(s.ids);
    for (int64_t e = 0; e < s.count; ++e) {
      if (s.type == type_nface) {
        append_polyhedron(s, e);
        continue;
      }
      int64_t type = s.type;
      size_t at = 0, size = 0;
      if (s.type == type_ngon) {
        at = size_t(s.offsets[size_t(e)]), size = size_t(s.offsets[size_t(e) + 1]) - at;
      } else if (s.type == type_mixed) {
        at = size_t(s.offsets[size_t(e)]) + 1;
        type = numbered(ids[at - 1], version_);
        if (mixed_dimension(ids[at - 1]) != dimension) continue;
        size = mixed_size(s, ids[at - 1]);
      } else {
        size = element_kind(type)->nodes, at = size_t(e) * size;
      }
      const ElementKind* kind = element_kind(type);
      if (kind)
        for (const uint8_t k : kind->order) ids_.push_back(zero_based(ids[at + k]));
      else
        for (size_t k = 0; k < size; ++k) ids_.push_back(zero_based(ids[at + k]));
      add_cell(kind ? kind->type : CellType::polygon);
    }
  }

  void add_cell(CellType type) {
    types_.push_back(uint8_t(type));
    offsets_.push_back(int64_t(ids_.size()));
    cell_faces_.push_back(int64_t(face_offsets_.size()) - 1);
  }

  // Appends the corners of the 2D element of that number.
  void add_face(const Section& cells, int64_t number) {
    const auto after =
        std::upper_bound(sections_.begin(), sections_.end(), number, [](int64_t n, const Section& f) { return n < f.first; });
    const Section* s = after == sections_.begin() ? nullptr : &after[-1];
    if (!s || number - s->first >= s->count || (s->dimension != 2 && s->type != type_mixed))
      file_.fail(fmt::format("a face is element {}, which is not a polygon", number), *cells.node);
    const IndexView ids = index_view(s->ids);
    const auto e = size_t(number - s->first);
    size_t at = 0, corners = 0;
    if (s->type == type_ngon) {
      at = size_t(s->offsets[e]), corners = size_t(s->offsets[e + 1]) - at;
    } else {
      int64_t type = s->type;
      if (type == type_mixed) at = size_t(s->offsets[e]) + 1, type = numbered(ids[at - 1], version_);
      else at = e * element_kind(type)->nodes;
      corners = type == 5 || type == 6 ? 3 : 4;
      if (!element_kind(type) || element_kind(type)->dimension != 2)
        file_.fail(fmt::format("a face is element {}, which is not a polygon", number), *cells.node);
    }
    for (size_t k = 0; k < corners; ++k) {
      const int64_t id = zero_based(ids[at + k]);
      face_ids_.push_back(id);
      ids_.push_back(id);
    }
    face_offsets_.push_back(int64_t(face_ids_.size()));
    // A hostile file repeats one large face in every cell.
    if (face_ids_.size() > (size_t(1) << 34)) file_.fail("its polyhedra have more than 2^34 corners", *cells.node);
  }

  void append_polyhedron(const Section& s, int64_t e) {
    const IndexView ids = index_view(s.ids);
    const auto first = ptrdiff_t(ids_.size());
    for (int64_t k = s.offsets[size_t(e)]; k < s.offsets[size_t(e) + 1]; ++k) {
      const int64_t f = ids[size_t(k)];  // negative: seen from the other side
      const auto start = ptrdiff_t(face_ids_.size());
      add_face(s, f < 0 && f != INT64_MIN ? -f : f);
      if (f < 0) std::reverse(face_ids_.begin() + start, face_ids_.end());
    }
    std::sort(ids_.begin() + first, ids_.end());
    ids_.erase(std::unique(ids_.begin() + first, ids_.end()), ids_.end());
    add_cell(CellType::polyhedron);
  }

  void finish(UnstructuredMesh& mesh) {
    mesh.cells.connectivity = Array::from_vector(std::move(ids_));
    mesh.cells.offsets = Array::from_vector(std::move(offsets_));
    mesh.types = Array::from_vector(std::move(types_));
    if (!face_ids_.empty()) {
      mesh.faces.connectivity = Array::from_vector(std::move(face_ids_));
      mesh.faces.offsets = Array::from_vector(std::move(face_offsets_));
      mesh.polyhedron_faces = Array::from_vector(std::move(cell_faces_));
    }
  }

  const CgFile& file_;
  double version_;
  std::vector<Section> sections_;
  std::vector<int64_t> ids_, offsets_{0}, face_ids_, face_offsets_{0}, cell_faces_{0};
  std::vector<uint8_t> types_;
};

}  // namespace

UnstructuredMesh zone_cells(const CgFile& file, const std::vector<Node>& zone, int cell_dimension, double version) {
  return Zone(file, version).read(zone, cell_dimension);
}

}  // namespace sg::cg

// SPDX-License-Identifier: Apache-2.0
// Exodus II: side sets, lists of (element, side) as cells of one dimension less.
#include "io/plugins/netcdf/exodus.h"

#include <fmt/core.h>

#include <algorithm>

namespace sg::nc {

// What the sides of one set become.
struct ExodusMesh::SideList {
  std::vector<int64_t> ids, offsets{0};
  std::vector<uint8_t> types;
  std::vector<std::pair<const BlockCells*, std::vector<CellSide>>> known;  // sides of the shapes met
  std::vector<std::pair<const BlockCells*, size_t>> faces;                 // of polyhedra
};

void ExodusMesh::add_side(const ExodusObject& set, const ExodusObject& block, size_t e, int64_t s, SideList& out) {
  const BlockCells& c = cells_of(block);
  const IndexView nodes = index_view(c.ids);
  const auto check = [&](size_t sides) {
    if (uint64_t(s) >= sides)
      file_.fail(fmt::format("side {} of element {} is not in 1..{}", s + 1, block.first + e + 1, sides),
                 fmt::format("side_ss{}", set.number));
  };
  if (c.shape.kind == ShapeKind::fixed) {
    auto at = std::find_if(out.known.begin(), out.known.end(), [&](const auto& k) { return k.first == &c; });
    if (at == out.known.end()) {
      std::vector<CellSide> sides;
      for (const SideCorners& corners : c.shape.sides) sides.push_back(cell_side(corners, c.shape.nodes));
      at = out.known.emplace(out.known.end(), &c, std::move(sides));
    }
    check(at->second.size());
    const CellSide& side = at->second[size_t(s)];
    out.types.push_back(uint8_t(side.type));
    for (const uint8_t k : side.nodes) out.ids.push_back(zero_based(nodes[e * c.per + k]));
    return;
  }
  const size_t begin = c.begin(e), n = c.end(e) - begin;
  check(n);
  if (c.shape.kind == ShapeKind::polyhedra) {
    if (out.faces.empty()) out.faces = all_faces();
    const int64_t f = nodes[begin + size_t(s)];
    if (f < 1 || size_t(f) > out.faces.size())
      file_.fail(fmt::format("element {} has the face {} of {}", block.first + e + 1, f, out.faces.size()));
    const auto& [faces_of, place] = out.faces[size_t(f) - 1];
    const IndexView corners = index_view(faces_of->ids);
    out.types.push_back(uint8_t(CellType::polygon));
    for (size_t k = faces_of->begin(place); k < faces_of->end(place); ++k) out.ids.push_back(zero_based(corners[k]));
  } else {  // an edge of a polygon, or a point itself
    const bool polygon = c.shape.kind == ShapeKind::polygons;
    out.types.push_back(uint8_t(polygon ? CellType::line : CellType::vertex));
    out.ids.push_back(zero_based(nodes[begin + size_t(s)]));
    if (polygon) out.ids.push_back(zero_based(nodes[begin + (size_t(s) + 1) % n]));
  }
}

DatasetPtr ExodusMesh::side_set(const ExodusObject& o) {
  const auto list = [&](const char* what) {
    const Variable& v = file_.require(fmt::format("{}_ss{}", what, o.number));
    if (!v.is_number() || v.shape.size() != 1 || v.shape[0] != o.size) file_.fail(fmt::format("must hold {} numbers", o.size), v.name);
    return file_.read(v, ElementType::i64);
  };
  const Array element_list = list("elem"), side_list = list("side");
  SideList out;
  for (size_t i = 0; i < o.size; ++i) {
    const int64_t e = zero_based(element_list.view<int64_t>().data[i]);
    const auto after =
        std::upper_bound(elements.begin(), elements.end(), e, [](int64_t n, const ExodusObject& b) { return n < int64_t(b.first); });
    const ExodusObject* block = e < 0 || after == elements.begin() ? nullptr : &after[-1];
    if (!block || size_t(e) - block->first >= block->size)
      file_.fail(fmt::format("side {} is of element {}, which does not exist", i, element_list.view<int64_t>().data[i]),
                 fmt::format("elem_ss{}", o.number));
    add_side(o, *block, size_t(e) - block->first, zero_based(side_list.view<int64_t>().data[i]), out);
    out.offsets.push_back(int64_t(out.ids.size()));
  }
  UnstructuredMesh mesh;
  const bool one_type = std::all_of(out.types.begin(), out.types.end(), [&](uint8_t t) { return t == out.types[0]; });
  if (one_type && out.types[0] != uint8_t(CellType::polygon)) {
    mesh.single_type = CellType(out.types[0]);
    mesh.cells.fixed = int(out.offsets[1]);
  } else {
    mesh.types = Array::from_vector(std::move(out.types));
    mesh.cells.offsets = Array::from_vector(std::move(out.offsets));
  }
  return finish(std::move(mesh), std::move(out.ids), object_fields(o, o.size), o, o.size);
}

}  // namespace sg::nc

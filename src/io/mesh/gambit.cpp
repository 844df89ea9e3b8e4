// SPDX-License-Identifier: Apache-2.0
// GAMBIT neutral files (.neu): nodes, linear elements, groups with their materials ("Material Type"), and sets of nodes with boundary
// conditions ("Boundary Condition": the number of the set from 1, 0 = none). Sets of element sides are left out. Source: GAMBIT
// neutral file format, Fluent Inc.
#include <fmt/core.h>

#include "base/file/file.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/text/mesh_text.h"

namespace sg {

namespace {

struct GambitType {
  CellType cell;
  std::vector<int> from;  ///< of each node of the cell, its place in the file's list; bricks and pyramids run x fastest
};

const GambitType* gambit_type(int64_t type, int64_t nodes) {
  static const std::vector<GambitType> types{{CellType::line, {0, 1}},
                                             {CellType::quad, {0, 1, 2, 3}},
                                             {CellType::triangle, {0, 1, 2}},
                                             {CellType::hexahedron, {0, 1, 3, 2, 4, 5, 7, 6}},
                                             {CellType::wedge, {0, 1, 2, 3, 4, 5}},
                                             {CellType::tetra, {0, 1, 2, 3}},
                                             {CellType::pyramid, {0, 1, 3, 2, 4}}};
  if (type < 1 || type > int64_t(types.size())) return nullptr;
  const GambitType& t = types[size_t(type - 1)];
  return int64_t(t.from.size()) == nodes ? &t : nullptr;
}

struct GambitMesh {
  size_t nodes = 0, elements = 0;
  int64_t dimension = 3;
  std::vector<int64_t> node_ids, element_ids;
  std::vector<double> xyz;
  MixedCells cells;
  std::vector<int32_t> condition, material;
  std::vector<std::pair<std::string, std::string>> notes;
  int sets = 0;
};

void read_header(TextCursor& in, GambitMesh& m) {
  in.line();
  in.line();  // ** GAMBIT NEUTRAL FILE
  const std::string_view title = in.line();
  if (!title.empty()) m.notes.emplace_back("title", std::string(title));
  while (in.peek() != "NUMNP") {
    if (in.at_end()) in.fail("the header has no line of counts", "NUMNP NELEM NGRPS NBSETS NDFCD NDFVL");
    in.line();
  }
  in.line();
  m.nodes = in.count("the number of nodes", 6);
  m.elements = in.count("the number of elements", 6);
  in.count("the number of groups", 1);
  in.count("the number of sets", 1);
  m.dimension = in.integer("the dimension");
  if (m.dimension < 2 || m.dimension > 3) in.fail(fmt::format("dimension {}", m.dimension), "2 or 3");
}

void read_nodes(TextCursor& in, GambitMesh& m) {
  if (!m.node_ids.empty()) in.fail("has a second list of nodes");
  for (size_t i = 0; i < m.nodes; ++i) {
    m.node_ids.push_back(in.integer("the number of a node"));
    for (int64_t a = 0; a < 3; ++a) {
      m.xyz.push_back(a < m.dimension ? in.number("a coordinate") : 0);
      if (!std::isfinite(m.xyz.back())) in.fail("a coordinate is not finite");
    }
  }
  m.condition.assign(m.nodes, 0);
}

void read_elements(TextCursor& in, GambitMesh& m) {
  if (m.node_ids.empty()) in.fail("the elements precede the nodes");
  if (!m.element_ids.empty()) in.fail("has a second list of elements");
  const TagIndex index(m.node_ids);
  std::vector<int64_t> nodes, points;
  for (size_t e = 0; e < m.elements; ++e) {
    m.element_ids.push_back(in.integer("the number of an element"));
    const int64_t type = in.integer("an element type"), n = in.integer("the number of nodes");
    const GambitType* t = gambit_type(type, n);
    if (!t) in.fail(fmt::format("an element of type {} with {} nodes is not supported", type, n), "linear elements are supported");
    nodes.clear(), points.clear();
    for (int64_t k = 0; k < n; ++k) {
      const int64_t id = in.integer("a node");
      nodes.push_back(index.find(id));
      if (nodes.back() < 0) in.fail(fmt::format("node {} does not exist", id));
    }
    for (int k : t->from) points.push_back(nodes[size_t(k)]);
    m.cells.add(t->cell, points);
  }
  m.material.assign(m.elements, 0);
}

// "GROUP: 1 ELEMENTS: 2 MATERIAL: 2 NFLAGS: 1", a name, flags, elements.
void read_group(TextCursor& in, GambitMesh& m, const TagIndex& elements) {
  in.expect("GROUP:");
  const int64_t group = in.integer("a group");
  in.expect("ELEMENTS:");
  const size_t n = in.count("the number of elements", 2);
  in.expect("MATERIAL:");
  const int64_t material = in.integer("a material");
  in.expect("NFLAGS:");
  const size_t flags = in.count("the number of flags", 1);
  in.line();
  m.notes.emplace_back(fmt::format("group {}", group), std::string(in.line()));
  for (size_t i = 0; i < flags; ++i) in.integer("a flag");
  for (size_t i = 0; i < n; ++i) {
    const int64_t id = in.integer("an element"), at = elements.find(id);
    if (at < 0) in.fail(fmt::format("element {} does not exist", id));
    m.material[size_t(at)] = int32_t(material);
  }
}

// "name type entries values ...", then entries: nodes (type 0) or elements with a side (type 1).
void read_conditions(TextCursor& in, GambitMesh& m, const TagIndex& nodes) {
  const std::vector<std::string_view> head = words(in.line());
  if (head.size() < 4) in.fail("a set has no header", "expected: name type entries values");
  const auto type = parse_int(head[1]), entries = parse_int(head[2]), values = parse_int(head[3]);
  if (!type || !entries || !values || *entries < 0 || *values < 0 || uint64_t(*entries) > in.left() / 2 + 1)
    in.fail(fmt::format("a set of {} entries", head[2]));
  ++m.sets;
  m.notes.emplace_back(fmt::format("boundary {}", m.sets), std::string(head[0]));
  for (int64_t i = 0; i < *entries; ++i) {
    in.skip_empty_lines();
    const std::vector<std::string_view> entry = words(in.line());
    const auto id = entry.empty() ? std::nullopt : parse_int(entry[0]);
    if (!id) in.fail("a set ends early");
    if (*type != 0) continue;
    const int64_t at = nodes.find(*id);
    if (at < 0) in.fail(fmt::format("node {} does not exist", *id));
    m.condition[size_t(at)] = m.sets;
  }
}

}  // namespace

bool sniff_gambit(std::span<const std::byte> head) {
  std::string_view s(reinterpret_cast<const char*>(head.data()), head.size());
  const size_t end = s.find('\n');
  if (end == std::string_view::npos || !trim(s.substr(0, end)).starts_with("CONTROL INFO")) return false;
  return trim(s.substr(end + 1)).starts_with("** GAMBIT NEUTRAL FILE");
}

Data read_gambit(const std::string& path, const ReadOptions&, Context&) {
  const MappedFile file(path);
  TextCursor in(file.text(), path);
  GambitMesh m;
  read_header(in, m);
  while (!in.at_end()) {
    const std::string_view section = in.line();
    if (section.starts_with("NODAL COORDINATES")) read_nodes(in, m);
    else if (section.starts_with("ELEMENTS/CELLS")) read_elements(in, m);
    else if (section.starts_with("ELEMENT GROUP")) read_group(in, m, TagIndex(m.element_ids));
    else if (section.starts_with("BOUNDARY CONDITIONS")) read_conditions(in, m, TagIndex(m.node_ids));
  }
  if (m.node_ids.empty() || (m.elements > 0 && m.element_ids.empty())) in.fail("the file ends before its nodes and elements");
  UnstructuredMesh mesh;
  m.cells.finish(mesh);
  mesh.points.xyz = Array::from_vector(std::move(m.xyz), 3);
  DatasetParts parts;
  parts.mesh = std::move(mesh);
  if (m.sets > 0) {
    Field f;
    f.name = "Boundary Condition";
    f.array = Array::from_vector(std::move(m.condition));
    f.role = Role::labels;
    parts.fields.add(std::move(f));
  }
  parts.fields.add(cell_ids("Material Type", std::move(m.material)));
  parts.notes = std::move(m.notes);
  return make_dataset(std::move(parts));
}

}  // namespace sg

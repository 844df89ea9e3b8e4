// SPDX-License-Identifier: Apache-2.0
// Non-conforming meshes (a tree of refined elements; the leaves are the mesh) and meshes that are made from a few numbers.
#include <fmt/core.h>

#include <algorithm>

#include "base/text/text.h"
#include "io/mfem/mesh_file.h"

namespace sg::mfem {

namespace {

// Positions of all nodes: given for the coarsest ones, else halfway between two parents.
void place_nodes(TextCursor& in, MeshFile& mesh, const std::vector<std::array<int64_t, 3>>& parents, std::vector<double> top) {
  Topology& t = mesh.topology;
  const auto d = size_t(mesh.space_dimension);
  int64_t n = int64_t(top.size() / d);
  for (int64_t v : t.corners) n = std::max(n, v + 1);
  for (const auto& p : parents)
    for (int64_t v : p) n = std::max(n, v + 1);
  if (uint64_t(n) > in.text().size()) in.fail(fmt::format("node {} in a file of {} bytes", n - 1, in.text().size()));
  t.vertices = n;
  enum : uint8_t { unknown, open, known };
  std::vector<uint8_t> state(size_t(n), unknown);
  std::vector<int64_t> record(size_t(n), -1);
  mesh.coordinates.assign(size_t(n) * d, std::nan(""));
  std::copy(top.begin(), top.end(), mesh.coordinates.begin());
  std::fill_n(state.begin(), top.size() / d, known);
  for (size_t i = 0; i < parents.size(); ++i)
    if (state[size_t(parents[i][0])] != known) record[size_t(parents[i][0])] = int64_t(i);
  std::vector<int64_t> stack;
  for (int64_t v : t.corners) {
    stack.assign(1, v);
    while (!stack.empty()) {
      const auto at = size_t(stack.back());
      if (state[at] == known) {
        stack.pop_back();
        continue;
      }
      if (record[at] < 0) in.fail(fmt::format("node {} has neither coordinates nor parents", at));
      const auto& p = parents[size_t(record[at])];
      if (state[at] == open) {
        for (size_t a = 0; a < d; ++a)
          mesh.coordinates[at * d + a] = (mesh.coordinates[size_t(p[1]) * d + a] + mesh.coordinates[size_t(p[2]) * d + a]) / 2;
        state[at] = known;
        stack.pop_back();
        continue;
      }
      state[at] = open;
      for (int64_t q : {p[1], p[2]}) {
        if (state[size_t(q)] == open) in.fail(fmt::format("node {} is its own ancestor", q));
        if (state[size_t(q)] == unknown) stack.push_back(q);
      }
    }
  }
}

// Only the vertices of the leaves stay, in their order.
void drop_unused(MeshFile& mesh) {
  Topology& t = mesh.topology;
  const auto d = size_t(mesh.space_dimension);
  std::vector<int64_t> number(size_t(t.vertices), -1);
  for (int64_t v : t.corners) number[size_t(v)] = 0;
  std::vector<double> kept;
  int64_t next = 0;
  for (size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = next++;
    kept.insert(kept.end(), mesh.coordinates.begin() + ptrdiff_t(v * d), mesh.coordinates.begin() + ptrdiff_t(v * d + d));
  }
  for (int64_t& v : t.corners) v = number[size_t(v)];
  t.vertices = next;
  mesh.coordinates = std::move(kept);
}

// "expected: rank attribute geometry refinement nodes", or children where refined: only leaves are kept.
void parse_tree_element(TextCursor& in, Topology& t) {
  std::vector<int64_t> v;
  for (std::string_view word : words(in.line())) {
    const auto i = parse_int(word);
    if (!i) in.fail(fmt::format("'{}' in an element", word.substr(0, 40)), "expected: rank attribute geometry refinement nodes");
    v.push_back(*i);
  }
  if (v.size() < 4 || v[3] != 0) return;  // not used any more, or refined
  if (v[2] < 0 || v[2] >= geometry_count || info(Geometry(v[2])).dimension != t.dimension)
    in.fail(fmt::format("an element has geometry {} in a mesh of dimension {}", v[2], t.dimension));
  const auto corners = size_t(info(Geometry(v[2])).corners);
  if (v.size() != 4 + corners) in.fail(fmt::format("an element has {} nodes", v.size() - 4), fmt::format("it needs {}", corners));
  for (size_t k = 4; k < v.size(); ++k) {
    if (v[k] < 0 || uint64_t(v[k]) > in.text().size()) in.fail(fmt::format("node {} does not exist", v[k]));
    t.corners.push_back(v[k]);
  }
  t.geometry.push_back(Geometry(v[2]));
  t.attribute.push_back(int32_t(std::clamp<int64_t>(v[1], INT32_MIN, INT32_MAX)));
  t.begin.push_back(t.corners.size());
}

}  // namespace

void parse_nonconforming(TextCursor& in, MeshFile& mesh) {
  Topology& t = mesh.topology;
  std::vector<std::array<int64_t, 3>> parents;
  bool elements = false;
  while (!in.at_end()) {
    const std::string_view w = in.word();
    if (w == "rank") {
      in.line();
    } else if (w == "elements") {
      const size_t n = in.count("the number of elements", 3);
      elements = true;
      for (size_t e = 0; e < n; ++e) {
        in.skip_empty_lines();
        if (in.at_end()) in.fail(fmt::format("the list of elements ends after {} of {}", e, n));
        parse_tree_element(in, t);
      }
    } else if (w == "boundary") {
      parse_elements(in, t, false);
    } else if (w == "vertex_parents") {
      parents.resize(in.count("the number of nodes with parents", 6));
      for (auto& p : parents)
        for (int64_t& v : p)
          if ((v = in.integer("a node")) < 0) in.fail(fmt::format("node {} does not exist", v));
    } else if (w == "root_state") {
      const size_t n = in.count("the number of roots", 2);
      for (size_t i = 0; i < n; ++i) in.integer("the state of a root");
    } else if (w == "coordinates") {
      const size_t n = in.count("the number of nodes", 2);
      const int64_t d = in.integer("the dimension of space");
      if (d < 1 || d > 3) in.fail(fmt::format("space has dimension {}", d), "1, 2 or 3");
      mesh.space_dimension = int(d);
      if (!elements) in.fail("the coordinates precede the elements");
      place_nodes(in, mesh, parents, parse_values(in, n * size_t(d)));
      drop_unused(mesh);
      return;
    } else if (w == "nodes") {
      in.fail("non-conforming meshes with curved elements are not supported", "save it with linear elements, or as a conforming mesh");
    } else {
      in.fail(fmt::format("found '{}' where a section was expected", w.substr(0, 40)),
              "use elements, boundary, vertex_parents or coordinates");
    }
  }
  in.fail("the mesh has no coordinates");
}

namespace {

using Corners = std::vector<std::array<int, 8>>;

// How the elements of each type fill one box of corners 0..7 (8 is its middle).
Corners box_split(std::string_view type) {
  if (type == "quad" || type == "hex") return {{0, 1, 2, 3, 4, 5, 6, 7}};
  if (type == "segment") return {{0, 1}};
  if (type == "tri") return {{0, 1, 2}, {0, 2, 3}};
  if (type == "wedge") return {{0, 1, 2, 4, 5, 6}, {0, 2, 3, 4, 6, 7}};
  if (type == "pyramid") return {{0, 1, 2, 3, 8}, {4, 7, 6, 5, 8}, {0, 4, 5, 1, 8}, {1, 5, 6, 2, 8}, {2, 6, 7, 3, 8}, {3, 7, 4, 0, 8}};
  return {{0, 1, 2, 6}, {0, 5, 1, 6}, {0, 4, 5, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}};  // around the diagonal 0-6
}

// n[a] boxes along each axis, each cut into elements of one type.
void fill_box(MeshFile& mesh, Geometry geometry, std::string_view type, std::array<int64_t, 3> n, std::array<double, 3> size) {
  Topology& t = mesh.topology;
  const GeometryInfo& g = info(geometry);
  const int d = g.dimension;
  const std::array<int64_t, 3> p{n[0] + 1, n[1] + 1, n[2] + 1};
  auto add_point = [&](double i, double j, double k) {
    const double at[3] = {i, j, k};
    for (int a = 0; a < d; ++a) mesh.coordinates.push_back(size[size_t(a)] * at[a] / double(n[size_t(a)]));
    return t.vertices++;
  };
  for (int64_t k = 0; k < p[2]; ++k)
    for (int64_t j = 0; j < p[1]; ++j)
      for (int64_t i = 0; i < p[0]; ++i) add_point(double(i), double(j), double(k));
  const Corners split = box_split(type);
  for (int64_t k = 0; k < std::max<int64_t>(n[2], 1); ++k)
    for (int64_t j = 0; j < std::max<int64_t>(n[1], 1); ++j)
      for (int64_t i = 0; i < n[0]; ++i) {
        int64_t box[9];
        for (int c = 0; c < 8; ++c) {
          const int64_t dx = c % 4 == 1 || c % 4 == 2, dy = c % 4 > 1, dz = c > 3;
          box[c] = i + dx + p[0] * (j + dy + p[1] * (k + dz));
        }
        if (geometry == Geometry::pyramid) box[8] = add_point(double(i) + 0.5, double(j) + 0.5, double(k) + 0.5);
        for (const auto& part : split) {
          for (int c = 0; c < g.corners; ++c) t.corners.push_back(box[part[size_t(c)]]);
          t.geometry.push_back(geometry);
          t.attribute.push_back(1);
          t.begin.push_back(t.corners.size());
        }
      }
}

}  // namespace

void parse_inline(TextCursor& in, MeshFile& mesh) {
  in.expect("mesh");
  in.line();
  std::string type;
  std::array<int64_t, 3> n{0, 0, 0};
  std::array<double, 3> size{1, 1, 1};
  while (!in.at_end()) {
    const std::string name = to_lower(std::string(in.word()));
    if (name == "mfem_mesh_end" || name == "finiteelementspace") break;
    in.expect("=");
    if (name == "type") {
      type = std::string(in.word());
      continue;
    }
    const size_t axis = name.size() == 2 && name[1] >= 'x' && name[1] <= 'z' ? size_t(name[1] - 'x') : 3;
    if (axis > 2 || (name[0] != 'n' && name[0] != 's'))
      in.fail(fmt::format("unknown parameter '{}'", name), "type, nx, ny, nz, sx, sy, sz");
    if (name[0] == 'n') n[axis] = in.integer("a number of elements");
    else size[axis] = in.number("a length");
  }
  struct Kind {
    const char* name;
    Geometry geometry;
  };
  static constexpr Kind kinds[] = {{"segment", Geometry::segment}, {"quad", Geometry::square},     {"tri", Geometry::triangle},
                                   {"hex", Geometry::cube},        {"tet", Geometry::tetrahedron}, {"wedge", Geometry::prism},
                                   {"pyramid", Geometry::pyramid}};
  const auto* kind = std::find_if(std::begin(kinds), std::end(kinds), [&](const Kind& k) { return type == k.name; });
  if (kind == std::end(kinds)) in.fail(fmt::format("type '{}'", type), "use segment, tri, quad, tet, hex, wedge or pyramid");
  Topology& t = mesh.topology;
  const GeometryInfo& g = info(kind->geometry);
  const int d = t.dimension = mesh.space_dimension = g.dimension;
  uint64_t cells = 1;
  for (int a = 0; a < 3; ++a) {
    if (a >= d) n[size_t(a)] = 0;
    else if (n[size_t(a)] < 1 || n[size_t(a)] > 100000) in.fail(fmt::format("n{} is {}", char('x' + a), n[size_t(a)]), "give 1 or more");
    else cells *= uint64_t(n[size_t(a)]);
    if (!(std::fabs(size[size_t(a)]) <= 1e300)) in.fail("a length is not finite");
  }
  if (cells > 4000000) in.fail(fmt::format("the few numbers of the file describe {} elements", cells), "at most 4 million are allowed");

  fill_box(mesh, kind->geometry, type, n, size);
}

}  // namespace sg::mfem

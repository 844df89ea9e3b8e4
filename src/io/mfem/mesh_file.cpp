// SPDX-License-Identifier: Apache-2.0
#include "io/mfem/mesh_file.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/text/text.h"
#include "io/mfem/vector_numbering.h"

namespace sg::mfem {

void parse_elements(TextCursor& in, Topology& t, bool keep) {
  const size_t n = in.count("the number of elements", 4);
  for (size_t e = 0; e < n; ++e) {
    const int64_t attribute = in.integer("an attribute");
    const int64_t g = in.integer("a geometry");
    if (g < 0 || g >= geometry_count) in.fail(fmt::format("there is no geometry {}", g), "geometries run from 0, a point, to 7, a pyramid");
    const GeometryInfo& i = info(Geometry(g));
    if (keep && i.dimension != t.dimension)
      in.fail(fmt::format("an element has dimension {} in a mesh of dimension {}", i.dimension, t.dimension));
    for (int k = 0; k < i.corners; ++k) {
      const int64_t v = in.integer("a vertex");
      if (v < 0) in.fail(fmt::format("vertex {} does not exist", v));
      if (keep) t.corners.push_back(v);
    }
    if (!keep) continue;
    t.geometry.push_back(Geometry(g));
    t.attribute.push_back(int32_t(std::clamp<int64_t>(attribute, INT32_MIN, INT32_MAX)));
    t.begin.push_back(t.corners.size());
  }
}

FeSpace parse_space(TextCursor& in) {
  FeSpace s;
  bool versioned = false;
  if (in.peek() == "MFEM") {  // "MFEM FiniteElementSpace v1.0"
    in.word();
    versioned = true;
  }
  in.expect("FiniteElementSpace");
  if (versioned) in.word();
  in.expect("FiniteElementCollection:");
  s.collection = parse_collection(in.word(), fmt::format("{}, line {}", in.where(), in.line_now()));
  in.expect("VDim:");
  const int64_t vdim = in.integer("the number of components");
  if (vdim < 1 || vdim > 64) in.fail(fmt::format("VDim is {}", vdim), "1 to 64 components are supported");
  s.vdim = int(vdim);
  in.expect("Ordering:");
  const int64_t ordering = in.integer("the ordering");
  if (ordering < 0 || ordering > 1) in.fail(fmt::format("Ordering is {}", ordering), "0 is byNODES, 1 is byVDIM");
  s.by_vdim = ordering == 1;
  if (is_vector_valued(s.collection) && s.vdim > 1)
    in.fail(fmt::format("VDim is {} with the vector-valued collection '{}'", s.vdim, s.collection.name), "one is supported");
  while (versioned) {
    const std::string_view w = in.word();
    if (w.empty()) in.fail("the space has no end line", "expected the line 'End: MFEM FiniteElementSpace v1.0'");
    if (w == "End:") {
      in.line();
      break;
    }
    if (w.starts_with("NURBS") || w.starts_with("Element") || w.starts_with("Variable"))
      in.fail(fmt::format("the space has '{}'", w), "only spaces with one order for all elements are supported");
  }
  return s;
}

size_t space_size(const Topology& t, const FeCollection& c, const std::string& where) {
  switch (c.family) {
    case Family::h1: return Numbering(t, c.order, where).size();
    case Family::l2: {
      size_t n = 0;
      for (Geometry g : t.geometry) n += element_dofs(g, c);
      return n;
    }
    case Family::nurbs: fail_data(fmt::format("the space '{}' needs a NURBS mesh", c.name), where);
    case Family::nd:
    case Family::rt: return VectorNumbering(t, c, where).size();
  }
  fail_internal("mfem: a family of collections that is not known");
}

std::vector<double> parse_values(TextCursor& in, size_t n) {
  if (n > in.left() / 2 + 1) in.fail(fmt::format("{} values should follow, but only {} bytes are left", n, in.left()));
  std::vector<double> v(n);
  for (double& x : v) x = in.number("a value");
  return v;
}

namespace {

void check_vertices(TextCursor& in, const Topology& t) {
  for (int64_t v : t.corners)
    if (v >= t.vertices) in.fail(fmt::format("an element has vertex {}, but there are {} (from 0)", v, t.vertices));
}

// Behind the word "nodes", or at "FiniteElementSpace".
void parse_nodes(TextCursor& in, MeshFile& mesh) {
  GridFunction f;
  f.space = parse_space(in);
  if (f.space.vdim > 3) in.fail(fmt::format("positions have {} components", f.space.vdim));
  const FeCollection& c = f.space.collection;
  if (c.family == Family::l2 && c.order == 0) in.fail("the positions are constant on each element");
  if (is_vector_valued(c)) in.fail(fmt::format("the positions are in the collection '{}'", c.name), "H1 or L2 collections hold positions");
  f.values = parse_values(in, space_size(mesh.topology, c, in.where()) * size_t(f.space.vdim));
  mesh.space_dimension = f.space.vdim;
  mesh.nodes = std::move(f);
}

void parse_vertices(TextCursor& in, MeshFile& mesh) {
  Topology& t = mesh.topology;
  const int64_t n = in.integer("the number of vertices");
  // Each vertex of an element is written at least once, so no file has more than bytes; periodic meshes list fewer.
  if (n < 0 || uint64_t(n) > in.text().size()) in.fail(fmt::format("{} vertices in a file of {} bytes", n, in.text().size()));
  t.vertices = n;
  check_vertices(in, t);
  if (in.peek() == "nodes") {
    in.word();
    return parse_nodes(in, mesh);
  }
  const int64_t d = in.integer("the dimension of space");
  if (d < 1 || d > 3) in.fail(fmt::format("space has dimension {}", d), "1, 2 or 3");
  mesh.space_dimension = int(d);
  mesh.coordinates = parse_values(in, size_t(n) * size_t(d));
  if (in.peek() == "nodes") {  // both are there: the nodes are the better ones
    in.word();
    parse_nodes(in, mesh);
  }
}

// Skips "attribute_sets" and the like: everything up to the next known section.
void skip_to_section(TextCursor& in) {
  while (!in.at_end()) {
    const std::string_view w = in.peek();
    if (w == "boundary" || w == "vertices" || w == "vertex_parents" || w == "coarse_elements" || w == "bdr_attribute_sets") return;
    in.line();
  }
}

}  // namespace

MeshFile parse_mesh(TextCursor& in) {
  MeshFile mesh;
  in.expect("MFEM");
  const std::string_view kind = in.word();
  if (kind == "INLINE") {
    parse_inline(in, mesh);
    return mesh;
  }
  const bool nurbs = kind == "NURBS", nonconforming = kind == "NC";
  if (nurbs || nonconforming) in.expect("mesh");
  else if (kind != "mesh")
    in.fail(fmt::format("'MFEM {}' is not a supported mesh", kind), "supported: 'MFEM mesh', 'MFEM NC mesh', 'MFEM NURBS mesh'");
  const std::string_view version = in.word();
  if (!version.starts_with("v1.")) in.fail(fmt::format("version '{}'", version), "versions v1.0 to v1.3 are supported");
  in.expect("dimension");
  Topology& t = mesh.topology;
  const int64_t d = in.integer("the dimension");
  if (d < 1 || d > 3) in.fail(fmt::format("the mesh has dimension {}", d), "1, 2 or 3");
  t.dimension = int(d);
  if (nonconforming) {
    parse_nonconforming(in, mesh);
    return mesh;
  }
  if (nurbs) {
    parse_nurbs(in, mesh);
    return mesh;
  }
  in.expect("elements");
  parse_elements(in, t, true);
  bool refined = false;
  while (!in.at_end()) {
    const std::string_view w = in.peek();
    if (w == "boundary") {
      in.word();
      parse_elements(in, t, false);
    } else if (w == "attribute_sets" || w == "bdr_attribute_sets") {
      in.word();
      skip_to_section(in);
    } else if (w == "vertex_parents") {
      in.word();
      refined = true;
      const size_t n = in.count("the number of vertices with parents", 6);
      for (size_t i = 0; i < 3 * n; ++i) in.integer("a vertex");
    } else if (w == "coarse_elements") {
      in.word();
      refined = true;
      skip_to_section(in);
    } else if (w == "vertices") {
      in.word();
      parse_vertices(in, mesh);
      if (refined && mesh.nodes)
        in.fail("non-conforming meshes with curved elements are not supported", "save it with linear elements, or as a conforming mesh");
      return mesh;
    } else {
      in.fail(fmt::format("found '{}' where a section was expected", w.substr(0, 40)), "use boundary or vertices");
    }
  }
  in.fail("the mesh has no vertices");
}

}  // namespace sg::mfem

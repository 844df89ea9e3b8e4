// SPDX-License-Identifier: Apache-2.0
// The text of NURBS meshes: patches by their corners, knot vectors by edges, and control points either numbered over the whole mesh
// (vertices, then the insides of edges, faces and patches) or patch by patch.
#include <fmt/core.h>

#include "base/text/text.h"
#include "io/mfem/mesh_file.h"

namespace sg::mfem {

namespace {

KnotVector parse_knots(TextCursor& in) {
  KnotVector k;
  const int64_t order = in.integer("the order of a knot vector");
  if (order < 1 || order > 10) in.fail(fmt::format("a knot vector has order {}", order), "orders 1 to 10 are supported");
  k.order = int(order);
  const size_t points = in.count("the number of control points", 2), n = points + size_t(order) + 1;
  if (points < size_t(order) + 1) in.fail(fmt::format("a knot vector has {} control points for order {}", points, order));
  k.knots = parse_values(in, n);
  const auto& u = k.knots;
  for (size_t i = 0; i + 1 < n; ++i)
    if (!(u[i] <= u[i + 1])) in.fail("a knot vector decreases");
  const auto p = size_t(order);
  if (!(u[0] == u[p]) || !(u[n - 1] == u[n - 1 - p]))
    in.fail("the end of a knot vector is not repeated", fmt::format("order {} needs the first and last knot {} times", order, p + 1));
  for (size_t i = 1; i + p + 1 < n; ++i)
    if (u[i] == u[i + p] && u[i] > u[0] && u[i] < u[n - 1])
      in.fail("a knot is repeated so often that the patch falls apart", fmt::format("interior knots may occur at most {} times", p));
  return k;
}

void parse_edges(TextCursor& in, NurbsMesh& n) {
  const size_t count = in.count("the number of edges", 6);
  for (size_t e = 0; e < count; ++e) {
    const int64_t knots = in.integer("a knot vector");
    if (knots < 0 || uint64_t(knots) > in.text().size()) in.fail(fmt::format("knot vector {} does not exist", knots));
    const int64_t a = in.integer("a vertex"), b = in.integer("a vertex");
    n.edge_knots.push_back(int(knots));
    n.edge_vertices.push_back({a, b});
  }
}

void parse_patches(TextCursor& in, const Topology& t, NurbsMesh& n, int& space_dimension) {
  for (size_t e = 0; e < t.size(); ++e) {
    NurbsMesh::Patch patch;
    in.expect("knotvectors");
    if (in.integer("the number of knot vectors") != t.dimension) in.fail("a patch needs one knot vector per dimension");
    uint64_t points = 1;
    for (int a = 0; a < t.dimension; ++a) {
      patch.knots.push_back(parse_knots(in));
      points *= patch.knots.back().control_points();
      if (points > in.text().size()) in.fail(fmt::format("a patch of more than {} control points", points));
    }
    in.expect("dimension");
    const int64_t d = in.integer("the dimension of space");
    if (d < 1 || d > 3 || (space_dimension && d != space_dimension)) in.fail(fmt::format("space has dimension {}", d));
    space_dimension = int(d);
    const std::string_view kind = in.word();
    if (kind != "controlpoints" && kind != "controlpoints_homogeneous" && kind != "controlpoints_cartesian")
      in.fail(fmt::format("found '{}' where 'controlpoints' was expected", kind));
    patch.points = parse_values(in, size_t(points) * size_t(d + 1));
    if (kind != "controlpoints_cartesian")
      for (size_t i = 0; i < patch.points.size(); i += size_t(d + 1))
        for (size_t a = 0; a < size_t(d); ++a) patch.points[i + a] /= patch.points[i + size_t(d)];
    n.patches.push_back(std::move(patch));
  }
}

}  // namespace

void parse_nurbs(TextCursor& in, MeshFile& mesh) {
  Topology& t = mesh.topology;
  mesh.nurbs.emplace();
  NurbsMesh& n = *mesh.nurbs;
  bool numbered = false;
  auto finish_topology = [&] {
    if (numbered) return;
    if (t.size() == 0) in.fail("the mesh has no elements");
    for (Geometry g : t.geometry)
      if (g != Geometry::segment && g != Geometry::square && g != Geometry::cube)
        in.fail("a NURBS patch must be a segment, square or cube");
    for (int64_t v : t.corners)
      if (v >= t.vertices) in.fail(fmt::format("a patch has vertex {}, but there are {} (from 0)", v, t.vertices));
    number_entities(t);
    numbered = true;
  };
  while (!in.at_end()) {
    const std::string_view w = in.peek();
    if (w == "FiniteElementSpace" || w == "MFEM") break;
    in.word();
    if (w == "elements") {
      parse_elements(in, t, true);
    } else if (w == "boundary") {
      parse_elements(in, t, false);
    } else if (w == "edges") {
      parse_edges(in, n);
    } else if (w == "vertices") {
      const int64_t v = in.integer("the number of vertices");
      if (v < 0 || uint64_t(v) > in.text().size()) in.fail(fmt::format("{} vertices in a file of {} bytes", v, in.text().size()));
      t.vertices = v;
    } else if (w == "knotvectors") {
      const size_t k = in.count("the number of knot vectors", 8);
      for (size_t i = 0; i < k; ++i) n.knots.push_back(parse_knots(in));
    } else if (w == "weights") {
      finish_topology();
      n.weights = parse_values(in, nurbs_size(mesh, in.where()));
    } else if (w == "patches") {
      finish_topology();
      parse_patches(in, t, n, mesh.space_dimension);
      return;
    } else {
      in.fail(fmt::format("the section '{}' of a NURBS mesh is not supported", w.substr(0, 40)),
              "supported: elements, boundary, edges, vertices, knotvectors, weights, patches");
    }
  }
  finish_topology();
  GridFunction f;
  f.space = parse_space(in);
  if (f.space.collection.family != Family::nurbs || f.space.vdim > 3)
    in.fail("the positions of a NURBS mesh must be NURBS of up to 3 components");
  const size_t points = nurbs_size(mesh, in.where());
  if (n.weights.empty()) n.weights.assign(points, 1.0);
  f.values = parse_values(in, points * size_t(f.space.vdim));
  mesh.space_dimension = f.space.vdim;
  mesh.nodes = std::move(f);
}

}  // namespace sg::mfem

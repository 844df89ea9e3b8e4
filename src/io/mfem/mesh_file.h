// SPDX-License-Identifier: Apache-2.0
// MFEM meshes and grid functions as their files hold them.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"
#include "io/mfem/topology.h"
#include "io/text/mesh_text.h"

namespace sg::mfem {

struct FeSpace {
  FeCollection collection;
  int vdim = 1;
  bool by_vdim = false;  ///< the components of a node lie together ("Ordering: 1")
};

struct GridFunction {
  std::string name;
  FeSpace space;
  std::vector<double> values;  ///< vdim numbers per degree of freedom
  size_t dofs() const { return values.size() / size_t(space.vdim); }
  double get(size_t dof, int component) const {
    return values[space.by_vdim ? dof * size_t(space.vdim) + size_t(component) : size_t(component) * dofs() + dof];
  }
};

struct KnotVector {
  int order = 1;
  std::vector<double> knots;
  size_t control_points() const { return knots.size() - size_t(order) - 1; }
};

/// What a NURBS mesh has besides its topology: one knot vector per edge direction, and weights per control point, or whole patches.
struct NurbsMesh {
  std::vector<std::array<int64_t, 2>> edge_vertices;  ///< as the file lists them
  std::vector<int> edge_knots;                        ///< knot vector of each edge; it runs from the first vertex to the second
  std::vector<KnotVector> knots;
  std::vector<double> weights;
  struct Patch {
    std::vector<KnotVector> knots;
    std::vector<double> points;  ///< x, y, (z), w each, first direction fastest; not yet multiplied by w
  };
  std::vector<Patch> patches;
};

struct MeshFile {
  Topology topology;
  int space_dimension = 0;
  std::vector<double> coordinates;    ///< of the vertices; empty when there are nodes
  std::optional<GridFunction> nodes;  ///< positions
  std::optional<NurbsMesh> nurbs;
};

/// Reads a mesh from its first line ("MFEM mesh v1.0", ...) on. Throws Error(data).
MeshFile parse_mesh(TextCursor& in);
/// The body of a NURBS mesh, behind "dimension D".
void parse_nurbs(TextCursor& in, MeshFile& mesh);
/// Non-conforming and INLINE meshes, behind the first line.
void parse_nonconforming(TextCursor& in, MeshFile& mesh);
void parse_inline(TextCursor& in, MeshFile& mesh);
/// "attribute geometry vertices..." lines; for boundaries the lines are read and left out.
void parse_elements(TextCursor& in, Topology& t, bool keep);

/// "FiniteElementSpace ... " up to its values.
FeSpace parse_space(TextCursor& in);
/// Number of degrees of freedom of one component.
size_t space_size(const Topology& t, const FeCollection& c, const std::string& where);
std::vector<double> parse_values(TextCursor& in, size_t n);
/// Everything of a NURBS mesh and fields on it as rational Bezier cells.
DatasetPtr nurbs_dataset(const MeshFile& mesh, const std::vector<GridFunction>& fields, const std::string& where);
/// Number of control points of a NURBS mesh.
size_t nurbs_size(const MeshFile& mesh, const std::string& where);
/// A mesh and fields on it as Lagrange cells.
DatasetPtr lagrange_dataset(const MeshFile& mesh, const std::vector<GridFunction>& fields, const std::string& where, Context& context);

}  // namespace sg::mfem

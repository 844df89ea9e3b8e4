// SPDX-License-Identifier: Apache-2.0
// Lines along which two vector fields are parallel (Peikert, Roth 1999), exact for fields that are linear in tetrahedra.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

/// Tetrahedra represent all other solid cells: their faces in triangles (diagonals from the smallest id, so that neighbours agree) joined
/// to the cell's middle, where fields are the mean of its corners. Curved cells count by their corners.
struct ParallelPoint {
  Vec3 at;
  uint32_t first = 0, count = 0;  ///< of its ids and weights
  int64_t cell = -1;              ///< the smallest cell that has it
  double ratio = 0;               ///< a = ratio * b
};
struct ParallelLines {
  std::vector<ParallelPoint> points;
  std::vector<int64_t> ids;  ///< of the mesh's points, and their weights
  std::vector<double> weights;
  std::vector<uint32_t> segments;  ///< two points each
  std::vector<int64_t> cells;      ///< per segment
};

/// `a` and `b`: one vector per point of the mesh. Points lie on the faces of the tetrahedra, where a s = ratio b s is an eigenproblem of
/// 3x3; within a tetrahedron the line is one curve over the ratio, so points that follow each other in it are joined when the place
/// half way is inside. What lies on an edge or a corner, |a x b| being at most `nothing` of the product of the largest a and b in the
/// cells around, is one point of all cells there, and lines may run in faces and along edges. Hidden cells are left out; so are tetrahedra
/// with NaN, and faces on which the fields are parallel everywhere. The same for any number of threads. Throws Error(usage) for a mesh
/// without solid cells.
ParallelLines parallel_lines(const DatasetPtr& data, std::span<const Vec3> a, std::span<const Vec3> b, Context& context,
                             double nothing = 1e-9);

/// For numbers of this type: rounding puts a line this far off an edge that it runs along.
inline double parallel_within(ElementType t) { return t == ElementType::f64 ? 1e-9 : 1e-5; }

/// As a SurfaceMesh of poly-lines; the fields of `data` at the points, cell fields as point fields, and `more`: one number a point.
struct PointNumbers {
  std::string name;
  std::vector<double> values;
};
DatasetPtr parallel_lines_mesh(const DatasetPtr& data, const ParallelLines& lines, Context& context, std::vector<PointNumbers> more = {});

struct ParallelVectorsParams {
  FieldName a, b;
};
inline void describe(Schema& s, ParallelVectorsParams& p) {
  s("a", p.a, "First vector field; default: the active vectors.").takes(fields::vectors);
  s("b", p.b, "Second vector field, parallel or opposite to the first on the lines.").takes(fields::vectors);
}
/// Poly-lines with the fields of the input and "parallel ratio" (a over b).
Data parallel_vectors(const Data& in, const ParallelVectorsParams& p, Context& context);

/// f of each mesh; several results as one mesh.
Data each_flow_mesh(const std::vector<DatasetPtr>& meshes, const std::function<DatasetPtr(const DatasetPtr&)>& f, Context& context);

/// A vector field's values at the points of the mesh, in double; cell fields averaged.
std::vector<Vec3> point_vectors(const DatasetPtr& in, const Field& field, Context& context);

}  // namespace sg

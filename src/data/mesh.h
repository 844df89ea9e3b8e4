// SPDX-License-Identifier: Apache-2.0
// The mesh kinds. Plain structs that are checked once, by make_dataset(), and never change afterwards.
//
// Lattices number their points x fastest: id = i + nx*(j + ny*k); their cells likewise with max(n-1, 1) cells per axis, so an
// axis with one point makes a 2D, 1D or 0D lattice (a cell is a hexahedron, quad, line or vertex accordingly).
#pragma once
#include <array>
#include <string_view>
#include <variant>
#include <vector>

#include "base/vec.h"
#include "data/array.h"
#include "data/cells/cell_type.h"

namespace sg {

/// Positions: origin + xyz. Data far from zero keeps a double origin and small f32 offsets, so that it does not jitter.
struct Points {
  Array xyz;  ///< f32 or f64, 3 components
  Vec3 origin{0, 0, 0};
  size_t count() const { return xyz.count(); }
  Vec3 at(size_t i) const { return {origin.x + xyz.get(i, 0), origin.y + xyz.get(i, 1), origin.z + xyz.get(i, 2)}; }
};

/// Lists of point ids, one list per cell. `offsets` has size()+1 entries from 0, or is empty when every cell has `fixed` points.
struct CellArray {
  Array connectivity;  ///< i32 or i64
  Array offsets;       ///< i32 or i64, size()+1 entries; empty when fixed > 0
  int fixed = 0;

  size_t size() const { return fixed > 0 ? connectivity.count() / size_t(fixed) : offsets.count() > 0 ? offsets.count() - 1 : 0; }
};

/// What kernels see of a CellArray.
struct CellsView {
  IndexView connectivity, offsets;
  size_t count = 0;
  int fixed = 0;
  size_t begin(size_t cell) const { return fixed > 0 ? cell * size_t(fixed) : size_t(offsets[cell]); }
  size_t end(size_t cell) const { return fixed > 0 ? (cell + 1) * size_t(fixed) : size_t(offsets[cell + 1]); }
  size_t size(size_t cell) const { return end(cell) - begin(cell); }
  int64_t point(size_t cell, size_t k) const { return connectivity[begin(cell) + k]; }
};
IndexView index_view(const Array& a);
CellsView cells_view(const CellArray& a);

struct UniformGrid {
  std::array<size_t, 3> dims{1, 1, 1};  ///< points per axis
  Vec3 origin{0, 0, 0};                 ///< position of point (0,0,0)
  Vec3 spacing{1, 1, 1};
  Mat3 direction;                                  ///< columns are the directions of the axes: p = origin + direction * (spacing * (i,j,k))
  std::array<long long, 3> extent_start{0, 0, 0};  ///< index of the first point in the file's whole extent
};

struct RectilinearGrid {
  Array x, y, z;  ///< f32 or f64, ascending or descending, one component
  std::array<size_t, 3> dims() const { return {x.count(), y.count(), z.count()}; }
  std::array<long long, 3> extent_start{0, 0, 0};
};

struct CurvilinearGrid {
  std::array<size_t, 3> dims{1, 1, 1};
  Points points;  ///< dims[0]*dims[1]*dims[2]
  std::array<long long, 3> extent_start{0, 0, 0};
};

/// Any cells. `types` has one u8 (CellType) per cell, or is empty when all are `single_type`.
/// Polyhedra: cell c has the faces polyhedron_faces[c]..polyhedron_faces[c+1], each a list of point ids in `faces`;
/// `cells` lists the distinct points of the polyhedron. Both are empty without polyhedra.
struct UnstructuredMesh {
  Points points;
  CellArray cells;
  Array types;
  CellType single_type = CellType::empty;
  CellArray faces;
  Array polyhedron_faces;  ///< i64, cells.size()+1
  Array degrees;           ///< Lagrange and Bezier cells: u8, 3 components a cell, orders along the axes; empty = the same along all
  Array weights;           ///< f64, one a point: rational weights of Bezier cells; empty = all 1

  CellType type(size_t cell) const { return types.empty() ? single_type : CellType(types.view<uint8_t>()[cell]); }
};

/// Cells in the order vertices, lines, polygons, strips: that is how cell fields are numbered.
struct SurfaceMesh {
  Points points;
  CellArray vertices, lines, polygons, strips;
  size_t cell_count() const { return vertices.size() + lines.size() + polygons.size() + strips.size(); }
};

struct PointCloud {
  Points points;
};

/// Overlapping patches. Cell fields hold the cells of all patches one after the other (level by level, patch by patch,
/// x fastest), point fields likewise. Covered cells are marked in Dataset::cell_ghost.
struct AmrGrid {
  struct Patch {
    std::array<long long, 3> lo{}, hi{};  ///< cell indices at this level, inclusive
    size_t cell_offset = 0, point_offset = 0;
    std::array<size_t, 3> cells() const { return {size_t(hi[0] - lo[0] + 1), size_t(hi[1] - lo[1] + 1), size_t(hi[2] - lo[2] + 1)}; }
  };
  struct Level {
    Vec3 spacing{1, 1, 1};
    std::array<int, 3> ratio{2, 2, 2};  ///< cells of this level per cell of the level above, per axis (1,1,1 for level 0)
    std::vector<Patch> patches;
  };
  int dimension = 3;
  Vec3 origin{0, 0, 0};
  std::vector<Level> levels;
};

using MeshKinds = std::variant<UniformGrid, RectilinearGrid, CurvilinearGrid, UnstructuredMesh, SurfaceMesh, PointCloud, AmrGrid>;

/// One of the kinds; std::visit, std::get_if and the like take it. A class only so that its copies and its end are compiled once.
class Mesh : public MeshKinds {
 public:
  using MeshKinds::MeshKinds, MeshKinds::operator=;
  Mesh() = default;
  Mesh(const Mesh&);
  Mesh(Mesh&&) noexcept;
  Mesh& operator=(const Mesh&);
  Mesh& operator=(Mesh&&) noexcept;
  ~Mesh();
};

/// "uniform", "rectilinear", "curvilinear", "unstructured", "surface", "points", "amr".
std::string_view mesh_kind(const Mesh& mesh);
size_t point_count(const Mesh& mesh);
size_t cell_count(const Mesh& mesh);
/// In parallel; exact over all points (for AMR over all patches).
Box3 bounds(const Mesh& mesh);
/// Cell type name -> count, in order of the type's number. Lattices report Vertex, Line, Quad or Hexahedron
/// (Pixel and Voxel for uniform and rectilinear ones).
std::vector<std::pair<std::string_view, size_t>> cell_type_counts(const Mesh& mesh);

/// Checks sizes, index ranges, types and order; throws Error(data) naming the invalid cell or coordinate.
void validate(const Mesh& mesh);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Puts surfaces together from what chunks of cells found, in chunk order: the same bytes for any number of threads.
#pragma once
#include <functional>
#include <vector>

#include "data/dataset.h"
#include "data/lattice.h"

namespace sg {

/// Positions of listed points without a look at the element type per call site.
struct PointReader {
  const float* f32 = nullptr;
  const double* f64 = nullptr;
  Vec3 origin;
  Array keep;  ///< owns the packed numbers

  explicit PointReader(const Points& p);
  Vec3 operator[](size_t i) const {
    if (f32) return {origin.x + double(f32[3 * i]), origin.y + double(f32[3 * i + 1]), origin.z + double(f32[3 * i + 2])};
    return {origin.x + f64[3 * i], origin.y + f64[3 * i + 1], origin.z + f64[3 * i + 2]};
  }
};

/// Cells of one kind found by one chunk: ids in the numbering of the input's points.
struct CellList {
  std::vector<int64_t> ids;
  std::vector<uint32_t> sizes;
  std::vector<int64_t> sources;  ///< input cell of each

  void add(std::span<const int64_t> points, int64_t source) {
    ids.insert(ids.end(), points.begin(), points.end());
    sizes.push_back(uint32_t(points.size()));
    sources.push_back(source);
  }
};
struct SurfaceChunk {
  CellList vertices, lines, polygons;
  CellList outlines;  ///< edges to draw; no cells of the surface
};

struct AssembledSurface {
  SurfaceMesh mesh;             ///< without its points
  CellArray outlines;           ///< over the same points
  std::vector<int64_t> points;  ///< input point of each point, ascending
  std::vector<int64_t> cells;   ///< input cell of each cell: vertices, lines, polygons
};
/// Joins the chunks, keeps the used ones of `point_count` points, and renumbers.
AssembledSurface assemble(const std::vector<SurfaceChunk>& chunks, size_t point_count);

/// Lists of ids as a CellArray: i32, fixed size when all are equal.
CellArray cell_array(const std::vector<const CellList*>& lists, const std::function<int32_t(int64_t)>& number);

/// Some of the points; element type and origin stay.
Points gather_points(const Points& points, std::span<const int64_t> ids);
/// Positions of lattice points: f64 (a curvilinear grid's own type and origin).
Points lattice_points(const Mesh& mesh, std::span<const int64_t> ids);
/// Positions of points of all patches of an AMR grid by their number: f64.
Points amr_points(const AmrGrid& grid, std::span<const int64_t> ids);
/// Whichever of the three fits the mesh.
Points points_of(const Mesh& mesh, std::span<const int64_t> ids);

/// What to do with each cell.
enum CellState : uint8_t {
  cell_visible = 0,
  cell_duplicate = 1,  ///< another piece or an earlier patch has it: not drawn, but still a neighbour
  cell_gone = 2        ///< hidden or refined, or touches a hidden point: as if it were not there
};
/// One CellState per cell from the ghost arrays (AMR: and where patches of a level overlap); empty when all are visible.
std::vector<uint8_t> cell_states(const Dataset& in);

/// An i64 cell or point field of ids (role labels, so that it is not a default for colouring).
Field id_field(std::string name, Association association, std::vector<int64_t> ids);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Curved faces and curves of high-order cells, split by their own shape functions as finely as a tolerance asks.
//
// The number of segments of each edge depends only on its own nodes: its order times a power of two, at most 32; two cells that
// share an edge therefore agree. A face is a regular grid of its finest need; on an edge with fewer segments the grid's points move to the
// nearest point that the edge has, so that no crack opens. Nodes stay points under their own number; new points are numbered behind
// the points of the mesh.
#pragma once
#include <algorithm>
#include <array>
#include <map>
#include <memory>

#include "base/context.h"
#include "data/cells/shape/cell_shape.h"
#include "filter/mesh/surface_builder.h"

namespace sg::detail {

/// What one chunk of cells found of curved things; their nodes in `nodes`.
struct CurvedChunk {
  struct Item {
    CellType type;
    std::array<int, 3> orders;
    int64_t cell;
    bool mirrored, is_curve;
    uint32_t first_node, count;
    size_t before;             ///< lines or polygons of the chunk that come before
    uint32_t first_use = 0;    ///< its sides in `uses`
    uint32_t sides = 0;        ///< 0: drawn through its nodes, no shape functions
    int level = 0;             ///< the grid is halved that often
    int64_t first_point = -1;  ///< number of its grid's first point
  };
  /// A side of an item: which edge, and whether it runs against the edge's own direction.
  struct Use {
    uint32_t edge;
    bool reversed;
  };
  std::vector<Item> items;
  std::vector<int64_t> nodes;
  std::vector<Use> uses;

  void add(CellType type, std::array<int, 3> orders, int64_t cell, bool mirrored, bool is_curve, std::span<const int64_t> ids,
           size_t before) {
    items.push_back({type, orders, cell, mirrored, is_curve, uint32_t(nodes.size()), uint32_t(ids.size()), before});
    nodes.insert(nodes.end(), ids.begin(), ids.end());
  }
};

/// Shape functions of one curve or face at the points of its finest grid, made once per kind.
struct ShapeGrid {
  const CellShape* shape = nullptr;
  bool triangle = false;
  std::array<int, 2> order{1, 0}, levels{0, 0}, finest{1, 0};  ///< along the axes; finest = order << levels
  std::vector<double> values;                                  ///< shape->nodes() numbers a point
  /// Steps of the finest grid between points of the one that is halved `level` times.
  int step(size_t axis, int level) const { return 1 << (levels[axis] - std::min(level, levels[axis])); }
  /// The grid halved `level` times numbers its points row by row, as many a row (a triangle leaves some numbers unused).
  size_t points(int level) const { return size_t(finest[0] / step(0, level) + 1) * size_t(finest[1] / step(1, level) + 1); }
  size_t index_of(size_t point, int level) const {
    const int row = finest[0] / step(0, level) + 1;
    return index(int(point) % row * step(0, level), int(point) / row * step(1, level));
  }
  /// Place of a point of the finest grid among the values.
  size_t index(int i, int j) const {
    return triangle ? size_t(j * (finest[0] + 1) - j * (j - 1) / 2 + i) : size_t(j * (finest[0] + 1) + i);
  }
};

/// All curved things of a mesh. Usage: construct, then merge() into the chunks, then points() for the numbers that survive.
class CurvedSkin {
 public:
  CurvedSkin(const Dataset& in, const UnstructuredMesh& mesh, std::vector<CurvedChunk> found, double tolerance, const Context& ctx);
  /// Puts the triangles and lines in their places among the others. With `outlines`, the true edges of all cells follow as one more chunk
  /// that has outlines only.
  void merge(std::vector<SurfaceChunk>& chunks, bool outlines) const;
  /// Points of the mesh and new ones together.
  size_t point_count() const { return points_; }
  /// Whether there are Bezier control points, which lie off the surface.
  bool moves_nodes() const { return !bezier_nodes_.empty(); }
  /// A surviving point as a blend of points of the mesh (appended): itself, a Bezier node's place on the surface, or a new point.
  void blend(int64_t number, std::vector<int64_t>& ids, std::vector<double>& weights) const;

 private:
  using Item = CurvedChunk::Item;
  struct Edge {
    const int64_t* nodes;  // end, end, inner ones; canonical direction
    uint32_t count;
    bool bezier;
    bool of_face;
    int level = 0;
    int64_t first_point = 0;
    const ShapeGrid* grid = nullptr;
  };
  struct Side {
    uint32_t chunk, use;
    bool bezier, of_face;
    uint32_t first, count;
  };
  // A face (chunk, item) or an edge (chunk = no_chunk, item = its number), and which point of its grid.
  struct Place {
    uint32_t chunk, item;
    size_t at = 0;
  };
  static constexpr uint32_t no_chunk = UINT32_MAX;
  struct Work;
  void add_sides(uint32_t c, std::vector<Side>& sides);
  void join_edges(std::vector<Side>& sides);
  const ShapeGrid* grid(CellType type, size_t nodes, std::array<int, 3> orders);
  const ShapeGrid* known_grid(CellType type, size_t nodes, std::array<int, 3> orders) const;
  double weight(int64_t id) const;
  void load(std::span<const int64_t> ids, const ShapeGrid& g, Work& w) const;
  void evaluate(const ShapeGrid& g, int level, Work& w) const;
  int edge_level(const Edge& e, Work& w) const;
  int face_level(const ShapeGrid& g, Work& w) const;
  void find_bezier_nodes();
  int64_t edge_point(const Edge& e, int i, int segments) const;
  void emit_face(const CurvedChunk& chunk, const Item& f, Work& w, CellList& out) const;
  void emit_curve(const Edge& e, bool reversed, std::vector<int64_t>& out) const;
  void rebuild(const CurvedChunk& chunk, bool curves, CellList& list) const;

  const UnstructuredMesh& mesh_;
  PointReader at_;
  std::vector<CurvedChunk> found_;
  std::vector<std::vector<int64_t>> edge_nodes_;  // of each chunk's sides, in canonical direction
  std::vector<Edge> edges_;
  std::vector<std::pair<int64_t, Place>> faces_;         // first point -> chunk, item
  std::vector<std::pair<int64_t, Place>> bezier_nodes_;  // inner node -> where it lies, by node
  std::map<std::array<int, 5>, std::unique_ptr<ShapeGrid>> grids_;
  struct Scaled {
    Array array;
    double scale;
  };
  std::vector<Scaled> fields_;  // of those that determine the subdivision
  Array rational_;
  double scale_ = 1;
  size_t points_ = 0;
};

}  // namespace sg::detail

// SPDX-License-Identifier: Apache-2.0
#include <cstring>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/cell_topology.h"
#include "data/cells/shape/mean_value.h"
#include "filter/mesh/faces/face_matching.h"
#include "filter/mesh/faces/faces_impl.h"
#include "filter/mesh/faces/hanging_faces.h"

namespace sg::detail {

namespace {

// Adds the cells of one chunk to the surface.
class ChunkWalk {
 public:
  ChunkWalk(const UnstructuredMesh& mesh, const PointReader& at, SurfaceChunk& out, CurvedChunk& curved)
      : mesh_(mesh), cells_(cells_view(mesh.cells)), at_(at), reader_(mesh), out_(out), curved_(curved) {}

  // Faces of a solid cell whose mark is set; outward, whatever the orientation of the cell.
  void solid(size_t cell, const uint8_t* external, size_t n) {
    if (std::none_of(external, external + n, [](uint8_t e) { return e != 0; })) return;
    reader_.open(cell);
    const bool polyhedron = mesh_.type(cell) == CellType::polyhedron;
    bool mirrored = false;
    if (polyhedron) {
      turn_polyhedron(n);
    } else {
      mirrored = volume(cell, *linear_topology(linear_type(mesh_.type(cell)))) < 0;
    }
    for (size_t f = 0; f < n; ++f) {
      if (!external[f]) continue;
      const auto nodes = reader_.nodes(f);
      ids_.assign(nodes.begin(), nodes.end());
      if (polyhedron) mirrored = turned_[f];
      add_face(reader_.face_type(f), cell, mirrored, reader_.face_orders(f));
    }
  }

  // Outer cells are scattered in memory: their lists, then their points, are prefetched some cells ahead.
  void expect_cell(size_t cell) const {
    const size_t at = cells_.begin(cell) * (cells_.connectivity.wide ? 8 : 4);
    __builtin_prefetch(static_cast<const char*>(cells_.connectivity.data) + at);
    __builtin_prefetch(static_cast<const char*>(cells_.connectivity.data) + at + 63);
  }
  void expect_points(size_t cell) const {
    for (size_t i = cells_.begin(cell), end = cells_.end(cell); i < end; ++i) {
      const auto p = size_t(cells_.connectivity[i]);
      if (at_.f32) __builtin_prefetch(at_.f32 + 3 * p);
      else __builtin_prefetch(at_.f64 + 3 * p);
    }
  }

  void other(size_t cell, int dimension) {
    const CellType type = mesh_.type(cell);
    ids_.clear();
    for (size_t i = cells_.begin(cell); i < cells_.end(cell); ++i) ids_.push_back(cells_.connectivity[i]);
    if (ids_.empty()) return;
    switch (dimension) {
      case 0: return out_.vertices.add(ids_, int64_t(cell));
      case 1:
        if (is_high_order(type) && ids_.size() > 2 && ids_.size() <= 11)
          return curved_.add(type, cell_orders(mesh_, cell), int64_t(cell), false, true, ids_, out_.lines.sizes.size());
        curve_order(type, ids_.size(), local_);
        line_.clear();
        for (uint32_t i : local_) line_.push_back(ids_[i]);
        return out_.lines.add(line_, int64_t(cell));
      case 2: return add_face(type, cell, false, cell_orders(mesh_, cell));
      default: break;
    }
  }

 private:
  void load(const std::vector<int64_t>& ids) {
    corner_.clear();
    for (int64_t id : ids) corner_.push_back(at_[size_t(id)]);
  }

  // Which faces of a polyhedron look inward as they are listed: decided by their edges and the volume, since the cell need not be convex.
  void turn_polyhedron(size_t n) {
    numbers_.clear(), triangles_.clear(), face_of_.clear(), corner_.clear();
    std::vector<size_t> first(n);
    for (size_t f = 0; f < n; ++f)
      for (const int64_t id : reader_.corners(f)) numbers_.push_back(id);
    std::sort(numbers_.begin(), numbers_.end());
    numbers_.erase(std::unique(numbers_.begin(), numbers_.end()), numbers_.end());
    load(numbers_);
    const auto number = [&](int64_t id) { return uint32_t(std::lower_bound(numbers_.begin(), numbers_.end(), id) - numbers_.begin()); };
    for (size_t f = 0; f < n; ++f) {
      first[f] = triangles_.size();
      const auto c = reader_.corners(f);
      for (size_t k = 1; k + 1 < c.size(); ++k) {
        triangles_.insert(triangles_.end(), {number(c[0]), number(c[k]), number(c[k + 1])});
        face_of_.push_back(uint32_t(f));
      }
    }
    const std::vector<uint32_t> before = triangles_;
    if (!triangles_.empty()) orient_outward(corner_, triangles_, face_of_);
    turned_.assign(n, 0);
    for (size_t f = 0; f < n; ++f) turned_[f] = first[f] + 1 < triangles_.size() && triangles_[first[f] + 1] != before[first[f] + 1];
  }

  // Six times the signed volume that the linear faces enclose, from the first corner.
  double volume(size_t cell, const LinearTopology& t) {
    Vec3 at[12];
    const size_t begin = cells_.begin(cell);
    for (size_t i = 0; i < size_t(t.corners); ++i) at[i] = at_[size_t(cells_.connectivity[begin + i])];
    const Vec3 base = at[t.face_corners[0]];
    double sum = 0;
    for (size_t f = 0; f < t.face_count(); ++f) {
      const auto c = t.face(f);
      const Vec3 a = at[c[0]];
      for (size_t i = 1; i + 1 < c.size(); ++i) sum += dot(a - base, cross(at[c[i]] - base, at[c[i + 1]] - base));
    }
    return sum;
  }

  void add_polygon(size_t cell, bool mirrored) {
    if (mirrored) std::reverse(ids_.begin(), ids_.end());
    out_.polygons.add(ids_, int64_t(cell));
  }

  // A 2D cell with the nodes ids_: linear ones as they are, strips as triangles; curved ones are noted.
  void add_face(CellType type, size_t cell, bool mirrored, std::array<int, 3> orders) {
    if (type == CellType::triangle || type == CellType::quad || type == CellType::polygon)
      return ids_.size() >= 3 ? add_polygon(cell, mirrored) : void();
    if (type == CellType::pixel) {
      std::swap(ids_[2], ids_[3]);
      return add_polygon(cell, mirrored);
    }
    if (is_high_order(type)) return curved_.add(type, orders, int64_t(cell), mirrored, false, ids_, out_.polygons.sizes.size());
    load(ids_);
    local_.clear();
    tessellate_face(type, corner_, local_, orders);
    for (size_t t = 0; t + 2 < local_.size(); t += 3) {
      int64_t tri[3] = {ids_[local_[t]], ids_[local_[t + 1]], ids_[local_[t + 2]]};
      if (mirrored) std::swap(tri[1], tri[2]);
      out_.polygons.add(tri, int64_t(cell));
    }
  }

  const UnstructuredMesh& mesh_;
  CellsView cells_;
  const PointReader& at_;
  CellFaceReader reader_;
  SurfaceChunk& out_;
  CurvedChunk& curved_;
  std::vector<int64_t> ids_, line_, numbers_;
  std::vector<Vec3> corner_;
  std::vector<uint32_t> local_, triangles_, face_of_;
  std::vector<uint8_t> turned_;  // of the faces of a polyhedron
};

}  // namespace

std::vector<SurfaceChunk> unstructured_faces(const UnstructuredMesh& mesh, const std::vector<uint8_t>& states,
                                             std::vector<CurvedChunk>& curved, const Context& ctx) {
  FaceMarks marks = match_faces(mesh, states, ctx);
  unmark_hanging_faces(mesh, marks, ctx);
  const PointReader at(mesh.points);
  const size_t cells = mesh.cells.size();
  std::array<int, 256> dimension{};  // looked up once per type, not per cell
  std::array<size_t, 256> faces{};
  for (size_t t = 0; t < 256; ++t)
    if (const CellTypeInfo* info = cell_type_info(uint8_t(t))) {
      dimension[t] = info->dimension;
      if (const LinearTopology* l = info->dimension == 3 ? linear_topology(linear_type(CellType(t))) : nullptr) faces[t] = l->face_count();
    }
  const int64_t* polyhedron_faces = mesh.polyhedron_faces.empty() ? nullptr : mesh.polyhedron_faces.view<int64_t>().data;
  const size_t same = mesh.types.empty() ? faces[size_t(mesh.single_type)] : 0;  // faces of each cell
  std::vector<SurfaceChunk> chunks(marks.chunk_start.size());
  curved.assign(chunks.size(), {});
  parallel_for(
      cells, FaceMarks::cells_per_chunk,
      [&](size_t begin, size_t end) {
        const size_t chunk = begin / FaceMarks::cells_per_chunk;
        ChunkWalk walk(mesh, at, chunks[chunk], curved[chunk]);
        const uint8_t* external = marks.external.data() + marks.chunk_start[chunk];
        if (same > 0) {  // from mark to mark
          std::vector<size_t> found;
          const size_t n = same * (end - begin);
          for (size_t at = 0; at < n;) {
            const void* next = std::memchr(external + at, 1, n - at);
            if (!next) break;
            const size_t c = size_t(static_cast<const uint8_t*>(next) - external) / same;
            if (states.empty() || states[begin + c] == cell_visible) found.push_back(c);
            at = (c + 1) * same;
          }
          for (size_t i = 0; i < found.size(); ++i) {
            if (i + 12 < found.size()) walk.expect_cell(begin + found[i + 12]);
            if (i + 6 < found.size()) walk.expect_points(begin + found[i + 6]);
            walk.solid(begin + found[i], external + found[i] * same, same);
          }
          return;
        }
        for (size_t c = begin; c < end; ++c) {
          const bool visible = states.empty() || states[c] == cell_visible;
          const CellType type = mesh.type(c);
          if (dimension[size_t(type)] == 3) {
            const size_t n = type == CellType::polyhedron ? size_t(polyhedron_faces[c + 1] - polyhedron_faces[c]) : faces[size_t(type)];
            if (visible) walk.solid(c, external, n);
            external += n;
          } else if (visible) {
            walk.other(c, dimension[size_t(type)]);
          }
        }
      },
      &ctx);
  return chunks;
}

}  // namespace sg::detail

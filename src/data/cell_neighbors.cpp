// SPDX-License-Identifier: Apache-2.0
#include "data/cell_neighbors.h"

#include <bit>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cell_topology.h"

namespace sg {

namespace {

uint64_t mixed(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}
uint64_t point_hash(int64_t id) { return mixed((uint64_t(id) + 1) * 0x9E3779B97F4A7C15u); }

struct Face {
  uint64_t hash;
  uint32_t cell, face;
};

constexpr size_t grain = 4096;  // cells per chunk

// Cells as lists of faces, faces as sets of corners.
class FaceSource {
 public:
  explicit FaceSource(const Mesh& mesh) {
    if (auto* u = std::get_if<UnstructuredMesh>(&mesh)) {
      cells_ = cells_view(u->cells), polyhedra_ = cells_view(u->faces);
      count_ = cells_.count, end_ = count_;
      if (!u->types.empty()) types_ = u->types.view<uint8_t>().data;
      single_ = u->single_type;
      if (!u->polyhedron_faces.empty()) polyhedron_faces_ = u->polyhedron_faces.view<int64_t>().data;
    } else if (auto* s = std::get_if<SurfaceMesh>(&mesh)) {
      cells_ = cells_view(s->polygons);
      count_ = s->cell_count();
      first_ = s->vertices.size() + s->lines.size(), end_ = first_ + cells_.count;
      single_ = CellType::polygon;
    } else {
      fail_internal(fmt::format("face neighbours of a {} mesh are asked for; in a grid they are arithmetic", mesh_kind(mesh)));
    }
    for (size_t t = 0; t < 256; ++t)
      if (const CellTypeInfo* info = cell_type_info(uint8_t(t)); info && info->dimension >= 2) {
        table_[t] = linear_topology(linear_type(CellType(t)));
        solid_[t] = info->dimension == 3;
      }
  }

  size_t count() const { return count_; }

  size_t faces(size_t cell) const {
    if (cell < first_ || cell >= end_) return 0;
    const CellType t = type(cell);
    if (const LinearTopology* table = table_[size_t(t)]) return solid_[size_t(t)] ? table->face_count() : table->edges.size();
    if (t == CellType::polyhedron) return size_t(polyhedron_faces_[cell + 1] - polyhedron_faces_[cell]);
    if (t == CellType::polygon) return cells_.size(cell - first_);
    if (t == CellType::quadratic_polygon) return cells_.size(cell - first_) / 2;
    return 0;
  }

  /// Distinct corners in ascending order; false when they do not make a face.
  bool corners(size_t cell, size_t face, std::vector<int64_t>& ids) const {
    ids.clear();
    const CellType t = type(cell);
    const size_t at = cells_.begin(cell - first_);
    size_t least = 2;
    if (const LinearTopology* table = table_[size_t(t)]) {
      if (solid_[size_t(t)]) {
        least = 3;
        for (uint8_t k : table->face(face)) ids.push_back(cells_.connectivity[at + k]);
      } else {
        for (uint8_t k : table->edges[face]) ids.push_back(cells_.connectivity[at + k]);
      }
    } else if (t == CellType::polyhedron) {
      least = 3;
      const auto f = size_t(polyhedron_faces_[cell]) + face;
      for (size_t i = polyhedra_.begin(f); i < polyhedra_.end(f); ++i) ids.push_back(polyhedra_.connectivity[i]);
    } else {
      const size_t n = faces(cell);
      ids = {cells_.connectivity[at + face], cells_.connectivity[at + (face + 1) % n]};
    }
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    return ids.size() >= least;
  }

 private:
  CellType type(size_t cell) const { return types_ ? CellType(types_[cell]) : single_; }
  CellsView cells_, polyhedra_;
  size_t count_ = 0, first_ = 0, end_ = 0;
  const uint8_t* types_ = nullptr;
  CellType single_ = CellType::empty;
  const int64_t* polyhedron_faces_ = nullptr;
  const LinearTopology* table_[256] = {};
  bool solid_[256] = {};
};

// Where each cell's faces start; a single number when all cells have as many.
size_t lay_out(const FaceSource& source, CellNeighbors& out) {
  const size_t n = source.count();
  std::vector<size_t> chunk((n + grain - 1) / grain);
  const size_t usual = n > 0 ? source.faces(0) : 0;
  const bool same = parallel_reduce(
      n, grain, true,
      [&](size_t begin, size_t end) {
        bool all = true;
        size_t sum = 0;
        for (size_t c = begin; c < end; ++c) {
          const size_t faces = source.faces(c);
          sum += faces, all = all && faces == usual;
        }
        chunk[begin / grain] = sum;
        return all;
      },
      [](bool a, bool b) { return a && b; });
  const size_t total = exclusive_scan(chunk);
  if (same) {
    out.fixed = int(usual);
    return total;
  }
  out.begin.resize(n + 1);
  out.begin[n] = total;
  parallel_for(n, grain, [&](size_t begin, size_t end) {
    size_t at = chunk[begin / grain];
    for (size_t c = begin; c < end; ++c) out.begin[c] = at, at += source.faces(c);
  });
  return total;
}

// Calls f(face record) for the real faces of cells [begin, end).
template <class F>
void walk(const FaceSource& source, size_t begin, size_t end, std::vector<int64_t>& ids, F&& f) {
  for (size_t c = begin; c < end; ++c)
    for (size_t face = 0, n = source.faces(c); face < n; ++face) {
      if (!source.corners(c, face, ids)) continue;
      uint64_t sum = 0;
      for (int64_t id : ids) sum += point_hash(id);
      f(Face{mixed(sum), uint32_t(c), uint32_t(face)});
    }
}

// Open addressing: the first of equal faces stays in the table with its partner, later ones find it.
void match(const FaceSource& source, std::span<const Face> faces, CellNeighbors& out) {
  if (faces.empty()) return;
  const size_t mask = std::bit_ceil(2 * faces.size()) - 1;
  std::vector<uint32_t> table(mask + 1, UINT32_MAX);
  std::vector<int64_t> a, b;
  for (uint32_t i = 0; i < faces.size(); ++i) {
    const Face& face = faces[i];
    a.clear();
    for (size_t at = face.hash & mask;; at = (at + 1) & mask) {
      if (table[at] == UINT32_MAX) {
        table[at] = i;
        break;
      }
      const Face& have = faces[table[at]];
      if (have.hash != face.hash || have.cell == face.cell) continue;
      if (a.empty()) source.corners(face.cell, face.face, a);
      source.corners(have.cell, have.face, b);
      if (a != b) continue;
      int32_t& theirs = out.across[out.first(have.cell) + have.face];
      if (theirs < 0) theirs = int32_t(face.cell);
      out.across[out.first(face.cell) + face.face] = int32_t(have.cell);
      break;
    }
  }
}

}  // namespace

CellNeighbors cell_neighbors(const Mesh& mesh, const Context* context) {
  const FaceSource source(mesh);
  const size_t n = source.count();
  if (n > size_t(INT32_MAX)) fail_usage("the mesh has more than 2^31 cells", "face neighbours", "split it into pieces");
  CellNeighbors out;
  const size_t total = lay_out(source, out);
  out.across.assign(total, -1);
  // Faces by the top bits of their hash, in the order of the cells: partitions small enough for the cache.
  size_t partitions = 1;
  while (partitions < 4096 && total / partitions > 4000) partitions *= 2;
  const int shift = 64 - std::countr_zero(partitions);
  auto partition_of = [&](const Face& f) { return partitions == 1 ? 0 : size_t(f.hash >> shift); };
  const size_t chunks = (n + grain - 1) / grain;
  std::vector<size_t> place(partitions * chunks);  // partition by partition, chunk by chunk
  parallel_for(
      n, grain,
      [&](size_t begin, size_t end) {
        std::vector<int64_t> ids;
        walk(source, begin, end, ids, [&](const Face& f) { ++place[partition_of(f) * chunks + begin / grain]; });
      },
      context);
  std::vector<Face> faces(exclusive_scan(place));
  parallel_for(
      n, grain,
      [&](size_t begin, size_t end) {
        std::vector<int64_t> ids;
        walk(source, begin, end, ids, [&](const Face& f) { faces[place[partition_of(f) * chunks + begin / grain]++] = f; });
      },
      context);
  parallel_for(
      partitions, 1,
      [&](size_t p, size_t) {
        // After the second pass each place is the end of its run.
        const size_t begin = p > 0 ? place[p * chunks - 1] : 0, end = chunks > 0 ? place[(p + 1) * chunks - 1] : 0;
        match(source, std::span(faces).subspan(begin, end - begin), out);
      },
      context);
  return out;
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "data/cells/cell_neighbors.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <unordered_map>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/cell_topology.h"

namespace sg {

namespace {

constexpr size_t cells_per_chunk = 4096;  // cells per chunk

// Cells as lists of faces, faces as sets of corners.
class FaceSource {
 public:
  explicit FaceSource(const Mesh& mesh) {
    if (auto* u = std::get_if<UnstructuredMesh>(&mesh)) {
      cells_ = cells_view(u->cells), polyhedra_ = cells_view(u->faces), points_ = u->points.count();
      count_ = cells_.count, end_ = count_;
      if (!u->types.empty()) types_ = u->types.view<uint8_t>().data;
      single_ = u->single_type;
      if (!u->polyhedron_faces.empty()) polyhedron_faces_ = u->polyhedron_faces.view<int64_t>().data;
    } else if (auto* s = std::get_if<SurfaceMesh>(&mesh)) {
      cells_ = cells_view(s->polygons), points_ = s->points.count();
      count_ = s->cell_count();
      first_ = s->vertices.size() + s->lines.size(), end_ = first_ + cells_.count;
      single_ = CellType::polygon;
    } else {
      fail_internal(fmt::format("face neighbours were requested for a {} mesh; in a grid they follow from the indices", mesh_kind(mesh)));
    }
    for (size_t t = 0; t < 256; ++t)
      if (const CellTypeInfo* info = cell_type_info(uint8_t(t)); info && info->dimension >= 2) {
        table_[t] = linear_topology(linear_type(CellType(t)));
        solid_[t] = info->dimension == 3;
      }
  }

  size_t count() const { return count_; }
  /// Of the mesh; or as many as the ids imply, when only topology was given.
  size_t points() const {
    if (points_ > 0) return points_;
    const IndexView& ids = cells_.connectivity;
    return parallel_reduce(
        cells_.count > 0 ? cells_.end(cells_.count - 1) : 0, size_t(1) << 18, size_t(0),
        [&](size_t begin, size_t end) {
          size_t n = 0;
          for (size_t i = begin; i < end; ++i) n = std::max(n, size_t(ids[i]) + 1);
          return n;
        },
        [](size_t a, size_t b) { return std::max(a, b); });
  }
  bool beyond_32_bits() const { return points_ >= UINT32_MAX; }
  /// Cells with faces are first() to end().
  size_t first() const { return first_; }
  size_t end() const { return end_; }
  bool wide() const { return cells_.connectivity.wide; }
  const void* ids() const { return cells_.connectivity.data; }
  size_t begin(size_t cell) const { return cells_.begin(cell - first_); }
  /// Of cells of fixed shape.
  const LinearTopology* table(size_t cell) const { return table_[size_t(type(cell))]; }

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
  size_t count_ = 0, first_ = 0, end_ = 0, points_ = 0;
  const uint8_t* types_ = nullptr;
  CellType single_ = CellType::empty;
  const int64_t* polyhedron_faces_ = nullptr;
  const LinearTopology* table_[256] = {};
  bool solid_[256] = {};
};

// Where each cell's faces start; a single number when all cells have as many.
size_t lay_out(const FaceSource& source, CellNeighbors& out) {
  const size_t n = source.count();
  std::vector<size_t> chunk((n + cells_per_chunk - 1) / cells_per_chunk);
  const size_t usual = n > 0 ? source.faces(0) : 0;
  const bool same = parallel_reduce(
      n, cells_per_chunk, true,
      [&](size_t begin, size_t end) {
        bool all = true;
        size_t sum = 0;
        for (size_t c = begin; c < end; ++c) {
          const size_t faces = source.faces(c);
          sum += faces, all = all && faces == usual;
        }
        chunk[begin / cells_per_chunk] = sum;
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
  parallel_for(n, cells_per_chunk, [&](size_t begin, size_t end) {
    size_t at = chunk[begin / cells_per_chunk];
    for (size_t c = begin; c < end; ++c) out.begin[c] = at, at += source.faces(c);
  });
  return total;
}

// Faces wait for their other cell in a list at their smallest point. Matches the faces whose smallest point lies in [lo, hi), in the order
// of the cells; the first of equal faces stays in its list, later ones find it there.
class Matcher {
 public:
  Matcher(const FaceSource& source, uint64_t lo, uint64_t hi, CellNeighbors& out)
      : source_(source), lo_(lo), hi_(hi), out_(out), head_(hi - lo, none) {
    pool_.reserve(2 * (hi - lo) + 16);
  }

  void run() {
    if (source_.wide()) run<int64_t>();
    else run<int32_t>();
  }

 private:
  static constexpr uint32_t none = UINT32_MAX, many = 1u << 31;
  struct Open {
    uint32_t key[3];      // the next corners, ascending, or `none`; with more than four corners the last is a hash
    uint32_t cell, face;  // face with `many`: more than four corners
    uint32_t next;
  };

  template <class Id>
  void run() {
    const Id* ids = static_cast<const Id*>(source_.ids());
    uint64_t v[12];
    for (size_t c = source_.first(), end = source_.end(); c < end; ++c) {
      const LinearTopology* t = source_.table(c);
      if (!t) {
        general(c);
        continue;
      }
      const Id* from = ids + source_.begin(c);
      for (int k = 0; k < t->corners; ++k) v[k] = uint64_t(from[k]);
      const size_t n = t->face_count();
      if (n == 0)
        for (size_t e = 0; e < t->edges.size(); ++e) edge(v[t->edges[e][0]], v[t->edges[e][1]], c, uint32_t(e));
      for (size_t f = 0; f < n; ++f) {
        const uint8_t* k = t->face_corners.data() + t->face_begin[f];
        const int m = t->face_begin[f + 1] - t->face_begin[f];
        if (m == 3) triangle(v[k[0]], v[k[1]], v[k[2]], c, uint32_t(f));
        else if (m == 4) quad(v[k[0]], v[k[1]], v[k[2]], v[k[3]], c, uint32_t(f));
        else long_face(c, uint32_t(f));
      }
    }
  }
  bool mine(uint64_t a) const { return a - lo_ < hi_ - lo_; }
  static void order(uint64_t& a, uint64_t& b) {
    const uint64_t lo = std::min(a, b), hi = std::max(a, b);
    a = lo, b = hi;
  }
  void edge(uint64_t a, uint64_t b, size_t cell, uint32_t face) {
    order(a, b);
    if (mine(a) && a != b) add(a, {uint32_t(b), none, none}, cell, face);
  }
  void triangle(uint64_t a, uint64_t b, uint64_t c, size_t cell, uint32_t face) {
    if (!mine(std::min(std::min(a, b), c))) return;
    order(a, b), order(b, c), order(a, b);
    if (a != b && b != c) add(a, {uint32_t(b), uint32_t(c), none}, cell, face);
  }
  void quad(uint64_t a, uint64_t b, uint64_t c, uint64_t d, size_t cell, uint32_t face) {
    if (!mine(std::min(std::min(a, b), std::min(c, d)))) return;
    order(a, b), order(c, d), order(a, c), order(b, d), order(b, c);
    if ((a == b) | (b == c) | (c == d)) long_face(cell, face);
    else add(a, {uint32_t(b), uint32_t(c), uint32_t(d)}, cell, face);
  }
  void general(size_t cell) {
    const size_t n = source_.faces(cell);
    for (size_t f = 0; f < n; ++f) long_face(cell, uint32_t(f));
  }
  // Any number of corners, some of which may be the same.
  void long_face(size_t cell, uint32_t face) {
    if (!source_.corners(cell, face, a_) || !mine(uint64_t(a_[0]))) return;
    std::array<uint32_t, 3> key{none, none, none};
    for (size_t k = 1; k < std::min<size_t>(a_.size(), 4); ++k) key[k - 1] = uint32_t(a_[k]);
    if (a_.size() > 4)
      for (size_t k = 4; k < a_.size(); ++k) key[2] = (key[2] ^ uint32_t(a_[k])) * 0x9E3779B1u;
    add(uint64_t(a_[0]), key, cell, a_.size() > 4 ? face | many : face);
  }
  void add(uint64_t a, const std::array<uint32_t, 3>& key, size_t cell, uint32_t face) {
    uint32_t* head = &head_[a - lo_];
    if (found(*head, key, cell, face)) return;
    if (full_) {  // a point of very many faces: the others by their hash
      const uint64_t mix = (a * 0x9E3779B97F4A7C15u ^ key[0]) * 0xD6E8FEB86659FD93u ^ (uint64_t(key[1]) << 32 | key[2]);
      head = &crowd_.try_emplace(mix, none).first->second;
      if (found(*head, key, cell, face)) return;
    }
    pool_.push_back({{key[0], key[1], key[2]}, uint32_t(cell), face, *head});
    *head = uint32_t(pool_.size() - 1);
  }
  // The face in a list, if its cell is another; `full_` says whether the list is long.
  bool found(uint32_t head, const std::array<uint32_t, 3>& key, size_t cell, uint32_t face) {
    int n = 0;
    for (uint32_t at = head; at != none; at = pool_[at].next, ++n) {
      const Open& have = pool_[at];
      if ((have.key[0] != key[0]) | (have.key[1] != key[1]) | (have.key[2] != key[2])) continue;
      if (have.cell == cell || (have.face & many) != (face & many) || !equal(have, cell, face)) continue;
      int32_t& theirs = out_.across[out_.first(have.cell) + (have.face & ~many)];
      if (theirs < 0) theirs = int32_t(cell);
      out_.across[out_.first(cell) + (face & ~many)] = int32_t(have.cell);
      return true;
    }
    full_ = n >= 32;
    return false;
  }
  // What the key does not contain.
  bool equal(const Open& have, size_t cell, uint32_t face) {
    if (!(face & many) && !source_.beyond_32_bits()) return true;
    source_.corners(cell, face & ~many, a_);
    source_.corners(have.cell, have.face & ~many, b_);
    return a_ == b_;
  }

  const FaceSource& source_;
  const uint64_t lo_, hi_;
  CellNeighbors& out_;
  std::vector<uint32_t> head_;
  std::vector<Open> pool_;
  std::unordered_map<uint64_t, uint32_t> crowd_;  // lists by the hash of a face
  bool full_ = false;
  std::vector<int64_t> a_, b_;
};

}  // namespace

CellNeighbors cell_neighbors(const Mesh& mesh, const Context* context) {
  const FaceSource source(mesh);
  const size_t n = source.count();
  if (n > size_t(INT32_MAX)) fail_usage("the mesh has more than 2^31 cells", "face neighbours", "split it into pieces");
  CellNeighbors out;
  const size_t total = lay_out(source, out);
  out.across.resize(total);
  parallel_for(total, 1 << 18, [&](size_t begin, size_t end) {
    std::fill(out.across.begin() + ptrdiff_t(begin), out.across.begin() + ptrdiff_t(end), -1);
  });
  // Each range of points reads all cells.
  const size_t points = source.points(), ranges = points < 10000 ? 1 : size_t(std::clamp(thread_count(), 1, 16));
  parallel_for(
      ranges, 1, [&](size_t r, size_t) { Matcher(source, points * r / ranges, points * (r + 1) / ranges, out).run(); }, context);
  return out;
}

}  // namespace sg

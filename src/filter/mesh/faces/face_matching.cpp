// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/faces/face_matching.h"

#include <algorithm>
#include <atomic>
#include <bit>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/cell_topology.h"
#include "filter/mesh/surface_builder.h"

namespace sg {

namespace {

uint64_t mix(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}
/// One round is enough here: the sum over the corners is mixed again.
uint64_t point_hash(uint32_t id) {
  const uint64_t x = (uint64_t(id) + 1) * 0x9E3779B97F4A7C15u;
  return (x ^ (x >> 32)) * 0xD6E8FEB86659FD93u;
}

constexpr size_t slots_per_point = 4;
constexpr size_t ahead = 384;  // prefetch distance in ids
constexpr uint32_t no_point = UINT32_MAX;

// A face that may have no partner: its sorted corners, in a pool, and its mark.
struct Candidate {
  uint64_t hash;
  uint32_t mark, first, corners;
  bool partner = false;
};
struct Candidates {
  std::vector<Candidate> faces;
  std::vector<uint32_t> pool;
  std::vector<uint32_t> partition_start;
  std::vector<uint32_t> order;  // by partition
};

class Matcher {
 public:
  Matcher(const UnstructuredMesh& mesh, const std::vector<uint8_t>& states, const Context& ctx)
      : mesh_(mesh), states_(states), ctx_(ctx), cells_(cells_view(mesh.cells)), polyhedra_(cells_view(mesh.faces)) {
    for (size_t t = 0; t < 256; ++t)
      if (const CellTypeInfo* info = cell_type_info(uint8_t(t)); info && info->dimension == 3)
        table_[t] = linear_topology(linear_type(CellType(t)));
    if (!mesh.types.empty()) types_ = mesh.types.view<uint8_t>().data;
    if (!types_ && table_[size_t(mesh.single_type)]) same_ = table_[size_t(mesh.single_type)]->face_count();
    if (!mesh.polyhedron_faces.empty()) polyhedron_faces_ = mesh.polyhedron_faces.view<int64_t>().data;
  }

  FaceMarks run() {
    FaceMarks marks;
    count(marks);
    if (marks.external.empty()) return marks;
    const size_t chunks = marks.chunk_start.size(), wanted = std::clamp<size_t>(chunks / 8, 1, std::max<size_t>(64, chunks / 256));
    const size_t block_chunks = (chunks + wanted - 1) / wanted;
    for (size_t c = 0; c < chunks; c += block_chunks) {
      Block& b = blocks_.emplace_back();
      b.begin = c * FaceMarks::cells_per_chunk, b.end = std::min(cells_.count, (c + block_chunks) * FaceMarks::cells_per_chunk);
      b.mark = uint32_t(marks.chunk_start[c]);
      b.faces = uint32_t((c + block_chunks < chunks ? marks.chunk_start[c + block_chunks] : marks.external.size()) - b.mark);
    }
    if (cancel_in_blocks()) join_blocks();
    else cancel_in_common();
    for_each_block([&](Block& b) { find_candidates(b); });
    match_candidates(marks);
    return marks;
  }

 private:
  uint8_t type(size_t cell) const { return types_ ? types_[cell] : uint8_t(mesh_.single_type); }
  bool gone(size_t cell) const { return !states_.empty() && states_[cell] == cell_gone; }
  size_t faces_of(size_t cell) const {
    const uint8_t t = type(cell);
    if (table_[t]) return table_[t]->face_count();
    return t == uint8_t(CellType::polyhedron) ? size_t(polyhedron_faces_[cell + 1] - polyhedron_faces_[cell]) : 0;
  }

  void count(FaceMarks& marks) const {
    marks.chunk_start.resize((cells_.count + FaceMarks::cells_per_chunk - 1) / FaceMarks::cells_per_chunk);
    parallel_for(cells_.count, FaceMarks::cells_per_chunk, [&](size_t begin, size_t end) {
      size_t n = 0;
      if (!types_ && mesh_.single_type != CellType::polyhedron) n = (end - begin) * faces_of(begin);
      else
        for (size_t c = begin; c < end; ++c) n += faces_of(c);
      marks.chunk_start[begin / FaceMarks::cells_per_chunk] = n;
    });
    const size_t total = exclusive_scan(marks.chunk_start);
    if (total > size_t(INT32_MAX) || mesh_.points.count() >= UINT32_MAX)
      fail_usage("the mesh has more than 2^31 faces or 2^32 points", "faces", "draw it in pieces");
    marks.external.resize(total);
    parallel_for(total, 1 << 20, [&](size_t begin, size_t end) {
      std::fill(marks.external.begin() + ptrdiff_t(begin), marks.external.begin() + ptrdiff_t(end), 0);
    });
  }

  // A run of cells, and slots for the points from the lowest that it uses to the highest.
  struct Block {
    struct Left {
      uint32_t slot, mark;
    };
    size_t begin = 0, end = 0;     // cells
    uint32_t mark = 0, faces = 0;  // first face, number of faces
    uint32_t lo = 0, hi = 0;
    uint64_t* slots = nullptr;
    std::vector<Left> left;  // faces whose slot is not zero
    Candidates found;
    size_t size() const { return slots_per_point * (size_t(hi) - lo + 1); }
    uint32_t slot(uint32_t lowest, uint32_t key) const { return slots_per_point * (lowest - lo) + (key * 0x9E3779B1u >> 30); }
  };

  template <class F>
  void for_each_block(F f) {
    parallel_for(
        blocks_.size(), 1, [&](size_t b, size_t) { f(blocks_[b]); }, &ctx_);
  }

  // Neighbouring cells have points with near numbers, mostly. Then each block has slots of its own, no thread waits for another, and the
  // cells come from memory once. False where blocks reach too far: nothing is done then.
  bool cancel_in_blocks() {
    const size_t room = 2 * slots_per_point * mesh_.points.count() + 4096;
    std::byte* memory = nullptr;
    memory_ = Buffer::allocate(room * sizeof(uint64_t), &memory);
    std::atomic<size_t> used{0};
    for_each_block([&](Block& b) {
      if (used.load(std::memory_order_relaxed) > room) return;
      reach(b);
      const size_t size = b.size() + 1, at = used.fetch_add(size, std::memory_order_relaxed);
      if (at + size > room) return;
      b.slots = reinterpret_cast<uint64_t*>(memory) + at;
      std::fill(b.slots, b.slots + size, 0);
      static thread_local Plane<uint32_t> slot_of_face;  // so that the second look needs no cells
      slot_of_face.resize(b.faces);
      uint32_t* next = slot_of_face.data();
      const auto none = uint32_t(size - 1);  // always zero
      walk_cells<true>(b, [&](uint32_t lowest, uint32_t key, auto&& hash) {
        const uint32_t slot = lowest == no_point ? none : b.slot(lowest, key);
        *next++ = slot;
        b.slots[slot] ^= slot == none ? 0 : hash();
      });
      b.left.reserve(b.faces / 5);
      for (uint32_t f = 0; f < b.faces; ++f)
        if (const uint32_t slot = slot_of_face[f]; b.slots[slot] != 0) b.left.push_back({slot, b.mark + f});
    });
    return used <= room;
  }

  // One array for all; XOR does not depend on the order of the threads.
  void cancel_in_common() {
    auto* slots = reinterpret_cast<uint64_t*>(const_cast<std::byte*>(memory_.data));
    const size_t points = mesh_.points.count();
    parallel_for(slots_per_point * points, 1 << 18, [&](size_t begin, size_t end) { std::fill(slots + begin, slots + end, 0); });
    for (Block& b : blocks_) b.lo = 0, b.hi = uint32_t(points - 1), b.slots = slots, b.left.clear();
    for_each_block([&](Block& b) {
      walk_cells<true>(b, [&](uint32_t lowest, uint32_t key, auto&& hash) {
        if (lowest != no_point) __atomic_fetch_xor(&b.slots[b.slot(lowest, key)], hash(), __ATOMIC_RELAXED);
      });
    });
    for_each_block([&](Block& b) {
      uint32_t mark = b.mark;
      walk_cells<false>(b, [&](uint32_t lowest, uint32_t key, auto&&) {
        if (lowest != no_point)
          if (const uint32_t slot = b.slot(lowest, key); b.slots[slot] != 0) b.left.push_back({slot, mark});
        ++mark;
      });
    });
  }

  // The lowest and the highest point of the block's cells.
  void reach(Block& b) const {
    int64_t lo = INT64_MAX, hi = 0;
    auto scan = [&](const CellsView& v, size_t first, size_t last) {
      auto range = [&](const auto* ids) {
        int64_t low[4] = {lo, lo, lo, lo}, high[4] = {hi, hi, hi, hi};  // four chains, so that none waits for the last
        size_t i = v.begin(first);
        const size_t n = v.begin(last);
        for (; i + 8 <= n; i += 8) {
          __builtin_prefetch(ids + i + ahead);
          for (size_t k = 0; k < 8; ++k)
            low[k % 4] = std::min(low[k % 4], int64_t(ids[i + k])), high[k % 4] = std::max(high[k % 4], int64_t(ids[i + k]));
        }
        for (; i < n; ++i) low[0] = std::min(low[0], int64_t(ids[i])), high[0] = std::max(high[0], int64_t(ids[i]));
        lo = *std::min_element(low, low + 4), hi = *std::max_element(high, high + 4);
      };
      if (v.connectivity.wide) range(static_cast<const int64_t*>(v.connectivity.data));
      else range(static_cast<const int32_t*>(v.connectivity.data));
    };
    scan(cells_, b.begin, b.end);
    if (polyhedron_faces_) scan(polyhedra_, size_t(polyhedron_faces_[b.begin]), size_t(polyhedron_faces_[b.end]));
    b.lo = uint32_t(std::min(lo, hi)), b.hi = uint32_t(hi);
  }

  // Of the faces left over those that the other blocks did not cancel either.
  void find_candidates(Block& b) const {
    Candidates& to = b.found;
    size_t cell = b.begin;
    uint32_t mark = b.mark;  // of the cell's first face
    for (size_t i = 0; i < b.left.size(); ++i) {
      if (i + 16 < b.left.size()) __builtin_prefetch(&b.slots[b.left[i + 16].slot]);
      const Block::Left& l = b.left[i];
      if (b.slots[l.slot] == 0) continue;
      if (same_ > 0) cell = b.begin + (l.mark - b.mark) / same_, mark = b.mark + uint32_t((cell - b.begin) * same_);
      else
        while (l.mark - mark >= faces_of(cell)) mark += uint32_t(faces_of(cell++));
      const auto first = uint32_t(to.pool.size());
      uint64_t sum = 0;
      corners_of(cell, l.mark - mark, [&](uint32_t id) { to.pool.push_back(id), sum += point_hash(id); });
      std::sort(to.pool.begin() + first, to.pool.end());
      to.faces.push_back({mix(sum), l.mark, first, uint32_t(to.pool.size()) - first});
    }
    b.left = {};
  }

  template <class F>
  void corners_of(size_t cell, size_t face, F add) const {
    if (const LinearTopology* t = table_[type(cell)]) {
      for (uint8_t l : t->face(face)) add(uint32_t(cells_.point(cell, l)));
    } else {
      const size_t f = size_t(polyhedron_faces_[cell]) + face;
      for (size_t i = polyhedra_.begin(f); i < polyhedra_.end(f); ++i) add(uint32_t(polyhedra_.connectivity[i]));
    }
  }

  // Points that several blocks use: each block gets the XOR of all.
  void join_blocks() {
    parallel_for(mesh_.points.count(), 1 << 14, [&](size_t begin, size_t end) {
      std::vector<const Block*> here;
      std::vector<size_t> borders{begin, end};
      for (const Block& b : blocks_) {
        if (b.hi < begin || b.lo >= end) continue;
        here.push_back(&b);
        borders.push_back(std::max<size_t>(b.lo, begin));
        borders.push_back(std::min<size_t>(size_t(b.hi) + 1, end));
      }
      std::sort(borders.begin(), borders.end());
      std::vector<uint64_t*> rows;
      for (size_t k = 0; k + 1 < borders.size(); ++k) {
        const size_t n = slots_per_point * (borders[k + 1] - borders[k]);
        rows.clear();
        for (const Block* b : here)
          if (n > 0 && b->lo <= borders[k] && b->hi >= borders[k]) rows.push_back(b->slots + slots_per_point * (borders[k] - b->lo));
        for (size_t r = 1; r < rows.size(); ++r)
          for (size_t i = 0; i < n; ++i) rows[0][i] ^= rows[r][i];
        for (size_t r = 1; r < rows.size(); ++r) std::copy(rows[0], rows[0] + n, rows[r]);
      }
    });
  }

  // Calls g(lowest corner, key, hash) for each face of the cells. `key` is the sum of the corners, hash() the face's hash, only with
  // `hashing`. Faces of cells that are gone, and faces without corners, have no_point for their lowest.
  template <bool hashing, class G>
  void walk_cells(const Block& b, G&& g) const {
    if (cells_.connectivity.wide) walk<hashing, int64_t>(b.begin, b.end, g);
    else walk<hashing, int32_t>(b.begin, b.end, g);
  }

  template <bool hashing, class Id, class G>
  void walk(size_t begin, size_t end, G& g) const {
    const Id* ids = static_cast<const Id*>(cells_.connectivity.data);
    uint32_t v[12];
    uint64_t h[12];
    auto load = [&](const Id* from, int n) {
      __builtin_prefetch(from + ahead);  // the processor's own prefetching ends with each page
      for (int i = 0; i < n; ++i) {
        v[i] = uint32_t(from[i]);
        if constexpr (hashing) h[i] = point_hash(v[i]);
      }
    };
    for (size_t c = begin; c < end; ++c) {
      const LinearTopology* t = table_[type(c)];
      if (gone(c)) {
        for (size_t f = 0, n = faces_of(c); f < n; ++f) g(no_point, 0, [] { return uint64_t(0); });
      } else if (t == tetra_) {
        load(ids + cells_.begin(c), 4);
        auto face = [&](int a, int b, int d) __attribute__((always_inline)) {
          g(std::min(std::min(v[a], v[b]), v[d]), v[a] + v[b] + v[d], [&] { return mix(h[a] + h[b] + h[d]); });
        };
        face(0, 1, 3), face(1, 2, 3), face(2, 0, 3), face(0, 2, 1);
      } else if (t == hexahedron_) {
        load(ids + cells_.begin(c), 8);
        auto face = [&](int a, int b, int d, int e) __attribute__((always_inline)) {
          g(std::min(std::min(v[a], v[b]), std::min(v[d], v[e])), (v[a] + v[b]) + (v[d] + v[e]),
            [&] { return mix((h[a] + h[b]) + (h[d] + h[e])); });
        };
        face(0, 4, 7, 3), face(1, 2, 6, 5), face(0, 1, 5, 4), face(3, 7, 6, 2), face(0, 3, 2, 1), face(4, 5, 6, 7);
      } else {
        for (size_t f = 0, n = faces_of(c); f < n; ++f) {
          uint32_t lowest = no_point, key = 0;
          uint64_t sum = 0;
          corners_of(c, f, [&](uint32_t id) {
            lowest = std::min(lowest, id), key += id;
            if constexpr (hashing) sum += point_hash(id);
          });
          g(lowest, key, [&] { return mix(sum); });
        }
      }
    }
  }

  // Partitions of a few thousand candidates each, so that their hash tables stay in the cache.
  void match_candidates(FaceMarks& marks) {
    size_t total = 0;
    for (const Block& b : blocks_) total += b.found.faces.size();
    size_t partitions = 2;
    while (partitions < 4096 && total / partitions > 4000) partitions *= 2;
    const int shift = 64 - std::countr_zero(partitions);
    auto partition_of = [&](const Candidate& c) { return size_t(c.hash >> shift); };
    parallel_for(blocks_.size(), 1, [&](size_t i, size_t) {
      Candidates& c = blocks_[i].found;
      c.partition_start.assign(partitions + 1, 0);
      for (const Candidate& f : c.faces) ++c.partition_start[partition_of(f) + 1];
      for (size_t p = 0; p < partitions; ++p) c.partition_start[p + 1] += c.partition_start[p];
      c.order.resize(c.faces.size());
      std::vector<uint32_t> next(c.partition_start);
      for (uint32_t f = 0; f < c.faces.size(); ++f) c.order[next[partition_of(c.faces[f])]++] = f;
    });
    parallel_for(
        partitions, 1, [&](size_t p, size_t) { join(p, marks); }, &ctx_);
  }

  struct Entry {
    Candidates* home = nullptr;
    uint32_t face = 0;
  };

  // Open addressing over one partition: the first of equal faces stays in the table, later ones mark it.
  void join(size_t p, FaceMarks& marks) {
    size_t total = 0;
    for (const Block& b : blocks_) total += b.found.partition_start[p + 1] - b.found.partition_start[p];
    if (total == 0) return;
    const size_t mask = std::bit_ceil(2 * total) - 1;
    std::vector<Entry> table(mask + 1);
    for (Block& block : blocks_) {
      Candidates& c = block.found;
      for (uint32_t i = c.partition_start[p]; i < c.partition_start[p + 1]; ++i) {
        const Candidate& face = c.faces[c.order[i]];
        const auto corners = std::span(c.pool).subspan(face.first, face.corners);
        for (size_t at = face.hash & mask;; at = (at + 1) & mask) {
          Entry& entry = table[at];
          if (!entry.home) {
            entry = {&c, c.order[i]};
            break;
          }
          Candidate& have = entry.home->faces[entry.face];
          if (have.hash != face.hash || have.corners != face.corners) continue;
          if (std::equal(corners.begin(), corners.end(), entry.home->pool.begin() + have.first)) {
            have.partner = true;
            break;
          }
        }
      }
    }
    for (const Entry& e : table)
      if (e.home && !e.home->faces[e.face].partner) marks.external[e.home->faces[e.face].mark] = 1;
  }

  const UnstructuredMesh& mesh_;
  const std::vector<uint8_t>& states_;
  const Context& ctx_;
  CellsView cells_, polyhedra_;
  const uint8_t* types_ = nullptr;
  const int64_t* polyhedron_faces_ = nullptr;
  const LinearTopology* table_[256] = {};
  const LinearTopology *tetra_ = linear_topology(CellType::tetra), *hexahedron_ = linear_topology(CellType::hexahedron);
  size_t same_ = 0;  // faces of each cell where all have as many
  std::vector<Block> blocks_;
  Buffer memory_;
};

}  // namespace

FaceMarks match_faces(const UnstructuredMesh& mesh, const std::vector<uint8_t>& states, const Context& ctx) {
  return Matcher(mesh, states, ctx).run();
}

}  // namespace sg

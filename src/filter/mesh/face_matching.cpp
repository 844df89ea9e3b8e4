// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/face_matching.h"

#include <bit>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cell_topology.h"
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
    if (!mesh.polyhedron_faces.empty()) polyhedron_faces_ = mesh.polyhedron_faces.view<int64_t>().data;
  }

  FaceMarks run() {
    FaceMarks marks;
    count(marks);
    if (marks.external.empty()) return marks;
    std::byte* memory = nullptr;
    const size_t slots = slots_per_point * mesh_.points.count();
    const Buffer owner = Buffer::allocate(slots * sizeof(uint64_t), &memory);
    slots_ = reinterpret_cast<uint64_t*>(memory);
    parallel_for(slots, 1 << 18, [&](size_t begin, size_t end) { std::fill(slots_ + begin, slots_ + end, 0); });
    // XOR does not depend on the order of the threads.
    for_each_chunk(marks, [&](size_t, auto walk) {
      walk([&](size_t slot, uint64_t hash, uint32_t, auto&&) { __atomic_fetch_xor(&slots_[slot], hash, __ATOMIC_RELAXED); });
    });
    found_.resize(marks.chunk_start.size());
    for_each_chunk(marks, [&](size_t chunk, auto walk) {
      Candidates& to = found_[chunk];
      walk([&](size_t slot, uint64_t hash, uint32_t mark, auto&& corners_of) {
        if (slots_[slot] == 0) return;
        const auto first = uint32_t(to.pool.size());
        corners_of([&](uint32_t id) { to.pool.push_back(id); });
        std::sort(to.pool.begin() + first, to.pool.end());
        to.faces.push_back({hash, mark, first, uint32_t(to.pool.size()) - first});
      });
    });
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
  }

  // f(chunk, walk), where walk(g) calls g(slot, hash, mark, corners_of) for each face of the chunk's cells.
  template <class F>
  void for_each_chunk(const FaceMarks& marks, F f) const {
    parallel_for(
        cells_.count, FaceMarks::cells_per_chunk,
        [&](size_t begin, size_t end) {
          const size_t chunk = begin / FaceMarks::cells_per_chunk;
          const auto mark = uint32_t(marks.chunk_start[chunk]);
          if (cells_.connectivity.wide) f(chunk, [&](auto&& g) { walk<int64_t>(begin, end, mark, g); });
          else f(chunk, [&](auto&& g) { walk<int32_t>(begin, end, mark, g); });
        },
        &ctx_);
  }

  template <class Id, class G>
  void walk(size_t begin, size_t end, uint32_t mark, G&& g) const {
    const Id* ids = static_cast<const Id*>(cells_.connectivity.data);
    uint32_t v[12];
    uint64_t h[12];
    auto load = [&](const Id* from, int n) {
      for (int i = 0; i < n; ++i) v[i] = uint32_t(from[i]), h[i] = point_hash(v[i]);
    };
    auto give = [&](uint32_t lowest, uint64_t sum, auto&& corners_of) {
      const uint64_t hash = mix(sum);
      g(lowest * slots_per_point + (hash >> 62), hash, mark++, corners_of);
    };
    for (size_t c = begin; c < end; ++c) {
      if (gone(c)) {
        mark += uint32_t(faces_of(c));
        continue;
      }
      const LinearTopology* t = table_[type(c)];
      if (t == tetra_) {
        load(ids + cells_.begin(c), 4);
        auto face = [&](int a, int b, int d) {
          give(std::min(std::min(v[a], v[b]), v[d]), h[a] + h[b] + h[d], [&](auto&& add) { add(v[a]), add(v[b]), add(v[d]); });
        };
        face(0, 1, 3), face(1, 2, 3), face(2, 0, 3), face(0, 2, 1);
      } else if (t == hexahedron_) {
        load(ids + cells_.begin(c), 8);
        auto face = [&](int a, int b, int d, int e) {
          give(std::min(std::min(v[a], v[b]), std::min(v[d], v[e])), (h[a] + h[b]) + (h[d] + h[e]),
               [&](auto&& add) { add(v[a]), add(v[b]), add(v[d]), add(v[e]); });
        };
        face(0, 4, 7, 3), face(1, 2, 6, 5), face(0, 1, 5, 4), face(3, 7, 6, 2), face(0, 3, 2, 1), face(4, 5, 6, 7);
      } else if (t) {
        load(ids + cells_.begin(c), t->corners);
        for (size_t f = 0; f < t->face_count(); ++f) {
          const auto face = t->face(f);
          uint32_t lowest = UINT32_MAX;
          uint64_t sum = 0;
          for (uint8_t l : face) lowest = std::min(lowest, v[l]), sum += h[l];
          give(lowest, sum, [&](auto&& add) {
            for (uint8_t l : face) add(v[l]);
          });
        }
      } else if (type(c) == uint8_t(CellType::polyhedron)) {
        for (auto f = size_t(polyhedron_faces_[c]); f < size_t(polyhedron_faces_[c + 1]); ++f) {
          uint32_t lowest = polyhedra_.size(f) ? UINT32_MAX : 0;
          uint64_t sum = 0;
          for (size_t i = polyhedra_.begin(f); i < polyhedra_.end(f); ++i) {
            const auto id = uint32_t(polyhedra_.connectivity[i]);
            lowest = std::min(lowest, id), sum += point_hash(id);
          }
          give(lowest, sum, [&](auto&& add) {
            for (size_t i = polyhedra_.begin(f); i < polyhedra_.end(f); ++i) add(uint32_t(polyhedra_.connectivity[i]));
          });
        }
      }
    }
  }

  // Partitions of a few thousand candidates each, so that their hash tables stay in the cache.
  void match_candidates(FaceMarks& marks) {
    size_t total = 0;
    for (const Candidates& c : found_) total += c.faces.size();
    size_t partitions = 2;
    while (partitions < 4096 && total / partitions > 4000) partitions *= 2;
    const int shift = 62 - std::countr_zero(partitions);  // the top two bits chose the slot
    auto partition_of = [&](const Candidate& c) { return size_t(c.hash << 2 >> 2 >> shift); };
    parallel_for(found_.size(), 1, [&](size_t i, size_t) {
      Candidates& c = found_[i];
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
    for (const Candidates& c : found_) total += c.partition_start[p + 1] - c.partition_start[p];
    if (total == 0) return;
    const size_t mask = std::bit_ceil(2 * total) - 1;
    std::vector<Entry> table(mask + 1);
    for (Candidates& c : found_)
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
  uint64_t* slots_ = nullptr;
  std::vector<Candidates> found_;
};

}  // namespace

FaceMarks match_faces(const UnstructuredMesh& mesh, const std::vector<uint8_t>& states, const Context& ctx) {
  return Matcher(mesh, states, ctx).run();
}

}  // namespace sg

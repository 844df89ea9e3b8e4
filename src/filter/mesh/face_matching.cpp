// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/face_matching.h"

#include <bit>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cell_topology.h"
#include "filter/mesh/surface_builder.h"

namespace sg {

namespace {

struct Entry {
  uint32_t a, b, c, d;  // the three smallest corners; the fourth, or all_three, or a hash of the rest
  uint32_t mark;        // place in FaceMarks; the top bit says that a partner was found
};
constexpr uint32_t all_three = UINT32_MAX, partner = uint32_t(1) << 31, vacant = UINT32_MAX;

uint64_t hash_of(uint32_t a, uint32_t b, uint32_t c) {
  const uint64_t x = (uint64_t(a) * 0x9E3779B97F4A7C15u) ^ (uint64_t(b) * 0xC2B2AE3D27D4EB4Fu) ^ (uint64_t(c) * 0x165667B19E3779F9u);
  return (x ^ (x >> 29)) * 0xBF58476D1CE4E5B9u;
}

void order(uint32_t& a, uint32_t& b) {
  const uint32_t lo = a < b ? a : b;
  b = a < b ? b : a;
  a = lo;
}

void set_key3(Entry& e, uint32_t a, uint32_t b, uint32_t c) {
  order(a, b), order(b, c), order(a, b);
  e.a = a, e.b = b, e.c = c, e.d = all_three;
}
void set_key4(Entry& e, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  order(a, b), order(c, d), order(a, c), order(b, d), order(b, c);
  e.a = a, e.b = b, e.c = c, e.d = d;
}
void set_key(Entry& e, std::vector<uint32_t>& corners) {
  if (corners.size() == 3) return set_key3(e, corners[0], corners[1], corners[2]);
  if (corners.size() == 4) return set_key4(e, corners[0], corners[1], corners[2], corners[3]);
  std::sort(corners.begin(), corners.end());
  corners.resize(std::max<size_t>(corners.size(), 3), 0);  // a polyhedron's face of two points is nobody's partner but its twin's
  uint32_t rest = uint32_t(corners.size());
  for (size_t i = 3; i < corners.size(); ++i) rest = (rest ^ corners[i]) * 0x9E3779B1u + (rest >> 15);
  e.a = corners[0], e.b = corners[1], e.c = corners[2], e.d = rest;
}

class Matcher {
 public:
  Matcher(const UnstructuredMesh& mesh, const std::vector<uint8_t>& states, const Context& ctx)
      : mesh_(mesh), states_(states), ctx_(ctx), cells_(cells_view(mesh.cells)), polyhedra_(cells_view(mesh.faces)) {
    for (size_t t = 0; t < 256; ++t)
      if (const CellTypeInfo* info = cell_type_info(uint8_t(t)); info && info->dimension == 3) table_[t] = linear_topology(linear_type(CellType(t)));
    if (!mesh.types.empty()) types_ = mesh.types.view<uint8_t>().data;
    if (!mesh.polyhedron_faces.empty()) polyhedron_faces_ = mesh.polyhedron_faces.view<int64_t>().data;
  }

  FaceMarks run() {
    FaceMarks marks;
    count(marks);
    if (marks.external.empty()) return marks;
    while (partitions_ < 1024 && marks.external.size() / partitions_ > 12000) partitions_ *= 2;
    shift_ = 64 - std::countr_zero(partitions_);
    std::byte* memory = nullptr;
    const Buffer owner = Buffer::allocate(marks.external.size() * sizeof(Entry), &memory);
    entries_ = reinterpret_cast<Entry*>(memory);
    const size_t chunks = marks.chunk_start.size();
    segment_.resize(chunks * (partitions_ + 1));
    parallel_for(cells_.count, FaceMarks::cells_per_chunk, [&](size_t begin, size_t end) {
      const size_t chunk = begin / FaceMarks::cells_per_chunk;
      cells_.connectivity.wide ? scatter<int64_t>(chunk, begin, end, marks) : scatter<int32_t>(chunk, begin, end, marks);
    }, &ctx_);
    parallel_for(partitions_, 1, [&](size_t p, size_t) { join(p, chunks, marks); }, &ctx_);
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
    if (total >= partner || mesh_.points.count() >= UINT32_MAX)
      fail_usage("the mesh has more than 2^31 faces or 2^32 points", "faces", "draw it in pieces");
    marks.external.resize(total);
  }

  // Entries of a chunk of cells, sorted by partition into the chunk's own part of the buffer.
  template <class Id>
  void scatter(size_t chunk, size_t begin, size_t end, FaceMarks& marks) const {
    thread_local std::vector<Entry> found;
    thread_local std::vector<uint16_t> partition;
    thread_local std::vector<uint32_t> corners, next;
    const size_t base = marks.chunk_start[chunk];
    const size_t all = (chunk + 1 < marks.chunk_start.size() ? marks.chunk_start[chunk + 1] : marks.external.size()) - base;
    found.resize(all);
    partition.resize(all);
    const Id* ids = static_cast<const Id*>(cells_.connectivity.data);
    size_t n = 0;
    auto mark = uint32_t(base);
    for (size_t c = begin; c < end; ++c) {
      if (gone(c)) {
        mark += uint32_t(faces_of(c));
        continue;
      }
      const LinearTopology* t = table_[type(c)];
      const Id* v = ids + cells_.begin(c);
      if (t == tetra_) {
        const auto a = uint32_t(v[0]), b = uint32_t(v[1]), e = uint32_t(v[2]), f = uint32_t(v[3]);
        set_key3(found[n], a, b, f), set_key3(found[n + 1], b, e, f), set_key3(found[n + 2], e, a, f), set_key3(found[n + 3], a, e, b);
        for (int k = 0; k < 4; ++k) found[n++].mark = mark++;
      } else if (t) {
        const uint8_t* local = t->face_corners.data();
        for (size_t f = 0; f < t->face_count(); ++f) {
          const auto first = t->face_begin[f], last = t->face_begin[f + 1];
          Entry& e = found[n++];
          if (last - first == 4) {
            set_key4(e, uint32_t(v[local[first]]), uint32_t(v[local[first + 1]]), uint32_t(v[local[first + 2]]), uint32_t(v[local[first + 3]]));
          } else if (last - first == 3) {
            set_key3(e, uint32_t(v[local[first]]), uint32_t(v[local[first + 1]]), uint32_t(v[local[first + 2]]));
          } else {
            corners.clear();
            for (auto i = first; i < last; ++i) corners.push_back(uint32_t(v[local[i]]));
            set_key(e, corners);
          }
          e.mark = mark++;
        }
      } else if (type(c) == uint8_t(CellType::polyhedron)) {
        for (auto f = size_t(polyhedron_faces_[c]); f < size_t(polyhedron_faces_[c + 1]); ++f) {
          corners.clear();
          for (size_t i = polyhedra_.begin(f); i < polyhedra_.end(f); ++i) corners.push_back(uint32_t(polyhedra_.connectivity[i]));
          set_key(found[n], corners);
          found[n++].mark = mark++;
        }
      }
    }
    uint32_t* segment = const_cast<uint32_t*>(segment_.data()) + chunk * (partitions_ + 1);
    next.assign(partitions_ + 1, 0);
    for (size_t i = 0; i < n; ++i) {
      partition[i] = uint16_t(partitions_ == 1 ? 0 : hash_of(found[i].a, found[i].b, found[i].c) >> shift_);
      ++next[partition[i] + 1];
    }
    for (size_t p = 0; p < partitions_; ++p) next[p + 1] += next[p];
    std::copy(next.begin(), next.end(), segment);
    for (size_t i = 0; i < n; ++i) entries_[base + next[partition[i]]++] = found[i];
  }

  // Open addressing over one partition: the first of equal faces stays in the table, later ones mark it.
  void join(size_t p, size_t chunks, FaceMarks& marks) const {
    thread_local std::vector<uint32_t> table;
    size_t total = 0;
    for (size_t c = 0; c < chunks; ++c) total += segment_[c * (partitions_ + 1) + p + 1] - segment_[c * (partitions_ + 1) + p];
    if (total == 0) return;
    const size_t mask = std::bit_ceil(2 * total) - 1;
    table.assign(mask + 1, vacant);
    for (size_t c = 0; c < chunks; ++c) {
      const uint32_t* s = segment_.data() + c * (partitions_ + 1) + p;
      for (uint32_t i = s[0]; i < s[1]; ++i) {
        const Entry& e = entries_[marks.chunk_start[c] + i];
        for (size_t at = hash_of(e.a, e.b, e.c) & mask;; at = (at + 1) & mask) {
          if (table[at] == vacant) {
            table[at] = uint32_t(marks.chunk_start[c] + i);
            break;
          }
          Entry& have = entries_[table[at]];
          if (have.a == e.a && have.b == e.b && have.c == e.c && have.d == e.d) {
            have.mark |= partner;
            break;
          }
        }
      }
    }
    for (size_t at = 0; at <= mask; ++at)
      if (table[at] != vacant && !(entries_[table[at]].mark & partner)) marks.external[entries_[table[at]].mark] = 1;
  }

  const UnstructuredMesh& mesh_;
  const std::vector<uint8_t>& states_;
  const Context& ctx_;
  CellsView cells_, polyhedra_;
  const uint8_t* types_ = nullptr;
  const int64_t* polyhedron_faces_ = nullptr;
  const LinearTopology* table_[256] = {};
  const LinearTopology* tetra_ = linear_topology(CellType::tetra);
  size_t partitions_ = 1;
  int shift_ = 0;
  Entry* entries_ = nullptr;
  std::vector<uint32_t> segment_;  // per chunk: first entry of each partition, from the chunk's first
};

}  // namespace

FaceMarks match_faces(const UnstructuredMesh& mesh, const std::vector<uint8_t>& states, const Context& ctx) { return Matcher(mesh, states, ctx).run(); }

}  // namespace sg

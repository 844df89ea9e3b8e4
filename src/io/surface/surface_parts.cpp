// SPDX-License-Identifier: Apache-2.0
#include "io/surface/surface_parts.h"

#include <fmt/core.h>

#include <cstring>

#include "base/parallel.h"

namespace sg {

const SurfaceMesh& surface_to_write(const Dataset& dataset, std::string_view format, const std::string& path) {
  const auto* s = dataset.as<SurfaceMesh>();
  if (!s)
    fail_usage(fmt::format("a {} file holds a surface, not a {} mesh", format, dataset.kind()), path,
               "extract its surface first: -f 'faces'");
  return *s;
}

PolygonList surface_polygons(const SurfaceMesh& m) {
  PolygonList r;
  const CellsView polygons = cells_view(m.polygons), strips = cells_view(m.strips);
  const size_t before = m.vertices.size() + m.lines.size();
  r.ids.reserve(m.polygons.connectivity.count());
  for (size_t c = 0; c < polygons.count; ++c) {
    for (size_t k = polygons.begin(c); k < polygons.end(c); ++k) r.ids.push_back(polygons.connectivity[k]);
    r.offsets.push_back(r.ids.size());
    r.source.push_back(before + c);
  }
  for (size_t c = 0; c < strips.count; ++c)
    for (size_t k = 0; k + 2 < strips.size(c); ++k) {
      // Every second triangle of a strip runs the other way round.
      r.ids.insert(r.ids.end(), {strips.point(c, k), strips.point(c, k + 1 + k % 2), strips.point(c, k + 2 - k % 2)});
      r.offsets.push_back(r.ids.size());
      r.source.push_back(before + polygons.count + c);
    }
  return r;
}

std::vector<int64_t> surface_triangles(const SurfaceMesh& m) {
  const PolygonList p = surface_polygons(m);
  std::vector<int64_t> t;
  t.reserve(p.ids.size());
  for (size_t c = 0; c + 1 < p.offsets.size(); ++c)
    for (size_t k = p.offsets[c] + 2; k < p.offsets[c + 1]; ++k) t.insert(t.end(), {p.ids[p.offsets[c]], p.ids[k - 1], p.ids[k]});
  return t;
}

namespace {

struct Key {
  uint32_t x, y, z;
  friend bool operator==(const Key&, const Key&) = default;
};

uint64_t hash_of(Key k) {
  uint64_t h = (uint64_t(k.x) << 32 | k.y) * 0x9e3779b97f4a7c15u;
  h ^= h >> 29;
  h = (h ^ k.z) * 0xbf58476d1ce4e5b9u;
  return h ^ h >> 32;
}

constexpr size_t chunk_corners = 3 * 8192;  ///< number of corners that share a table, which stays in the second-level cache
constexpr size_t partitions = 64;

// A chunk's distinct corners in order of first use.
struct Distinct {
  std::vector<Key> keys;
  std::vector<uint32_t> hash;
};

// Replaces the corners [begin, end) by numbers of distinct ones; returns the first corner that is not finite, or `end`.
size_t merge_chunk(const std::byte* corners, size_t begin, size_t end, size_t stride, int32_t* ids, Distinct& d) {
  constexpr size_t slots = 32768;  // more than corners in a chunk, so a free one is always found
  thread_local std::vector<uint32_t> table;
  table.assign(slots, 0);
  d.keys.clear(), d.hash.clear();
  d.keys.reserve(8192), d.hash.reserve(8192);
  const std::byte* triangle = corners + begin / 3 * stride;
  for (size_t i = begin; i < end; triangle += stride) {
    for (size_t k = 0; k < 3 && i < end; ++k, ++i) {
      Key key;
      std::memcpy(&key, triangle + 12 * k, 12);
      for (uint32_t* v : {&key.x, &key.y, &key.z}) {
        if ((*v & 0x7f800000u) == 0x7f800000u) return i;
        if (*v == 0x80000000u) *v = 0;
      }
      const uint64_t h = hash_of(key);
      size_t slot = h % slots;
      for (;; slot = (slot + 1) % slots) {
        const uint32_t have = table[slot];
        if (have == 0) {
          d.keys.push_back(key);
          d.hash.push_back(uint32_t(h >> 32 ^ h));
          table[slot] = uint32_t(d.keys.size());
          ids[i] = int32_t(d.keys.size() - 1);
          break;
        }
        if (d.keys[have - 1] == key) {
          ids[i] = int32_t(have - 1);
          break;
        }
      }
    }
  }
  return end;
}

}  // namespace

MergedPoints merge_corners(const std::byte* corners, size_t count, size_t stride, const std::string& where, Context& context) {
  if (count >= (uint64_t(1) << 32)) fail_data(fmt::format("{} corners are too many to merge", count), where);
  const size_t chunks = (count + chunk_corners - 1) / chunk_corners;
  int32_t* ids = nullptr;
  Array id_array = Array::make<int32_t>(count, 1, &ids);

  // 1. Each chunk on its own: neighbouring triangles share most of their corners.
  std::vector<Distinct> distinct(chunks);
  parallel_for(
      count, chunk_corners,
      [&](size_t begin, size_t end) {
        const size_t bad = merge_chunk(corners, begin, end, stride, ids, distinct[begin / chunk_corners]);
        if (bad != end) fail_data(fmt::format("triangle {} has a coordinate that is not a finite number", bad / 3), where);
      },
      &context);

  // 2. The distinct corners of all chunks, sorted by hash into partitions; within one they keep their order.
  std::vector<size_t> first(chunks);
  for (size_t c = 0; c < chunks; ++c) first[c] = distinct[c].keys.size();
  const size_t candidates = exclusive_scan(first);
  std::vector<size_t> place(chunks * partitions);  // [partition][chunk]
  parallel_for(chunks, 1, [&](size_t c, size_t) {
    size_t n[partitions] = {};
    for (const uint32_t h : distinct[c].hash) ++n[h % partitions];
    for (size_t p = 0; p < partitions; ++p) place[p * chunks + c] = n[p];
  });
  exclusive_scan(place);
  struct Candidate {
    Key key;
    uint32_t index;  ///< among all candidates
  };
  std::byte *candidate_bytes = nullptr, *same_bytes = nullptr;
  const Buffer candidate_memory = Buffer::allocate(candidates * sizeof(Candidate), &candidate_bytes);
  const Buffer same_memory = Buffer::allocate(candidates * sizeof(uint32_t), &same_bytes);
  auto* sorted = reinterpret_cast<Candidate*>(candidate_bytes);
  auto* same = reinterpret_cast<uint32_t*>(same_bytes);  ///< first candidate with the same coordinates; later: the point's number
  std::vector<size_t> partition_begin(partitions + 1, candidates);
  for (size_t p = 0; p < partitions && chunks > 0; ++p) partition_begin[p] = place[p * chunks];
  parallel_for(chunks, 1, [&](size_t c, size_t) {
    size_t at[partitions];
    for (size_t p = 0; p < partitions; ++p) at[p] = place[p * chunks + c];
    const Distinct& d = distinct[c];
    for (size_t i = 0; i < d.keys.size(); ++i) sorted[at[d.hash[i] % partitions]++] = {d.keys[i], uint32_t(first[c] + i)};
  });
  parallel_for(partitions, 1, [&](size_t p, size_t) {
    const size_t begin = partition_begin[p], end = partition_begin[p + 1];
    size_t slots = 16;
    while (slots < 2 * (end - begin)) slots *= 2;
    std::vector<uint32_t> table(slots, 0);
    for (size_t i = begin; i < end; ++i) {
      for (size_t slot = (hash_of(sorted[i].key) >> 8) % slots;; slot = (slot + 1) % slots) {
        if (table[slot] == 0) {
          table[slot] = uint32_t(i - begin) + 1;
          same[sorted[i].index] = sorted[i].index;
          break;
        }
        const Candidate& have = sorted[begin + table[slot] - 1];
        if (have.key == sorted[i].key) {
          same[sorted[i].index] = have.index;
          break;
        }
      }
    }
  });

  // 3. Points are numbered by first use: those candidates that are their own first, counted before each chunk.
  std::vector<size_t> points_before(chunks);
  parallel_for(chunks, 1, [&](size_t c, size_t) {
    size_t n = 0;
    for (size_t i = first[c]; i < first[c] + distinct[c].keys.size(); ++i) n += size_t(same[i] == i);
    points_before[c] = n;
  });
  const size_t points = exclusive_scan(points_before);
  if (points > size_t(INT32_MAX)) fail_data(fmt::format("{} points are more than a surface can have", points), where);
  float* xyz = nullptr;
  MergedPoints r;
  r.xyz = Array::make<float>(points, 3, &xyz);
  std::byte* number_bytes = nullptr;
  const Buffer number_memory = Buffer::allocate(candidates * sizeof(uint32_t), &number_bytes);
  auto* number = reinterpret_cast<uint32_t*>(number_bytes);
  parallel_for(chunks, 1, [&](size_t c, size_t) {
    size_t n = points_before[c];
    const Distinct& d = distinct[c];
    for (size_t i = 0; i < d.keys.size(); ++i)
      if (same[first[c] + i] == first[c] + i) {
        number[first[c] + i] = uint32_t(n);
        std::memcpy(xyz + 3 * n++, &d.keys[i], 12);
      }
  });
  parallel_for(count, chunk_corners, [&](size_t begin, size_t end) {
    const size_t base = first[begin / chunk_corners];
    for (size_t i = begin; i < end; ++i) ids[i] = int32_t(number[same[base + size_t(ids[i])]]);
  });
  r.ids = std::move(id_array);
  return r;
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Cut edges of cells that were looked at in chunks become points of one surface, each edge once. Inside filter/scalar only.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "filter/scalar/contour/contour_finder.h"

namespace sg::contouring {

/// What a chunk of cells leaves: its edges, each once, and cells of the surface that name them by their place here.
struct EdgeChunk {
  static constexpr size_t parts = 64;
  static constexpr uint32_t inner_bit = 0x80000000u;
  std::vector<uint64_t> keys;     ///< by part, inside it in the order of their first use
  std::vector<uint32_t> numbers;  ///< point of the surface, once EdgePoints is made
  std::array<uint32_t, parts + 1> begin{};
  std::vector<uint32_t> lines, triangles;  ///< places in keys, or inner_bit + place in inner
  std::vector<uint32_t> line_cells, triangle_cells;
  std::vector<CellPoint> inner;
  size_t first_inner = 0;

  /// Takes what was found; `point_count` is that of the mesh. Edges are assigned to parts by their lower point.
  void take(Found& found, size_t point_count);
};

/// Numbers the edges of all chunks: by part, inside it in order of first use in the order of the chunks. Fills EdgeChunk::numbers.
/// The time is linear in the edges; tables stay in the cache since each part has its own.
class EdgePoints {
 public:
  EdgePoints(std::vector<EdgeChunk>& chunks, const Context& context);
  size_t size() const { return first_.back(); }
  /// f(number, a, b) for all edges, in parallel; a < b.
  template <class F>
  void each(F&& f, const Context& context) const {
    parallel_for(
        EdgeChunk::parts, grain_,
        [&](size_t begin, size_t end) {
          size_t v = first_[begin];
          for (size_t part = begin; part < end; ++part)
            for (uint64_t k : keys_[part]) f(v++, uint32_t(k >> 32), uint32_t(k));
        },
        &context);
  }

 private:
  std::vector<uint64_t> keys_[EdgeChunk::parts];
  size_t grain_ = 1;  // parts in one go: all where there are so few points that waking another thread would take longer
  std::vector<size_t> first_;
};

}  // namespace sg::contouring

// SPDX-License-Identifier: Apache-2.0
// Pieces of cut cells, between a chunk's counting and writing passes.
#pragma once
#include "filter/mesh/clip/clip_impl.h"

namespace sg::clipping {

/// What the pieces of a chunk of cells need; sums become places.
struct PieceCounts {
  size_t cells = 0, ids = 0, inner = 0, inner_ids = 0;
  void add(const PieceCounts& o) { cells += o.cells, ids += o.ids, inner += o.inner, inner_ids += o.inner_ids; }
};

/// Counts the pieces of one cell and lists the cut edges that they use; `used(point)` hears of each mesh point.
template <class Used>
void count_pieces(const CellClipper& clipper, const CellPieces& p, PieceCounts& n, std::vector<uint64_t>* cuts, Used&& used) {
  n.cells += p.types.size();
  n.ids += p.vertices.size();
  uint64_t seen[4] = {};
  std::vector<uint8_t> many;
  if (p.names.size() > 256) many.assign(p.names.size(), 0);
  std::vector<double> weights;
  for (const uint16_t v : p.vertices) {
    if (many.empty() ? seen[v >> 6] >> (v & 63) & 1 : many[v]) continue;
    if (many.empty()) seen[v >> 6] |= uint64_t(1) << (v & 63);
    else many[v] = 1;
    const uint64_t name = p.names[v];
    if (p.is_inner(v)) {
      clipper.weights(v, weights);
      ++n.inner;
      for (const double w : weights) n.inner_ids += w != 0;
    } else if (name >> 32 == (name & 0xffffffffu)) {
      used(name >> 32);
    } else if (cuts) {
      cuts->push_back(name);
    }
  }
}

/// Where the pieces of a chunk go.
struct PieceWriter {
  Build& build;
  int32_t* connectivity;
  int32_t* offsets;
  uint8_t* types;
  size_t first_cut, first_inner;  ///< numbers of the first cut point and the first inner vertex
  PieceCounts at;                 ///< the next cell, id and inner vertex
  std::vector<uint32_t> number;   // of each vertex of the cell at hand
  std::vector<double> weights;

  /// `rank(point)` is the number of a kept point; `cut(name)` the place of a cut among all, asked in the order of count_pieces().
  template <class Rank, class Cut>
  void write(const CellClipper& clipper, const CellPieces& p, size_t cell, Rank&& rank, Cut&& cut) {
    constexpr uint32_t open = ~0u;
    number.assign(p.names.size(), open);
    for (const uint16_t v : p.vertices) {
      if (number[v] != open) continue;
      const uint64_t name = p.names[v];
      if (p.is_inner(v)) {
        clipper.weights(v, weights);
        for (size_t k = 0; k < weights.size(); ++k)
          if (weights[k] != 0) {
            build.inner_points[at.inner_ids] = uint32_t(p.names[k]);
            build.inner_weights[at.inner_ids++] = weights[k];
          }
        build.inner_first[at.inner + 1] = at.inner_ids;
        number[v] = uint32_t(first_inner + at.inner++);
      } else if (name >> 32 == (name & 0xffffffffu)) {
        number[v] = rank(name >> 32);
      } else {
        number[v] = uint32_t(first_cut + cut(name));
      }
    }
    for (size_t i = 0; i < p.types.size(); ++i) {
      build.source[at.cells] = uint32_t(cell);
      types[at.cells] = uint8_t(p.types[i]);
      offsets[at.cells++] = int32_t(at.ids);
      for (size_t k = p.first[i]; k < p.first[i + 1]; ++k) connectivity[at.ids++] = int32_t(number[p.vertices[k]]);
    }
  }
};

/// Room for everything; `whole` cells of `fixed` points (0: lists) come before the pieces. Throws Error(usage) above 2^31 ids or points.
void allocate(Build& b, size_t whole_cells, size_t whole_ids, const PieceCounts& pieces, int32_t** connectivity, int32_t** offsets,
              uint8_t** types);

/// Inner vertices with the same shares of the same four points become one: those of a bent face, which both of its cells have made.
/// Lists of `ids` of the pieces: from first_inner on they are inner vertices.
void merge_shared(Build& b, size_t first_inner, std::span<const std::span<int32_t>> ids);

/// Rounding error of coordinates, to recognise faces that are flat up to it.
double rounding_of(const Points& points, const Dataset& mesh);

}  // namespace sg::clipping

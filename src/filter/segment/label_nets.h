// SPDX-License-Identifier: Apache-2.0
// The net of quads between samples of different labels: which corners of the voxels it uses, its faces, and its relaxation.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/context.h"
#include "base/huge_allocator.h"

namespace sg {

/// Corner (i,j,k) lies before sample (i,j,k) along each axis: there is one more of them than samples along each axis.
class LabelNet {
 public:
  /// `code` 0 is nothing, as are all samples outside; with walls == false all other codes are alike.
  LabelNet(const int32_t* code, std::array<size_t, 3> dims, bool walls, const Context& context);

  size_t vertices() const { return vertices_; }
  size_t faces() const { return faces_; }
  /// connectivity: 4 per face, counterclockwise seen from side 1; samples: the sample on each of the two sides, -1 outside.
  void fill_faces(int32_t* connectivity, int64_t* samples) const;
  /// Corner of each vertex.
  void fill_corners(uint32_t* corners) const;
  /// Offsets from the corners in index units, 3 per vertex, each within [-0.5, 0.5].
  std::vector<float> relaxed(int iterations) const;

 private:
  int32_t code_at(int64_t i, int64_t j, int64_t k) const;
  bool differ(int32_t a, int32_t b) const { return walls_ ? a != b : (a != 0) != (b != 0); }
  int32_t vertex(size_t i, size_t row) const;
  template <class F>
  void for_faces_of_row(size_t row, F&& f) const;
  void neighbors_of_row(size_t row, int32_t* out) const;

  const int32_t* code_;
  std::array<size_t, 3> dims_, corners_;
  bool walls_;
  const Context& context_;
  size_t words_ = 0, vertices_ = 0, faces_ = 0;
  std::vector<uint64_t> used_;                     // a bit per corner
  std::vector<uint32_t> rank_;                     // used corners of the row before each word
  std::vector<size_t> first_vertex_, first_face_;  // of each row of corners
};

}  // namespace sg

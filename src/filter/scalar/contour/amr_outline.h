// SPDX-License-Identifier: Apache-2.0
// A leaf of an AMR grid as a polyhedron without hanging nodes. Inside filter/scalar only.
#pragma once
#include <vector>

#include "filter/scalar/contour/amr_leaves.h"

namespace sg::contouring {

/// The faces of one leaf after another, split as their finer neighbours split them.
class AmrOutline {
 public:
  using Leaf = AmrLeaves::Leaf;
  using Place = AmrLeaves::Place;
  explicit AmrOutline(const AmrLeaves& leaves) : leaves_(leaves), flat_(leaves.dimension() == 2) {}
  /// Fills `faces` and `corners` with those of `leaf`.
  void open(const Leaf& leaf);

  std::vector<std::vector<Place>> faces;  ///< seen from outside counterclockwise; 2D: the outline as one
  std::vector<Place> corners;             ///< distinct, ascending

 private:
  void split_edge(Place from, size_t axis, size_t level, std::vector<Place>& out) const;
  std::vector<Place> rectangle(const Place& lo, size_t axis, size_t level) const;
  void split_face(const Place& lo, size_t axis, bool high, size_t level, std::vector<std::vector<Place>>& out) const;

  const AmrLeaves& leaves_;
  bool flat_;
};

}  // namespace sg::contouring

// SPDX-License-Identifier: Apache-2.0
// Elements of an MFEM mesh by their vertices, and the numbers that MFEM gives to their edges, faces and nodes.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "io/mfem/element.h"

namespace sg::mfem {

struct Topology {
  int dimension = 0;
  int64_t vertices = 0;  ///< number of vertices, used or not
  std::vector<Geometry> geometry;
  std::vector<int32_t> attribute;
  std::vector<size_t> begin{0};  ///< elements + 1 places in `corners`
  std::vector<int64_t> corners;

  // Numbered by number_entities(), in the order of first appearance, when needed: not for linear meshes.
  mutable bool numbered = false;
  mutable size_t edges = 0, faces = 0;
  mutable std::vector<size_t> edge_begin, face_begin;  ///< elements + 1 places in ...
  mutable std::vector<int64_t> edge, face;             ///< ... the edges and faces of each element (edges from dimension 2, faces in 3)
  mutable std::vector<std::array<int64_t, 4>> face_corners;  ///< of the element that has it first; -1 for the fourth of a triangle

  size_t size() const { return geometry.size(); }
  std::span<const int64_t> element(size_t e) const { return std::span(corners).subspan(begin[e], begin[e + 1] - begin[e]); }
};

/// Does nothing when it is done. Not thread-safe.
void number_entities(const Topology& t);

/// The continuous numbering of order p: every element's nodes, as local_nodes() lists them.
class Numbering {
 public:
  Numbering(const Topology& t, int p, const std::string& where);
  size_t size() const { return size_; }
  /// Numbers of the nodes of an element; the result lives until the next call.
  std::span<const int64_t> element(size_t e);

 private:
  int64_t face_node(const Topology& t, size_t e, const LocalNode& n) const;
  const Topology& t_;
  int p_;
  std::string where_;
  size_t size_ = 0, edges_ = 0;
  std::vector<int64_t> face_first_, inside_first_;
  std::vector<LocalNode> nodes_[geometry_count];
  std::vector<int64_t> ids_;
};

/// Where base corner b lies among the corners of an element's face; -1 when it is none of them.
int corner_in(std::span<const int64_t> corners, int64_t vertex);

}  // namespace sg::mfem

// SPDX-License-Identifier: Apache-2.0
// The numbers that MFEM gives to the degrees of freedom of vector-valued spaces: edges from their smaller vertex, faces as the element
// that comes first lists their corners, insides. What an element sees of a face from another corner are sums of these.
#pragma once

#include "io/mfem/topology.h"
#include "io/mfem/vector_element.h"

namespace sg::mfem {

class VectorNumbering {
 public:
  /// Throws Error(data) naming `where` for a face whose corners two elements list crosswise.
  VectorNumbering(const Topology& t, const FeCollection& c, const std::string& where);
  size_t size() const { return size_; }

  /// A number of the space times a factor.
  struct Share {
    size_t dof;
    double factor;
  };
  /// Degree of freedom d of the element, as vector_dofs() lists them, is the sum of shares[begin[d]] to shares[begin[d + 1]].
  struct Shares {
    std::vector<uint32_t> begin;
    std::vector<Share> shares;
  };
  /// The result lives until the next call.
  const Shares& element(size_t e);

 private:
  void add(size_t first, const std::vector<VectorDof>& dofs, Vec3 origin, Vec3 x, Vec3 y);
  void add_face(size_t e, size_t f);

  const Topology& t_;
  std::string where_;
  size_t size_ = 0;
  std::vector<VectorDof> of_edge_, of_triangle_, of_square_;
  std::vector<size_t> face_first_, inside_first_;
  std::array<size_t, geometry_count> inside_{};
  Shares now_;
};

}  // namespace sg::mfem

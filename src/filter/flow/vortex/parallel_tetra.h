// SPDX-License-Identifier: Apache-2.0
// Lines in one tetrahedron along which two vector fields, linear in it, are parallel. Inside filter/flow/vortex only.
#pragma once
#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "base/vec.h"

namespace sg::parallel {

/// A corner of a tetrahedron: a point of the mesh, or the middle of a cell (number: points of the mesh + cell).
struct Corner {
  int64_t id;
  Vec3 at, a, b;
  double most_a, most_b;  // lengths of a and b in the cells around: what counts as nothing
  bool parallel;          // here
};

/// A point of the lines belongs to a corner, to an edge between two or to a triangle between three; smaller ids first, none = -1. So what
/// lies exactly on an edge is the same point for all triangles there.
struct Key {
  std::array<int64_t, 3> corners;
  int place;  // which of up to three solutions
  friend auto operator<=>(const Key&, const Key&) = default;
};

struct Found {
  Key key;
  Vec3 at;
  double s[3];          // barycentric, in the order of the key
  double x[4];          // in the tetrahedron
  unsigned corners;     // of the tetrahedron, those that the key names, in bits
  double ratio, angle;  // a cos(angle) = b sin(angle), in units of the tetrahedron's largest values; (-pi/2, pi/2]
  int64_t cell;
};

struct Segment {
  Key from, to;
  int64_t cell;
};

/// |a x b| at most `nothing` of the product of the largest lengths around.
inline bool are_parallel(Vec3 a, Vec3 b, double most_a, double most_b, double nothing) {
  const Vec3 c = cross(a, b);
  return dot(c, c) <= nothing * nothing * (most_a * most_a) * (most_b * most_b);
}

/// Collects the points and segments of tetrahedra; neighbours find the points that they share with the same keys and in the same bits.
class TetraLines {
 public:
  explicit TetraLines(double least = 0) : nothing(least) {}
  void tetra(const Corner& p, const Corner& q, const Corner& r, const Corner& s, int64_t cell);

  double nothing;  ///< what counts as parallel, see are_parallel()
  std::vector<Found> found;
  std::vector<Segment> segments;
};

}  // namespace sg::parallel

// SPDX-License-Identifier: Apache-2.0
// TetWalk: one line through a TetMesh, tetrahedron by tetrahedron, that never gets lost.
//
// The line is a point in the plane across it. It crosses a face when it lies in the face's shadow there. The side of an edge on which it
// lies is decided exactly (rounded products that differ are in the right order; equal ones are compared by their rounding errors), from
// coordinates that depend only on the vertex, and a line through an edge or a vertex counts as moved by (e, e^2) for an infinitely small e
// (Edelsbrunner, Muecke 1990). So of the four faces of a tetrahedron the line crosses none or two, and a path that begins in a face of the
// boundary ends in another one, whatever the shape of the tetrahedra: flat, turned inside out or folded.
#pragma once
#include <vector>

#include "render/volume/sources/cells/cell_volume.h"

namespace sg::volume {

/// Whether the turn from a to b, seen from the point (0, 0), is to the left. Never the same for (a, b) and (b, a), unless a = b.
inline bool turns_left(double ax, double ay, double bx, double by) {
  const double p = ax * by, q = ay * bx;
  if (p != q) return p > q;
  const double ep = std::fma(ax, by, -p), eq = std::fma(ay, bx, -q);
  if (ep != eq) return ep > eq;
  if (ay != by) return ay > by;
  return bx > ax;
}

/// Where the point (0, 0) lies in a triangle around it, as weights of its corners, accurate to the last bits however flat it is. A line
/// through a face that it sees edge-on meets it somewhere on the line, too, not somewhere on the face.
void weights_in_face(const double corners[3][2], double weights[3]);

class TetWalk {
 public:
  /// Contribution of one tetrahedron.
  struct Piece {
    double from, to;  ///< ray lengths; to < from in parts that are folded back
    float enter, leave;
    uint32_t tet;
  };

  explicit TetWalk(const CellVolume& volume) : volume_(volume), mesh_(*volume.mesh) {}
  /// The line through `origin` (world) along the unit vector `direction`; nothing beyond `to` is needed.
  void start(Vec3 origin, Vec3 direction, double to);
  /// The next piece, near ones first where cells do not overlap; false when there is no more before `to`.
  bool next(Piece& piece);
  /// Where the line meets the mesh for the first time; HUGE_VAL when it does not before `to`.
  double entry() const { return entry_; }
  /// The ray's origin relative to the mesh's, and its direction.
  Vec3 origin() const { return origin_; }
  Vec3 direction() const { return direction_; }

 private:
  struct Corner {
    uint32_t id;
    double x, y, t;
    float f;
  };
  struct Hit {
    double t;
    uint32_t face;
    bool used;
  };
  Corner corner(uint32_t id) const;
  bool enter(uint32_t face, double& t);
  bool begin_path();
  void end_path(uint32_t tet, uint32_t apex);
  double interpolate(float& f) const;

  const CellVolume& volume_;
  const TetMesh& mesh_;
  Vec3 origin_, direction_, across_[2];
  double to_ = 0, t_ = 0, entry_ = 0;
  float f_ = 0;
  int32_t tet_ = -1;
  size_t steps_ = 0;
  Corner v_[3];  // of the face that was entered, to the left around the line
  std::vector<Hit> hits_;
};

}  // namespace sg::volume

// SPDX-License-Identifier: Apache-2.0
// Frames along poly-lines that turn no more than the line makes them: what tubes and ribbons are hung on.
#pragma once
#include <span>
#include <vector>

#include "data/dataset.h"

namespace sg {

/// Unit tangent, and two unit vectors across it; right-handed in the order tangent, normal, binormal.
struct LineFrame {
  Vec3 at, tangent, normal, binormal;
};

/// Of one line without repeated points (first and last may coincide: closed). Tangents halve the angle between segments; normals are
/// carried by double reflection (Wang, Juettler, Zheng, Liu 2008: rotation minimising to fourth order in the length of segments). `first`:
/// wanted direction of the first normal, or zero for any. Closed lines: what is left of a turn after one round is spread evenly, so that
/// the frames close.
void make_frames(std::span<const Vec3> line, bool closed, Vec3 first, std::vector<LineFrame>& out);

/// The lines of a mesh, as point numbers; points at the place of the one before, and points that are not finite, are left out. A closed
/// line does not repeat its first point.
struct LinePath {
  std::vector<uint32_t> points;
  uint32_t cell = 0;
  bool closed = false;
};
/// All lines of two points and more. `mesh` is a SurfaceMesh.
std::vector<LinePath> line_paths(const Dataset& mesh);

}  // namespace sg

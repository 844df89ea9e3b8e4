// SPDX-License-Identifier: Apache-2.0
// Faces and edges of cloth against the points and edges of surfaces: what points alone would not feel.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/vec.h"
#include "data/dataset.h"
#include "simulate/particles/bodies/box_grid.h"
#include "simulate/particles/obstacles.h"

namespace sg::swarm {

/// While a step is gone along straight ways, a point of a surface meets a face where the four points lie in a plane, and so do two edges:
/// a cubic in time (Provot 1997; Bridson, Fedkiw, Anderson 2002). A little gap is kept between them, which tells the next step on which
/// side the cloth is.
class FaceContact {
 public:
  /// Faces of `cloth`: its polygons, strips and flat cells. Surfaces without faces, and cloth without any, meet nothing here.
  FaceContact(const DatasetPtr& cloth, const std::vector<DatasetPtr>& surfaces, Bounce bounce, const std::string& who, Context& context);
  bool empty() const { return (faces_.empty() && edges_.empty()) || points_.empty(); }

  /// Finds what is met on the way from x0 to x1, and pushes the ends of these faces and edges back to where they are met, each by its
  /// share, those in `held` not at all; their velocities v1 lose what goes into the surface, bounce and are slowed by friction. Marks those
  /// that it moved; returns whether there were any. `stop`: they are to stay where they began, which is the last resort.
  bool push_back(std::span<const Vec3> x0, std::span<const Vec3> v0, std::span<Vec3> x1, std::span<Vec3> v1, std::span<const uint8_t> held,
                 bool stop, std::vector<uint8_t>& moved, const Context& context) const;

 private:
  struct Contact {
    std::array<uint32_t, 3> point;
    std::array<double, 3> weight;  // of the place that is met
    Vec3 at, normal;               // of the surface; towards where the cloth came from
  };
  double side(double first, double last, bool end) const;
  void meet_face(std::span<const Vec3> x0, std::span<const Vec3> x1, size_t face, std::vector<uint32_t>& near,
                 std::vector<Contact>& out) const;
  void meet_edge(std::span<const Vec3> x0, std::span<const Vec3> x1, size_t edge, std::vector<uint32_t>& near,
                 std::vector<Contact>& out) const;

  std::vector<std::array<uint32_t, 3>> faces_;
  std::vector<std::array<uint32_t, 2>> edges_;
  std::vector<Vec3> points_;  // of the surfaces
  std::vector<std::array<uint32_t, 2>> their_edges_;
  BoxGrid point_grid_, edge_grid_;
  Bounce bounce_;
  double gap_ = 0;  // what stays between
};

}  // namespace sg::swarm

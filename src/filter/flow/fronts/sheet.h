// SPDX-License-Identifier: Apache-2.0
// Sheet: triangles between particles that a flow carries, split where they grow (Krishnan, Garth, Joy 2009: time and streak surfaces).
#pragma once
#include <array>
#include <vector>

#include "filter/flow/unsteady/particles.h"

namespace sg {

struct Sheet {
  std::vector<Particle> particles;
  std::vector<double> s, born;  ///< per particle: seed parameter, time of release
  std::vector<std::array<uint32_t, 3>> triangles;

  /// Adds a particle; its number.
  uint32_t add(Vec3 x, double t, double seed_parameter);
  /// Puts a particle into the middle of every edge longer than `longest`, until none is (or eight times); then leaves out triangles with an
  /// edge longer than `tear`, and those of particles that have all ended or of whose edges one to an ended particle is longer than one and
  /// a half times `longest`. New particles take the time `t`. Edges are split in the order of their ends, so neighbours agree. Stops
  /// splitting above `most` particles.
  void refine(UnsteadyCursor& flow, double t, double longest, double tear, size_t most);

 private:
  bool split(UnsteadyCursor& flow, double t, double longest);
};

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// The skeleton of a flow: critical points, the lines that part it, its periodic orbits, and where it touches the border.
#pragma once
#include "filter/flow/topology/closed_orbits.h"

namespace sg {

struct TopologyParams {
  FieldName field;
  CriticalOptions critical{.noise = 0.02};
  bool separatrices = true, orbits = true, border = true;
  double offset = 0.02;
  int64_t max_steps = 2000;
  double tolerance = 1e-5;
  double circle = 0.25;
};
void describe(Schema& s, TopologyParams& p);

/// Parts, left out where empty: "critical points" (always there), "separatrices", "closed orbits", "switch points" and "border" (flat
/// meshes), "separation circles" (solids: seed curves of the separating surfaces). Lines from a surface or plane, points with their fields
/// as in critical_points, separatrices and closed_orbits. Throws Error(usage) for meshes of lines and fields that are not velocities.
CollectionPtr topology(const Data& in, const TopologyParams& p, Context& context);

struct TopologySeedsParams {
  FieldName field;
  CriticalOptions critical{.noise = 0.02};
  int64_t count = 8;
  double radius = 0.4;
};
void describe(Schema& s, TopologySeedsParams& p);
/// Seeds of streamlines in a pattern for each class (Verma, Kao, Pang 2000): a circle or sphere about nodes, a ray from foci and centres,
/// the diagonals between the directions of saddles. A point cloud with "critical point" and "type"; seeds outside the mesh are left out.
/// A flow without critical points gives an empty cloud and a warning.
DatasetPtr topology_seeds(const Data& in, const TopologySeedsParams& p, Context& context);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Isolated periodic orbits (limit cycles) of flows in the plane.
#pragma once
#include <vector>

#include "filter/flow/topology/critical_points.h"
#include "filter/flow/topology/poincare_map.h"
#include "filter/flow/topology/separatrices.h"

namespace sg {

struct OrbitOptions {
  int64_t max_steps = 5000;  ///< of the lines that look for orbits
  double tolerance = 1e-6;   ///< error of a step, in cell sizes
  double isolated = 0.02;    ///< see periodic_orbit()
};

/// Lines that neither leave the mesh nor end at a critical point spiral towards an orbit (Poincare, Bendixson). They start next to sources
/// (with the flow), sinks (against it) and centres (both), in the four sectors of each saddle and on each stretch of the border where the
/// flow enters, leaves or runs along (both ways), go along `separatrices`, and start at both sides of each orbit that was found: a line in
/// every region between the separatrices, also about holes. Orbits that only errors of interpolation part from their neighbours
/// (Orbit::resolved) belong to families. The fixed point of the return map is then found to 1e-10 cells. In order of
/// first discovery; the same for any number of threads. `in_families`: how many lines were closed among closed neighbours.
std::vector<Orbit> find_closed_orbits(const FlowParts& flow, const CriticalPoints& critical, const std::vector<Separatrix>& separatrices,
                                      const OrbitOptions& options, Context& context, size_t* in_families = nullptr);

/// Lines that come within 1/50 of a cell of an orbit and stay there end on it.
void end_at_orbits(std::vector<Separatrix>& lines, const std::vector<Orbit>& orbits, Context& context);

/// Closed poly-lines with the point field "speed" and cell fields "repelling" (0, 1), "period", "multiplier" and "length".
DatasetPtr orbits_dataset(const std::vector<Orbit>& orbits);

struct ClosedOrbitsParams {
  FieldName field;
  int64_t max_steps = 5000;
  double tolerance = 1e-6;
  double isolated = 0.02;
};
void describe(Schema& s, ClosedOrbitsParams& p);
/// Throws Error(usage) for meshes that are not flat.
DatasetPtr closed_orbits(const Data& in, const ClosedOrbitsParams& p, Context& context);

}  // namespace sg

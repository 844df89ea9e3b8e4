// SPDX-License-Identifier: Apache-2.0
// Lines that part regions of different flow: from saddles and from places of the border where it touches the flow.
#pragma once
#include <vector>

#include "filter/flow/topology/critical_points.h"
#include "filter/flow/topology/switch_points.h"
#include "filter/flow/trace.h"

namespace sg {

struct SeparatrixOptions {
  double offset = 0.02;  ///< from a saddle to where tracing begins, in diagonals of its cell
  TraceOptions trace;
};

/// Where lines end: "to" is the critical point that they came to.
struct Separatrix {
  enum class Origin : uint8_t { saddle, border, circle };
  std::vector<Vec3> points;   ///< the origin first
  std::vector<double> speed;  ///< at each of them
  Origin origin = Origin::saddle;
  int64_t from = -1;     ///< number of the critical point or of the switch point
  int64_t to = -1;       ///< number of the critical point where it ends; -1: elsewhere
  int64_t orbit = -1;    ///< number of the periodic orbit where it ends
  bool unstable = true;  ///< the flow leaves the origin along it; else it comes by it
  StopReason stop = StopReason::speed;
};

/// From each saddle of a surface four lines, from each in space the two along its single direction; from inner switch points one each
/// way, from detachment points one with the flow, from attachment points one against it. They end where they come within 1/10 of a cell
/// of a point that attracts (those traced backwards: repels) or 1/20 of another saddle, at the border, and by the trace options.
/// In order of saddles, then switch points; the same for any number of threads.
std::vector<Separatrix> find_separatrices(const FlowParts& flow, const CriticalPoints& critical, const std::vector<SwitchPoint>& border,
                                          const SeparatrixOptions& options, Context& context);

/// Seeds of the separating surfaces in space: about each saddle a circle in the plane of its two like directions, of radius `radius` in
/// diagonals of its cell; closed, `points` points.
std::vector<Separatrix> separatrix_circles(const CriticalPoints& critical, double radius, int points);

/// Seeds followed with the flow (sign 1) or against it (-1) until a limit: what find_separatrices() does with its seeds.
struct LimitSeed {
  Vec3 at;
  double sign;
  Separatrix line;  ///< with the points before the seed
};
void trace_to_limits(const FlowParts& flow, const CriticalPoints& critical, std::vector<LimitSeed>& seeds, const TraceOptions& options,
                     Context& context);

/// Poly-lines with the point field "speed" and cell fields "origin", "from", "to", "orbit" (where lines end at some), "unstable".
DatasetPtr separatrices_dataset(const std::vector<Separatrix>& lines);

struct SeparatricesParams {
  FieldName field;
  CriticalOptions critical{.noise = 0.02};
  double offset = 0.02;
  bool border = true;
  int64_t max_steps = 2000;
  double tolerance = 1e-5;
};
void describe(Schema& s, SeparatricesParams& p);
DatasetPtr separatrices(const Data& in, const SeparatricesParams& p, Context& context);

}  // namespace sg

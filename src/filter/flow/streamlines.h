// SPDX-License-Identifier: Apache-2.0
// streamlines: lines along a steady flow from seeds.
#pragma once
#include "filter/flow/seeds/seeds.h"
#include "filter/flow/trace.h"

namespace sg {

/// Fields of the lines besides speed, time, length and velocity.
enum class LineAttribute { fields, vorticity, rotation, none };
constexpr auto enum_words(LineAttribute) {
  using enum LineAttribute;
  return std::array{Word{"fields", fields}, Word{"vorticity", vorticity}, Word{"rotation", rotation}, Word{"none", none}};
}

struct StreamlinesParams {
  FieldName field;
  TraceDirection direction = TraceDirection::both;
  IntegrationParams integration;
  StopParams stop;
  SeedParams seeds;
  bool geographic = false;  ///< see geographic.h
  std::vector<LineAttribute> attributes{LineAttribute::fields};
};
void describe(Schema& s, StreamlinesParams& p);

/// A SurfaceMesh of poly-lines, one for each seed that lies in the flow, in the order of the seeds; lines follow the flow, so their first
/// point is upstream. A collection is one flow: lines cross from part to part, in cells of its highest dimension. A second input is a mesh
/// whose points are the seeds.
/// Point fields: "speed" (the active one), "time" and "length" since the seed (negative upstream of it), the velocity under the name of the
/// field (role vectors; on surfaces its part along the surface); by `attributes`: "fields": all other fields of the mesh (point fields
/// interpolated, a cell field by its cell; those that all parts of a collection have); "vorticity": the curl of the flow, from the cell's
/// gradient; "rotation": "angular velocity", half the vorticity along the line (radians a time), and "rotation", its integral over time
/// since the seed (radians): how far a ribbon has turned.
/// Cell fields: "seed" (number of the seed) and "stop" (why the line ended downstream, upstream with direction=backward: a StopReason,
/// labels). Of random seeds without a given count only the first are used, as many as give lines that can be distinguished in a picture.
/// Without max_length and max_time, lines end after one and a half times the mesh's diagonal. In grids that are mostly noise
/// (noise_speed.h) they end below 2 % of the largest speed, unless min_speed is given. Uniform grids and tetrahedra of f32 vectors go
/// through packets (packets/packets.h). Throws Error(usage) without a vector field, for one that is zero everywhere, and when no seed lies
/// in the flow.
Data streamlines(const std::vector<Data>& inputs, const StreamlinesParams& p, Context& context);

/// Lines of two points and more as that mesh, with the first four point fields and the cell fields. f32, about an origin of their own when
/// they lie far from zero.
DatasetPtr lines_dataset(const TracedLines& lines, const std::string& velocity_name, const std::string& unit);

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/topology.h"

#include <fmt/core.h>

#include "filter/flow/topology/border_edges.h"

namespace sg {

void describe(Schema& s, TopologyParams& p) {
  s("field", p.field, "Velocity field; default: the active vectors.").takes(fields::vectors);
  describe(s, p.critical);
  s("separatrices", p.separatrices, "Trace the lines that separate regions of different flow.");
  s("orbits", p.orbits, "Find periodic orbits (flat meshes).");
  s("border", p.border, "Find points where the flow touches the border, or separates from or attaches to walls (flat meshes).");
  s("offset", p.offset, "Distance from a saddle at which tracing begins, in diagonals of its cell.").positive();
  s("max_steps", p.max_steps, "Maximum number of steps of a line.").range(1, 1e9);
  s("tolerance", p.tolerance, "Error per step, in local cell sizes.").positive();
  s("circle", p.circle, "In 3D: radius of the seed circles of separation surfaces, in diagonals of the saddle's cell.").positive();
}

CollectionPtr topology(const Data& in, const TopologyParams& p, Context& context) {
  const FlowParts flow(in, p.field.name, "topology", context);
  const CriticalPoints critical = find_critical_points(flow, p.critical, context);
  auto out = std::make_shared<Collection>();
  out->parts.push_back({"critical points", critical_points_dataset(critical)});
  std::string text = "topology: " + summary(critical);
  std::vector<SwitchPoint> border;
  if (p.border && critical.plane) border = find_switch_points(flow, *critical.plane, context);
  std::vector<Separatrix> lines;
  if (p.separatrices || p.orbits) {
    SeparatrixOptions options;
    options.offset = p.offset;
    options.trace.tolerance = p.tolerance, options.trace.max_steps = p.max_steps, options.trace.min_speed = 1e-9 * flow.largest_speed();
    lines = find_separatrices(flow, critical, border, options, context);
  }
  std::vector<Orbit> orbits;
  size_t families = 0;
  if (p.orbits && critical.plane) {
    orbits = find_closed_orbits(flow, critical, lines, {}, context, &families);
    end_at_orbits(lines, orbits, context);
  }
  if (p.separatrices && !lines.empty()) {
    out->parts.push_back({"separatrices", separatrices_dataset(lines)});
    text += fmt::format("; {} separatrices", lines.size());
  }
  if (!orbits.empty()) {
    out->parts.push_back({"closed orbits", orbits_dataset(orbits)});
    text += fmt::format("; {} periodic orbit{}", orbits.size(), orbits.size() == 1 ? "" : "s");
  }
  if (families > 0) text += "; families of closed lines around centres";
  if (!border.empty()) {
    out->parts.push_back({"switch points", switch_points_dataset(border)});
    text += fmt::format("; {} switch point{} of the border", border.size(), border.size() == 1 ? "" : "s");
  }
  if (p.border && critical.plane) {  // where all of it lies
    const auto edges = border_edges(flow, *critical.plane, context);
    if (!edges.empty()) out->parts.push_back({"border", border_dataset(flow, edges)});
  }
  if (critical.dimension == 3) {
    const auto circles = separatrix_circles(critical, p.circle, 32);
    if (!circles.empty()) out->parts.push_back({"separation circles", separatrices_dataset(circles)});
  }
  context.info(text);
  return out;
}

}  // namespace sg

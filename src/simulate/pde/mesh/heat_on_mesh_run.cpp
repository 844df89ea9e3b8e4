// SPDX-License-Identifier: Apache-2.0
// The operation: a run, its frames and what it was given.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "data/cells/cell_topology.h"
#include "filter/field/calc/calc.h"
#include "filter/mesh/tessellate_cells.h"
#include "simulate/pde/mesh/heat_on_mesh.h"

namespace sg {

namespace {

DatasetPtr without_curved_solids(const DatasetPtr& in, Context& context) {
  const auto* m = in->as<UnstructuredMesh>();
  if (!m) return in;
  for (size_t c = 0; c < m->cells.size(); ++c)
    if (is_high_order(m->type(c)) && cell_type_info(m->type(c)).dimension == 3)
      return tessellate(in, {.tolerance = 1e-3, .max_level = 1}, context);
  return in;
}

// Keeps the mesh that was given, so that no other one can lie at its place while the run is kept.
struct MeshHeatRun : pde::MeshHeat {
  MeshHeatRun(DatasetPtr in, const HeatOnMeshParams& p, Context& context)
      : pde::MeshHeat(without_curved_solids(in, context), p, context), given(std::move(in)) {}
  DatasetPtr given;
};

// The mesh, and its fields that the expressions name, or that is warm.
GivenData given_to(const DatasetPtr& in, const HeatOnMeshParams& p) {
  std::vector<const Field*> fields;
  const auto add = [&](const Field& f) {
    if (std::find(fields.begin(), fields.end(), &f) == fields.end()) fields.push_back(&f);
  };
  for (const std::string* e : {&p.initial, &p.held, &p.value, &p.source, &p.diffusivity})
    for (const std::string& name : names_in_expression(*e))
      for (const Field& f : in->fields())
        if (f.name == name) add(f);
  if (p.initial.empty())
    if (const Field* f = p.field.empty() ? in->fields().active(1) : in->fields().find(p.field.name)) add(*f);
  GivenData given;
  given.add(in, std::move(fields));
  return given;
}

}  // namespace

RunCost cost_of_heat_on_mesh(const HeatOnMeshParams& p, uint64_t bytes) {
  const double points = double(bytes) / 72, solve = 1e-6 * points;
  const uint64_t result = bytes + uint64_t(8 * points);
  if (p.steady) return {result, 20 * solve};
  return cost_of_run(p, "heat_on_mesh", result, solve, equal_steps(p.frame, p.step.value_or(p.frame)));
}

DatasetPtr heat_on_mesh(const DatasetPtr& in, const HeatOnMeshParams& p, Context& context) {
  const auto make = [&] { return std::make_unique<MeshHeatRun>(in, p, context); };
  if (p.steady) {
    if (!p.store.empty()) fail_usage("a steady state has no run that could be stored", "heat_on_mesh store", "leave it out");
    const auto run = make();
    run->settle(context);
    return run->dataset(context);
  }
  return frame_of_run<MeshHeatRun>("heat_on_mesh", p, make, context, given_to(in, p));
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <cmath>

#include "base/text/text.h"
#include "data/cells/mesh_dimension.h"
#include "filter/mesh/surface.h"
#include "scene/look/look_parts.h"
#include "scene/show/surface.h"

namespace sg {

namespace {

// Whether the shape tells nothing: all points of the outer surface lie on the sides of its box.
bool is_box(const DatasetPtr& data, Context& context) {
  const DatasetPtr outside = surface_of(data, context);
  const auto* mesh = outside->as<SurfaceMesh>();
  const Box3 b = outside->bounds();
  if (!mesh || b.empty()) return false;
  const double hair = 1e-4 * b.diagonal();
  for (size_t i = 0; i < mesh->points.count(); ++i) {
    const Vec3 p = mesh->points.at(i);
    bool on_side = false;
    for (int a = 0; a < 3; ++a) on_side = on_side || p[a] - b.lo[a] < hair || b.hi[a] - p[a] < hair;
    if (!on_side) return false;
  }
  return true;
}

// What could be a velocity.
const Field* flow_of(const Dataset& d) {
  const Field* f = d.fields().with_role(Role::vectors);
  if (!f) f = d.fields().active(3);
  if (!f || f->components() != 3 || f->association != Association::point || f->role == Role::normals || f->role == Role::colors ||
      f->role == Role::tcoords)
    return nullptr;
  const std::string name = to_lower(f->name);
  if (name.find("disp") != name.npos || name.find("coord") != name.npos) return nullptr;
  const Range r = d.range(*f, -1);
  return !r.empty() && r.lo < r.hi ? f : nullptr;
}

}  // namespace

void show_flow(Look& look, const DatasetPtr& data, const std::string& field, Context& context) {
  constexpr size_t fewest = 200, most = 2000000;  // cells
  if (!field.empty() || !look.filter.empty() || look.camera.parallel || look.shows.size() != 1 || !look.shows[0].kind->is<SurfaceShow>())
    return;
  const Field* flow = flow_of(*data);
  if (!flow || data->cell_count() < fewest || data->cell_count() > most || mesh_dimension(*data) != 3 || !is_box(data, context)) return;
  // Few and no longer than the box, as closed rooms wind them up.
  look.filter = {"streamlines", "field=" + flow->name, "count=30", "max_length=" + short_number(data->bounds().diagonal(), 3)};
  look.shows[0].of_input = false;
  look.reason =
      fmt::format("{} mesh: its outside is a box, so the flow '{}' within is shown by streamlines; --show surface shows the outside",
                  data->kind(), flow->name);
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "scene/look.h"

#include <fmt/core.h>

#include "base/text/text.h"
#include "data/cells/mesh_dimension.h"
#include "data/lattice.h"
#include "io/y_up.h"
#include "scene/choose/scale.h"
#include "scene/choose/shown_range.h"
#include "scene/choose/volume_look.h"
#include "scene/show/labels.h"
#include "scene/show/outline.h"
#include "scene/show/points.h"
#include "scene/show/surface.h"
#include "scene/show/volume.h"

namespace sg {

namespace {

template <class P>
void add_show(Look& look, P params, bool of_input) {
  look.shows.push_back({&show_kind<P>(), param_set_of(std::move(params)), of_input});
}

// What a surface, line or dot will be coloured by.
std::string field_reason(const Dataset& d, const std::string& field) {
  const Field* f = field.empty() ? automatic_field(d) : d.fields().find(field);
  if (!f) return d.fields().empty() ? "one colour (there is no field)" : "one colour (no field varies over it)";
  if (f->role == Role::colors) return fmt::format("its own colours '{}'", f->name);
  return fmt::format("coloured by '{}'{}", f->name, f->components() > 1 ? " (magnitude)" : "");
}

// The normal of a surface whose points all lie in one plane, towards the usual viewer; nothing for others.
std::optional<Vec3> plane_normal(const Dataset& d, Vec3 towards) {
  const auto* m = d.as<SurfaceMesh>();
  if (!m || m->polygons.size() == 0) return {};
  const CellsView c = cells_view(m->polygons);
  const double size = d.bounds().diagonal();
  Vec3 normal;
  for (size_t cell = 0; cell < c.count && !(length(normal) > 0); ++cell) {
    Vec3 sum;  // Newell: twice the area vector
    const Vec3 first = m->points.at(size_t(c.point(cell, 0)));
    for (size_t k = 1; k + 1 < c.size(cell); ++k)
      sum += cross(m->points.at(size_t(c.point(cell, k))) - first, m->points.at(size_t(c.point(cell, k + 1))) - first);
    if (length(sum) > 1e-9 * size * size) normal = normalize(sum);
  }
  if (!(length(normal) > 0)) return {};
  const Vec3 origin = m->points.at(size_t(c.point(0, 0)));
  for (size_t i = 0; i < m->points.count(); ++i)
    if (std::abs(dot(m->points.at(i) - origin, normal)) > 1e-4 * size) return {};
  return dot(normal, towards) < 0 ? -normal : normal;
}

bool has_polygons(const Dataset& d) {
  if (auto* s = d.as<SurfaceMesh>()) return s->polygons.size() + s->strips.size() > 0;
  return true;
}

// A grid whose box does not lie along x, y and z: the box with the numbers is not its own.
bool is_turned(const Dataset& d) {
  const auto* g = d.as<UniformGrid>();
  if (!g) return false;
  for (int a = 0; a < 3; ++a) {
    const Vec3 axis = g->direction.column(a);
    if (std::max({std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)}) < 0.99999 * length(axis)) return true;
  }
  return false;
}

// A 3D scalar image or box grid: seen through, or for labels its voxel faces.
void look_at_grid(const Dataset& d, const Field& f, Look& look) {
  if (d.as<UniformGrid>() && f.association == Association::point && looks_like_labels(d, f)) {
    look.filter = {"label_surface", "field=" + f.name};
    SurfaceShow surface;
    surface.coloring.field.name = f.name, surface.coloring.map = "labels";
    add_show(look, surface, false);
    look.reason =
        fmt::format("'{}' has few integer values in connected regions: taken as labels, shown as surfaces with one colour each", f.name);
    return;
  }
  VolumeShow volume;
  volume.coloring.field.name = f.name;
  if (f.look.shows == FieldLook::Shows::fibres)
    if (const Field* speed = d.fields().find("speed", f.association); speed && speed->components() == 1)
      volume.color_by.name = speed->name, volume.sampling.tolerance = 0.01;  // a single colour would show less
  add_show(look, volume, true);
  if (is_turned(d)) add_show(look, OutlineShow(), true);
  ColoringParams params;
  Context quiet;
  VolumeItem item;
  item.color = choose_scale(d, f, params, quiet);
  const std::string why = choose_volume_look(d, f, params, item);
  look.reason = fmt::format("scalar field '{}' on a 3D grid: shown as a volume; {}", f.name, why);
}

}  // namespace

void choose_view(const Box3& b, const std::string& extension, Look& look) {
  if (b.empty()) return;
  const Vec3 s = b.size();
  const double most = std::max({s.x, s.y, s.z});
  const bool graphics = y_points_up(extension);
  const double flat = 1e-6 * most;
  if (s.z <= flat) {
    look.direction = {0, 0, 1}, look.up = {0, 1, 0}, look.parallel = true;
  } else if (s.y <= flat) {
    look.direction = {0, -1, 0}, look.up = {0, 0, 1}, look.parallel = true;
  } else if (s.x <= flat) {
    look.direction = {1, 0, 0}, look.up = {0, 0, 1}, look.parallel = true;
  } else if (graphics) {
    look.direction = {0.55, 0.42, 1.0}, look.up = {0, 1, 0};
  }
}

Look choose_look(const Dataset& d, const std::string& field, const std::string& extension) {
  Look look;
  choose_view(d.bounds(), extension, look);
  bool flat = look.parallel;
  if (!flat)
    if (const auto normal = plane_normal(d, look.direction)) look.direction = *normal, flat = true;
  if (d.point_count() == 0) {
    look.reason = "no points: the picture is empty";
    return look;
  }
  const auto dims = lattice_dims(d.mesh());
  const bool grid3 = is_lattice(d.mesh()) && dims[0] > 1 && dims[1] > 1 && dims[2] > 1;
  const bool box_grid = d.as<UniformGrid>() || d.as<RectilinearGrid>();
  const Field* scalar = field.empty() ? d.fields().with_role(Role::scalars) : d.fields().find(field);
  if (!scalar || (field.empty() && scalar->components() != 1)) scalar = d.fields().active(1);
  if (!scalar) scalar = d.fields().active(0);
  if (grid3 && field.empty())
    for (const Field& f : d.fields())
      if (f.look.shows == FieldLook::Shows::fibres && f.association == Association::point && f.components() == 1) scalar = &f;
  const bool colors = scalar && scalar->role == Role::colors && scalar->components() >= 3;

  if (grid3 && box_grid && scalar && !colors) {
    look_at_grid(d, *scalar, look);
    return look;
  }
  if (is_line_labels(d)) {
    add_show(look, LabelsShow(), true);
    look.reason = "label positions along lines: their values as text";
    return look;
  }
  if (d.as<PointCloud>() || (d.cell_count() == 0 && !is_lattice(d.mesh()))) {
    PointsShow points;
    points.size = d.point_count() > 200000 ? 1.5 : d.point_count() > 5000 ? 3 : 7;
    if (d.fields().with_role(Role::normals) && field.empty() && !automatic_field(d)) points.coloring.color = "#c8c8cc";  // lit
    add_show(look, points, true);
    look.reason = fmt::format("points only: shown as dots, {}", field_reason(d, field));
    return look;
  }
  if (!has_polygons(d)) {
    add_show(look, SurfaceShow(), true);
    look.reason = fmt::format("lines and vertices, {}", field_reason(d, field));
    return look;
  }
  // Crests and cores lie inside, of whatever cells; the outer surface shows none of them.
  using Shows = FieldLook::Shows;
  if (scalar && !colors && mesh_dimension(d) == 3)
    if (const Shows shows = scalar->look.shows; shows == Shows::high || shows == Shows::low) {
      VolumeShow volume;
      volume.coloring.field.name = scalar->name;
      add_show(look, volume, true);
      look.reason = fmt::format("'{}' in a solid mesh: shown as a volume", scalar->name);
      return look;
    }
  SurfaceShow surface;
  const bool simulation = !d.as<SurfaceMesh>() && !is_lattice(d.mesh());
  const bool bare_map = look.parallel && d.fields().empty() && d.as<SurfaceMesh>();  // only edges distinguish its parts
  const bool show_edges = (simulation && d.cell_count() <= 12000) || (bare_map && d.cell_count() <= 2000);
  surface.edges = show_edges;
  const Field* colored = field.empty() ? automatic_field(d) : d.fields().find(field);
  const bool filled_contours = flat && colored && colored->look.bands;
  surface.lit = !((look.parallel && box_grid) || filled_contours);  // an image: its colours as they are
  add_show(look, surface, true);
  if (is_lattice(d.mesh()) && !box_grid) add_show(look, OutlineShow(), true);
  look.reason = fmt::format("{} mesh: its outer surface{}, {}", d.kind(), show_edges ? " with cell edges" : "", field_reason(d, field));
  return look;
}

}  // namespace sg

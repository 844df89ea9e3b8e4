// SPDX-License-Identifier: Apache-2.0
#include "scene/look/look.h"

#include <fmt/core.h>

#include <numeric>
#include <set>

#include "base/text/text.h"
#include "data/cells/mesh_dimension.h"
#include "data/cells/plane_normal.h"
#include "data/lattice.h"
#include "data/patient/modality.h"
#include "data/patient/patient_frame.h"
#include "filter/mesh/surface.h"
#include "io/y_up.h"
#include "scene/choose/histogram.h"
#include "scene/choose/own_materials.h"
#include "scene/choose/scale.h"
#include "scene/choose/shown_range.h"
#include "scene/choose/signed_distance.h"
#include "scene/choose/telling_field.h"
#include "scene/choose/view/open_side.h"
#include "scene/choose/view/seen_outside.h"
#include "scene/choose/view/stretch.h"
#include "scene/choose/view/viewpoint.h"
#include "scene/choose/volume/look.h"
#include "scene/choose/volume/visible_box.h"
#include "scene/look/look_parts.h"
#include "scene/show/labels.h"
#include "scene/show/points.h"
#include "scene/show/surface.h"
#include "scene/show/volume.h"

namespace sg {

namespace {

// What a surface, line or dot will be coloured by.
std::string field_reason(const Dataset& d, const std::string& field) {
  const Field* f = field.empty() ? automatic_field(d) : d.fields().find(field);
  if (!f && d.fields().empty()) return "one colour (there is no field)";
  if (!f && has_own_materials(d)) return "its own materials (own_materials=false colours by its fields)";
  if (!f) {
    const auto is_id = [&](const Field& any) { return any.association != Association::whole && telling(d, any) == Telling::ids; };
    const bool ids = std::any_of(d.fields().begin(), d.fields().end(), is_id);
    return ids ? "one colour (its fields are ids of points, cells or groups)" : "one colour (no field varies over it)";
  }
  if (is_direct_color(*f)) return fmt::format("its own colours '{}'", f->name);
  return fmt::format("coloured by '{}'{}", f->name, f->components() > 1 ? " (magnitude)" : "");
}

// A slice of a scan that lies across the frame, as the nearest of the three usual ones is seen.
void face_slice(Vec3 normal, CameraDefaults& c) {
  const Vec3 a{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
  const bool axial = a.z >= a.x && a.z >= a.y, coronal = !axial && a.y >= a.x;
  const Vec3 usual = axial ? Vec3{0, 0, -1} : coronal ? Vec3{0, -1, 0} : Vec3{1, 0, 0};
  c.direction = dot(normal, usual) < 0 ? -normal : normal;
  c.up = axial ? Vec3{0, -1, 0} : Vec3{0, 0, 1};
  c.parallel = true;
}

// Solid cells in a single thin layer, as programs that know no plane cells keep a case of two dimensions: all points lie in two planes
// across one axis. -1: it is none.
int axis_of_layer(const Dataset& d) {
  constexpr size_t few = 16;  // cells of a block, which has two planes by chance
  const Box3 b = d.bounds();
  if (b.empty() || d.cell_count() < few || mesh_dimension(d) != 3) return -1;
  const Vec3 s = b.size();
  const int a = s.z <= s.x && s.z <= s.y ? 2 : s.y <= s.x ? 1 : 0;
  if (s[a] > 0.5 * std::min(s[(a + 1) % 3], s[(a + 2) % 3])) return -1;
  const Points* points = nullptr;
  if (const auto* u = d.as<UnstructuredMesh>()) points = &u->points;
  else if (const auto* c = d.as<CurvilinearGrid>()) points = &c->points;
  if (!points) return is_lattice(d.mesh()) && lattice_dims(d.mesh())[size_t(a)] == 2 ? a : -1;
  const double slack = 1e-5 * s[a];
  for (size_t i = 0; i < points->count(); ++i) {
    const double x = points->at(i)[a];
    if (x > b.lo[a] + slack && x < b.hi[a] - slack) return -1;
  }
  return a;
}

// Through the opening, unless that is above or below; a little from the side, as before.
void look_into(Vec3 opening, CameraDefaults& c) {
  const double upward = dot(opening, c.up);
  if (std::abs(upward) > 0.7 || dot(opening, c.direction) > 0.7 * length(c.direction)) return;
  c.direction = normalize(opening - c.up * upward) + c.up * 0.25 + normalize(cross(c.up, opening)) * 0.3;
}

// What lies flat is seen from higher up, what is long more from its side.
void face_bounds(Vec3 size, Vec3& direction) {
  constexpr double usual_height = 0.5, steeper = 2.1, long_ratio = 1.5, sideways = 0.5;
  const double wide = std::sqrt(size.x * size.y);
  if (!(wide > 0)) return;
  direction.z += steeper * std::max(usual_height - size.z / wide, 0.0);
  if (size.x > long_ratio * size.y) direction.x = sideways;
  if (size.y > long_ratio * size.x) direction.x = 1, direction.y = -sideways;
}

bool has_polygons(const Dataset& d) {
  if (auto* s = d.as<SurfaceMesh>()) return s->polygons.size() + s->strips.size() > 0;
  return true;
}

// What magnetic resonance and the like measure has no opacity of its own: three slices through the middle, as on a console, in grey.
bool look_at_scan(const Dataset& d, const Field& f, Look& look) {
  double offset = 0;
  const Range r = d.range(f);
  constexpr double cut_out = 0.7;
  if (!is_scanned(d, f) || r.empty() || two_sided(f, r) || modality_of(d, f) == Modality::ct || looks_like_ct(d, f, &offset)) return false;
  // What was cut out of its surroundings has a surface to be seen: a brain without its skull, vessels alone.
  const std::vector<size_t> bins = histogram(d, f, -1, r.lo, r.hi, 1024);
  if (double(bins.front()) > cut_out * double(std::accumulate(bins.begin(), bins.end(), size_t(0)))) return false;
  look.filter = {"slice", "planes=xyz"};
  SurfaceShow slices;
  slices.coloring.field.name = f.name;
  slices.lit = false;  // as measured
  add_show(look, slices, false);
  look.camera.direction = {0.8, -1.0, 0.65};
  look.picture = {"views=front,left,bottom,iso"};
  look.reason =
      fmt::format("'{}' is a scan: three slices through its middle, each seen straight on; --show volume shows it as a body", f.name);
  return true;
}

// Whether all values are about equally frequent, as those of a ramp: none is what others stand before.
bool has_no_background(const Dataset& d, const Field& f) {
  constexpr double even = 1.6;  // times as many as a twentieth of the range has on average
  const Range r = d.range(f);
  const auto bins = histogram(d, f, -1, r.lo, r.hi, 20);
  const size_t all = std::accumulate(bins.begin(), bins.end(), size_t(0));
  return double(*std::max_element(bins.begin(), bins.end())) < even * double(all) / double(bins.size());
}

// A layer through which rays would meet too little to be seen.
bool is_thin(const Box3& b) {
  constexpr double thin = 0.1;
  const Vec3 s = b.size();
  const double least = std::min({s.x, s.y, s.z}), most = std::max({s.x, s.y, s.z});
  return least < thin * (s.x + s.y + s.z - least - most);
}

// So few cells that each can be told from the next, or values that hide nothing: a body, as there is nothing to see through.
bool look_at_body(const Dataset& d, const Field& f, Look& look) {
  constexpr size_t few = 10;  // along each axis
  const auto dims = lattice_dims(d.mesh());
  const bool few_cells = *std::max_element(dims.begin(), dims.end()) <= few + 1, thin = is_thin(d.bounds());
  if (in_patient_frame(d) || f.look.shows != FieldLook::Shows::any || !(few_cells || thin || has_no_background(d, f))) return false;
  SurfaceShow surface;
  surface.edges = few_cells;
  surface.coloring.field.name = f.name;
  add_show(look, surface, true);
  look.reason = fmt::format("'{}' on a grid{}: its outer surface{}; --show volume sees through it", f.name,
                            few_cells ? " of few cells"
                            : thin    ? " that is a thin layer"
                                      : ", all values alike frequent",
                            few_cells ? " with cell edges" : "");
  return true;
}

// A 3D scalar image or box grid: seen through, or for labels its voxel faces.
void look_at_grid(const Dataset& d, const Field& f, Look& look) {
  const bool image = d.as<UniformGrid>() || (d.as<RectilinearGrid>() && f.role == Role::labels);
  if (image && f.association == Association::point && looks_like_labels(d, f)) {
    look.filter = {"label_surface", "field=" + f.name, "iterations=100"};  // steps of voxels would catch the light
    SurfaceShow surface;
    surface.coloring.field.name = f.name, surface.coloring.map = "labels";
    add_show(look, surface, false);
    look.reason =
        fmt::format("'{}' has few integer values in connected regions: taken as labels, shown as surfaces with one colour each", f.name);
    return;
  }
  if ((d.as<UniformGrid>() && look_at_scan(d, f, look)) || look_at_body(d, f, look)) return;
  VolumeShow volume;
  volume.coloring.field.name = f.name;
  if (f.look.shows == FieldLook::Shows::fibres)
    if (const Field* speed = d.fields().find("speed", f.association); speed && speed->components() == 1)
      volume.color_by.name = speed->name, volume.sampling.tolerance = 0.01;  // a single colour would show less
  add_show(look, volume, true);
  ColoringParams params;
  Context quiet;
  VolumeItem item;
  item.color = choose_scale(d, f, params, quiet);
  const std::string why = choose_volume_look(d, f, params, item);
  const std::optional<HeadPose> pose = unstated_pose(d);
  if (!in_patient_frame(d) && !pose) look.frame = visible_box(d, f, params.component, item.opacity);
  if (look.frame && !in_patient_frame(d) && look.camera.up == CameraDefaults().up)
    look.camera.direction = CameraDefaults().direction, face_bounds(look.frame->size(), look.camera.direction);
  look.reason = fmt::format("scalar field '{}' on a 3D grid: shown as a volume; {}", f.name, why);
  if (pose) look.reason += "; " + face_unstated(*pose, look.camera);
}

// A signed distance, or another function whose zeros alone mean something: their surface.
bool look_at_level_set(const Dataset& d, const Field& f, Look& look) {
  const bool known = f.look.shows == FieldLook::Shows::zero || (f.look.shows == FieldLook::Shows::any && is_signed_distance(d, f));
  if (!known || f.components() != 1 || mesh_dimension(d) != 3) return false;
  const Range r = d.range(f, 0);
  if (!(r.lo < 0 && r.hi > 0)) return false;
  look.filter = {"contour", "field=" + f.name, "values=0"};
  add_show(look, SurfaceShow(), false);
  look.reason = fmt::format("'{}' is a level set: shown as the surface where it is 0", f.name);
  return true;
}

}  // namespace

void face_axis(int axis, bool patient, CameraDefaults& c) {
  c.parallel = true;
  if (axis == 2) c.direction = {0, 0, patient ? -1.0 : 1.0}, c.up = {0, patient ? -1.0 : 1.0, 0};
  else c.direction = axis == 1 ? Vec3{0, -1, 0} : Vec3{1, 0, 0}, c.up = {0, 0, 1};
}

std::string face_unstated(const HeadPose& pose, CameraDefaults& camera) {
  if (stand_up(pose, camera))
    return fmt::format("how the patient lies is not stated: the crown of a head is seen where z is {}", pose.crown > 0 ? "high" : "low");
  return "how the patient lies is not stated: --camera 'view=front up=0,0,-1' turns one that is upside down";
}

namespace {

CameraDefaults usual_view(const Box3& b, bool y_up, bool patient) {
  CameraDefaults c;
  if (patient) c.axes = patient_view_axes, c.direction = {0.4, -1.0, 0.25};
  else if (y_up) c.axes = graphics_axes, c.direction = {0.55, 0.42, 1.0}, c.up = {0, 1, 0};
  if (b.empty()) return c;
  const Vec3 s = b.size();
  if (!patient && !y_up) face_bounds(s, c.direction);
  const double flat = 1e-6 * std::max({s.x, s.y, s.z});
  if (flat == 0) return c;  // a point
  for (int a = 2; a >= 0; --a)
    if (s[a] <= flat) {
      face_axis(a, patient, c);
      break;
    }
  return c;
}

}  // namespace

CameraDefaults view_with_up(const Box3& bounds, bool y_up) { return usual_view(bounds, y_up, false); }

CameraDefaults choose_view(const Box3& bounds, const std::string& extension, bool patient) {
  return usual_view(bounds, y_points_up(extension), patient);
}

Look choose_look(const Dataset& d, const std::string& field, const std::string& extension, bool of_series) {
  Look look;
  const bool patient = in_patient_frame(d);
  look.camera = choose_view(d.bounds(), extension, patient);
  bool flat = look.camera.parallel;
  if (!flat && d.bounds().diagonal() > 0)
    if (const auto normal = plane_normal(d, look.camera.direction)) {
      look.camera.direction = *normal, flat = true;
      if (patient) face_slice(*normal, look.camera);
    }
  if (const auto* mesh = d.as<SurfaceMesh>(); mesh && !flat && y_points_up(extension))
    if (const auto open = open_side(*mesh)) look_into(*open, look.camera);
  if (!flat && !patient)
    if (const int axis = axis_of_layer(d); axis >= 0) face_axis(axis, patient, look.camera);
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
  if (field.empty() && scalar && telling(d, *scalar) != Telling::values)
    if (const Field* f = automatic_field(d); f && f->components() == 1) scalar = f;
  if (grid3 && field.empty())
    for (const Field& f : d.fields())
      if (f.look.shows == FieldLook::Shows::fibres && f.association == Association::point && f.components() == 1) scalar = &f;
  const bool colors = scalar && scalar->role == Role::colors && scalar->components() >= 3;

  if (field.empty() && ((of_series && look_at_diffusion(d, look)) || look_at_tensors(d, look) || look_at_stress(d, look))) return look;
  if (scalar && (look_at_profile(d, *scalar, look) || look_at_line_probe(d, *scalar, look) || look_at_level_set(d, *scalar, look)))
    return look;
  if (grid3 && box_grid && scalar && !colors) {
    look_at_grid(d, *scalar, look);
    if (is_unstated_depth(d, *scalar)) {
      const DatasetPtr alone(DatasetPtr(), &d);
      const Vec3 f = chosen_stretch({&alone, 1}, d.bounds());
      look.picture.push_back(fmt::format("stretch={},{},{}", short_number(f.x), short_number(f.y), short_number(-f.z)));
      look.reason += "; its third axis grows downwards, as there are fewer values the farther along it they are";
    }
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
  const bool bare_map = look.camera.parallel && d.fields().empty() && d.as<SurfaceMesh>();  // only edges distinguish its parts
  const int dimension = mesh_dimension(d);
  const bool show_edges = dimension >= 2 && ((simulation && d.cell_count() <= 100000) || (bare_map && d.cell_count() <= 2000));
  constexpr std::string_view seen[] = {"its points", "its lines", "its faces", "its outer surface"};
  surface.edges = show_edges;
  add_show(look, surface, true);
  look.reason =
      fmt::format("{} mesh: {}{}, {}", d.kind(), seen[size_t(dimension)], show_edges ? " with cell edges" : "", field_reason(d, field));
  return look;
}

void face_detail(Look& look, std::span<const DatasetPtr> parts, const std::string& extension, Context& context) {
  constexpr size_t few_cells = 1000;
  if (look.camera.parallel || !look.filter.empty()) return;
  std::vector<DatasetPtr> outer;
  std::vector<const SurfaceMesh*> surfaces;
  for (const DatasetPtr& d : parts) {
    if (in_patient_frame(*d) || (!y_points_up(extension) && automatic_field(*d))) return;
    const bool few_solids = !is_lattice(d->mesh()) && mesh_dimension(*d) == 3 && d->cell_count() <= few_cells;
    outer.push_back(few_solids ? surface_of(d, context) : d);
    const auto* mesh = outer.back()->as<SurfaceMesh>();
    if (!mesh) return;
    surfaces.push_back(mesh);
  }
  look.camera.direction = telling_direction(surfaces, look.camera.direction, look.camera.up);
}

namespace {

// The names of the types of solid cells, where there are cells of other dimensions too.
std::string solid_types_of_mixed(const Dataset& d) {
  const auto* mesh = d.as<UnstructuredMesh>();
  if (!mesh || mesh->types.empty()) return "";
  std::set<CellType> solid;
  bool mixed = false;
  for (size_t i = 0; i < d.cell_count(); ++i) {
    if (cell_type_info(mesh->type(i)).dimension == 3) solid.insert(mesh->type(i));
    else mixed = true;
  }
  std::string names;
  for (const CellType t : solid) names += fmt::format("{}{}", names.empty() ? "" : ",", cell_type_info(t).name);
  return mixed ? names : "";
}

}  // namespace

void cut_open(Look& look, const DatasetPtr& data, const std::string& field, Context& context) {
  if (!look.filter.empty() || look.camera.parallel || look.shows.size() != 1 || !look.shows[0].kind->is<SurfaceShow>()) return;
  const Field* f = field.empty() ? automatic_field(*data) : data->fields().find(field);
  if (!f || f->role == Role::colors || !tells_only_inside(data, *f, context)) return;
  // Across the line of sight, but a long body lengthwise.
  const Vec3 size = data->bounds().size(), towards = look.camera.direction;
  const int longest = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const bool is_long = size[longest] > 1.5 * std::max(size[(longest + 1) % 3], size[(longest + 2) % 3]);
  int axis = -1;
  for (int a = 0; a < 3; ++a)
    if (!(is_long && a == longest) && (axis < 0 || std::abs(towards[a]) > std::abs(towards[axis]))) axis = a;
  // Faces that lie upon solids would hide where these are cut.
  if (const std::string solids = solid_types_of_mixed(*data); !solids.empty()) look.prepare = {"extract", "types=" + solids};
  look.filter = {"clip", fmt::format("axis={}", "xyz"[axis])};
  look.shows[0].of_input = false;
  look.reason += telling(*data, *f) == Telling::divisions
                     ? fmt::format("; parts of '{}' lie inside, so it is cut open", f->name)
                     : fmt::format("; its outside has nearly one value of '{}', so it is cut open", f->name);
}

}  // namespace sg

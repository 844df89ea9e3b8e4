// SPDX-License-Identifier: Apache-2.0
#include "scene/show/surface.h"

#include <fmt/core.h>

#include "base/error.h"
#include "color/parse_color.h"
#include "data/cells/plane_normal.h"
#include "data/field_ops.h"
#include "filter/field/sampling/point_cell.h"
#include "filter/mesh/faces/bilinear_quads.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/surface.h"
#include "image/image.h"
#include "scene/choose/own_materials.h"
#include "scene/show/field_color.h"
#include "scene/show/own_look.h"
#include "scene/show/texture_color.h"

namespace sg {

void describe(Schema& s, SurfaceShow& p) {
  describe(s, p.coloring);
  s("style", p.style, "solid: its faces; wireframe: the edges of the faces alone; points: their points alone.");
  s("opacity", p.opacity, "Opacity: 1 is opaque, 0 invisible.").range(0, 1);
  s("edges", p.edges, "Draw the edges of the cells; they fade where those are narrower than eight pixels, all of them where most are.");
  s("flat", p.flat, "Shade with one normal per polygon instead of smoothly.");
  s("lit", p.lit, "Light the surface; default: yes, but not a flat one that a field colours: its colours are those of the legend.");
  s("feature_angle", p.feature_angle, "Edges with a larger angle stay sharp when normals are computed.").unit("deg").range(0, 180);
  describe(s, p.lic);
  describe(s, p.material);
  describe(s, p.varying);
  s("texture", p.texture, "Point field in [0, 1] that darkens and brightens the colours; default: 'lic' or 'spot noise'; 'none' for none.")
      .takes(fields::point_scalars);
  describe(s, p.isolines);
  describe(s, p.picture);
  s("own_materials", p.own_materials,
    "Draw with the materials and pictures that come with the data (glTF, OBJ), where neither a field nor a colour is stated.");
}

void check(const SurfaceShow& p) {
  check(p.picture);
  if (p.style != SurfaceStyle::solid && (p.picture.any() || p.picture.any_other() || p.varying.any_picture()))
    fail_usage("edges and points show no picture", "style", "style=solid does");
  if (p.style != SurfaceStyle::solid && p.isolines.any())
    fail_usage("lines of equal value are drawn on faces, and edges and points have none", "style",
               "style=solid does; edges=yes adds the edges");
  if (!p.picture.any()) return;
  if (!p.coloring.field.empty() && !p.coloring.field.none())
    fail_usage(fmt::format("both a picture and the field '{}' are to colour the surface", p.coloring.field.name), "picture",
               "leave one out; texture=FIELD darkens colours by a field");
}

const Field* automatic_field(const SurfaceShow& p, const Dataset& d) {
  if (p.picture.any() || p.material.has_color()) return nullptr;
  return p.own_materials ? automatic_field(d) : automatic_field_without_materials(d);
}

namespace {

// Where colours tell values, light may not take them far from those of the legend: it shows the shape and no more.
constexpr Material telling_colors{0.42f, 0.58f, 0.08f, 32, true};

// The points of the vertex cells as a cloud, on which a cell field is a point field.
DatasetPtr vertex_cells(const Dataset& d, const SurfaceMesh& mesh, const std::string& field) {
  const CellsView v = cells_view(mesh.vertices);
  std::vector<double> xyz;
  std::vector<int64_t> cells;
  for (size_t c = 0; c < v.count; ++c)
    for (size_t k = v.begin(c); k < v.end(c); ++k) {
      const Vec3 p = mesh.points.at(size_t(v.connectivity[k])) - mesh.points.origin;
      xyz.insert(xyz.end(), {p.x, p.y, p.z});
      cells.push_back(int64_t(c));
    }
  Field f = d.fields().require(field, Association::cell);
  f.association = Association::point;
  f.array = gather(f.array, cells);
  FieldSet fields;
  fields.add(std::move(f));
  return make_dataset(Mesh(PointCloud{{Array::from_vector(std::move(xyz), 3), mesh.points.origin}}), std::move(fields));
}

// Its points with their fields, and its edges as lines.
DatasetPtr edges_as_lines(const Dataset& surface) {
  const SurfaceMesh& from = *surface.as<SurfaceMesh>();
  const std::vector<uint32_t> ends = edges_of(from);
  SurfaceMesh mesh;
  mesh.points = from.points;
  mesh.lines = {Array::from_vector(std::vector<int64_t>(ends.begin(), ends.end())), {}, 2};
  FieldSet fields;
  for (const Field& f : surface.fields())
    if (f.association == Association::point) fields.add(f);
  return make_dataset(Mesh(std::move(mesh)), std::move(fields));
}

std::optional<Legend> add_sparse(Scene& scene, const DatasetPtr& input, const SurfaceShow& p, Context& context) {
  DatasetPtr data = surface_of(input, context);
  auto color_by = field_color(*input, p.coloring, context);
  const auto legend = legend_of(color_by);
  if (color_by && color_by->direct && color_by->association == Association::cell) color_by.reset();  // colours have no mean
  if (color_by && color_by->association == Association::cell) {                                      // edges and points lie between cells
    CellToPointParams to_points;
    to_points.fields = {color_by->field};
    data = cell_to_point(data, to_points, context);
    color_by->association = Association::point;
  }
  const auto draw = [&](auto item) {
    item.color_by = color_by, item.opacity = p.opacity;
    if (!p.coloring.color.empty()) item.color = parse_color(p.coloring.color, "color");
    scene.items.emplace_back(std::move(item));
  };
  if (p.style == SurfaceStyle::points) {
    PointsItem points;
    points.data = data;
    draw(std::move(points));
  } else {
    LinesItem lines;
    lines.data = edges_as_lines(*data), lines.width = 1.2;
    draw(std::move(lines));
  }
  return legend;
}

// The colours of points that a file multiplies with its materials.
std::optional<FieldColor> own_colors(const Dataset& d) {
  for (const Field& f : d.fields())
    if (f.association == Association::point && is_direct_color(f)) return FieldColor{f.name, f.association, -1, {}, true};
  return {};
}

// The field by name where it is not the one that every way to show would take.
ColoringParams coloring_of(const SurfaceShow& p, const Dataset& d) {
  ColoringParams c = p.coloring;
  if (p.own_materials || !c.field.empty() || !c.color.empty()) return c;
  const Field* f = automatic_field(p, d);
  c.field.name = f ? f->name : "none";
  return c;
}

}  // namespace

void share(const std::vector<DatasetPtr>& parts, const std::vector<SurfaceShow*>& params) {
  Box3 box;
  for (const DatasetPtr& d : parts) box.add(d->bounds());
  for (SurfaceShow* p : params) p->body = box.diagonal();
}

std::optional<Legend> add(Scene& scene, const DatasetPtr& input, const SurfaceShow& p, Context& context) {
  check(p);
  if (p.style != SurfaceStyle::solid) return add_sparse(scene, input, p, context);
  const bool unstated = p.coloring.field.empty() && p.coloring.color.empty() && !p.coloring.states_map() && !p.material.any() &&
                        !p.varying.any() && !p.picture.any() && !p.picture.any_other();
  const bool own_look = unstated && p.own_materials && !automatic_field(*input) && has_own_materials(*input);
  SurfaceItem item;
  // Ranges come from the whole input, so that a surface and its volume share colours.
  if (own_look) item.color_by = own_colors(*input);
  else if ((!p.material.has_color() && !p.picture.any()) || !p.coloring.field.empty())
    item.color_by = field_color(*input, coloring_of(p, *input), context);
  if (p.edges) {
    // Of a clipped mesh the pieces of a cell keep its own number, by which the edges between them are left out.
    Skin skin = faces_and_edges(input, {.original_cell = false}, context);
    item.data = std::move(skin.surface), item.edge_lines = std::move(skin.edges);
  } else {
    item.data = surface_of(input, context);
  }
  if (item.color_by && item.color_by->association == Association::point && item.color_by->scale.labels.empty()) {
    const DatasetPtr whole = std::exchange(item.data, bilinear_parts(item.data, item.color_by->field));
    if (item.data != whole && !item.edge_lines) item.edge_lines = whole;
  }
  const bool varies = p.varying.any() || !p.picture.material_picture.empty();
  if (p.material.any() || varies) item.made_of = p.material.made(p.body > 0 ? p.body : input->bounds().diagonal());
  if (p.material.has_color()) item.color = own_color(*item.made_of);
  if (p.picture.any() && !p.material.has_color()) item.color = {1, 1, 1};
  if (!p.coloring.color.empty()) item.color = parse_color(p.coloring.color, "color");
  item.pictures = pictures_of(*item.data, p.picture);
  if (varies) {
    auto pictures = item.pictures ? std::make_shared<SurfacePictures>(*item.pictures) : std::make_shared<SurfacePictures>();
    apply(p.varying, p.material, p.picture, *item.data, *item.made_of, *pictures, context);
    item.pictures = std::move(pictures);
  }
  item.opacity = p.opacity;
  item.edges = p.edges;
  item.flat = p.flat;
  if (item.color_by && !item.color_by->direct) item.material = telling_colors;
  item.material.lit = p.lit.value_or(!(item.color_by && plane_normal(*item.data)));
  item.feature_angle = p.feature_angle;
  item.lic = surface_texture_of(*item.data, p.lic);
  const SurfaceMesh& mesh = *item.data->as<SurfaceMesh>();
  const auto legend = legend_of(item.color_by);
  if (mesh.lines.size() > 0) {
    LinesItem lines;
    lines.data = item.data;
    lines.color_by = item.color_by;
    lines.opacity = p.opacity;
    if (mesh.polygons.size() + mesh.strips.size() == 0) lines.width = 2.5, lines.color = lone_color;
    if (!p.coloring.color.empty()) lines.color = item.color;
    scene.items.emplace_back(std::move(lines));
  }
  if (mesh.vertices.size() > 0) {
    PointsItem points;
    points.data = item.data;
    points.color_by = item.color_by;
    if (item.color_by && item.color_by->association == Association::cell) {
      points.data = vertex_cells(*item.data, mesh, item.color_by->field);
      points.color_by->association = Association::point;
    }
    if (!p.coloring.color.empty()) points.color = item.color;
    else if (mesh.polygons.size() + mesh.strips.size() == 0) points.color = lone_color;
    points.opacity = p.opacity;
    points.size = 8;
    scene.items.emplace_back(std::move(points));
  }
  const bool any_surface = mesh.polygons.size() + mesh.strips.size() > 0;
  const std::optional<FieldColor> lines_by = item.color_by;
  apply_texture(item, texture_field(*input, p.texture, item.color_by));  // gives the item other data: `mesh` may be gone
  if (!any_surface) return legend;
  const auto isolines = isolines_of(*item.data, p.isolines, lines_by);
  for (SurfaceItem& each : own_look ? items_of_materials(item, context) : std::vector{item}) {
    if (isolines) {
      auto drawn = each.pictures ? std::make_shared<SurfacePictures>(*each.pictures) : std::make_shared<SurfacePictures>();
      drawn->isolines = isolines;
      each.pictures = drawn;
    }
    scene.items.emplace_back(std::move(each));
  }
  return legend;
}

}  // namespace sg

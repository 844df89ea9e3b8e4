// SPDX-License-Identifier: Apache-2.0
#include "scene/show.h"

#include "base/text.h"
#include "color/parse_color.h"
#include "data/field_ops.h"
#include "filter/mesh/faces.h"
#include "filter/mesh/surface.h"
#include "scene/show_glyphs.h"
#include "scene/show_labels.h"
#include "scene/show_volume.h"
#include "scene/texture_color.h"

namespace sg {

void describe(Schema& s, ColoringParams& p) {
  s("field", p.field, "Field to colour by; default: the active scalar; 'none' for one colour.");
  s("component", p.component, "Component of a field with several; -1 is the magnitude.").range(-1, 1e6);
  s("map", p.map, "Colour map (see: sightglass colormap), or a file: FILE.cpt, FILE.json:NAME; 'auto' looks at the data.");
  s("range", p.range, "Values at the two ends of the map; default: the range of the data.").unit("@field");
  s("scale", p.scale, "How values spread over the map.").choices({"linear", "log", "symlog"});
  s("linear_threshold", p.linear_threshold, "symlog: linear between minus and plus this; 0 chooses a thousandth of the range.").at_least(0);
  s("below", p.below, "Colour of values below the range; default: the first colour.");
  s("above", p.above, "Colour of values above the range; default: the last colour.");
  s("nan", p.nan, "Colour where there is no value.");
  s("clamp", p.clamp, "Values out of range take the end colours; false leaves them out of the picture.");
  s("color", p.color, "One colour instead of a field: #rrggbb, r,g,b or a name.");
}

void describe(Schema& s, SurfaceShow& p) {
  describe(s, p.coloring);
  s("opacity", p.opacity, "1 hides what is behind, 0 is invisible.").range(0, 1);
  s("edges", p.edges, "Draw the edges of the cells.");
  s("flat", p.flat, "One normal per polygon instead of smooth shading.");
  s("lit", p.lit, "Light the surface; false shows the plain colours.");
  s("feature_angle", p.feature_angle, "Edges sharper than this stay sharp when normals are computed.").unit("deg").range(0, 180);
  describe(s, p.lic);
  s("texture", p.texture, "Point field in [0, 1] that darkens and brightens the colours; default: 'lic' or 'spot noise'; 'none' for none.");
}

void describe(Schema& s, LinesShow& p) {
  describe(s, p.coloring);
  s("opacity", p.opacity, "1 hides what is behind, 0 is invisible.").range(0, 1);
  s("width", p.width, "Width of the lines.").unit("pixels").positive();
  s("lit", p.lit, "Light the lines by their direction: bright across the light, dark along it.");
  s("halo", p.halo, "Border around each line that hides lines behind it, so that crossings show which is in front.")
      .unit("pixels")
      .range(0, 100);
  s("halo_color", p.halo_color, "Colour of the halos.");
}

void describe(Schema& s, PointsShow& p) {
  describe(s, p.coloring);
  s("opacity", p.opacity, "1 hides what is behind, 0 is invisible.").range(0, 1);
  s("size", p.size, "Diameter of the dots.").unit("pixels").positive();
  s("discs", p.discs, "Draws points that have normals and a field 'radius' as discs in space (see surfels); they hide what is behind.");
}

void describe(Schema& s, OutlineShow& p) {
  s("color", p.color, "Colour of the box.");
  s("width", p.width, "Width of the lines.").unit("pixels").positive();
}

namespace {

// Ids: 5, 6, 7, ... in the order of the points or cells, or a name that says so; textures.
bool is_numbering(const Field& f) {
  if (f.components() != 1) return false;
  const std::string name = to_lower(f.name);
  if (name == "lic" || name == "spot noise") return true;  // a texture goes with the colours of another field
  for (std::string_view end : {"id", "ids", "nodenums", "elemnums", "number", "valid"})
    if (name.ends_with(end)) return true;
  const size_t n = std::min<size_t>(f.array.count(), 1000);
  if (n < 16) return false;
  for (size_t i = 1; i < n; ++i)
    if (f.array.get(i) != f.array.get(i - 1) + 1) return false;
  return true;
}

}  // namespace

const Field* automatic_field(const Dataset& d) {
  // A field that is the same everywhere (a contour's own field) says nothing in colour.
  auto varies = [&](const Field& f) {
    const Range r = d.range(f);
    return r.empty() || r.lo < r.hi;
  };
  auto plain = [](Role r) { return r != Role::normals && r != Role::tcoords && r != Role::global_ids; };
  if (is_banded(d)) return d.fields().find("band", Association::cell);
  if (const Field* f = d.fields().with_role(Role::scalars); f && f->components() == 1 && varies(*f)) return f;
  if (const Field* f = d.fields().with_role(Role::colors)) return f;
  for (const bool numberings : {false, true})
    for (int components : {1, 3})
      for (Association a : {Association::point, Association::cell})
        for (const Field& f : d.fields())
          if (f.association == a && f.components() == components && plain(f.role) && is_numbering(f) == numberings && varies(f)) return &f;
  return nullptr;
}

const Field* wanted_field(const Dataset& d, const ColoringParams& p) {
  if (!p.color.empty() || p.field.name == "none") return nullptr;
  if (!p.field.empty()) {
    const Field& f = d.fields().require(p.field.name);
    if (f.association == Association::whole)
      fail_usage(fmt::format("field '{}' belongs to the whole dataset, not to points or cells", f.name), "field");
    return &f;
  }
  return automatic_field(d);
}

namespace {

bool is_direct(const Field& f) {
  const int n = f.components();
  return f.role == Role::colors && (n == 3 || n == 4) && (f.array.type() == ElementType::u8 || is_float(f.array.type()));
}

std::optional<FieldColor> field_color(const Dataset& d, const ColoringParams& p, Context& context) {
  const Field* f = wanted_field(d, p);
  if (!f) return {};
  FieldColor c;
  c.field = f->name;
  c.association = f->association;
  c.component = p.component;
  c.direct = is_direct(*f) && p.map == "auto" && p.component < 0;
  if (!c.direct) c.scale = choose_scale(d, *f, p, context);
  return c;
}

std::optional<ColorScale> legend_of(const std::optional<FieldColor>& c) {
  if (!c || c->direct) return {};
  return c->scale;
}

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

std::optional<ColorScale> add(Scene& scene, const DatasetPtr& input, const SurfaceShow& p, Context& context) {
  SurfaceItem item;
  // Ranges come from the whole input, so that a surface and its volume share colours.
  item.color_by = field_color(*input, p.coloring, context);
  if (p.edges) {
    Skin skin = faces_and_edges(input, {}, context);
    item.data = std::move(skin.surface), item.edge_lines = std::move(skin.edges);
  } else {
    item.data = surface_of(input, context);
  }
  if (!p.coloring.color.empty()) item.color = parse_color(p.coloring.color, "color");
  item.opacity = p.opacity;
  item.edges = p.edges;
  item.flat = p.flat;
  item.material.lit = p.lit;
  item.feature_angle = p.feature_angle;
  item.lic = surface_texture_of(*item.data, p.lic);
  const SurfaceMesh& mesh = *item.data->as<SurfaceMesh>();
  const auto legend = legend_of(item.color_by);
  if (mesh.lines.size() > 0) {
    LinesItem lines;
    lines.data = item.data;
    lines.color_by = item.color_by;
    if (!p.coloring.color.empty()) lines.color = item.color;
    lines.opacity = p.opacity;
    if (mesh.polygons.size() + mesh.strips.size() == 0) lines.width = 2.5;  // alone they may be seen
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
    points.opacity = p.opacity;
    points.size = 8;
    scene.items.emplace_back(std::move(points));
  }
  const bool any_surface = mesh.polygons.size() + mesh.strips.size() > 0;
  apply_texture(item, texture_field(*input, p.texture, item.color_by));  // gives the item other data: `mesh` may be gone
  if (any_surface) scene.items.emplace_back(std::move(item));
  return legend;
}

std::optional<ColorScale> add(Scene& scene, const DatasetPtr& input, const LinesShow& p, Context& context) {
  LinesItem item;
  item.data = surface_of(input, context);
  if (const auto& m = *item.data->as<SurfaceMesh>(); m.lines.size() == 0 && m.polygons.size() + m.strips.size() > 0)
    context.warn(
        "lines: these data have cells but no lines, nothing is drawn; -f streamlines, isolines, feature_edges or contour of a flat mesh "
        "make lines, --show 'surface edges=true' draws the edges of cells");
  item.color_by = field_color(*input, p.coloring, context);
  if (!p.coloring.color.empty()) item.color = parse_color(p.coloring.color, "color");
  item.opacity = p.opacity;
  item.width = p.width;
  item.lit = p.lit;
  item.halo = p.halo;
  item.halo_color = parse_color(p.halo_color, "halo_color");
  auto legend = legend_of(item.color_by);
  scene.items.emplace_back(std::move(item));
  return legend;
}

std::optional<ColorScale> add(Scene& scene, const DatasetPtr& input, const PointsShow& p, Context& context) {
  PointsItem item;
  item.data = input;
  item.color_by = field_color(*input, p.coloring, context);
  if (item.color_by && item.color_by->association == Association::cell) {
    context.info("points take their colours from point fields; cell field '" + item.color_by->field + "' is not shown on them");
    item.color_by.reset();
  }
  if (const Field* normals = input->fields().with_role(Role::normals), *radius = input->fields().find("radius", Association::point);
      p.discs && p.opacity >= 1 && normals && normals->association == Association::point && normals->components() == 3 && radius &&
      radius->components() == 1) {
    item.disc_normals = normals->name, item.disc_radius = radius->name;
    item.color = SurfaceItem().color;
  }
  if (!p.coloring.color.empty()) item.color = parse_color(p.coloring.color, "color");
  item.opacity = p.opacity;
  item.size = p.size;
  auto legend = legend_of(item.color_by);
  scene.items.emplace_back(std::move(item));
  return legend;
}

// The twelve edges of a uniform grid's own box (turned with it), or of the bounds.
std::optional<ColorScale> add(Scene& scene, const DatasetPtr& input, const OutlineShow& p, Context&) {
  const Box3 box = input->bounds();
  if (box.empty()) return {};
  Vec3 corner[8];
  const auto* grid = input->as<UniformGrid>();
  for (int c = 0; c < 8; ++c) {
    if (grid) {
      const Vec3 index{c & 1 ? double(grid->dims[0] - 1) : 0.0, c & 2 ? double(grid->dims[1] - 1) : 0.0,
                       c & 4 ? double(grid->dims[2] - 1) : 0.0};
      corner[c] = grid->origin + grid->direction * (grid->spacing * index);
    } else {
      corner[c] = {c & 1 ? box.hi.x : box.lo.x, c & 2 ? box.hi.y : box.lo.y, c & 4 ? box.hi.z : box.lo.z};
    }
  }
  SurfaceMesh mesh;
  std::vector<float> xyz;
  mesh.points.origin = box.center();
  for (const Vec3& v : corner)
    for (int a = 0; a < 3; ++a) xyz.push_back(float(v[a] - mesh.points.origin[a]));
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  std::vector<int32_t> ends;
  for (int c = 0; c < 8; ++c)
    for (int bit : {1, 2, 4})
      if (!(c & bit) && !(corner[c] == corner[c | bit])) ends.insert(ends.end(), {c, c | bit});
  mesh.lines.fixed = 2;
  mesh.lines.connectivity = Array::from_vector(std::move(ends));
  LinesItem item;
  item.data = make_dataset(std::move(mesh));
  item.color = parse_color(p.color, "color");
  item.width = p.width;
  scene.items.emplace_back(std::move(item));
  return {};
}

template <class P>
std::string help_of() {
  P p;
  return params_help(schema_of(p));
}
template <class P>
std::string json_of() {
  P p;
  return params_json(schema_of(p));
}
template <class P>
void check_words(const std::vector<std::string>& words) {
  P p;
  Schema s = schema_of(p);
  set_params(s, words, "show");
}
template <class P>
std::optional<Legend> add_words(Scene& scene, const DatasetPtr& data, const std::vector<std::string>& words, Context& context) {
  P p;
  Schema s = schema_of(p);
  set_params(s, words, "show");
  if (auto scale = add(scene, data, p, context)) return Legend(std::move(*scale));
  return {};
}

template <class P>
constexpr ShowKind kind(std::string_view name, std::string_view sentence) {
  return {name, sentence, help_of<P>, json_of<P>, check_words<P>, add_words<P>};
}

}  // namespace

std::span<const ShowKind> show_kinds() {
  static constexpr ShowKind kinds[] = {
      kind<SurfaceShow>("surface", "The outer surface, coloured by a field."),
      {"volume", "A scalar field of any mesh with volume, seen through.", help_of<VolumeShow>, json_of<VolumeShow>, check_volume_words,
       add_volume},
      kind<LinesShow>("lines", "Lines of constant width."),
      kind<PointsShow>("points", "Every point as a dot."),
      kind<LabelsShow>("labels", "Numbers at points, turned along their lines (see line_labels)."),
      kind<GlyphsShow>("glyphs", "Arrows, barbs and other shapes at points, turned and scaled by fields."),
      kind<OutlineShow>("outline", "The box around the data."),
  };
  return kinds;
}

const ShowKind& find_show(std::string_view name) {
  std::vector<std::string> names;
  for (const ShowKind& k : show_kinds()) {
    if (k.name == name) return k;
    names.emplace_back(k.name);
  }
  fail_usage(fmt::format("unknown way to show '{}'", name), "--show", unknown_name_hint(name, names));
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "scene/show/volume.h"

#include <fmt/core.h>

#include "base/text/text.h"
#include "color/parse_color.h"
#include "color/transfer_text.h"
#include "color/widgets/transfer_widget.h"
#include "color/widgets/widgets_text.h"
#include "data/fields/field_component.h"
#include "data/lattice.h"
#include "data/ranks/over_all.h"
#include "filter/field/sampling/point_cell.h"
#include "image/image.h"
#include "scene/choose/scale.h"
#include "scene/choose/volume/boundaries.h"
#include "scene/choose/volume/extent.h"
#include "scene/choose/volume/look.h"
#include "scene/show/volume_presets.h"

namespace sg {

namespace {

const Field& mesh_field(const Dataset& d, const std::string& name, std::string_view word) {
  const Field& f = d.fields().require(name);
  if (f.association == Association::whole)
    fail_usage(fmt::format("field '{}' belongs to the whole dataset, not to points or cells", f.name), std::string(word));
  return f;
}

// One colour for all values.
void take_one_colour(ColorScale& scale, Vec3f c) {
  scale.map = Colormap{"one", MapKind::sequential, "One colour.", {c, c}, {}};
  scale.labels.clear(), scale.label_names.clear();
}

// Whether it is said how a field is coloured, or which.
bool states_colors(const VolumeShow& p) {
  return p.coloring.states_map() || !p.coloring.range.empty() || !p.color_by.empty() || !p.opacity_by.empty();
}

struct Fields {
  const Field* color;    // through the colour scale
  const Field* opacity;  // the value axis
};

Fields fields_of(const Dataset& d, const VolumeShow& p) {
  ColoringParams named = p.coloring;
  named.color.clear();
  if (named.field.none()) named.field.name.clear();
  Fields f{};
  f.color = wanted_field(d, named);
  if (!f.color) f.color = d.fields().active(1);  // one that is the same everywhere is seen through all the same
  if (!p.color_by.empty() && named.field.empty() && f.color && f.color->name == p.color_by.name) f.color = nullptr;  // the other one
  if (!f.color && named.field.empty() && !p.color_by.empty())
    for (const Field& other : d.fields())
      if (!f.color && other.association != Association::whole && other.components() == 1 && other.name != p.color_by.name) f.color = &other;
  if (!f.color) fail_usage("there is no field to show as a volume", "volume", "name one with field=");
  f.opacity = f.color;
  if (!p.opacity_by.empty()) f.opacity = &mesh_field(d, p.opacity_by.name, "opacity_by");
  if (!p.color_by.empty()) f.color = &mesh_field(d, p.color_by.name, "color_by");
  return f;
}

/// A component counts for the fields that have several; where both have one, for none.
int component_of(const VolumeShow& p, const Fields& all, const Field& f) {
  const Field& other = &f == all.color ? *all.opacity : *all.color;
  return f.components() == 1 && other.components() > 1 ? -1 : p.coloring.component;
}

void check_second_field(const Field& value, const Field& second) {
  if (second.components() != 1)
    fail_usage(fmt::format("'{}' has {} components", second.name, second.components()), "volume",
               "a second field must be scalar: -f 'calc expr=mag(NAME)' computes the magnitude");
  if (value.association != second.association)
    fail_usage(fmt::format("'{}' is a {} field and '{}' a {} field", value.name, association_name(value.association), second.name,
                           association_name(second.association)),
               "volume", "both must be point fields or both cell fields: -f cell_to_point converts");
}

// The second axis and its part of opacity; colours by it.
void take_second_axis(const VolumeShow& p, const Fields& fields, const ColorScale& colors, VolumeItem& item, Context& context) {
  TransferDetail& detail = item.detail;
  const Dataset& d = *item.data;
  const Field* second = nullptr;
  const std::string& word = p.second;
  if (fields.color != fields.opacity) {
    detail.second = SecondAxis::field, detail.color_by_second = true, detail.second_color = colors;
    second = fields.color;
  } else {
    detail.second = value_of_word<SecondAxis>(word).value_or(SecondAxis::field);
    if (detail.second == SecondAxis::none && !p.widgets.empty()) detail.second = SecondAxis::gradient;
    if (detail.second == SecondAxis::field) {
      second = d.fields().find(word);
      if (!second) {
        std::vector<std::string> names;
        for (const Word<SecondAxis>& w : enum_words(SecondAxis())) names.emplace_back(w.word);
        for (const std::string& n : d.fields().names()) names.push_back(n);
        fail_usage(fmt::format("'{}' is neither a second axis nor a field", word), "second", unknown_name_hint(word, names));
      }
    }
  }
  if (detail.second == SecondAxis::none) return;
  if (second) check_second_field(*fields.opacity, *second), detail.second_field = second->name;
  const Range r = second_axis_range(item.data, *fields.opacity, item.component, detail.second, second, context);
  detail.second_lo = r.lo, detail.second_hi = r.hi;
  ColorScale axis;
  axis.lo = r.lo, axis.hi = r.hi;
  if (p.second_opacity) detail.second_factor = parse_opacity(*p.second_opacity, axis, "second_opacity");
  else if (detail.second == SecondAxis::gradient) detail.second_factor = parse_opacity("0:0,0.25:1", axis);
  else if (detail.second == SecondAxis::second_derivative)
    detail.second_factor = parse_opacity("0.35:0,0.5:1,0.65:0", axis);  // the middle of borders
  else if (detail.second == SecondAxis::curvature)
    detail.second_factor = parse_opacity("0:1,0.3:1,0.5:0.1,0.7:1,1:1", axis);  // ridges and valleys
  if (!p.widgets.empty()) {
    detail.widgets = parse_widgets(p.widgets, item.color, axis);
    // For everything that only knows values.
    item.opacity = bounding_curve(detail.widgets);
  }
}

// Of all parts beside the data that have such a field, the data among them, the one with the most points.
DatasetPtr largest_beside(const DatasetPtr& data, const Field& field, const Context& context) {
  DatasetPtr largest = data;
  if (context.parts)
    for (const DatasetPtr& part : *context.parts) {
      const Field* f = part->fields().find(field.name, field.association);
      if (f && f->components() == field.components() && part->point_count() > largest->point_count()) largest = part;
    }
  return largest;
}

// The default level: the value at which something begins.
void choose_level(const Field& field, VolumeItem& item, Context& context) {
  const Range r = range_over_all(*item.data, field, field.components() > 1 ? item.component : 0, context);
  if (r.empty()) return item.levels.push_back(0);
  const DatasetPtr largest = largest_beside(item.data, field, context);  // several volumes have one level
  const Field& of = largest == item.data ? field : largest->fields().require(field.name, field.association);
  const auto found = material_boundaries(sample_derivatives(largest, of, item.component, false, 500000, context), r.lo, r.hi, 1);
  double level = 0.5 * (r.lo + r.hi);
  if (!found.empty()) level = found[0].value;
  item.levels.push_back(*parse_double(short_number(level, 4)));
  context.info(fmt::format("level {}: {}", short_number(item.levels[0]),
                           found.empty() ? "the middle of the range" : "the strongest material boundary (where the mean gradient peaks)"));
}

// Opacity, and for CT the colours, where nothing is stated.
void choose_transfer(const VolumeShow& p, const Field& field, VolumeItem& item, Context& context) {
  if (item.mode == RayFunction::isosurface) {
    // The innermost surface hides, those around it are seen through.
    if (item.levels.size() == 1) return item.opacity.points = {{item.color.lo, 1}}, void();
    const double last = *std::max_element(item.levels.begin(), item.levels.end());
    const Range r{item.color.lo, item.color.hi};
    const double before = std::nextafter(last, -HUGE_VAL);
    item.opacity.points = {{std::min(r.lo, before), 0.35}, {before, 0.35}, {last, 1}, {std::max(r.hi, last), 1}};
    return;
  }
  if (!info_of(item.mode).classifies) {  // what is collected is drawn as it is
    item.opacity.points = {{item.color.lo, 1}};
    return;
  }
  if (value_of_word<TransferChoice>(p.transfer) == TransferChoice::boundaries) {
    const Range r = range_over_all(*item.data, field, field.components() > 1 ? item.component : 0, context);
    const auto found = material_boundaries(sample_derivatives(item.data, field, item.component, false, 2000000, context), r.lo, r.hi);
    const bool free = item.detail.second == SecondAxis::none;
    TransferDetail detail;
    const std::string why = show_boundaries(found, r.lo, r.hi, item.opacity, detail);
    if (!why.empty()) {
      if (free) {
        item.detail.second = detail.second, item.detail.second_factor = detail.second_factor;
        const Range axis = second_axis_range(item.data, field, item.component, SecondAxis::gradient, nullptr, context);
        item.detail.second_lo = axis.lo, item.detail.second_hi = axis.hi;
      }
      return context.info(why);
    }
    context.info(fmt::format("no material boundaries stand out in '{}'; opacity is chosen from its histogram", field.name));
  }
  const std::string why = choose_volume_look(*item.data, field, p.coloring, item,
                                             value_of_word<TransferChoice>(p.transfer) == TransferChoice::automatic, context);
  if (info_of(item.mode).absorbs) context.info(why);
}

/// Fields that are constant in each cell have no level sets: they become fields of the points. (Even grids are seen between the middles of
/// their cells, and so are AMR grids.)
DatasetPtr without_steps(const DatasetPtr& data, const Fields& fields, Context& context) {
  const bool between_middles = data->as<UniformGrid>() || data->as<RectilinearGrid>() || data->as<AmrGrid>();
  if (between_middles || fields.opacity->association != Association::cell) return data;
  CellToPointParams of;
  of.fields = {fields.opacity->name};
  if (fields.color != fields.opacity && fields.color->association == Association::cell) of.fields.push_back(fields.color->name);
  context.info(fmt::format("the isosurface is that of '{}' averaged to the points, as it is constant in each cell", fields.opacity->name));
  return cell_to_point(data, of, context);
}

/// What level sets are made of, and the pictures on them.
void take_matter(const VolumeShow& p, double body, VolumeItem& item, Context& context) {
  item.made_of = p.material.made(body);
  item.pictures = pictures_of(*item.data, p.picture);
  if (!p.varying.any() && p.picture.material_picture.empty()) return;
  auto pictures = item.pictures ? std::make_shared<SurfacePictures>(*item.pictures) : std::make_shared<SurfacePictures>();
  apply(p.varying, p.material, p.picture, *item.data, *item.made_of, *pictures, context);
  item.pictures = std::move(pictures);
}

std::string title_of_second(const TransferDetail& detail) {
  switch (detail.second) {
    case SecondAxis::none: return "";
    case SecondAxis::gradient: return "gradient";
    case SecondAxis::second_derivative: return "2nd derivative";
    case SecondAxis::curvature: return "curvature";
    case SecondAxis::field: return detail.second_field;
  }
  return "";
}

// What the legend shows: what the ray collects, and for those that composite the opacity.
Legend legend_of(const VolumeItem& item) {
  Legend legend(item.detail.color_by_second ? item.detail.second_color : item.color);
  const auto opaque = [](Vec2 point) { return point.y == 1; };
  const bool solid = item.mode == RayFunction::isosurface && std::all_of(item.opacity.points.begin(), item.opacity.points.end(), opaque);
  if (info_of(item.mode).shows_opacity && !solid)
    legend.volume = VolumeLegend{item.opacity, item.detail, item.color, title_of_second(item.detail)};
  return legend;
}

// The preset's look, but where the parameters state otherwise.
VolumeShow with_preset(const VolumeShow& p, const Schema& schema, const Dataset& d, Context& context) {
  const ParamSet defaults = make_param_set<VolumeShow>();
  VolumeShow given = p;
  const Schema own = schema_of(given);
  const auto states = [&](std::string_view name) {
    return schema.stated(name) || own.find(name)->ref.get() != defaults.schema.find(name)->ref.get();
  };
  const Fields fields = fields_of(d, p);
  const int component = component_of(p, fields, *fields.opacity);
  check_component(*fields.opacity, component, "component");
  std::string reason;
  VolumeShow look = volume_of_preset(p.preset, d, *fields.opacity, component, reason, context);
  context.info(reason);
  look.picture.grids = p.picture.grids;
  if (states("map") || states("color")) look.colors.clear();
  if (states("widgets") || states("transfer")) look.opacity.reset();
  if (states("opacity_by") || states("color_by") || states("widgets") || states("second"))
    look.second = "none", look.second_opacity.reset();
  if (states("colors")) look.coloring.range.clear();
  Schema result = schema_of(look);
  for (const ParamDecl& decl : own.decls())
    if (states(decl.name)) result.find(decl.name)->ref.set(decl.ref.get());
  return look;
}

}  // namespace

void share(const std::vector<DatasetPtr>& parts, const std::vector<VolumeShow*>& params) {
  Box3 box;
  for (const DatasetPtr& d : parts) box.add(d->bounds());
  for (VolumeShow* p : params) p->body = box.diagonal();
}

std::optional<Legend> add(Scene& scene, const DatasetPtr& input, const VolumeShow& p, Context& context) {
  return add(scene, input, p, Schema(), context);
}

std::optional<Legend> add(Scene& scene, const DatasetPtr& data, const VolumeShow& stated, const Schema& schema, Context& context) {
  if (is_lattice(data->mesh())) {
    const auto n = lattice_dims(data->mesh());
    if (std::min({n[0], n[1], n[2]}) < 2)
      fail_usage(fmt::format("a grid of {}x{}x{} points has no volume", n[0], n[1], n[2]), "volume",
                 "show it as a surface: --show surface");
  }
  const VolumeShow p = stated.preset.empty() ? stated : with_preset(stated, schema, *data, context);
  const DatasetPtr input = p.mode == RayFunction::isosurface ? without_steps(data, fields_of(*data, p), context) : data;
  const Fields fields = fields_of(*input, p);
  VolumeItem item;
  item.data = input;
  item.field = fields.opacity->name;
  item.association = fields.opacity->association;
  item.component = component_of(p, fields, *fields.opacity);
  check_component(*fields.opacity, item.component, "component");
  item.method = p.method;
  item.mode = p.mode;
  item.levels = p.levels;
  item.shaded = p.shaded;
  item.unit_distance = p.unit;
  item.sampling = p.sampling;
  item.light = p.light;
  item.scattering = p.scattering;
  if (p.scattering.light == VolumeLighting::map && !schema.stated("shaded")) item.shaded = false;
  if (!p.clip.empty()) item.clip = parse_clip(p.clip);

  // Colours as requested, over the field that they belong to.
  ColoringParams coloring = p.coloring;
  coloring.component = component_of(p, fields, *fields.color);
  ColorScale colors = choose_scale(*input, *fields.color, coloring, context);
  const ColorScale whole = colors;
  if (!p.coloring.color.empty()) take_one_colour(colors, parse_color(p.coloring.color, "color"));
  if (!p.colors.empty()) parse_color_stops(p.colors, colors, !p.coloring.range.empty());
  if (fields.color == fields.opacity) item.color = whole;
  else {
    ColoringParams plain;
    plain.component = item.component;
    item.color = choose_scale(*input, *fields.opacity, plain, context);
  }
  if (info_of(item.mode).needs_level && item.levels.empty()) choose_level(*fields.opacity, item, context);
  take_second_axis(p, fields, colors, item, context);
  if (!p.widgets.empty()) {
  } else if (!p.opacity) choose_transfer(p, *fields.opacity, item, context);
  else item.opacity = parse_opacity(*p.opacity, item.color);
  bool own_colors = !p.colors.empty() || !p.coloring.color.empty();
  if (p.material.any() || p.varying.any() || p.picture.any() || p.picture.any_other())
    take_matter(p, stated.body > 0 ? stated.body : input->bounds().diagonal(), item, context);
  const bool surfaces = item.mode == RayFunction::isosurface, matter = p.material.has_color() || p.picture.any();
  if (matter && !p.opacity) item.opacity.points = {{item.color.lo, 1}};
  // Surfaces of one colour: a legend could show nothing of the field.
  bool one_color = surfaces && !p.coloring.color.empty();
  if (surfaces && (matter || item.levels.size() == 1) && !own_colors && !states_colors(p)) {
    const Vec3f c = p.material.has_color() ? own_color(*item.made_of) : p.picture.any() ? Vec3f{1, 1, 1} : SurfaceItem().color;
    take_one_colour(colors, c);
    own_colors = one_color = true;
  }
  if (fields.color == fields.opacity && own_colors) item.color = colors;
  take_collected_range(item, p.coloring.range.empty() && p.colors.empty(), !p.coloring.map && !own_colors);
  std::optional<Legend> legend;
  if (!one_color) legend = legend_of(item);
  scene.items.emplace_back(std::move(item));
  return legend;
}

}  // namespace sg

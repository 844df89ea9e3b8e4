// SPDX-License-Identifier: Apache-2.0
#include "scene/show_volume.h"

#include "base/text.h"
#include "color/parse_color.h"
#include "color/transfer_text.h"
#include "data/lattice.h"
#include "scene/volume_boundaries.h"
#include "scene/volume_extent.h"
#include "scene/volume_look.h"
#include "scene/volume_presets.h"

namespace sg {

void describe(Schema& s, VolumeShow& p) {
  describe(s, p.coloring);
  std::string presets;
  std::vector<std::string> names;
  for (const VolumePreset& preset : volume_presets()) {
    presets += fmt::format("{}{} ({})", presets.empty() ? "" : ", ", preset.name, preset.about);
    names.emplace_back(preset.name);
  }
  s("preset", p.preset, fmt::format("A whole look by name; words stated besides it win: {}.", presets)).choices(names);
  s("transfer", p.transfer,
    "What decides on opacity (and colours) where none are stated: auto, histogram, boundaries (of materials: where gradients are large), "
    "or a "
    "FILE.yaml made with save.");
  s("save", p.save, "Writes the look to this file, for transfer=FILE.yaml.");
  s("opacity", p.opacity,
    "Opacity as place:opacity points with straight lines between them, ascending: 0:0,0.3:0.1,1:0.8. A place is a position on the range, "
    "or with @ a "
    "value: @-500:0,@200:0.4. Two points at one place make a step. Per 'unit' of length.");
  s("colors", p.colors, "Colours as place:colour stops instead of a map: 0:#000000,0.4:#aa3311,1:white, or @-500:black,@300:ivory.");
  s("opacity_by", p.opacity_by, "Field whose values decide on opacity, while 'field' gives the colours.");
  s("color_by", p.color_by, "Field whose values give the colours, while 'field' decides on opacity.");
  s("second", p.second,
    "Second axis: none, gradient (its magnitude), second_derivative (along the gradient), curvature (mean curvature of the level set), or "
    "a field.");
  s("second_opacity", p.second_opacity,
    "Factor of opacity over the second axis, points as in opacity: 0:0,0.2:1. Positions: 0 to the largest gradient; minus to plus the "
    "largest "
    "second derivative or curvature; the range of the field.");
  s("widgets", p.widgets,
    "Regions of the plane (value, second) that are drawn, instead of opacity: 'triangle LO HI BASE TOP OPACITY COLOR; rectangle LO HI LOW "
    "HIGH "
    "OPACITY COLOR'. Places as in opacity; second=gradient unless stated.");
  s("unit", p.unit, "World length to which opacity refers; 0 is a hundredth of the diagonal.").at_least(0);
  s("method", p.method, "The algorithm; ray is the reference.").choices(volume_method_names());
  s("mode", p.mode, "What a ray collects.").choices(ray_function_names());
  s("levels", p.levels, "Values of first_hit, distance and accumulate (one), and isosurface; default: the strongest border of materials.")
      .unit("@field");
  s("shaded", p.shaded, "Light the volume by the gradient of the field.");
  describe(s, p.sampling);
  describe(s, p.light);
  s("clip", p.clip,
    "What is cut away: planes 'nx,ny,nz,offset; ...' draw the side where n.x <= offset, 'box x0,x1,y0,y1,z0,z1' its inside.");
}

namespace {

constexpr std::string_view second_words[] = {"none", "gradient", "second_derivative", "curvature"};
constexpr std::string_view transfer_choices[] = {"auto", "histogram", "boundaries"};

template <size_t N>
int place_in(const std::string_view (&words)[N], std::string_view w) {
  for (size_t i = 0; i < N; ++i)
    if (words[i] == w) return int(i);
  return -1;
}

RayFunction ray_function(const std::string& mode) {
  const auto& names = ray_function_names();
  return RayFunction(std::find(names.begin(), names.end(), mode) - names.begin());
}
VolumeMethod volume_method(const std::string& method) {
  const auto& names = volume_method_names();
  return VolumeMethod(std::find(names.begin(), names.end(), method) - names.begin());
}

bool states(const std::vector<std::string>& words, std::string_view key) {
  return std::any_of(words.begin(), words.end(),
                     [&](const std::string& w) { return w.size() > key.size() && w.starts_with(key) && w[key.size()] == '='; });
}

VolumeShow read(const std::vector<std::string>& words) {
  VolumeShow p;
  Schema s = schema_of(p);
  set_params(s, words, "show");
  return p;
}

// Are there positions beside @values, so that only data can tell which comes first?
bool mixes_places(const std::string& points) {
  int values = 0, positions = 0;
  for (const std::string_view part : split(points, ','))
    if (part.find(':') != part.npos) ++(part.starts_with('@') ? values : positions);
  return values > 0 && positions > 0;
}
bool mixes_ends(const std::string& widgets) {
  for (const std::string_view part : split(widgets, ';')) {
    const auto w = words(part);
    for (size_t i = 1; i + 1 < std::min<size_t>(w.size(), 5); i += 2)
      if (w[i].starts_with('@') != w[i + 1].starts_with('@')) return true;
  }
  return false;
}

// What cannot be whatever the data is.
void check(const VolumeShow& p) {
  std::string problems;
  const auto each = [&](auto&& f) {
    try {
      f();
    } catch (const Error& e) {
      problems += (problems.empty() ? "" : "; ") + std::string(e.what());
    }
  };
  ColorScale axis;  // any will do
  if (p.coloring.scale == "log") axis.kind = ScaleKind::log, axis.lo = 1e-300, axis.hi = 1;
  each([&] {
    std::vector<double> numbers{p.unit, p.sampling.step};
    numbers.insert(numbers.end(), p.levels.begin(), p.levels.end());
    for (const double v : numbers)
      if (!std::isfinite(v))
        fail_usage(fmt::format("{} is not a finite number", exact_number(v)), "volume", "unit, step and levels are finite");
  });
  if (p.opacity != "auto" && !mixes_places(p.opacity)) each([&] { parse_opacity(p.opacity, axis); });
  if (p.second_opacity != "auto" && !mixes_places(p.second_opacity))
    each([&] { parse_opacity(p.second_opacity, ColorScale{}, "second_opacity"); });
  if (!p.colors.empty() && !mixes_places(p.colors))
    each([&] {
      ColorScale scale = axis;
      parse_color_stops(p.colors, scale, false);
    });
  if (!p.widgets.empty())
    each([&] {
      if (!mixes_ends(p.widgets)) parse_widgets(p.widgets, axis, ColorScale{});
      if (p.opacity != "auto")
        fail_usage("both opacity and widgets are stated", "widgets", "the widgets decide on opacity; leave out one of the two");
    });
  if (!p.clip.empty()) each([&] { parse_clip(p.clip); });
  each([&] {
    if (place_in(transfer_choices, p.transfer) < 0) {
      const std::vector<std::string> names(std::begin(transfer_choices), std::end(transfer_choices));
      fail_usage(fmt::format("'{}' is no way to choose a transfer function", p.transfer), "transfer",
                 unknown_name_hint(p.transfer, names) + "; files end in .yaml");
    }
    const int by = !p.opacity_by.empty() + !p.color_by.empty();
    if (by == 2) fail_usage("both opacity_by and color_by are stated", "opacity_by", "state one of them, and the other field as field=");
    if (by == 1 && p.second != "none")
      fail_usage("a second field already is the second axis", "second", "leave out second=, or opacity_by and color_by");
    if (p.second == "none" && p.second_opacity != "auto" && p.widgets.empty() && by == 0)
      fail_usage("there is no second axis", "second_opacity", "state one: second=gradient");
  });
  if (!problems.empty()) fail_usage(problems);
}

const Field& mesh_field(const Dataset& d, const std::string& name, std::string_view word) {
  const Field& f = d.fields().require(name);
  if (f.association == Association::whole)
    fail_usage(fmt::format("field '{}' belongs to the whole dataset, not to points or cells", f.name), std::string(word));
  return f;
}

// One colour for all values.
void take_one_colour(ColorScale& scale, const std::string& color) {
  const Vec3f c = parse_color(color, "color");
  scale.map = Colormap{"one", MapKind::sequential, "One colour.", {c, c}};
  scale.labels.clear(), scale.label_names.clear();
}

struct Fields {
  const Field* color;    // through the colour scale
  const Field* opacity;  // the value axis
};

Fields fields_of(const Dataset& d, const VolumeShow& p) {
  ColoringParams named = p.coloring;
  named.color.clear();
  if (named.field.name == "none") named.field.name.clear();
  Fields f{};
  f.color = wanted_field(d, named);
  if (!f.color) f.color = d.fields().active(1);  // one that is the same everywhere is seen through all the same
  if (!p.color_by.empty() && named.field.empty() && f.color && f.color->name == p.color_by.name) f.color = nullptr;  // the other one
  if (!f.color && named.field.empty() && !p.color_by.empty())
    for (const Field& other : d.fields())
      if (!f.color && other.association != Association::whole && other.components() == 1 && other.name != p.color_by.name) f.color = &other;
  if (!f.color) fail_usage("there is no field to see through", "volume", "name one with field=");
  f.opacity = f.color;
  if (!p.opacity_by.empty()) f.opacity = &mesh_field(d, p.opacity_by.name, "opacity_by");
  if (!p.color_by.empty()) f.color = &mesh_field(d, p.color_by.name, "color_by");
  return f;
}

void check_second_field(const Field& value, const Field& second) {
  if (second.components() != 1)
    fail_usage(fmt::format("'{}' has {} components", second.name, second.components()), "volume",
               "a second field has one number each: -f 'calc expr=mag(NAME)' makes the magnitude");
  if (value.association != second.association)
    fail_usage(fmt::format("'{}' is a {} field and '{}' a {} field", value.name, association_name(value.association), second.name,
                           association_name(second.association)),
               "volume", "both must lie on the points or both on the cells: -f cell_to_point makes point fields");
}

// The second axis and its part of opacity; colours by it.
void take_second_axis(const VolumeShow& p, const Fields& fields, const ColorScale& colors, VolumeItem& item, Context& context) {
  TransferDetail& detail = item.detail;
  const Dataset& d = *item.data;
  const Field* second = nullptr;
  std::string word = p.second;
  if (fields.color != fields.opacity) {
    detail.second = SecondAxis::field, detail.color_by_second = true, detail.second_color = colors;
    second = fields.color;
  } else {
    if (word == "none" && !p.widgets.empty()) word = "gradient";
    const int k = place_in(second_words, word);
    if (k >= 0) detail.second = SecondAxis(k);
    else {
      detail.second = SecondAxis::field;
      second = d.fields().find(word);
      if (!second) {
        std::vector<std::string> names(std::begin(second_words), std::end(second_words));
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
  if (p.second_opacity != "auto") detail.second_factor = parse_opacity(p.second_opacity, axis, "second_opacity");
  else if (detail.second == SecondAxis::gradient) detail.second_factor = parse_opacity("0:0,0.25:1", axis);
  else if (detail.second == SecondAxis::second_derivative)
    detail.second_factor = parse_opacity("0.35:0,0.5:1,0.65:0", axis);  // the middle of borders
  else if (detail.second == SecondAxis::curvature)
    detail.second_factor = parse_opacity("0:1,0.3:1,0.5:0.1,0.7:1,1:1", axis);  // ridges and valleys
  if (!p.widgets.empty()) {
    detail.widgets = parse_widgets(p.widgets, item.color, axis);
    // The curve that bounds them, for everything that only knows values: largest opacity at each end and middle.
    std::vector<double> knots;
    for (const TransferWidget& w : detail.widgets) knots.insert(knots.end(), {w.lo, 0.5 * (w.lo + w.hi), w.hi});
    std::sort(knots.begin(), knots.end());
    knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
    item.opacity.points.clear();
    for (const double x : knots) {
      double most = 0;
      for (const TransferWidget& w : detail.widgets)
        most = std::max(most, w.opacity * (1 - std::abs(x - 0.5 * (w.lo + w.hi)) / (0.5 * (w.hi - w.lo))));
      item.opacity.points.push_back({x, std::max(0.0, most)});
    }
  }
}

bool needs_level(RayFunction f) {
  return f == RayFunction::first_hit || f == RayFunction::distance || f == RayFunction::accumulate || f == RayFunction::isosurface;
}

// The value at which something begins, when nobody says.
void choose_level(const Field& field, VolumeItem& item, Context& context) {
  const Range r = item.data->range(field, field.components() > 1 ? item.component : 0);
  if (r.empty()) return item.levels.push_back(0);
  const auto found = material_boundaries(sample_derivatives(item.data, field, item.component, false, 500000, context), r.lo, r.hi, 1);
  double level = 0.5 * (r.lo + r.hi);
  if (!found.empty()) level = found[0].value;
  item.levels.push_back(*parse_double(short_number(level, 4)));
  context.info(
      fmt::format("level {}: {}", short_number(item.levels[0]),
                  found.empty() ? "the middle of the range" : "the strongest border of materials (the mean gradient peaks there)"));
}

// Opacity, and for CT the colours, where nothing is stated.
void choose_transfer(const VolumeShow& p, const Field& field, VolumeItem& item, Context& context) {
  if (item.mode == RayFunction::isosurface) {
    // The innermost surface hides, those around it are seen through.
    const double last = *std::max_element(item.levels.begin(), item.levels.end());
    const Range r{item.color.lo, item.color.hi};
    const double before = std::nextafter(last, -HUGE_VAL);
    item.opacity.points = {{std::min(r.lo, before), 0.35}, {before, 0.35}, {last, 1}, {std::max(r.hi, last), 1}};
    return;
  }
  if (p.transfer == "boundaries") {
    const Range r = item.data->range(field, field.components() > 1 ? item.component : 0);
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
    context.info(fmt::format("no borders of materials stand out in '{}'; opacity comes from its histogram", field.name));
  }
  const std::string why = choose_volume_look(*item.data, field, p.coloring, item, p.transfer == "auto");
  if (item.mode == RayFunction::composite || item.mode == RayFunction::maximum_difference) context.info(why);
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
  const RayFunction f = item.mode;
  if (f == RayFunction::composite || f == RayFunction::isosurface || f == RayFunction::maximum_difference)
    legend.volume = VolumeLegend{item.opacity, item.detail, item.color, title_of_second(item.detail)};
  return legend;
}

// The preset's words, without those that stated ones replace, before the stated ones.
std::vector<std::string> with_preset(const std::vector<std::string>& words, const VolumeShow& p, const Dataset& d, Context& context) {
  if (p.preset.empty()) return words;
  std::string reason;
  const Field* field = fields_of(d, p).opacity;
  std::vector<std::string> all = words_of_preset(p.preset, d, *field, p.coloring.component, reason);
  context.info(reason);
  std::erase_if(all, [&](const std::string& w) {
    if (w.starts_with("colors=")) return states(words, "map") || states(words, "colors") || states(words, "color");
    if (w.starts_with("opacity=")) return states(words, "widgets") || states(words, "transfer");
    if (w.starts_with("second"))
      return states(words, "second") || states(words, "opacity_by") || states(words, "color_by") || states(words, "widgets");
    return w.starts_with("range=") && states(words, "colors");
  });
  all.insert(all.end(), words.begin(), words.end());
  return all;
}

}  // namespace

void check_volume_words(const std::vector<std::string>& words) { check(read(words)); }

std::optional<Legend> add_volume(Scene& scene, const DatasetPtr& input, const std::vector<std::string>& stated, Context& context) {
  VolumeShow p = read(stated);
  check(p);
  if (is_lattice(input->mesh())) {
    const auto n = lattice_dims(input->mesh());
    if (std::min({n[0], n[1], n[2]}) < 2)
      fail_usage(fmt::format("a grid of {}x{}x{} points has no volume", n[0], n[1], n[2]), "volume",
                 "show it as a surface: --show surface");
  }
  if (!p.preset.empty()) p = read(with_preset(stated, p, *input, context));
  const Fields fields = fields_of(*input, p);
  VolumeItem item;
  item.data = input;
  item.field = fields.opacity->name;
  item.association = fields.opacity->association;
  item.component = p.coloring.component;
  item.method = volume_method(p.method);
  item.mode = ray_function(p.mode);
  item.levels = p.levels;
  item.shaded = p.shaded;
  item.unit_distance = p.unit;
  item.sampling = p.sampling;
  item.light = p.light;
  if (!p.clip.empty()) item.clip = parse_clip(p.clip);

  // Colours as asked for, over the field that they belong to.
  ColorScale colors = choose_scale(*input, *fields.color, p.coloring, context);
  const ColorScale whole = colors;
  if (!p.coloring.color.empty()) take_one_colour(colors, p.coloring.color);
  if (!p.colors.empty()) parse_color_stops(p.colors, colors, !p.coloring.range.empty());
  if (fields.color == fields.opacity) item.color = whole;
  else {
    ColoringParams plain;
    plain.component = p.coloring.component;
    item.color = choose_scale(*input, *fields.opacity, plain, context);
  }
  if (needs_level(item.mode) && item.levels.empty()) choose_level(*fields.opacity, item, context);
  take_second_axis(p, fields, colors, item, context);
  if (!p.widgets.empty()) {
  } else if (p.opacity == "auto") choose_transfer(p, *fields.opacity, item, context);
  else item.opacity = parse_opacity(p.opacity, item.color);
  const bool own_colors = !p.colors.empty() || !p.coloring.color.empty();
  if (fields.color == fields.opacity && own_colors) item.color = colors;
  take_collected_range(item, p.coloring.range.empty() && p.colors.empty(), p.coloring.map == "auto" && !own_colors);
  const Legend legend = legend_of(item);
  scene.items.emplace_back(std::move(item));
  return legend;
}

std::vector<ClipPlane> parse_clip(const std::string& text) {
  const char* form = "write planes as nx,ny,nz,offset with ; between them, or box x0,x1,y0,y1,z0,z1";
  std::vector<ClipPlane> planes;
  for (std::string_view part : split(text, ';')) {
    if (part.empty()) continue;
    const bool box = part.starts_with("box");
    const auto words = split(trim(box ? part.substr(3) : part), ',');
    std::vector<double> v;
    for (const std::string_view w : words) {
      const auto x = parse_double(w);
      if (!x || !std::isfinite(*x)) fail_usage(fmt::format("'{}' in '{}' is not a number", w, part), "clip", form);
      v.push_back(*x);
    }
    if (v.size() != (box ? 6u : 4u)) fail_usage(fmt::format("'{}' has {} numbers", part, v.size()), "clip", form);
    if (box) {
      for (size_t a = 0; a < 3; ++a) {
        if (!(v[2 * a] < v[2 * a + 1]))
          fail_usage(fmt::format("the box '{}' is empty", part), "clip", "write the lower end of each axis first");
        Vec3 n{a == 0 ? 1.0 : 0.0, a == 1 ? 1.0 : 0.0, a == 2 ? 1.0 : 0.0};
        planes.push_back({-n, -v[2 * a]});
        planes.push_back({n, v[2 * a + 1]});
      }
      continue;
    }
    const Vec3 n{v[0], v[1], v[2]};
    if (!(length(n) > 0)) fail_usage(fmt::format("the plane '{}' has no direction", part), "clip", form);
    planes.push_back({n, v[3]});
  }
  if (planes.empty()) fail_usage("there are no planes", "clip", form);
  return planes;
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/scale.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "base/all_ranks.h"
#include "base/text/text.h"
#include "color/css_colors.h"
#include "color/map_files/colormap_file.h"
#include "color/parse_color.h"
#include "data/field_ops.h"
#include "data/fields/label_names.h"
#include "data/fields/stand_in_names.h"
#include "data/lattice.h"
#include "data/patient/modality.h"
#include "data/patient/patient_frame.h"
#include "data/ranks/over_all.h"
#include "scene/choose/histogram.h"
#include "scene/choose/shared_scale.h"
#include "scene/choose/shown_range.h"
#include "scene/choose/telling_field.h"

namespace sg {

namespace {

constexpr size_t most_labels = 64, most_legend_labels = 4096;  // where they are guessed, and at all

// Distinct values of all pieces among evenly spread samples, or more than `limit` of them.
std::vector<double> distinct_values(const Field& field, size_t limit, const Context& context) {
  const size_t n = field.array.count(), step = std::max<size_t>(1, n / 400000);
  std::vector<double> found;
  dispatch(field.array, [&](auto v) {
    double last = NAN;
    for (size_t i = 0; i < n && found.size() <= limit; i += step) {
      const double x = double(v[i]);
      if (x == last || std::isnan(x)) continue;
      last = x;
      const auto at = std::lower_bound(found.begin(), found.end(), x);
      if (at == found.end() || *at != x) found.insert(at, x);
    }
  });
  if (!context.communicator) return found;
  found = all_concatenated(std::span<const double>(found), context.communicator);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

// Of neighbours along an axis of which one at least is not background, the share that is equal; 1 where there are none.
double share_of_equal_neighbours(const Field& field, std::array<size_t, 3> dims, size_t axis, double background, const Context& context) {
  uint64_t counts[2] = {0, 0};  // equal, all
  size_t ahead = 1;
  for (size_t a = 0; a < axis; ++a) ahead *= dims[a];
  dispatch(field.array, [&](auto v) {
    const size_t nx = dims[0], rows = v.count / std::max<size_t>(nx, 1), step = std::max<size_t>(1, rows / 2000);
    for (size_t r = 0; r < rows; r += step)
      for (size_t i = 0; i < nx; ++i) {
        const size_t at = r * nx + i;
        if (at / ahead % dims[axis] + 1 == dims[axis]) continue;
        const double a = double(v[at]), b = double(v[at + ahead]);
        if (a == background && b == background) continue;
        counts[0] += a == b, ++counts[1];
      }
  });
  all_sum(std::span<uint64_t>(counts), context.communicator);
  return counts[1] ? double(counts[0]) / double(counts[1]) : 1.0;
}

// Label 1 takes the first colour, 2 the second, whichever others are there, so that a selection keeps its colours; 0, which often is what
// has none, grey.
void color_by_number(ColorScale& s) {
  const std::vector<Vec3f> palette = s.map.colors;
  const auto n = double(palette.size());
  if (!std::all_of(s.labels.begin(), s.labels.end(), [&](double v) { return v == std::round(v) && v >= 0 && v <= n; })) return;
  s.map.colors.clear();
  for (const double v : s.labels) s.map.colors.push_back(v == 0 ? Vec3f{0.70f, 0.70f, 0.72f} : palette[size_t(v) - 1]);
}

// What is called red is red: where half of the names are those of colours, these have them.
void color_by_name(ColorScale& s) {
  std::vector<const CssColor*> named;
  for (const std::string& name : s.label_names) {
    const auto* at =
        std::find_if(std::begin(css_colors), std::end(css_colors), [&](const CssColor& c) { return c.name == to_lower(name); });
    named.push_back(at == std::end(css_colors) ? nullptr : at);
  }
  const size_t n = named.size(), have = n - size_t(std::count(named.begin(), named.end(), nullptr));
  if (n == 0 || n != s.labels.size() || 2 * have < n || s.map.colors.empty()) return;
  const std::vector<Vec3f> palette = s.map.colors;
  s.map.colors.clear();
  for (size_t i = 0; i < n; ++i) s.map.colors.push_back(named[i] ? parse_color(named[i]->name, "label") : palette[i % palette.size()]);
}

// The colours of a map between two of its places.
Colormap part_of(const Colormap& map, double from, double to) {
  constexpr size_t samples = 257;
  Colormap part = map;
  part.colors.clear(), part.positions.clear();
  for (size_t i = 0; i < samples; ++i) part.colors.push_back(map.at(from + (to - from) * double(i) / (samples - 1)));
  return part;
}

double nice_symmetric(const Range& r) { return std::max(std::abs(r.lo), std::abs(r.hi)); }

// The categories of a file where most values of the data are among them; values without a category of their own take the colours
// in order. Data with other or more values gets the colours as bands over the range.
void take_categories(const FileColormap& file, const Field& field, ColorScale& s, Context& context) {
  const auto is_category = [&](double v) { return std::find(file.labels.begin(), file.labels.end(), v) != file.labels.end(); };
  const auto met = size_t(std::count_if(s.labels.begin(), s.labels.end(), is_category));
  if (file.labels.empty() ? s.labels.size() <= file.map.colors.size() : 2 * met >= s.labels.size()) {
    if (!file.labels.empty()) s.labels = file.labels, s.label_names = file.label_names;
    return;
  }
  s.labels.clear();
  context.warn(fmt::format("the values of '{}' are not the categories of the colour map '{}'; its {} colours are drawn as bands",
                           field.name, s.map.name, file.map.colors.size()));
}

// Names of numbers by the dataset's notes.
void add_noted_names(const Dataset& d, const Field& field, std::map<double, std::string>& known) {
  for (const auto& [name, text] : d.notes())
    if (name == "labels of " + field.name)
      for (auto& [number, word] : names_in_note(text)) known[number] = word;
}

// Where values lie outside a stated range its legend ends in triangles, of the colours of its ends unless others are stated.
void show_what_lies_beyond(const Range& values, ColorScale& s) {
  if (!s.clamp || !s.labels.empty() || values.empty()) return;
  const double lo = std::min(s.lo, s.hi), hi = std::max(s.lo, s.hi), slack = 1e-6 * (hi - lo);
  const bool under = values.lo<lo - slack, over = values.hi> hi + slack;
  if (!s.below && (s.lo <= s.hi ? under : over)) s.below = s.map.at(0);
  if (!s.above && (s.lo <= s.hi ? over : under)) s.above = s.map.at(1);
}

// Numbers of a file that says what they stand for are labels also where they are stored as floats, with NaN for none.
bool holds_whole_numbers(const Field& field) { return !is_float(field.array.type()) || field.role == Role::labels || names_numbers(field); }

bool names_its_labels(const Dataset& d, const Field& field) {
  return field.role == Role::labels &&
         std::any_of(d.notes().begin(), d.notes().end(), [&](const auto& note) { return note.first == "labels of " + field.name; });
}

// What may name things: small integers of one component, or any that number parts.
bool may_be_labels(const Dataset& d, const Field& field, const Range& r) {
  return holds_whole_numbers(field) && field.components() == 1 && field.role != Role::global_ids && field.role != Role::colors &&
         !r.empty() && r.lo >= 0 &&
         (r.hi - r.lo <= 10000 || telling(d, field) == Telling::divisions || telling(d, field) == Telling::numbering);
}

// The point field whose values lie within the limits of every polygon's band: what the bands are of. Null when there is none.
const Field* banded_field(const Dataset& d, const Field& low, const Field& high) {
  const auto* mesh = d.as<SurfaceMesh>();
  if (!mesh || mesh->vertices.size() + mesh->lines.size() + mesh->strips.size() > 0) return nullptr;
  const CellsView c = cells_view(mesh->polygons);
  const auto fits = [&](const Field& f) {
    for (size_t cell = 0; cell < c.count; ++cell)
      for (size_t k = 0; k < c.size(cell); ++k) {
        const double v = f.array.get(size_t(c.point(cell, k)));
        if (v < low.array.get(cell) || v > high.array.get(cell)) return false;
      }
    return true;
  };
  for (const Field& f : d.fields())
    if (f.association == Association::point && f.components() == 1 && fits(f)) return &f;
  return nullptr;
}

// The stated numbers that lie on the scale; of the others it is said where they are.
std::vector<double> ticks_on_scale(const std::vector<double>& stated, const ColorScale& s, Context& context) {
  std::vector<double> ticks;
  std::string beyond;
  for (const double v : stated) {
    const double at = s.position(v);
    if (at >= 0 && at <= 1) ticks.push_back(v);
    else beyond += (beyond.empty() ? "" : ", ") + short_number(v);
  }
  if (beyond.empty()) return ticks;
  std::string text = fmt::format("legend_ticks: {} {} beyond the legend, which goes from {} to {}", beyond,
                                 beyond.find(',') == beyond.npos ? "is" : "are", short_number(s.lo), short_number(s.hi));
  text += stated.size() == 1 ? fmt::format("; legend_count={} asks for that many numbers", beyond) : "; range=LOW,HIGH sets its ends";
  context.warn(text);
  return ticks;
}

// What is stated of the legend.
void name_legend(const ColoringParams& p, ColorScale& s, Context& context) {
  if (p.legend_title) s.title = *p.legend_title;
  if (p.legend_unit) s.unit = *p.legend_unit;
  if (s.labels.empty() && !p.legend_ticks.empty()) s.ticks = ticks_on_scale(p.legend_ticks, s, context);
  s.tick_count = p.legend_count, s.number_format = p.legend_format;
  if (!s.number_format.empty()) formatted_number(0, s.number_format);  // mistakes are told before anything is drawn
}

// Filled contours: a colour for each band, and a legend of the limits between them.
ColorScale band_scale(const Dataset& d, const Field& band, const ColoringParams& p, Context& context) {
  const Field &low = d.fields().require("band low", Association::cell), &high = d.fields().require("band high", Association::cell);
  std::map<double, std::pair<double, double>> bands;
  for (size_t c = 0; c < band.array.count(); ++c) bands.try_emplace(band.array.get(c), low.array.get(c), high.array.get(c));
  ColorScale s;
  const Field* of = banded_field(d, low, high);
  s.title = of ? of->name : "band";
  s.unit = low.unit;
  std::vector<double> limits;
  bool neighbours = true;
  for (const auto& [number, ends] : bands) {
    neighbours = neighbours && (limits.empty() || limits.back() == ends.first);
    if (limits.empty()) limits.push_back(ends.first);
    limits.push_back(ends.second);
    s.labels.push_back(number);
    const auto texts = distinct_texts({ends.first, ends.second});
    s.label_names.push_back(texts[0] + " \u2026 " + texts[1]);
  }
  if (s.labels.empty()) s.labels = {0}, s.label_names = {""};
  else if (neighbours) s.limits = limits;
  // The colours of values: evenly from band to band, or where range, scale or a middle at zero ask for places.
  Range r;
  for (double v : limits) r.add({v, v});
  if (r.empty()) r = {0, 1};
  const bool is_signed = r.lo < 0 && r.hi > 0 && std::min(-r.lo, r.hi) > 0.05 * std::max(-r.lo, r.hi);
  const std::optional<FileColormap> file = p.map && names_colormap_file(*p.map) ? std::optional(find_file_colormap(*p.map)) : std::nullopt;
  s.map = file ? file->map : find_colormap(p.map ? *p.map : is_signed && p.scale != ScaleKind::log ? "coolwarm" : "sight");
  ColorScale by_value;
  by_value.kind = p.scale;
  by_value.linear_threshold = p.linear_threshold;
  const bool centred = s.map.kind == MapKind::diverging && is_signed;
  by_value.lo = r.lo, by_value.hi = r.hi;
  if (centred) by_value.hi = nice_symmetric(r), by_value.lo = -by_value.hi;
  if (!p.range.empty()) by_value.lo = p.range[0], by_value.hi = p.range[1];
  if (!s.map.categorical()) {
    std::vector<Vec3f> colors;
    const size_t n = s.labels.size();
    for (const auto& [number, ends] : bands) {
      double t = n > 1 ? double(colors.size()) / double(n - 1) : 0.5;
      if (centred || !p.range.empty() || by_value.kind != ScaleKind::linear)
        t = 0.5 * (by_value.position(ends.first) + by_value.position(ends.second));
      colors.push_back(s.map.at(std::isfinite(t) ? std::clamp(t, 0.0, 1.0) : 0));
    }
    if (!colors.empty()) s.map.colors = colors, s.map.kind = MapKind::categorical;
  }
  s.lo = s.labels.front(), s.hi = std::max(s.labels.back(), s.lo + 1);
  if (!p.nan.empty()) s.nan = parse_color(p.nan, "nan");
  name_legend(p, s, context);
  return s;
}

}  // namespace

bool looks_like_labels(const Dataset& data, const Field& field, const Context& context) {
  if (!holds_whole_numbers(field) || field.components() != 1) return false;  // before anything is read
  const uint64_t count = all_sum(uint64_t(field.array.count()), context.communicator);
  if (!may_be_labels(data, field, range_over_all(data, field, -1, context)) || count < 2) return false;
  const auto values = distinct_values(field, most_labels, context);
  if (values.size() > most_labels || values.size() < 2) return false;
  if (std::any_of(values.begin(), values.end(), [](double v) { return v != std::round(v); })) return false;
  if (names_its_labels(data, field)) return true;
  // A piece without cells is no grid, whatever the others are.
  const bool grid = is_lattice(data.mesh());
  if (!all_most(int(grid), context.communicator)) return values.size() * 2 <= count + 2;
  if (values.size() == 2 || field.role == Role::labels) return true;
  auto dims = grid ? lattice_dims(data.mesh()) : std::array<size_t, 3>{1, 1, 1};
  if (field.association == Association::cell)
    for (size_t& n : dims) n = std::max<size_t>(n, 2) - 1;
  // Along x alone a ramp along y would do; across thin slices things change faster.
  return share_of_equal_neighbours(field, dims, 0, values[0], context) > 0.7 &&
         share_of_equal_neighbours(field, dims, 1, values[0], context) > 0.5;
}

Labels labels_of(std::span<const FieldOf> fields, bool categorical, const Context& context) {
  Labels labels;
  std::map<double, std::string> known;
  for (const FieldOf& f : fields) {
    const Range r = range_over_all(*f.data, *f.field, -1, context);
    if (r.empty()) continue;
    if (!categorical && !(may_be_labels(*f.data, *f.field, r) && (r.lo == r.hi || looks_like_labels(*f.data, *f.field, context))))
      return {};
    const auto values = distinct_values(*f.field, most_legend_labels, context);
    labels.values.insert(labels.values.end(), values.begin(), values.end());
    add_noted_names(*f.data, *f.field, known);
  }
  std::sort(labels.values.begin(), labels.values.end());
  labels.values.erase(std::unique(labels.values.begin(), labels.values.end()), labels.values.end());
  if (!categorical && (labels.values.size() < 2 || labels.values.size() > most_labels)) return {};
  for (const double v : labels.values)
    if (const auto k = known.find(v); k != known.end()) labels.names.push_back(k->second);
  if (labels.names.size() != labels.values.size()) labels.names.clear();
  return labels;
}

bool two_sided(const Field& field, const Range& r) {
  const FieldLook& look = field.look;
  if (look.one_sided || !(r.lo < 0 && r.hi > 0)) return false;
  return look.two_sided || std::min(-r.lo, r.hi) > 0.05 * std::max(-r.lo, r.hi);
}

bool is_scanned(const Dataset& data, const Field& field) {
  return in_patient_frame(data) && field.role == Role::scalars && field.components() == 1 && !field.look.result;
}

std::string_view sequential_map(const Dataset& data, const Field& field) { return is_scanned(data, field) ? "gray" : "sight"; }

ColorScale choose_scale(const Dataset& data, const Field& field, const ColoringParams& p, Context& context) {
  ColorScale s;
  s.title = is_stand_in_name(field.name) ? "value" : field.name;
  if (field.components() > 1) s.title += p.component < 0 ? " magnitude" : fmt::format(" [{}]", p.component);
  s.unit = field.unit;
  Range r = range_over_all(data, field, p.component, context);
  if (r.empty()) {
    context.warn(fmt::format("field '{}' has no finite value; it is drawn in the colour of NaN", field.name));
    r = {0, 1};
  }
  if (!p.range.empty() && (p.range.size() != 2 || !(p.range[0] < p.range[1])))
    fail_usage("range needs two numbers, the lower one first", "range", "like range=0,100");
  if (field.look.bands) return band_scale(data, field, p, context);
  const bool automatic = !p.map;
  const std::optional<FileColormap> file = p.map && names_colormap_file(*p.map) ? std::optional(find_file_colormap(*p.map)) : std::nullopt;
  const Colormap asked = automatic ? Colormap{} : file ? file->map : find_colormap(*p.map);
  const bool shared = !p.labels.values.empty();
  const bool labels = shared || (automatic ? p.range.empty() && looks_like_labels(data, field, context) : asked.categorical());
  if (labels && is_stand_in_name(field.name)) s.title = "label";
  s.kind = p.scale;
  const FieldOf itself{&data, &field};
  bool below_log = false, zeros = false;
  if (s.kind == ScaleKind::log && p.range.empty() && r.lo <= 0) {
    // Zeros and negative values have no place on a log scale: start at the smallest positive value.
    Range positive;
    const Field& f = field;
    dispatch(f.array, [&](auto v) {
      for (size_t i = 0; i < v.count; ++i) {
        const double x = double(v(i, std::max(p.component, 0)));
        if (x > 0 && std::isfinite(x)) positive.add({x, x});
      }
    });
    positive = over_all(positive, context);
    if (positive.empty())
      fail_usage(fmt::format("field '{}' has no positive value for a log scale", field.name), "scale", "use scale=linear or scale=symlog");
    r = positive;
    below_log = zeros = true;
    context.info(
        fmt::format("values of '{}' at or below 0 have no place on a log scale, which begins at {}, the smallest above 0; they are "
                    "drawn in grey (below= takes another colour)",
                    field.name, short_number(positive.lo)));
  }
  constexpr double decades = 1e12;  // what lies below is what rounding left
  if (s.kind == ScaleKind::log && p.range.empty() && r.lo > 0 && r.lo * decades < r.hi) r.lo = r.hi / decades, below_log = true;
  const bool ct = is_scanned(data, field) && modality_of(data, field) == Modality::ct;
  const bool is_signed = two_sided(field, r) && !ct;  // Hounsfield's zero, water, is no middle
  if (automatic)
    s.map = find_colormap(labels ? "labels" : is_signed && s.kind != ScaleKind::log ? "coolwarm" : sequential_map(data, field));
  else s.map = asked;
  if (s.map.kind == MapKind::unsafe)
    context.warn(fmt::format(
        "colour map '{}' is not perceptually uniform: its lightness rises and falls, so it shows edges that are not in the data; "
        "'sight' is the safe choice (see: sightglass colormap {})",
        s.map.name, s.map.name));

  if (!p.range.empty()) {
    s.lo = p.range[0], s.hi = p.range[1];
  } else {
    s.lo = r.lo, s.hi = r.hi;
    const bool centred = s.map.kind == MapKind::diverging && is_signed && !(file && file->hard_hinge);
    if (centred) s.hi = nice_symmetric(r), s.lo = -s.hi;
    if (s.kind == ScaleKind::linear && !labels && !file)
      if (const ShownRange shown = shown_range({&itself, 1}, p.component, centred, context); !shown.range.empty())
        take_shown_range(shown, r, field.name, s, context);
    if (const Range window = stated_window(data);
        automatic && !labels && !is_signed && is_scanned(data, field) && window.lo < s.hi && window.hi > s.lo) {
      s.lo = std::max(s.lo, window.lo), s.hi = std::min(s.hi, window.hi);
    } else if (automatic && !labels && ct && window.empty() && s.lo < -1024 && s.hi > -500) {
      s.lo = -1024, s.hi = std::min(s.hi, 2000.0);  // from air to bone; what lies below was never measured
    } else if (automatic && !labels && !ct && !is_signed && window.empty() && s.lo == r.lo && s.hi == r.hi && is_scanned(data, field)) {
      s.hi = std::min(s.hi, foreground(field, p.component, r.lo, r.hi, context, 0.01).hi);  // a few bright vessels must not darken the rest
      if (s.hi < r.hi) s.above = s.map.at(1);
    }
  }
  const bool chosen = p.range.empty() || !p.range_of.empty();  // not stated by a user
  if (chosen && !labels && s.map.name == "coolwarm" && s.kind == ScaleKind::linear && s.lo == -s.hi) {
    // Of the side that reaches less far the map's outer colours are left out, so that zero keeps its own and equal steps look alike.
    const Range all = p.range_of.empty() ? r : p.range_of;
    const double m = s.hi, lo = std::max(s.lo, all.lo), hi = std::min(s.hi, all.hi);
    if (hi - lo < 1.5 * m) s.map = part_of(s.map, 0.5 + 0.5 * lo / m, 0.5 + 0.5 * hi / m), s.lo = lo, s.hi = hi;
  }
  if (s.lo == s.hi) {  // a constant field: any range around it will do
    const double d = s.lo == 0 ? 1 : std::abs(s.lo) * 0.01;
    s.ticks = {s.lo};
    s.lo -= d, s.hi += d;
    if (s.kind == ScaleKind::log) s.lo = s.hi / 1.1;
  }
  if (s.kind == ScaleKind::symlog) s.linear_threshold = p.linear_threshold > 0 ? p.linear_threshold : nice_symmetric({s.lo, s.hi}) * 1e-3;
  if (labels) {
    const Labels found = shared ? p.labels : labels_of({&itself, 1}, true, context);
    s.labels = found.values;
    if (file) take_categories(*file, field, s, context);
    else s.label_names = found.names;
    if (!s.labels.empty()) s.lo = s.labels.front(), s.hi = std::max(s.labels.back(), s.lo + 1);
    if (s.map.name == "labels" && !file) color_by_number(s), color_by_name(s);
  }
  if (file) {
    s.below = file->below, s.above = file->above;
    if (file->nan) s.nan = *file->nan;
    if (file->hard_hinge && s.kind == ScaleKind::linear) s.map = hinged(*file, s.lo, s.hi);
  }
  if (!p.below.empty()) s.below = parse_color(p.below, "below");
  if (!p.above.empty()) s.above = parse_color(p.above, "above");
  if (!p.nan.empty()) s.nan = parse_color(p.nan, "nan");
  if (tells_beyond(p) && !labels) tell_beyond(field, p.beyond ? *p.beyond : count_beyond({&itself, 1}, p), context);
  s.clamp = p.clamp;
  if (zeros && !s.below) s.below = Vec3f{0.82f, 0.82f, 0.82f};  // else zeros look like the least that is more than nothing
  if (!p.range.empty() || ct || below_log) show_what_lies_beyond(data.range(field, p.component), s);
  name_legend(p, s, context);
  return s;
}

}  // namespace sg

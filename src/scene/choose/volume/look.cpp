// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/volume/look.h"

#include <fmt/core.h>

#include "base/text/text.h"
#include "data/fields/stand_in_names.h"
#include "data/lattice.h"
#include "data/patient/modality.h"
#include "data/patient/patient_frame.h"
#include "data/ranks/over_all.h"
#include "scene/choose/histogram.h"
#include "scene/choose/scale.h"
#include "scene/choose/shown_range.h"

namespace sg {

bool looks_like_ct(const Dataset& data, const Field& field, double* offset, const Context& context) {
  const ElementType t = field.array.type();
  if ((t != ElementType::i16 && t != ElementType::u16) || field.components() != 1) return false;
  const Modality modality = modality_of(data, field);
  const Range r = range_over_all(data, field, 0, context);
  if (r.empty() || modality == Modality::other) return false;
  const bool hounsfield = r.lo <= -500;
  *offset = hounsfield ? 0 : 1024;
  if (modality == Modality::ct) return hounsfield || r.hi > 500;
  if (r.hi < 1500 || r.hi > 8000 || r.lo < -4000 || (!hounsfield && r.lo > 300)) return false;
  // Air: a good part of the volume lies at least 300 HU below water. Of the rest soft tissue is a narrow peak about water; MR images, which
  // begin at 0 as well, are spread over their whole range.
  const auto h = histogram(data, field, -1, r.lo, r.hi, 1024, context);
  size_t all = 0, air = 0, tissue = 0;
  for (size_t b = 0; b < h.size(); ++b) {
    const double hu = r.lo + (double(b) + 0.5) / double(h.size()) * (r.hi - r.lo) - *offset;
    all += h[b];
    if (hu < -300) air += h[b];
    if (hu > -150 && hu < 200) tissue += h[b];
  }
  return air * 10 > all && tissue * 20 > all && (hounsfield || tissue * 5 > 2 * (all - air));
}

namespace {

// Fields of which it is known what matters in them: crests, troughs or strands. "" when it is not.
std::string known_look(const Dataset& data, const Field& field, const Range& r, int component, VolumeItem& item, const Context& context) {
  using Shows = FieldLook::Shows;
  const Shows shows = field.look.shows;
  if (shows == Shows::any || shows == Shows::zero) return "";
  const auto h = histogram(data, field, component, r.lo, r.hi, 1024, context);
  size_t all = 0;
  for (const size_t n : h) all += n;
  const double width = r.hi - r.lo;
  if (shows == Shows::fibres && 10 * h.front() > 3 * all) {  // else made of white noise, which has no strands
    item.opacity.points = {{r.lo, 0}, {r.lo + 0.2 * width, 0}, {r.lo + 0.5 * width, 0.95}, {r.hi, 0.99}};
    if (const auto* grid = data.as<UniformGrid>(); grid && item.unit_distance == 0) {
      const Vec3 s = grid->spacing;
      item.unit_distance = 3 * std::max({s.x, s.y, s.z});  // as wide as a strand
    }
    return "strands along the flow";
  }
  const bool low = shows == Shows::low;
  // From what most of the volume holds to the end that matters; zero and what lies beyond it is no crest.
  const double end = low ? r.lo : r.hi, most = histogram_quantile(h, r.lo, r.hi, low ? 0.25 : 0.75);
  double start = most;
  if (r.lo < 0 && r.hi > 0 && two_sided(field, r)) start = low ? std::min(most, 0.0) : std::max(most, 0.0);
  start += 0.06 * (end - start);
  const double middle = start + 0.3 * (end - start);
  if (low) item.opacity.points = {{end, 0.75}, {middle, 0.18}, {start, 0}, {r.hi, 0}};
  else item.opacity.points = {{r.lo, 0}, {start, 0}, {middle, 0.18}, {end, 0.75}};
  return fmt::format("{} values matter: those {} {} are shown", low ? "low" : "high", low ? "below" : "above", short_number(start, 3));
}

// Skin to be seen through, bone strongly; colours of flesh and ivory. Hounsfield units + offset.
void ct_look(const Field& field, const Range& r, double offset, bool choose_colors, VolumeItem& item) {
  item.opacity.points.clear();
  // The border of skin and air is a layer of its own: thin, and much denser than the flesh beneath it.
  const double points[][2] = {{-620, 0},   {-520, 0.65}, {-320, 0.65}, {-190, 0.02}, {60, 0.02},
                              {130, 0.06}, {250, 0.45},  {800, 0.75},  {3000, 0.9}};
  for (const auto& p : points) item.opacity.points.push_back({p[0] + offset, p[1]});
  item.shaded = true;
  if (!choose_colors) return;
  struct Stop {
    double hu;
    Vec3f color;
  };
  const Stop stops[] = {{-500, {0.91f, 0.72f, 0.59f}}, {-200, {0.88f, 0.63f, 0.50f}}, {-60, {0.85f, 0.55f, 0.42f}},
                        {60, {0.88f, 0.52f, 0.40f}},   {160, {0.93f, 0.80f, 0.64f}},  {300, {0.96f, 0.93f, 0.86f}},
                        {1500, {1.0f, 1.0f, 0.97f}}};
  item.color.lo = std::max(-500 + offset, r.lo);
  item.color.hi = std::min(1500 + offset, r.hi);
  item.color.map = Colormap{"ct", MapKind::sequential, "Flesh to bone over Hounsfield units.", {}, {}};
  for (int i = 0; i < 256; ++i) {
    const double hu = item.color.lo + (item.color.hi - item.color.lo) * i / 255.0 - offset;
    size_t k = 1;
    while (k + 1 < std::size(stops) && stops[k].hu < hu) ++k;
    const float t = float(std::clamp((hu - stops[k - 1].hu) / (stops[k].hu - stops[k - 1].hu), 0.0, 1.0));
    item.color.map.colors.push_back(lerp(stops[k - 1].color, stops[k].color, t));
  }
  if (is_stand_in_name(field.name) && item.color.title == "value") item.color.title = "CT value";
}

// From a soft grey to white: what is dark in an image must still show its shape in the light.
Colormap soft_grey() { return {"soft grey", MapKind::sequential, "A warm grey to white.", {{0.46f, 0.42f, 0.40f}, {1, 0.98f, 0.95f}}, {}}; }

// Whatever is no air, in soft grey and lit, so that the skin can be read; the window is the file's own or that of the foreground.
void scan_look(const Dataset& data, const Field& field, int component, const Range& r, VolumeItem& item, const Context& context) {
  const Range f = foreground(field, component, r.lo, r.hi, context), stated = stated_window(data);
  const bool window = !stated.empty() && stated.hi > r.lo && stated.lo < r.hi;
  const double width = f.hi - f.lo;
  item.opacity.points = {{r.lo, 0}, {f.lo, 0}, {f.lo + 0.06 * width, 0.25}, {f.hi, 0.5}, {r.hi, 0.5}};
  if (f.hi >= r.hi) item.opacity.points.pop_back();
  item.shaded = true;
  item.color.map = soft_grey();
  item.color.lo = window ? std::max(stated.lo, r.lo) : r.lo, item.color.hi = window ? std::min(stated.hi, r.hi) : f.hi;
}

// Where the colours of what is seen end: few values far above all others, as of a density about its nuclei, would leave most of them
// unused.
double end_of_foreground(std::vector<size_t> h, const Range& r, double start) {
  constexpr double bright = 0.005, far = 0.75;
  const double width = r.hi - r.lo;
  std::fill(h.begin(), h.begin() + ptrdiff_t(std::clamp((start - r.lo) / width, 0.0, 1.0) * double(h.size())), size_t(0));
  const double end = *parse_double(short_number(histogram_quantile(h, r.lo, r.hi, 1 - bright), 2));
  return end > start && end - r.lo < far * width ? end : r.hi;
}

}  // namespace

std::string choose_volume_look(const Dataset& data, const Field& field, const ColoringParams& params, VolumeItem& item, bool anatomy,
                               const Context& context) {
  const Range r{item.color.lo, item.color.hi};
  if (item.mode == VolumeItem::Mode::maximum) {
    item.opacity.points = {{r.lo, 0}, {r.hi, 1}};
    return "maximum along each ray";
  }
  const Range values = range_over_all(data, field, params.component, context);
  if (!values.empty() && values.lo == values.hi) {
    item.opacity.points = {{values.lo, 0.2}};
    return fmt::format("every value is {}: drawn evenly", short_number(values.lo, 6));
  }
  double offset = 0;
  if (anatomy && !params.states_range() && looks_like_ct(data, field, &offset, context)) {
    ct_look(field, range_over_all(data, field, 0, context), offset, !params.states_map(), item);
    const bool stated = modality_of(data, field) == Modality::ct;
    return fmt::format("CT ({}{}): skin and bone colours", stated ? "stated in the file" : "an air peak and soft tissue in 16-bit values",
                       offset ? ", Hounsfield + 1024" : "");
  }
  if (item.color.kind != ScaleKind::linear) {  // by position, so that decades get equal shares
    item.opacity.points.clear();
    for (int i = 0; i <= 16; ++i) item.opacity.points.push_back({item.color.value_at(i / 16.0), 0.25 * (i / 16.0) * (i / 16.0)});
    return "opacity rises with the position on the scale";
  }
  if (const std::string why = known_look(data, field, r, params.component, item, context); !why.empty()) return why;
  if (item.color.map.kind == MapKind::diverging && r.lo < 0 && r.hi > 0) {
    const double m = std::max(-r.lo, r.hi);
    item.opacity.points = {{-m, 0.8}, {-0.5 * m, 0.25}, {-0.2 * m, 0}, {0.2 * m, 0}, {0.5 * m, 0.25}, {m, 0.8}};
    return "signed: opaque away from zero on both sides";
  }
  if (anatomy && in_patient_frame(data) && !params.states_map() && !params.states_range()) {
    scan_look(data, field, params.component, r, item, context);
    return fmt::format("a scan: in grey, values above {} are shown", short_number(item.opacity.points[1].x, 3));
  }
  // What most samples have about is taken for the background; opacity follows the quantiles away from it.
  const auto h = histogram(data, field, params.component, r.lo, r.hi, 256, context);
  const size_t peak = fullest_bin(h);
  if (peak > h.size() / 2) {  // bright background: see the low values
    const double q50 = histogram_quantile(h, r.lo, r.hi, 0.5), q10 = histogram_quantile(h, r.lo, r.hi, 0.1);
    item.opacity.points = {{r.lo, 0.5}, {std::min(q10, 0.5 * (r.lo + q50)), 0.10}, {q50, 0}, {r.hi, 0}};
    std::sort(item.opacity.points.begin(), item.opacity.points.end(), [](Vec2 a, Vec2 b) { return a.x < b.x; });
    return "the background is bright: low values are shown";
  }
  const double width = r.hi - r.lo, peak_value = r.lo + (double(peak) + 1) / double(h.size()) * width;
  // Where the foreground begins: past the background peak, and past what most of the volume holds.
  const double start = std::max(peak_value + 0.02 * width, std::min(histogram_quantile(h, r.lo, r.hi, 0.6), r.lo + 0.35 * width));
  const double middle = std::max(start + 0.15 * width, histogram_quantile(h, r.lo, r.hi, 0.95));
  const double end = !params.states_range() ? end_of_foreground(h, r, start) : r.hi;
  if (end < r.hi) item.color.hi = end, item.color.above = item.color.above.value_or(item.color.map.at(1));
  item.opacity.points = {{r.lo, 0}, {start, 0}, {std::min(middle, 0.5 * (start + end)), 0.12}, {end, 0.7}};
  return fmt::format("values above {} are shown, the background below is left out", short_number(start, 3));
}

}  // namespace sg

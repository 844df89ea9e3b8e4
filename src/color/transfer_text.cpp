// SPDX-License-Identifier: Apache-2.0
#include "color/transfer_text.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/text/text.h"
#include "color/map_files/colormap_nodes.h"
#include "color/parse_color.h"

namespace sg {

namespace {

const char* opacity_form = "write position:opacity pairs, e.g. 0:0,0.3:0.1,1:0.8, or @value:opacity, e.g. @-500:0,@200:0.4";
const char* stops_form = "write position:colour pairs, e.g. 0:#000000,0.4:#aa3311,1:white, or @value:colour";

// Values written as positions would leave the curve empty without a word.
void check_position(std::string_view where, double t, const std::string& word) {
  if (!where.starts_with('@') && !(t >= 0 && t <= 1))
    fail_usage(fmt::format("position {} is not between 0 and 1, the ends of the range", where), word,
               fmt::format("a value is written with @: @{}", where));
}

// The two halves of "place:what"; a colour may hold no colon.
std::pair<std::string_view, std::string_view> halves(std::string_view part) {
  const size_t colon = part.find(':');
  if (colon == part.npos) return {part, {}};
  return {trim(part.substr(0, colon)), trim(part.substr(colon + 1))};
}

void check_ascends(double before, double now, std::string_view part, const ColorScale& axis, const std::string& word) {
  if (now < before)
    fail_usage(fmt::format("'{}' lies below the previous point ({} after {})", part, short_number(axis.value_at(now)),
                           short_number(axis.value_at(before))),
               word, "write the points in ascending order; two points at one position make a step");
}

}  // namespace

std::optional<double> place_position(std::string_view text, const ColorScale& axis) {
  const bool absolute = text.starts_with('@');
  const auto v = parse_double(trim(absolute ? text.substr(1) : text));
  if (!v || !std::isfinite(*v)) return {};
  if (!absolute) return *v;
  if (axis.labels.empty()) return axis.kind == ScaleKind::log && !(*v > 0) ? NAN : axis.position(*v);
  return (*v - axis.lo) / (axis.hi - axis.lo);  // labels: between them, too
}

double place_value(std::string_view text, const ColorScale& axis) {
  if (text.starts_with('@')) return *parse_double(trim(text.substr(1)));
  const double t = *parse_double(text);
  if (axis.kind == ScaleKind::linear || !axis.labels.empty()) return t == 1 ? axis.hi : axis.lo + t * (axis.hi - axis.lo);
  return axis.value_at(t);
}

OpacityCurve parse_opacity(const std::string& text, const ColorScale& axis, const std::string& word) {
  OpacityCurve curve;
  curve.points.clear();
  const auto parts = split(text, ',');
  if (parts.empty()) fail_usage("the curve is empty", word, opacity_form);
  double last = -HUGE_VAL;
  int same = 0;
  bool last_is_value = false;
  for (const std::string_view part : parts) {
    auto [where, how_much] = halves(part);
    const bool constant = parts.size() == 1 && part.find(':') == part.npos;
    if (constant) how_much = where, where = "0";
    const auto t = place_position(where, axis);
    const auto y = parse_double(how_much);
    if (!t || !y) fail_usage(fmt::format("'{}' is not a point of an opacity curve", part), word, opacity_form);
    if (!std::isfinite(*t))
      fail_usage(fmt::format("'{}' cannot be placed on a log scale", where), word, "values on a log scale are above 0");
    if (!(*y >= 0 && *y <= 1)) fail_usage(fmt::format("opacity {} is not between 0 and 1", how_much), word, opacity_form);
    check_position(where, *t, word);
    check_ascends(last, *t, part, axis, word);
    same = *t == last ? same + 1 : 0;
    if (same == 2) fail_usage(fmt::format("'{}' is the third point at one position", part), word, "two points at one position make a step");
    const double x = place_value(where, axis);
    const bool is_value = where.starts_with('@');
    if (!curve.points.empty() && axis.kind != ScaleKind::linear && *t > last && !(is_value && last_is_value)) {
      // Between positions opacity is straight along the scale: bent over values.
      const Vec2 from = curve.points.back();
      const int pieces = 16;
      for (int i = 1; i < pieces; ++i) {
        const double s = double(i) / pieces;
        curve.points.push_back({axis.value_at(last + s * (*t - last)), from.y + s * (*y - from.y)});
      }
    }
    curve.points.push_back({x, *y});
    last = *t, last_is_value = is_value;
  }
  return curve;
}

OpacityCurve parse_opacity(const std::string& text, double lo, double hi) {
  ColorScale axis;
  axis.lo = lo, axis.hi = hi;
  return parse_opacity(text, axis);
}

std::string opacity_text(const OpacityCurve& curve) {
  std::string r;
  for (const Vec2& p : curve.points) r += fmt::format("{}@{}:{}", r.empty() ? "" : ",", exact_number(p.x), exact_number(p.y));
  return r;
}

void parse_color_stops(const std::string& text, ColorScale& scale, bool keep_range) {
  // Commas also occur within "r,g,b": a part without a colon belongs to the previous one.
  std::vector<std::string> parts;
  for (const std::string_view part : split(text, ',')) {
    if (part.find(':') == part.npos && !parts.empty()) parts.back() += "," + std::string(part);
    else parts.emplace_back(part);
  }
  if (parts.empty()) fail_usage("there are no colours", "colors", stops_form);
  std::vector<ColorNode> nodes;
  std::string_view first, last;
  for (const std::string& part : parts) {
    const auto [where, what] = halves(part);
    const auto t = place_position(where, scale);
    if (!t || what.empty()) fail_usage(fmt::format("'{}' is not a colour at a position", part), "colors", stops_form);
    if (!std::isfinite(*t))
      fail_usage(fmt::format("'{}' cannot be placed on a log scale", where), "colors", "values on a log scale are above 0");
    check_position(where, *t, "colors");
    if (!nodes.empty()) check_ascends(nodes.back().position, *t, part, scale, "colors");
    if (nodes.size() > 1 && *t == nodes[nodes.size() - 2].position)
      fail_usage(fmt::format("'{}' is the third colour at one position", part), "colors", "two colours at one position make a step");
    nodes.push_back({*t, parse_color(what, "colors")});
    (nodes.size() == 1 ? first : last) = where;
  }
  Colormap map{"stops", MapKind::sequential, "Colours as given.", {}, {}};
  const bool flat = nodes.front().position == nodes.back().position;
  if (flat || keep_range) {
    // The end colours go on to the ends of the range; what lies beyond the range is cut off.
    std::vector<ColorNode> whole;
    const auto at = [&](double t) {
      if (t <= nodes.front().position) return nodes.front().color;
      for (size_t i = 1; i < nodes.size(); ++i)
        if (t < nodes[i].position)
          return lerp(nodes[i - 1].color, nodes[i].color, float((t - nodes[i - 1].position) / (nodes[i].position - nodes[i - 1].position)));
      return nodes.back().color;
    };
    whole.push_back({0, at(0)});
    for (const ColorNode& n : nodes)
      if (n.position > 0 && n.position < 1) whole.push_back(n);
    whole.push_back({1, nodes.back().position <= 1 ? nodes.back().color : at(1)});
    nodes = std::move(whole);
  } else {
    const double lo = place_value(first, scale), hi = place_value(last, scale);
    scale.lo = lo, scale.hi = hi;
  }
  set_nodes(map, nodes, NodeSpace::rgb);
  scale.map = std::move(map);
  scale.labels.clear(), scale.label_names.clear(), scale.limits.clear();
}

std::string color_stops_text(const ColorScale& scale) {
  std::string r;
  const auto add = [&](double t, Vec3f color) {
    r += fmt::format("{}@{}:{}", r.empty() ? "" : ",", exact_number(scale.value_at(t)), color_text(color));
  };
  const auto& c = scale.map.colors;
  const size_t n = c.size();
  if (scale.map.categorical()) {
    for (size_t i = 0; i < n; ++i) add(double(i) / double(n), c[i]), add(double(i + 1) / double(n), c[i]);
    return r;
  }
  if (!scale.map.positions.empty()) {
    for (size_t i = 0; i < n; ++i) add(scale.map.positions[i], c[i]);
    return r;
  }
  // Greedy: the farthest sample to which a straight line misses no colour between by half a step of 8 bits.
  constexpr float miss = 0.5f / 255;
  for (size_t i = 0; i < n;) {
    add(n > 1 ? double(i) / double(n - 1) : 0, c[i]);
    if (i + 1 == n) break;
    size_t to = i + 1;
    for (size_t j = i + 2; j < n; ++j) {
      bool straight = true;
      for (size_t k = i + 1; k < j && straight; ++k) {
        const Vec3f line = lerp(c[i], c[j], float(k - i) / float(j - i));
        for (int a = 0; a < 3; ++a) straight = straight && std::abs(line[a] - c[k][a]) <= miss;
      }
      if (!straight) break;
      to = j;
    }
    i = to;
  }
  return r;
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "color/widgets/widgets_text.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/text/text.h"
#include "color/parse_color.h"
#include "color/transfer_text.h"

namespace sg {

namespace {

using Shape = TransferWidget::Shape;

/// A drag of the mouse over the window's plane comes to some 30 points.
constexpr size_t most_points = 256;

const char* form =
    "write 'triangle LO HI BASE TOP OPACITY COLOR', 'rectangle LO HI LOW HIGH OPACITY COLOR', 'ellipse LO HI LOW HIGH OPACITY COLOR' or "
    "'paint RADIUS:RADIUS VALUE,SECOND VALUE,SECOND OPACITY COLOR', separated by ';'; LO, HI and VALUE are positions (or @values), LOW, "
    "HIGH and SECOND are on the second axis";

double value_at(std::string_view text, const ColorScale& axis, std::string_view part) {
  const auto t = place_position(text, axis);
  if (!t) fail_usage(fmt::format("'{}' in '{}' is not a position", text, part), "widgets", form);
  return place_value(text, axis);
}

// The two sides of a pair; the second is empty where there is no mark between them, or more than one.
std::pair<std::string_view, std::string_view> pair_of(std::string_view text, char between) {
  const size_t at = text.find(between);
  if (at == text.npos || text.find(between, at + 1) != text.npos) return {text, {}};
  return {text.substr(0, at), text.substr(at + 1)};
}
bool is_pair(std::string_view text, char between) { return !pair_of(text, between).second.empty(); }

double radius_of(std::string_view text, const ColorScale& axis, std::string_view part) {
  const bool absolute = text.starts_with('@');
  const auto r = parse_double(absolute ? text.substr(1) : text);
  if (!r || !std::isfinite(*r)) fail_usage(fmt::format("'{}' in '{}' is not a radius", text, part), "widgets", form);
  if (!(*r > 0))
    fail_usage(fmt::format("the brush of '{}' has the radius {}", part, text), "widgets",
               "radii are above 0: shares of the ranges of both axes, such as 0.03:0.05, or with @ lengths on them");
  return absolute ? *r : *r * std::abs(axis.hi - axis.lo);
}

// "RADIUS:RADIUS VALUE,SECOND ..." after the first word; how many words it takes.
size_t parse_line(const std::vector<std::string_view>& w, std::string_view part, const ColorScale& value, const ColorScale& second,
                  TransferWidget& r) {
  if (w.size() < 2 || !is_pair(w[1], ':')) fail_usage(fmt::format("'{}' does not begin with the radii of a brush", part), "widgets", form);
  const auto [along, up] = pair_of(w[1], ':');
  const double radius = radius_of(along, value, part), second_radius = radius_of(up, second, part);
  std::vector<Vec2> line;
  size_t taken = 2;
  for (; taken < w.size() && is_pair(w[taken], ','); ++taken) {
    const auto [x, y] = pair_of(w[taken], ',');
    line.push_back({value_at(x, value, part), value_at(y, second, part)});
  }
  if (line.empty()) fail_usage(fmt::format("'{}' has no points", part), "widgets", form);
  if (line.size() > most_points)
    fail_usage(fmt::format("a stroke has {} points", line.size()), "widgets",
               fmt::format("no more than {} are taken: write it as several strokes", most_points));
  r = painted(std::move(line), radius, second_radius, 1, r.color);
  return taken;
}

std::string exact_place(double v) { return "@" + exact_number(v); }

}  // namespace

std::vector<TransferWidget> parse_widgets(const std::string& text, const ColorScale& value, const ColorScale& second) {
  std::vector<TransferWidget> widgets;
  for (const std::string_view part : split(text, ';')) {
    const auto w = words(part);
    if (w.empty()) continue;
    const auto shape = value_of_word<Shape>(w[0]);
    if (!shape) {
      std::vector<std::string> names;
      for (const Word<Shape>& known : enum_words(Shape())) names.emplace_back(known.word);
      fail_usage(fmt::format("unknown widget '{}'", w[0]), "widgets", unknown_name_hint(std::string(w[0]), names));
    }
    TransferWidget r;
    size_t taken = 5;
    if (*shape == Shape::paint) {
      taken = parse_line(w, part, value, second, r);
      if (w.size() > taken + 2)
        fail_usage(fmt::format("'{}' is not a point, and more than opacity and colour follow it", w[taken]), "widgets", form);
    } else {
      r.shape = *shape;
      if (w.size() < 5 || w.size() > 7) fail_usage(fmt::format("'{}' has {} numbers", part, w.size() - 1), "widgets", form);
      r.lo = value_at(w[1], value, part), r.hi = value_at(w[2], value, part);
      r.second_lo = value_at(w[3], second, part), r.second_hi = value_at(w[4], second, part);
    }
    if (*shape != Shape::paint && (!(r.lo < r.hi) || !(r.second_lo < r.second_hi)))
      fail_usage(fmt::format("'{}' has zero width or height", part), "widgets", "write the lower end of each axis first");
    if (w.size() > taken) {
      const auto y = parse_double(w[taken]);
      if (!y || !(*y >= 0 && *y <= 1)) fail_usage(fmt::format("opacity {} is not between 0 and 1", w[taken]), "widgets", form);
      r.opacity = *y;
    }
    r.color = w.size() > taken + 1 && w[taken + 1] != "map" ? parse_color(w[taken + 1], "widgets") : Vec3f{-1, -1, -1};
    widgets.push_back(std::move(r));
  }
  if (widgets.empty()) fail_usage("there are no widgets", "widgets", form);
  return widgets;
}

std::string widgets_text(const std::vector<TransferWidget>& widgets) {
  std::string r;
  for (const TransferWidget& w : widgets) {
    r += fmt::format("{}{}", r.empty() ? "" : "; ", word_of(w.shape));
    if (w.shape == Shape::paint) {
      r += fmt::format(" {}:{}", exact_place(w.radius), exact_place(w.second_radius));
      for (const Vec2& p : w.line) r += fmt::format(" {},{}", exact_place(p.x), exact_place(p.y));
    } else {
      for (const double v : {w.lo, w.hi, w.second_lo, w.second_hi}) r += " " + exact_place(v);
    }
    r += fmt::format(" {} {}", exact_number(w.opacity), w.color.x < 0 ? "map" : color_text(w.color));
  }
  return r;
}

bool mixes_ends(const std::string& text) {
  for (const std::string_view part : split(text, ';')) {
    const auto w = words(part);
    if (w.empty() || value_of_word<Shape>(w[0]) == Shape::paint) continue;  // a line has no lower end
    for (size_t i = 1; i + 1 < std::min<size_t>(w.size(), 5); i += 2)
      if (w[i].starts_with('@') != w[i + 1].starts_with('@')) return true;
  }
  return false;
}

}  // namespace sg

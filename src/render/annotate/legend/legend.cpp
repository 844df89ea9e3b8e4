// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/legend/legend.h"

#include <algorithm>
#include <cmath>

#include "render/annotate/legend/band.h"
#include "render/annotate/legend/column.h"
#include "render/annotate/legend/parts.h"

namespace sg {
namespace {

constexpr double usual_share = 0.5, least_bar = 14;  // of lying bars: share of the width; font sizes
constexpr double beside_bar = 6;                     // font sizes that ends of lying bars take, about

std::vector<size_t> legends_at(const std::vector<Legend>& scales, LegendPlace side) {
  std::vector<size_t> at;
  for (size_t i = 0; i < scales.size(); ++i)
    if (scales[i].place == side) at.push_back(i);
  return at;
}

// Lying legends of one side in rows, as many side by side as have room, in the middle of the area; returns their height.
double layout_bands(const Overlay& o, const std::vector<Legend>& scales, LegendPlace side, const Rect& area, double whole, double font,
                    bool nan, std::vector<LegendLayout>& legends) {
  const std::vector<size_t> these = legends_at(scales, side);
  if (these.empty()) return 0;
  const double gap = 2 * legend::column_gap * font, share = area.width / double(these.size()) - gap - beside_bar * font;
  struct Line {
    std::vector<size_t> members;
    double width = 0, bars = 0, below = 0;  // largest height above and from the upper edge of the bars
  };
  std::vector<Line> lines;
  for (const size_t i : these) {
    const double usual = std::min(usual_share * whole, std::max(share, least_bar * font));
    // A list may be as wide as the area: how many names stand side by side depends on it.
    const double length = scales[i].bar                ? *scales[i].bar * whole
                          : legend::has_bar(scales[i]) ? usual
                                                       : std::max(usual, these.size() > 1 ? share : 0.9 * area.width);
    LegendLayout& l = legends[i] = layout_band(o, scales[i], length, area.width, 0.3 * area.height, font, nan);
    if (lines.empty() || lines.back().width + gap + l.column.width > area.width) lines.emplace_back();
    Line& line = lines.back();
    line.width += (line.members.empty() ? 0 : gap) + l.column.width;
    line.members.push_back(i);
    line.bars = std::max(line.bars, l.bar.y), line.below = std::max(line.below, l.column.height - l.bar.y);
  }
  double height = legend::column_gap * font * 0.6 * double(lines.size() - 1);
  for (const Line& line : lines) height += std::ceil(line.bars + line.below);
  double y = std::round(side == LegendPlace::top ? area.y : area.bottom() - height);
  for (const Line& line : lines) {
    double x = std::round(area.x + 0.5 * (area.width - line.width));
    for (const size_t i : line.members) {
      const double width = legends[i].column.width;
      legends[i] = moved(std::move(legends[i]), int(x), int(std::round(y + line.bars - legends[i].bar.y)));
      x = std::round(x + width + gap);
    }
    y = std::round(y + std::ceil(line.bars + line.below) + legend::column_gap * font * 0.6);
  }
  return height;
}

bool is_legible(const LegendLayout& l, const Rect& area) {
  const double f = l.font;
  if (l.lies()) return l.column.width <= area.width - legend::margin * f && (l.swatches > 0 || l.bar.width >= 6 * f);
  return (l.swatches > 0 || l.bar.height >= 3 * f) && (l.nan ? l.nan_at.y + 1.5 * f : l.bar.bottom()) <= l.column.bottom();
}

}  // namespace

std::vector<LegendLayout> layout_legends(const Overlay& overlay, const std::vector<Legend>& scales, const Rect& area, double font,
                                         bool nan) {
  using enum LegendPlace;
  std::vector<LegendLayout> legends;
  for (double f = font;; f *= 0.88) {
    legends.assign(scales.size(), {});
    for (size_t i = 0; i < scales.size(); ++i) legends[i].place = scales[i].place;
    const double margin = legend::margin * f, gap = legend::column_gap * f;
    Rect rest{area.x, area.y + margin, area.width - margin, area.height - 2 * margin};
    const std::vector<size_t> at_right = legends_at(scales, right);
    for (size_t k = at_right.size(); k-- > 0;) {
      LegendLayout& l = legends[at_right[k]] = layout_column(overlay, scales[at_right[k]], rest, area.height, f, nan);
      rest.width = l.column.x - gap - rest.x;
    }
    rest = {area.x + margin, area.y + margin, area.width - margin, area.height - 2 * margin};
    for (const size_t i : legends_at(scales, left)) {
      legends[i] = layout_column(overlay, scales[i], rest, area.height, f, nan);
      rest.x = legends[i].column.right() + gap;
    }
    // Lying ones are centred on the picture itself.
    const double taken_left = legends_width(legends, left), taken_right = legends_width(legends, right), across = taken_left + taken_right;
    rest = {area.x + std::max(taken_left, margin), area.y + margin, 0, area.height - 2 * margin};
    rest.width = std::max(1.0, area.right() - std::max(taken_right, margin) - rest.x);
    double down = 0;
    for (const LegendPlace side : {top, bottom})
      if (const double height = layout_bands(overlay, scales, side, rest, area.width, f, nan, legends); height > 0)
        down += height + 2 * margin;
    const bool legible = std::all_of(legends.begin(), legends.end(), [&](const LegendLayout& l) { return is_legible(l, area); });
    // Of the height less than half, so that they need not go over the picture.
    const auto within = [&](double share, double high) { return across <= share * area.width && down <= high * area.height; };
    if (legible && (within(0.6, 0.45) || (f < 5.5 && within(0.95, 0.95)))) return legends;
    if (f < 3) return {};
  }
}

double legends_width(const std::vector<LegendLayout>& legends, LegendPlace side) {
  const bool lie = side == LegendPlace::top || side == LegendPlace::bottom;
  double from = HUGE_VAL, to = -HUGE_VAL, font = 0;
  for (const LegendLayout& l : legends)
    if (l.place == side) {
      from = std::min(from, lie ? l.column.y : l.column.x), to = std::max(to, lie ? l.column.bottom() : l.column.right());
      font = l.font;
    }
  return from > to ? 0 : to - from + 2 * legend::margin * font;
}

}  // namespace sg

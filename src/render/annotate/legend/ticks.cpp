// SPDX-License-Identifier: Apache-2.0
#include "render/annotate/legend/ticks.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text/text.h"
#include "color/counted_ticks.h"
#include "render/annotate/legend/parts.h"

namespace sg {

namespace {

// A bar as an axis with numbers along it.
struct NumberedBar {
  const Overlay& overlay;
  const Rect& bar;
  bool lies;
  double font, line_height;

  double length() const { return lies ? bar.width : bar.height; }
  int at(double position) const {
    const double last = length() - 1;
    return lies ? int(bar.x + std::lround(position * last)) : int(bar.y + std::lround((1 - position) * last));
  }
  double width(const std::string& text) const { return overlay.measure(text, legend::sized(font)).width; }
  // Pixels from one number to the next without which they would touch.
  double between(const std::string& a, const std::string& b) const {
    return lies ? 0.5 * (width(a) + width(b)) + 0.9 * font : 1.05 * line_height;
  }
};

std::vector<LegendLayout::Tick> limits_of_bands(const NumberedBar& b, const ColorScale& s) {
  std::vector<LegendLayout::Tick> ticks;
  std::vector<std::string> texts = distinct_texts(s.limits);
  for (size_t i = 0; i < texts.size(); ++i)
    texts[i] = typeset_number(s.number_format.empty() ? texts[i] : formatted_number(s.limits[i], s.number_format));
  double apart = 1.15 * b.line_height;
  if (b.lies)
    for (const std::string& t : texts) apart = std::max(apart, b.width(t) + 0.9 * b.font);
  const size_t n = s.limits.size(), every = size_t(std::ceil(apart * double(n - 1) / std::max(b.length() - 1, 1.0)));
  for (size_t i = 0; i < n; i += std::max<size_t>(every, 1)) ticks.push_back({s.limits[i], texts[i], b.at(double(i) / double(n - 1))});
  return ticks;
}

// How many round numbers to ask for. Beside a standing bar all have the same height; below a lying one as many as stay apart in even steps.
int round_numbers(const NumberedBar& b, const ColorScale& s) {
  if (!b.lies) return std::clamp(int(b.bar.height / (2.6 * b.line_height)), 2, 9);
  int wanted = std::clamp(int(b.bar.width / (3.5 * b.font)), 2, 9);
  for (; wanted > 2; --wanted) {
    std::string last;
    int last_at = 0;
    bool apart = true;
    for (const TickLabel& t : nice_ticks(s.lo, s.hi, wanted, s.kind, s.linear_threshold)) {
      const std::string text = typeset_number(s.number_format.empty() ? t.text : formatted_number(t.value, s.number_format));
      const double position = s.position(t.value);
      if (!(position >= 0 && position <= 1)) continue;
      const int at = b.at(position);
      apart = apart && (last.empty() || std::abs(at - last_at) >= b.between(last, text));
      last = text, last_at = at;
    }
    if (apart) break;
  }
  return wanted;
}

// Stated numbers with as many decimals as the longest of them.
std::vector<std::string> texts_of_stated(const ColorScale& s) {
  constexpr int most_decimals = 6;
  std::vector<std::string> texts;
  size_t decimals = 0;
  bool plain = s.kind == ScaleKind::linear;
  for (const double v : s.ticks) {
    const std::string& text = texts.emplace_back(short_number(v, 8));
    const size_t point = text.find('.');
    if (point != text.npos) decimals = std::max(decimals, text.size() - point - 1);
    plain = plain && text.find('e') == text.npos;
  }
  if (plain && decimals <= most_decimals)
    for (size_t i = 0; i < texts.size(); ++i) texts[i] = fmt::format("{:.{}f}", s.ticks[i], decimals);
  return texts;
}

}  // namespace

std::vector<LegendLayout::Tick> legend_ticks(const Overlay& overlay, const ColorScale& s, const Rect& bar, bool lies, double font) {
  const NumberedBar b{overlay, bar, lies, font, overlay.measure("0", legend::sized(font)).height};
  if (s.limits.size() > 1) return limits_of_bands(b, s);
  std::vector<LegendLayout::Tick> ticks;
  const auto offer = [&](double value, std::string text) {
    if (!s.number_format.empty()) text = formatted_number(value, s.number_format);
    text = typeset_number(text);
    const double t = s.position(value);
    if (!(t >= 0 && t <= 1)) return;
    const int at = b.at(t);
    for (const auto& other : ticks)
      if (std::abs(other.row - at) < b.between(other.text, text) || other.text == text) return;
    ticks.push_back({value, text, at});
  };
  if (!s.ticks.empty()) {
    const std::vector<std::string> texts = texts_of_stated(s);
    for (size_t i = 0; i < texts.size(); ++i) offer(s.ticks[i], texts[i]);
    return ticks;
  }
  if (s.tick_count > 0) {
    for (const TickLabel& t : counted_ticks(s)) offer(t.value, t.text);
    return ticks;
  }
  size_t longest = 0;
  for (const TickLabel& t : nice_ticks(s.lo, s.hi, round_numbers(b, s), s.kind, s.linear_threshold))
    longest = std::max(longest, t.text.size()), offer(t.value, t.text);
  const int digits = digits_between(s);
  for (double end : {s.lo, s.hi}) {
    const std::string exact = exact_number(end),
                      text = exact.size() <= std::max<size_t>(6, longest + 1) ? exact : short_number(end, digits);
    if (text.size() <= longest + 3) offer(end, text);
  }
  return ticks;
}

}  // namespace sg

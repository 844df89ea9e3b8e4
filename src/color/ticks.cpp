// SPDX-License-Identifier: Apache-2.0
// nice_ticks: round numbers, and texts that distinguish them.
#include <fmt/core.h>

#include <algorithm>

#include "base/text/text.h"
#include "color/color_scale.h"

namespace sg {
namespace {

/// digit * 10^exponent, correctly rounded for exponents that doubles hold exactly.
double decimal(double digit, int exponent) {
  if (exponent >= 0) return digit * std::pow(10.0, exponent);
  return digit / std::pow(10.0, -exponent);
}

int decade_below(double v) {
  int e = int(std::floor(std::log10(v)));
  if (decimal(1, e + 1) <= v) ++e;
  if (decimal(1, e) > v) --e;
  return e;
}

/// "-1.50e+07" -> "-1.50e7"
std::string tidy_exponent(std::string s) {
  const size_t e = s.find('e');
  if (e == std::string::npos) return s;
  std::string digits = s.substr(e + 1);
  const bool negative = digits[0] == '-';
  const size_t first = digits.find_first_not_of("+-0");
  digits = first == std::string::npos ? "0" : digits.substr(first);
  return s.substr(0, e + 1) + (negative ? "-" : "") + digits;
}

/// One form for all ticks: fixed decimals, or scientific where that is shorter for the largest.
std::vector<TickLabel> with_texts(const std::vector<double>& values, int step_exponent) {
  double largest = 0;
  for (double v : values) largest = std::max(largest, std::abs(v));
  const int top = largest > 0 ? decade_below(largest) : 0;
  const int decimals = std::max(0, -step_exponent), mantissa = std::max(0, top - step_exponent);
  // Fixed up to 6 digits; beyond that whichever is shorter.
  const int fixed_length = std::max(top, 0) + 1 + (decimals ? 1 + decimals : 0);
  const int scientific_length = 1 + (mantissa ? 1 + mantissa : 0) + 2 + (std::abs(top) >= 10) + (top < 0);
  const bool scientific = fixed_length > 6 && scientific_length < fixed_length;
  std::vector<TickLabel> ticks;
  for (double v : values)
    ticks.push_back({v, v == 0       ? "0"
                        : scientific ? tidy_exponent(fmt::format("{:.{}e}", v, mantissa))
                                     : fmt::format("{:.{}f}", v, decimals)});
  if (!scientific)
    for (TickLabel& t : ticks)
      if (t.value == 0) t.text = fmt::format("{:.{}f}", 0.0, decimals);
  return ticks;
}

/// Only the ends, for ranges too narrow or too wide for steps in double precision.
std::vector<TickLabel> end_ticks(double lo, double hi) {
  std::vector<TickLabel> ticks{{lo + 0.0, exact_number(lo + 0.0)}};
  if (lo != hi) ticks.push_back({hi + 0.0, exact_number(hi + 0.0)});
  return ticks;
}

std::vector<double> multiples(double lo, double hi, double digit, int exponent) {
  const double step = decimal(digit, exponent);
  const double first = std::floor(lo / step) - 1, last = std::ceil(hi / step) + 1;
  std::vector<double> values;
  if (!(last - first < 4000) || std::max(std::abs(first), std::abs(last)) > 0x1p52) return values;
  for (double i = first; i <= last; ++i) {
    const double v = decimal(i * digit, exponent);
    if (v >= lo && v <= hi && (values.empty() || v > values.back())) values.push_back(v == 0 ? 0.0 : v);
  }
  return values;
}

std::vector<TickLabel> linear_ticks(double lo, double hi, int wanted) {
  const double range = hi - lo, largest = std::max(std::abs(lo), std::abs(hi));
  if (lo == hi) return {{lo + 0.0, short_number(lo + 0.0)}};
  if (!std::isfinite(range) || range < 1e-290 || range < 64 * std::numeric_limits<double>::epsilon() * largest) return end_ticks(lo, hi);
  const int e = decade_below(range / wanted);
  std::vector<double> best;
  int best_exponent = 0;
  double best_miss = HUGE_VAL;
  for (int exponent = e + 1; exponent >= e - 1; --exponent)
    for (double digit : {5.0, 2.0, 1.0}) {
      std::vector<double> values = multiples(lo, hi, digit, exponent);
      // A single tick does not define a scale.
      const double miss = std::abs(double(values.size()) - wanted) + (values.size() < 2 ? 1000 : 0);
      if (!values.empty() && miss < best_miss) best = std::move(values), best_exponent = exponent, best_miss = miss;
    }
  return best.empty() ? end_ticks(lo, hi) : with_texts(best, best_exponent);
}

std::string power_text(double v) {
  const double a = std::abs(v);
  if (v == 0) return "0";
  if (a >= 1e-3 && a < 1e5) return short_number(v, 6);
  return tidy_exponent(fmt::format("{:.0e}", v));
}

std::vector<TickLabel> log_ticks(double lo, double hi, int wanted) {
  if (!(lo > 0)) return {};
  const int first = decade_below(lo), last = decade_below(hi);
  std::vector<TickLabel> best;
  // 1, then 1-3, then 1-2-5 per decade: the richest that is not too much.
  for (const std::vector<double>& digits : {std::vector<double>{1}, {1, 3}, {1, 2, 5}}) {
    std::vector<TickLabel> ticks;
    const int decades = last - first + 1;
    const int stride = digits.size() == 1 ? std::max(1, (decades + wanted - 1) / wanted) : 1;
    for (int e = first; e <= last; ++e) {
      if (stride > 1 && e % stride != 0) continue;
      for (double d : digits) {
        const double v = decimal(d, e);
        if (v >= lo && v <= hi) ticks.push_back({v, power_text(v)});
      }
    }
    if (best.size() < 2 || (int(ticks.size()) <= wanted + 1 && ticks.size() > best.size())) best = std::move(ticks);
  }
  return best.size() >= 2 ? best : linear_ticks(lo, hi, wanted);
}

std::vector<TickLabel> symlog_ticks(double lo, double hi, int wanted, double threshold) {
  const double largest = std::max(std::abs(lo), std::abs(hi));
  if (!(threshold > 0)) threshold = 1e-3 * largest;
  if (largest <= threshold) return linear_ticks(lo, hi, wanted);
  if (lo > 0 && lo >= threshold) return log_ticks(lo, hi, wanted);
  const int first = decade_below(threshold) + (decimal(1, decade_below(threshold)) < threshold), last = decade_below(largest);
  const int sides = (lo < 0) + (hi > 0);
  const int stride = std::max(1, (sides * (last - first + 1) + wanted - 1) / wanted);
  std::vector<TickLabel> ticks;
  // Anchored at the largest decade on both sides, so that the ticks mirror each other.
  for (int e = last; e >= first; --e)
    if ((last - e) % stride == 0 && -decimal(1, e) >= lo && -decimal(1, e) <= hi)
      ticks.push_back({-decimal(1, e), power_text(-decimal(1, e))});
  if (lo <= 0 && hi >= 0) ticks.push_back({0, "0"});
  for (int e = first; e <= last; ++e)
    if ((last - e) % stride == 0 && decimal(1, e) <= hi && decimal(1, e) >= lo) ticks.push_back({decimal(1, e), power_text(decimal(1, e))});
  return ticks.size() >= 2 ? ticks : linear_ticks(lo, hi, wanted);
}

}  // namespace

std::vector<TickLabel> nice_ticks(double lo, double hi, int wanted, ScaleKind kind, double linear_threshold) {
  if (!std::isfinite(lo) || !std::isfinite(hi)) return {};
  if (hi < lo) std::swap(lo, hi);
  wanted = std::clamp(wanted, 1, 1000);
  if (lo == hi) return linear_ticks(lo, hi, wanted);
  if (kind == ScaleKind::log) return log_ticks(lo, hi, wanted);
  if (kind == ScaleKind::symlog) return symlog_ticks(lo, hi, wanted, linear_threshold);
  return linear_ticks(lo, hi, wanted);
}

std::vector<std::string> distinct_texts(const std::vector<double>& values) {
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  double least = HUGE_VAL;
  for (size_t i = 1; i < sorted.size(); ++i)
    if (sorted[i] > sorted[i - 1]) least = std::min(least, sorted[i] - sorted[i - 1]);
  std::vector<std::string> texts;
  int fewest = 3;  // 1000 stays 1000: no power of ten below a million
  for (double v : values)
    while (fewest < 6 && std::abs(v) >= decimal(1, fewest) && std::abs(v) < 1e6) ++fewest;
  for (int digits = fewest; digits <= 8; ++digits) {
    texts.clear();
    double worst = 0;
    for (double v : values) {
      texts.push_back(short_number(v, digits));
      worst = std::max(worst, std::abs(parse_double(texts.back()).value_or(v) - v));
    }
    if (worst <= 0.01 * least) break;
  }
  return texts;
}

}  // namespace sg

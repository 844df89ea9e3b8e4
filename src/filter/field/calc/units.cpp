// SPDX-License-Identifier: Apache-2.0
#include "filter/field/calc/units.h"

#include <algorithm>

#include "base/text/text.h"

namespace sg {

namespace {

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '%' || c == '_' || static_cast<unsigned char>(c) >= 0x80;
}

std::string power_text(double p) { return p == 1 ? "" : "^" + exact_number(p); }

}  // namespace

void Unit::add(const std::string& symbol, double power) {
  const auto at = std::lower_bound(powers_.begin(), powers_.end(), symbol, [](const auto& p, const std::string& s) { return p.first < s; });
  if (at != powers_.end() && at->first == symbol) {
    at->second += power;
    if (at->second == 0) powers_.erase(at);
  } else if (power != 0) {
    powers_.insert(at, {symbol, power});
  }
}

std::optional<Unit> Unit::parse(std::string_view s) {
  Unit u;
  size_t i = 0;
  double sign = 1;
  auto skip = [&] {
    while (i < s.size() && (s[i] == ' ' || s[i] == '*' || s[i] == '.')) ++i;
  };
  for (skip(); i < s.size(); skip()) {
    if (s[i] == '/') {
      sign = -1, ++i;  // the next symbol only: "a/b c" is a c / b
      continue;
    }
    const size_t begin = i;
    while (i < s.size() && is_letter(s[i])) ++i;
    const std::string symbol(s.substr(begin, i - begin));
    if (symbol.empty() && !(s[i] == '1' && (i + 1 == s.size() || s[i + 1] == '/' || s[i + 1] == ' '))) return std::nullopt;
    double power = 1;
    if (i < s.size() && s[i] == '^') ++i;
    const size_t number = i;
    while (i < s.size() && (s[i] == '-' || s[i] == '+' || (s[i] >= '0' && s[i] <= '9'))) ++i;
    if (i > number) {
      const auto p = parse_int(s.substr(number, i - number));
      if (!p) return std::nullopt;
      power = double(*p);
    }
    if (!symbol.empty()) u.add(symbol, sign * power);
    sign = 1;
  }
  return u;
}

Unit Unit::of(std::string_view text) {
  if (const auto u = parse(text)) return *u;
  Unit u;
  u.add(std::string(text), 1);
  return u;
}

std::string Unit::text() const {
  std::string above, below;
  for (const auto& [symbol, power] : powers_) {
    std::string& side = power > 0 ? above : below;
    if (power > 0) side += (side.empty() ? "" : " ") + symbol + power_text(power);
    else side += "/" + symbol + power_text(-power);
  }
  return above.empty() && !below.empty() ? "1" + below : above + below;
}

Unit Unit::times(const Unit& other) const {
  Unit u = *this;
  for (const auto& [symbol, power] : other.powers_) u.add(symbol, power);
  return u;
}

Unit Unit::to_power(double p) const {
  Unit u;
  if (p != 0)
    for (const auto& [symbol, power] : powers_) u.powers_.emplace_back(symbol, power * p);
  return u;
}

}  // namespace sg

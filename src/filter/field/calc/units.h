// SPDX-License-Identifier: Apache-2.0
// Units as words with exponents: enough to carry them through arithmetic, no conversion.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sg {

/// "kg m^-3" as {kg:1, m:-3}. Symbols are opaque: mm and m are different units.
class Unit {
 public:
  Unit() = default;
  /// Reads "m/s", "m s-1", "m s^-1", "kg/m^3", "m2", "1/s". Nothing for any other text ("degrees north").
  static std::optional<Unit> parse(std::string_view text);
  /// A text that could not be read stays one opaque symbol.
  static Unit of(std::string_view text);
  bool none() const { return powers_.empty(); }
  /// "m/s", "kg/m^3", "1/s"; "" for none.
  std::string text() const;
  Unit times(const Unit& other) const;
  Unit to_power(double p) const;
  friend bool operator==(const Unit&, const Unit&) = default;

 private:
  void add(const std::string& symbol, double power);
  std::vector<std::pair<std::string, double>> powers_;  // sorted by symbol, none 0
};

}  // namespace sg

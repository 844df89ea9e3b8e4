// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/walls/sides.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/text/text.h"

namespace sg::fluid {

namespace {

constexpr std::array<std::string_view, 6> side_names{"x0", "x1", "y0", "y1", "z0", "z1"};

}  // namespace

Sides sides_of_text(const std::string& text, Sides sides, const std::string& who) {
  for (const std::string_view part : split(text, ';')) {
    const std::string entry(part);
    const std::vector<std::string_view> words = sg::words(entry);
    if (words.empty()) continue;
    const std::string hint = "write SIDE KIND [VX,VY,VZ], such as 'x0 inflow 1,0,0; x1 open'; sides are x0, x1, y0, y1, z0 and z1";
    const auto name = std::find(side_names.begin(), side_names.end(), words[0]);
    if (name == side_names.end()) fail_usage(fmt::format("'{}' is no side of a box", words[0]), who, hint);
    const size_t at = size_t(name - side_names.begin());
    const std::optional<SideKind> kind = words.size() > 1 ? value_of_word<SideKind>(words[1]) : std::nullopt;
    if (!kind) fail_usage(fmt::format("'{}' does not say what lies at {}", entry, words[0]), who, "slip, held, inflow or open");
    Side& side = sides[at];
    side = {*kind, {}};
    if (words.size() == 2) continue;
    const std::vector<std::string_view> numbers = split(words[2], ',');
    for (size_t a = 0; a < 3; ++a) {
      const auto v = a < numbers.size() ? parse_double(numbers[a]) : std::nullopt;
      if (!v || !std::isfinite(*v) || numbers.size() != 3 || words.size() > 3)
        fail_usage(fmt::format("'{}' has no velocity of three numbers", entry), who, hint);
      side.velocity[int(a)] = *v;
    }
    const double through = side.velocity[int(at / 2)];
    if (side.kind != SideKind::inflow && side.kind != SideKind::held)
      fail_usage(fmt::format("{} is {} and has no velocity of its own", words[0], words[1]), who, "walls that hold, and inflow, have one");
    if (side.kind == SideKind::held && through != 0)
      fail_usage(fmt::format("the wall {} cannot move out of its plane", words[0]), who,
                 "it moves along itself; inflow goes through a side");
  }
  return sides;
}

}  // namespace sg::fluid

// SPDX-License-Identifier: Apache-2.0
#include "color/parse_color.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/text.h"
#include "color/css_colors.h"

namespace sg {

namespace {

Vec3f from_hex(uint32_t rgb) { return {float(rgb >> 16 & 255) / 255.f, float(rgb >> 8 & 255) / 255.f, float(rgb & 255) / 255.f}; }

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

}  // namespace

Vec3f parse_color(std::string_view text, std::string_view where) {
  const std::string t = to_lower(trim(text));
  if (!t.empty() && t[0] == '#' && (t.size() == 7 || t.size() == 4)) {
    uint32_t rgb = 0;
    bool good = true;
    for (size_t i = 1; i < t.size(); ++i) {
      const int d = hex_digit(t[i]);
      good = good && d >= 0;
      rgb = t.size() == 7 ? rgb << 4 | uint32_t(d & 15) : rgb << 8 | uint32_t((d & 15) * 17);
    }
    if (good) return from_hex(rgb);
  }
  if (const auto parts = split(t, ','); parts.size() == 3) {
    Vec3f c;
    bool good = true;
    for (int i = 0; i < 3; ++i) {
      const auto v = parse_double(parts[size_t(i)]);
      good = good && v && *v >= 0 && *v <= 1;
      c[i] = v ? float(*v) : 0.f;
    }
    if (good) return c;
  }
  std::vector<std::string> names;
  for (const CssColor& n : css_colors) {
    if (n.name == t) return from_hex(n.rgb);
    names.emplace_back(n.name);
  }
  const std::string near = nearest_name(t, names);
  fail_usage(fmt::format("'{}' is not a colour", text), std::string(where),
             (near.empty() ? "" : "did you mean '" + near + "'? ") +
                 "write #rrggbb, three numbers from 0 to 1 like 0.9,0.2,0, or a name of CSS such as steelblue");
}

std::string color_text(Vec3f c) {
  auto byte = [](float v) { return int(std::min(1.f, std::max(0.f, v)) * 255.f + 0.5f); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(c.x), byte(c.y), byte(c.z));
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// Colour maps in JSON: ParaView's (RGBPoints in a ColorSpace, or IndexedColors with Annotations, NanColor) and niivue's (lists R, G,
// B, A over I from 0 to 255, and the values min and max).
#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/json.h"
#include "base/text/text.h"
#include "color/map_files/colormap_formats.h"

namespace sg {

namespace {

struct JsonMaps {
  const std::string& path;

  [[noreturn]] void fail(const std::string& map, const std::string& what) const {
    fail_data(map.empty() ? what : fmt::format("map '{}': {}", map, what), path);
  }

  std::vector<double> numbers(const Json& o, const char* key, const std::string& map) const {
    std::vector<double> r;
    const Json& list = o[key];
    if (list.is_null()) return r;
    if (!list.is_list()) fail(map, fmt::format("'{}' is not a list", key));
    for (const Json& v : list.items()) {
      if (!v.is_number() || !std::isfinite(v.number())) fail(map, fmt::format("'{}' contains something that is not a number", key));
      r.push_back(v.number());
    }
    return r;
  }

  Vec3f rgb(const std::vector<double>& v, size_t at, double most, const std::string& map) const {
    Vec3f c;
    for (int k = 0; k < 3; ++k) {
      const double x = v[at + size_t(k)] / most;
      if (!(x >= -1e-6 && x <= 1 + 1e-6))
        fail(map, fmt::format("{} is not a colour value; they range from 0 to {}", v[at + size_t(k)], most));
      c[k] = float(std::clamp(x, 0.0, 1.0));
    }
    return c;
  }

  std::optional<Vec3f> color(const Json& o, const char* key, const std::string& map) const {
    const auto v = numbers(o, key, map);
    if (v.empty()) return {};
    if (v.size() < 3) fail(map, fmt::format("'{}' has {} numbers", key, v.size()));
    return rgb(v, 0, 1, map);
  }

  static NodeSpace space_of(const std::string& name) {
    const std::string s = to_lower(name);
    return s == "hsv"                           ? NodeSpace::hsv
           : s.find("lab") != std::string::npos ? NodeSpace::lab
           : s == "diverging"                   ? NodeSpace::diverging
                                                : NodeSpace::rgb;
  }

  FileColormap paraview(const Json& o) const {
    FileColormap f;
    auto word = [&](const char* key) { return o[key].text(); };
    f.map.name = word("Name");
    const std::string& name = f.map.name;
    f.nan = color(o, "NanColor", name);
    f.below = color(o, "BelowRangeColor", name);
    f.above = color(o, "AboveRangeColor", name);
    f.space = word("ColorSpace");
    if (f.space.empty()) f.space = "RGB";
    const auto points = numbers(o, "RGBPoints", name);
    if (!points.empty()) {
      if (points.size() % 4) fail(name, fmt::format("'RGBPoints' has {} numbers, not a multiple of 4", points.size()));
      std::vector<ColorNode> nodes;
      for (size_t i = 0; i < points.size(); i += 4) {
        if (!nodes.empty() && points[i] < nodes.back().position) fail(name, "the positions in 'RGBPoints' do not increase");
        nodes.push_back({points[i], rgb(points, i + 1, 1, name)});
      }
      f.entries = nodes.size();
      f.lo = nodes.front().position, f.hi = nodes.back().position;
      set_nodes(f.map, nodes, space_of(f.space));
      f.map.kind = f.space == "Diverging" && nodes.size() <= 3 ? MapKind::diverging : kind_of_colors(f.map);
      return f;
    }
    const auto indexed = numbers(o, "IndexedColors", name);
    if (indexed.empty() || indexed.size() % 3) fail(name, "has neither 'RGBPoints' nor 'IndexedColors' in groups of three");
    for (size_t i = 0; i < indexed.size(); i += 3) f.map.colors.push_back(rgb(indexed, i, 1, name));
    f.entries = f.map.colors.size();
    f.map.kind = MapKind::categorical;
    f.hi = double(f.entries - 1);
    annotations(o, f);
    return f;
  }

  // Pairs of value and text. Kept only when they give a value to each colour.
  void annotations(const Json& o, FileColormap& f) const {
    const Json& list = o["Annotations"];
    if (!list.is_list() || list.size() / 2 < f.entries) return;
    for (size_t i = 0; i < f.entries; ++i) {
      const Json &value = list[2 * i], &text = list[2 * i + 1];
      const auto v = value.is_number() ? std::optional(value.number()) : value.is_text() ? parse_double(value.text()) : std::nullopt;
      f.labels.push_back(v.value_or(double(i)));
      f.label_names.push_back(text.is_text() ? text.text() : text.dump());
    }
  }

  FileColormap niivue(const Json& o) const {
    FileColormap f;
    const auto r = numbers(o, "R", ""), g = numbers(o, "G", ""), b = numbers(o, "B", ""), a = numbers(o, "A", "");
    auto at = numbers(o, "I", "");
    const size_t n = r.size();
    if (n == 0 || g.size() != n || b.size() != n || (!a.empty() && a.size() != n) || (!at.empty() && at.size() != n))
      fail("", "the lists R, G, B, A and I differ in length");
    const bool labels = o["labels"].is_list();
    for (size_t i = 0; at.size() < n; ++i) at.push_back(labels || n == 1 ? double(i) : 255 * double(i) / double(n - 1));
    std::vector<ColorNode> nodes;
    for (size_t i = 0; i < n; ++i) nodes.push_back({at[i], rgb({r[i], g[i], b[i]}, 0, 255, "")});
    for (size_t i = 1; i < n && !labels; ++i)
      if (at[i] < at[i - 1]) fail("", "the positions in 'I' do not increase");
    f.entries = n;
    f.space = "RGB";
    f.lo = at.front(), f.hi = at.back();
    for (const auto& [key, to] : {std::pair{"min", &f.range_lo}, std::pair{"max", &f.range_hi}})
      if (o[key].is_number()) *to = o[key].number();
    if (labels) {
      f.map.kind = MapKind::categorical;
      for (size_t i = 0; i < n; ++i) {
        f.map.colors.push_back(nodes[i].color);
        f.labels.push_back(at[i]);
        f.label_names.push_back(o["labels"][i].text());
      }
      return f;
    }
    set_nodes(f.map, nodes, NodeSpace::rgb);
    f.map.kind = kind_of_colors(f.map);
    return f;
  }
};

}  // namespace

std::vector<FileColormap> parse_json_maps(std::string_view text, const std::string& path) {
  const JsonMaps maps{path};
  const Json root = parse_json(text, path);
  std::vector<FileColormap> r;
  if (root.contains("R") && root.contains("G") && root.contains("B")) r.push_back(maps.niivue(root));
  else if (root.contains("RGBPoints") || root.contains("IndexedColors")) r.push_back(maps.paraview(root));
  else if (root.is_list() && !root.empty())
    for (const Json& o : root.items()) {
      if (!o.is_object()) fail_data("contains something that is not a colour map", path);
      r.push_back(maps.paraview(o));
    }
  else fail_data("is JSON, but not a colour map", path, "colour maps are a list of RGBPoints or IndexedColors, or the lists R, G, B, A, I");
  return r;
}

}  // namespace sg

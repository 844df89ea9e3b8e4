// SPDX-License-Identifier: Apache-2.0
#include "color/map_files/colormap_file.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "color/map_files/colormap_formats.h"
#include "color/map_files/colormap_nodes.h"

namespace sg {

namespace {

constexpr uint64_t largest_file = uint64_t(64) << 20;

// ".Name .q3-9{fill:rgb(1,2,3)}" -> name, place, number of colours, colour; false for other rules.
struct Rule {
  std::string name;
  int64_t place = 0, count = 0;
  Vec3f color;
};

bool parse_rule(std::string_view selector, std::string_view body, Rule& r) {
  const auto parts = words(selector);
  if (parts.size() != 2 || !parts[0].starts_with('.') || !parts[1].starts_with(".q")) return false;
  const auto numbers = split(parts[1].substr(2), '-');
  if (numbers.size() != 2) return false;
  const auto place = parse_int(numbers[0]), count = parse_int(numbers[1]);
  const size_t open = body.find("rgb("), close = body.find(')', open == std::string_view::npos ? 0 : open);
  if (!place || !count || open == std::string_view::npos || close == std::string_view::npos) return false;
  const auto rgb = split(body.substr(open + 4, close - open - 4), ',');
  if (rgb.size() != 3 || *place < 0 || *place >= *count || *count > 256) return false;
  for (int k = 0; k < 3; ++k) {
    const auto v = parse_int(rgb[size_t(k)]);
    if (!v || *v < 0 || *v > 255) return false;
    r.color[k] = float(*v) / 255;
  }
  r.name = parts[0].substr(1), r.place = *place, r.count = *count;
  return true;
}

bool is_qualitative(std::string_view name) {
  for (std::string_view q : {"Accent", "Dark2", "Paired", "Pastel1", "Pastel2", "Set1", "Set2", "Set3"})
    if (name == q) return true;
  return false;
}

void add_numbered(std::vector<FileColormap>& maps) {
  for (size_t i = 0; i < maps.size(); ++i) {
    const std::string name = maps[i].map.name;
    for (size_t n = 2, k = i + 1; k < maps.size(); ++k)
      if (maps[k].map.name == name) maps[k].map.name = fmt::format("{} ({})", name, n++);
  }
}

struct Asked {
  std::string path, map;  ///< map "" = the only one
};

// The end of the path: behind the first extension of ours that ends the name or stands before ':' or "_r".
std::optional<Asked> split_name(std::string_view name) {
  const std::string lower = to_lower(name);
  for (std::string_view ext : {".cpt", ".json", ".css"})
    for (size_t at = lower.find(ext); at != std::string::npos; at = lower.find(ext, at + 1)) {
      const size_t end = at + ext.size();
      if (at == 0) continue;
      if (end == name.size()) return Asked{std::string(name), ""};
      if (name.substr(end) == "_r") return Asked{std::string(name.substr(0, end)), "_r"};
      if (name[end] == ':') return Asked{std::string(name.substr(0, end)), std::string(name.substr(end + 1))};
    }
  return {};
}

}  // namespace

std::vector<FileColormap> parse_css_maps(std::string_view text, const std::string& path) {
  std::vector<FileColormap> r;
  std::vector<size_t> longest;  // of each name, in order
  for (size_t at = 0; (at = text.find('{', at)) != std::string_view::npos;) {
    const size_t close = text.find('}', at);
    if (close == std::string_view::npos) fail_data("a rule does not end", path);
    size_t begin = text.find_last_of("}/", at);
    begin = begin == std::string_view::npos ? 0 : begin + 1;
    Rule rule;
    if (parse_rule(text.substr(begin, at - begin), text.substr(at, close - at), rule)) {
      const std::string name = fmt::format("{}-{}", rule.name, rule.count);
      if (r.empty() || r.back().map.name != name) {
        FileColormap& f = r.emplace_back();
        f.map.name = name;
        f.entries = size_t(rule.count);
        f.space = "RGB";
      }
      FileColormap& f = r.back();
      if (f.map.colors.size() != size_t(rule.place)) fail_data(fmt::format("the colours of '{}' are not in order", name), path);
      f.map.colors.push_back(rule.color);
    }
    at = close;
  }
  if (r.empty()) fail_data("contains no rule like .YlGn .q0-3{fill:rgb(247,252,185)}", path);
  std::vector<FileColormap> all;
  for (size_t i = 0; i < r.size(); ++i) {
    FileColormap& f = r[i];
    if (f.map.colors.size() != f.entries) fail_data(fmt::format("'{}' has {} colours", f.map.name, f.map.colors.size()), path);
    const std::string name = f.map.name.substr(0, f.map.name.rfind('-'));
    f.hi = double(f.entries - 1);
    f.map.kind = is_qualitative(name) ? MapKind::categorical : kind_of_colors(f.map);
    all.push_back(f);
    const bool last = i + 1 == r.size() || !r[i + 1].map.name.starts_with(name + "-");
    if (last) {  // the lists of a name get longer
      all.push_back(f);
      all.back().map.name = name;
    }
  }
  return all;
}

bool names_colormap_file(std::string_view name) { return split_name(name).has_value(); }

std::vector<FileColormap> read_colormaps(const std::string& path) {
  const MappedFile file(path);
  if (file.size() > largest_file) fail_data(fmt::format("has {}; a colour map has fewer", human_bytes(file.size())), path);
  const std::string ext = extension_of(path);
  std::vector<FileColormap> maps;
  constexpr struct {
    std::string_view extension;
    std::vector<FileColormap> (*parse)(std::string_view text, const std::string& path);
  } of_several[] = {{"json", parse_json_maps}, {"css", parse_css_maps}};
  const auto* several = std::find_if(std::begin(of_several), std::end(of_several), [&](const auto& f) { return f.extension == ext; });
  if (several != std::end(of_several)) maps = several->parse(file.text(), path);
  else maps.push_back(parse_cpt(file.text(), path));
  const std::string stem = file_name_of(path).substr(0, file_name_of(path).size() - ext.size() - (ext.empty() ? 0 : 1));
  for (size_t i = 0; i < maps.size(); ++i) {
    FileColormap& f = maps[i];
    if (f.map.name.empty()) f.map.name = maps.size() == 1 ? stem : fmt::format("{} {}", stem, i + 1);
    f.map.about = fmt::format("{} {} of '{}'.", f.entries, f.map.categorical() ? "colours" : "entries", path);
  }
  add_numbered(maps);
  return maps;
}

FileColormap find_file_colormap(std::string_view name) {
  auto asked = split_name(name);
  if (!asked) fail_usage(fmt::format("'{}' does not name a file of colour maps", name), "colour map", "write FILE.cpt or FILE.json:NAME");
  std::vector<FileColormap> maps = read_colormaps(asked->path);
  auto find = [&](std::string_view wanted) -> FileColormap* {
    for (FileColormap& f : maps)
      if (f.map.name == wanted) return &f;
    for (FileColormap& f : maps)
      if (equal_ignoring_case(f.map.name, wanted)) return &f;
    return nullptr;
  };
  const bool only = asked->map.empty() || asked->map == "_r";
  FileColormap* found = only ? (maps.size() == 1 ? maps.data() : nullptr) : find(asked->map);
  bool reversed = only && asked->map == "_r";
  if (!found && !only && asked->map.ends_with("_r")) {
    found = find(std::string_view(asked->map).substr(0, asked->map.size() - 2));
    reversed = true;
  }
  if (!found) {
    std::vector<std::string> names;
    for (const FileColormap& f : maps) names.push_back(f.map.name);
    if (only)
      fail_usage(fmt::format("'{}' contains {} maps", asked->path, maps.size()), "colour map",
                 fmt::format("name one, e.g. {}:{} (list all with: sightglass colormap {})", asked->path, names[0], asked->path));
    if (const std::string near = nearest_name(asked->map, names); names.size() > 20)
      fail_usage(fmt::format("'{}' contains no map '{}'", asked->path, asked->map), "colour map",
                 (near.empty() ? "" : "did you mean '" + near + "'? ") +
                     fmt::format("list all {} with: sightglass colormap {}", names.size(), asked->path));
    fail_usage(fmt::format("'{}' contains no map '{}'", asked->path, asked->map), "colour map", unknown_name_hint(asked->map, names));
  }
  FileColormap r = std::move(*found);
  r.map.name = name;
  if (reversed) {
    reverse(r.map);
    std::swap(r.below, r.above);
    if (r.hinge) r.hinge = r.lo + r.hi - *r.hinge;
    r.map.about += " Reversed.";
  }
  return r;
}

Colormap hinged(const FileColormap& f, double lo, double hi) {
  if (!f.hinge || !(f.hi > f.lo) || !(hi > lo) || f.map.categorical()) return f.map;
  const double h = std::clamp((*f.hinge - f.lo) / (f.hi - f.lo), 0.0, 1.0);
  const std::vector<Vec3f>& colors = f.map.colors;
  const size_t n = colors.size();
  const auto place = [&](size_t i) {
    return f.map.positions.empty() ? double(i) / double(std::max<size_t>(n, 2) - 1) : f.map.positions[i];
  };
  // Below the hinge and above it the colours keep their places within that side; of a hard hinge each side has its own colour.
  std::vector<ColorNode> nodes;
  if (lo < 0) {
    const double end = std::min(hi, 0.0);
    if (!(h > 0)) nodes = {{lo, colors.front()}, {end, colors.front()}};
    for (size_t i = 0; i < n && h > 0 && (i == 0 || place(i - 1) < h); ++i)
      nodes.push_back(place(i) > h ? ColorNode{end, f.map.at(h)} : ColorNode{end + (lo - end) * (1 - place(i) / h), colors[i]});
  }
  if (hi > 0) {
    const double begin = std::max(lo, 0.0);
    if (!(h < 1)) nodes.push_back({begin, colors.back()}), nodes.push_back({hi, colors.back()});
    else nodes.push_back({begin, f.map.at(h)});
    for (size_t i = 0; i < n && h < 1; ++i)
      if (place(i) > h) nodes.push_back({begin + (hi - begin) * ((place(i) - h) / (1 - h)), colors[i]});
  }
  Colormap r = f.map;
  set_nodes(r, nodes, NodeSpace::rgb);
  return r;
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cstdio>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "cli/cli.h"
#include "color/colormap.h"
#include "color/map_files/colormap_file.h"
#include "color/map_files/colormap_nodes.h"
#include "color/parse_color.h"
#include "image/codec.h"

namespace sg {

namespace {

std::string_view kind_name(MapKind k) {
  constexpr std::string_view names[] = {"sequential", "diverging", "categorical", "cyclic", "unsafe"};
  return names[size_t(k)];
}

// The map as a strip, and below it its lightness as greys.
Image swatch(const Colormap& map, const LightnessReport& report) {
  Image image(512, 96, 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const double t = (x + 0.5) / image.width;
      const size_t i = size_t(t * double(report.lightness.size()));
      // L* of a grey of sRGB value v is a curve; inverting it by its own formula keeps the strip honest.
      const double l = report.lightness[i], f = (l + 16) / 116, linear = l > 8 ? f * f * f : l * 27 / 24389;
      const float grey = srgb_encode(float(linear));
      const Vec3f c = y < 64 ? map.at(t) : Vec3f{grey, grey, grey};
      for (int k = 0; k < 3; ++k) image.at(x, y)[k] = uint8_t(std::clamp(c[k], 0.f, 1.f) * 255 + 0.5f);
    }
  return image;
}

// What the count of falls means for this kind of map.
std::string verdict(const Colormap& map, const LightnessReport& r) {
  switch (map.kind) {
    case MapKind::sequential:
      if (r.falls_float == 0) return "lightness rises throughout: order can be seen without a legend";
      return r.falls_float + 1 == int(r.lightness.size()) ? "lightness falls throughout: order can be seen without a legend"
                                                          : "lightness falls in places";
    case MapKind::diverging: return "lightness rises to the middle and falls again: distance from the middle can be seen";
    case MapKind::cyclic: return "starts and ends with the same colour: for angles and phases";
    case MapKind::categorical: return "unordered: one colour per label";
    case MapKind::unsafe:
      return "lightness rises and falls along the map: it shows edges that are not in the data, and hides some that are";
  }
  return "";
}

std::string hex_or_none(const std::optional<Vec3f>& c) { return c ? color_text(*c) : std::string("none"); }

// A file's data besides the colours, as JSON members or one line of text.
std::string file_facts(const FileColormap& f, bool json) {
  if (json) {
    auto color = [](const std::optional<Vec3f>& c) { return c ? json_string(color_text(*c)) : std::string("null"); };
    std::string r = fmt::format("\"entries\":{},\"space\":{},\"positions\":[{},{}],\"first\":{},\"last\":{}", f.entries,
                                json_string(f.space), exact_number(f.lo), exact_number(f.hi), json_string(color_text(f.map.colors.front())),
                                json_string(color_text(f.map.colors.back())));
    if (f.range_lo && f.range_hi) r += fmt::format(",\"range\":[{},{}]", exact_number(*f.range_lo), exact_number(*f.range_hi));
    if (f.hinge) r += fmt::format(",\"hinge\":{},\"hard\":{}", exact_number(*f.hinge), f.hard_hinge);
    return r + fmt::format(",\"below\":{},\"above\":{},\"nan\":{}", color(f.below), color(f.above), color(f.nan));
  }
  std::string r = fmt::format("{} entries in {}, positions {} to {}", f.entries, f.space, short_number(f.lo), short_number(f.hi));
  if (f.range_lo && f.range_hi) r += fmt::format(", made for {} to {}", short_number(*f.range_lo), short_number(*f.range_hi));
  if (f.hinge) r += fmt::format(", {} hinge at {}", f.hard_hinge ? "hard" : "soft", short_number(*f.hinge));
  return r + fmt::format("; below {}, above {}, NaN {}", hex_or_none(f.below), hex_or_none(f.above), hex_or_none(f.nan));
}

// The maps of a file that holds several.
void list_file(const std::string& path, const std::vector<FileColormap>& maps, bool json) {
  std::string text = fmt::format("{{\"file\":{},\"colormaps\":[", json_string(path));
  for (size_t i = 0; i < maps.size(); ++i) {
    const FileColormap& f = maps[i];
    if (json)
      text += fmt::format("{}{{\"name\":{},\"kind\":\"{}\",{}}}", i ? "," : "", json_string(f.map.name), kind_name(f.map.kind),
                          file_facts(f, true));
    else
      std::printf("  %-44s %-12s %zu %s\n", printable(f.map.name).c_str(), std::string(kind_name(f.map.kind)).c_str(), f.entries,
                  f.map.categorical() ? "colours" : "entries");
  }
  if (json) std::printf("%s]}\n", text.c_str());
}

}  // namespace

int run_colormap(const Options& o, Context&) {
  if (o.inputs.empty()) {
    if (!o.output.empty())
      fail_usage("no map given to draw", "sightglass colormap", "name one, e.g. sightglass colormap sight -o sight.png");
    std::string json = "{\"colormaps\":[";
    bool first = true;
    for (const Colormap& m : colormaps()) {
      if (o.json)
        json += fmt::format("{}{{\"name\":{},\"kind\":\"{}\",\"about\":{}}}", first ? "" : ",", json_string(m.name), kind_name(m.kind),
                            json_string(m.about));
      else std::printf("  %-14s %-12s %s\n", m.name.c_str(), std::string(kind_name(m.kind)).c_str(), m.about.c_str());
      first = false;
    }
    if (o.json) std::printf("%s]}\n", json.c_str());
    return 0;
  }
  for (const std::string& name : o.inputs) {
    std::optional<FileColormap> file;
    if (names_colormap_file(name)) {
      if (file_exists(name) && !is_folder(name)) {
        const std::vector<FileColormap> maps = read_colormaps(name);
        if (maps.size() > 1) {
          list_file(name, maps, o.json);
          continue;
        }
      }
      file = find_file_colormap(name);
    }
    const Colormap map = file ? file->map : find_colormap(name);
    const LightnessReport r = lightness_report(map);
    if (o.json) {
      std::printf("{\"name\":%s,\"kind\":\"%s\",\"falls\":%d,\"falls_8bit\":%d,\"lowest\":%s,\"highest\":%s,\"lightness\":[",
                  json_string(map.name).c_str(), std::string(kind_name(map.kind)).c_str(), r.falls_float, r.falls_8bit,
                  exact_number(r.lowest).c_str(), exact_number(r.highest).c_str());
      for (size_t i = 0; i < r.lightness.size(); ++i) std::printf("%s%s", i ? "," : "", short_number(r.lightness[i], 7).c_str());
      std::printf("]%s%s}\n", file ? "," : "", file ? file_facts(*file, true).c_str() : "");
    } else {
      std::printf("%s (%s): %s\n", printable(map.name).c_str(), std::string(kind_name(map.kind)).c_str(), printable(map.about).c_str());
      if (file) std::printf("  %s\n", printable(file_facts(*file, false)).c_str());
      const bool hinge_only = map.kind == MapKind::diverging && kind_of_colors(map) != MapKind::diverging;
      std::printf("  %s\n",
                  hinge_only ? "two sides that meet at a value; lightness does not show the distance from it" : verdict(map, r).c_str());
      std::printf("  lightness L* from %s to %s (CIELAB, D65)\n", short_number(r.lowest, 4).c_str(), short_number(r.highest, 4).c_str());
      std::printf("  L* falls in %d of 255 steps (%d after rounding the colours to 8 bits)\n", r.falls_float, r.falls_8bit);
      std::printf("  colour difference per unit of position: from %s down to %s (CIEDE2000)\n", short_number(r.steepest, 4).c_str(),
                  short_number(r.flattest, 4).c_str());
      std::printf("  first %s, middle %s, last %s\n", color_text(map.at(0)).c_str(), color_text(map.at(0.5)).c_str(),
                  color_text(map.at(1)).c_str());
    }
    if (!o.output.empty()) write_image(o.output, swatch(map, r));
  }
  return 0;
}

}  // namespace sg

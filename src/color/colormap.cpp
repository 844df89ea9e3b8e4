// SPDX-License-Identifier: Apache-2.0
#include "color/colormap.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <mutex>

#include "base/error.h"
#include "base/text/text.h"
#include "color/map_construction.h"
#include "color/map_files/colormap_file.h"
#include "color/maps/brewer_maps.h"
#include "color/maps/maps_elsewhere.h"
#include "color/maps/segment_maps.h"
#include "color/published_maps.h"

namespace sg {
namespace {

std::vector<Vec3f> sight() {
  static constexpr HueChroma path[] = {{312, 38}, {305, 46}, {297, 48}, {287, 43}, {270, 34}, {238, 27}, {200, 31}, {155, 50}, {103, 82}};
  return sequential_path(15, 93, path);
}

std::vector<Vec3f> ember() {
  static constexpr HueChroma path[] = {{25, 2}, {30, 36}, {33, 54}, {38, 66}, {46, 72}, {57, 71}, {70, 68}, {86, 56}, {100, 20}};
  return sequential_path(3, 96, path);
}

std::vector<Vec3f> ice() {
  static constexpr HueChroma path[] = {{290, 4}, {288, 24}, {284, 38}, {270, 34}, {255, 32}, {240, 29}, {225, 28}, {210, 20}, {200, 4}};
  return sequential_path(3, 97, path);
}

std::vector<Vec3f> gray() {
  static constexpr HueChroma path[] = {{0, 0}, {0, 0}};
  return sequential_path(0, 100, path);
}

std::vector<Vec3f> bone() {
  static constexpr HueChroma path[] = {{275, 1}, {272, 8}, {265, 11}, {250, 11}, {235, 10}, {220, 9}, {205, 7}, {195, 5}, {190, 1}};
  return sequential_path(1, 99, path);
}

std::vector<Vec3f> green_helix() { return cubehelix(0.5, -1.5, 1, 1); }
std::vector<Vec3f> coolwarm() { return moreland_diverging(Vec3{59, 76, 192} / 255.0, Vec3{180, 4, 38} / 255.0); }
std::vector<Vec3f> purple_green() { return diverging_path(36, 95, 312, 142, 44); }
std::vector<Vec3f> phase() { return hue_circle(); }

std::vector<Vec3f> jet() {
  std::vector<Vec3f> colors;  // its corners lie at odd multiples of 1/8
  for (int i = 0; i <= 8; ++i) {
    const auto channel = [&](float peak) { return std::clamp(1.5f - std::abs(0.5f * float(i) - peak), 0.0f, 1.0f); };
    colors.push_back({channel(3), channel(2), channel(1)});
  }
  return colors;
}

std::vector<Vec3f> rainbow() { return {{0, 0, 1}, {0, 1, 1}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}}; }

/// Eight hand-picked colours that work together, then farthest points: each the colour of a CIELAB grid (L* 30 to 88, chroma 18 to 85)
/// whose smallest CIEDE2000 distance to all before it, to white, to black and to the NaN grey is largest. No two are closer
/// than 12, of the first 24 than 18, of the first eight than 24; the test measures that.
std::vector<Vec3f> labels() {
  static constexpr uint32_t found[] = {
      0x307BBB, 0xF48B38, 0x409D5B, 0xD14649, 0x9569BC, 0x26C3CD, 0xEFD044, 0xF998C2, 0x745401, 0x185953, 0x603C4A, 0x88F65D, 0x2733B7,
      0xBBC3FE, 0x345F01, 0x832700, 0x988D3F, 0xBE057C, 0xAFD5B9, 0xEABDAD, 0x32B5FE, 0x9F7257, 0x598A84, 0x9E7685, 0x565D7A, 0xF439C0,
      0xC7BB94, 0x98082F, 0x05F8DB, 0xFD8270, 0x6D6F50, 0x95B816, 0x838BFF, 0xB4E4F6, 0x085673, 0x713982, 0xD290FB, 0xD6500A, 0xF3D3EE,
      0x6C4E3E, 0xB07506, 0x8C8EAE, 0x01774F, 0x3FD489, 0x8B9B7D, 0x4E472B, 0x2897B5, 0xFC527F, 0x5F5EF0, 0xDFA001, 0xD5E494, 0x60880D,
      0x41B299, 0x9E505F, 0xFCC183, 0xBB9565, 0xBB9DB6, 0xC18F86, 0xAD25BB, 0x9D4D04, 0x374C2F, 0xC70E04, 0x795F7F, 0x237787};
  std::vector<Vec3f> colors;
  for (uint32_t c : found) colors.push_back({float(c >> 16) / 255, float(c >> 8 & 255) / 255, float(c & 255) / 255});
  return colors;
}

struct Entry {
  const char* name;
  MapKind kind;
  std::vector<Vec3f> (*make)();
  const char* about;
};

constexpr Entry entries[] = {
    {"sight", MapKind::sequential, sight,
     "The default: dark violet over blue, teal and green to yellow; lightness linear, colour steps even (CIEDE2000)."},
    {"ember", MapKind::sequential, ember,
     "Black over red and orange to pale yellow, for heat and emission; lightness linear, colour steps even."},
    {"ice", MapKind::sequential, ice, "Black over deep blue and cyan to white, for depth and cold; lightness linear, colour steps even."},
    {"gray", MapKind::sequential, gray, "Black to white, linear in CIELAB lightness."},
    {"bone", MapKind::sequential, bone, "Grey with a blue tinge, for scans; lightness linear."},
    {"cubehelix", MapKind::sequential, green_helix,
     "Helix round the greys that stays readable in black and white (Green 2011; start 0.5, -1.5 turns)."},
    {"coolwarm", MapKind::diverging, coolwarm, "Blue over a neutral middle to red, for values about a centre (Moreland 2009)."},
    {"purple_green", MapKind::diverging, purple_green,
     "Purple over white to green, equally light on both sides, safe for red-green blindness."},
    {"phase", MapKind::cyclic, phase, "Once round the hues at nearly equal lightness, for angles and phases; both ends are one colour."},
    {"labels", MapKind::categorical, labels,
     "Colours for names and numbers without order: 8 hand-picked, then each as different as possible from all before (CIEDE2000)."},
    {"jet", MapKind::unsafe, jet,
     "The old rainbow clip(1.5-|4x-{3,2,1}|): its lightness falls in 114 of 255 steps and shows edges that are not in the data."},
    {"rainbow", MapKind::unsafe, rainbow,
     "HSV hues from blue to red; its lightness rises and falls and shows edges that are not in the data."},
};
// All built-in maps by number: ours, then those of published colours and of published stops.
struct BuiltIn {
  std::string_view name;
  const Entry* own = nullptr;
  const PublishedMap* published = nullptr;
  const SegmentMap* segments = nullptr;
};
const std::vector<BuiltIn>& built_in() {
  static const std::vector<BuiltIn> all = [] {
    std::vector<BuiltIn> maps;
    for (const Entry& e : entries) maps.push_back({e.name, &e});
    for (const PublishedMap& m : published_maps()) maps.push_back({m.name, nullptr, &m});
    for (const SegmentMap& m : segment_maps()) maps.push_back({m.name, nullptr, nullptr, &m});
    for (const PublishedMap& m : brewer_maps()) maps.push_back({m.name, nullptr, &m});
    return maps;
  }();
  return all;
}
size_t count() { return built_in().size(); }
std::string_view name_of(size_t i) { return built_in()[i].name; }

// The map of that name, in any case; count() when there is none.
size_t index_of(std::string_view name) {
  size_t i = 0;
  while (i < count() && to_lower(name_of(i)) != to_lower(name)) ++i;
  return i;
}

/// Each built on first use: a picture needs one map.
const Colormap& built(size_t i) {
  static std::vector<std::once_flag> once(count());
  static std::vector<Colormap> maps(count());
  std::call_once(once[i], [i] {
    const BuiltIn& b = built_in()[i];
    if (b.own) maps[i] = {b.own->name, b.own->kind, b.own->about, b.own->make(), {}};
    else if (b.segments) maps[i] = colormap_of(*b.segments);
    else maps[i] = {std::string(b.name), b.published->kind, std::string(b.published->about), colors_of(*b.published), {}};
  });
  return maps[i];
}

[[noreturn]] void fail_unknown(std::string_view name) {
  if (const std::string near = nearest_map(name); !near.empty())
    fail_usage(fmt::format("colour map '{}' is not built in", name), "colour map", fmt::format("the nearest built-in one is '{}'", near));
  std::vector<std::string> names;
  for (size_t i = 0; i < count(); ++i) names.emplace_back(name_of(i));
  const bool reversed = name.size() > 2 && name.ends_with("_r");
  fail_usage(fmt::format("colour map '{}' not found", name), "colour map",
             unknown_name_hint(reversed ? name.substr(0, name.size() - 2) : name, names) + "; or name a file: .cpt, .json:NAME, .css:NAME");
}

}  // namespace

Vec3f Colormap::at(double t) const {
  const size_t n = colors.size();
  if (n == 0) return {0, 0, 0};
  if (positions.size() == n && !categorical()) {
    const size_t after = size_t(std::upper_bound(positions.begin(), positions.end(), t) - positions.begin());
    if (after == 0 || t != t) return colors.front();
    if (after == n) return colors.back();
    const double from = positions[after - 1], width = positions[after] - from;
    return lerp(colors[after - 1], colors[after], float((t - from) / width));
  }
  if (!(t > 0)) return colors.front();
  if (t >= 1) return colors.back();
  if (categorical()) return colors[std::min(n - 1, size_t(t * double(n)))];
  const double x = t * double(n - 1);
  const size_t i = std::min(size_t(x), n - 1);
  if (i + 1 == n) return colors.back();
  return lerp(colors[i], colors[i + 1], float(x - double(i)));
}

void reverse(Colormap& map) {
  std::reverse(map.colors.begin(), map.colors.end());
  std::reverse(map.positions.begin(), map.positions.end());
  for (double& p : map.positions) p = 1 - p;
}

const std::vector<Colormap>& colormaps() {
  static const std::vector<Colormap> all = [] {
    std::vector<Colormap> maps;
    for (size_t i = 0; i < count(); ++i) maps.push_back(built(i));
    return maps;
  }();
  return all;
}

Colormap find_colormap(std::string_view name) {
  if (const size_t i = index_of(name); i < count()) return built(i);
  if (name.size() > 2 && (name.ends_with("_r") || name.ends_with("_R")))
    if (const size_t i = index_of(name.substr(0, name.size() - 2)); i < count()) {
      Colormap map = built(i);
      map.name += "_r";
      map.about += " Reversed.";
      reverse(map);
      return map;
    }
  if (names_colormap_file(name)) return find_file_colormap(name).map;
  fail_unknown(name);
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// GMT colour palette tables. Slices "z0 colour z1 colour [annotation] [;label]", categories "key colour [;label]", the colours B, F
// and N, and the comments COLOR_MODEL, RANGE, HARD_HINGE, SOFT_HINGE, HINGE. Source: GMT manual, "Of colors and color legends".
#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "base/error.h"
#include "base/text/text.h"
#include "color/map_files/colormap_formats.h"
#include "color/parse_color.h"

namespace sg {

namespace {

enum class Model { rgb, hsv, cmyk };

// Names that mean something else in X11, and so here, than in CSS.
struct X11Color {
  std::string_view name;
  int r, g, b;
};
constexpr X11Color x11[] = {
    {"green", 0, 255, 0}, {"purple", 160, 32, 240}, {"gray", 190, 190, 190}, {"grey", 190, 190, 190}, {"maroon", 176, 48, 96}};

Vec3f of_bytes(double r, double g, double b) { return {float(r / 255), float(g / 255), float(b / 255)}; }

struct CptParser {
  const std::string& path;
  size_t line = 0;
  Model model = Model::rgb;

  [[noreturn]] void fail(const std::string& what) const { fail_data(fmt::format("line {}: {}", line, what), path); }

  Vec3f of_numbers(const double* v, size_t n, std::string_view text) const {
    const bool hsv = n == 3 && model == Model::hsv;
    const double most = n == 4 ? 100 : 255;
    for (size_t i = 0; i < n; ++i)
      if (!(v[i] >= 0 && v[i] <= (hsv ? (i == 0 ? 360 : 1) : most))) fail(fmt::format("'{}' is not a colour", text));
    if (n == 1) return of_bytes(v[0], v[0], v[0]);
    if (hsv) return hsv_to_rgb(v[0], v[1], v[2]);
    if (n == 3) return of_bytes(v[0], v[1], v[2]);
    const double k = 1 - v[3] / 100;
    return {float((1 - v[0] / 100) * k), float((1 - v[1] / 100) * k), float((1 - v[2] / 100) * k)};
  }

  Vec3f named(std::string_view text) const {
    const std::string t = to_lower(text);
    size_t end = t.size();
    while (end > 0 && t[end - 1] >= '0' && t[end - 1] <= '9') --end;
    const std::string base = t.substr(0, end);
    const auto number = parse_int(std::string_view(t).substr(end));
    if (number && (base == "gray" || base == "grey")) {
      if (*number < 0 || *number > 100) fail(fmt::format("'{}' is not a colour", text));
      const double v = std::floor(double(*number) * 2.55 + 0.5);
      return of_bytes(v, v, v);
    }
    // darkorange1 .. darkorange4: shades of which the darker ones are 93.2, 80.4 and 54.5 percent.
    if (number && (*number < 1 || *number > 4)) fail(fmt::format("'{}' is not a colour", text));
    constexpr float shades[] = {1, 0.932f, 0.804f, 0.545f};
    const float shade = number ? shades[*number - 1] : 1;
    if (number && base == "darkorange") return of_bytes(255, 127, 0) * shade;
    for (const X11Color& n : x11)
      if (n.name == base) return of_bytes(n.r, n.g, n.b) * shade;
    try {
      return parse_color(base, "") * shade;
    } catch (const Error&) {
      fail(fmt::format("'{}' is not a colour", text));
    }
  }

  // Three numbers of "h-s-v" or "h/s/v".
  std::optional<Vec3f> hsv(std::string_view text) const {
    if (model != Model::hsv) return {};
    double v[3];
    size_t n = 0;
    for (std::string_view part : split(text, text.find('/') == std::string_view::npos ? '-' : '/')) {
      const auto x = parse_double(part);
      if (!x || n == 3) return {};
      v[n++] = *x;
    }
    if (n != 3) return {};
    of_numbers(v, 3, text);
    return Vec3f(float(v[0]), float(v[1]), float(v[2]));
  }

  // A colour as nodes hold it: a table in HSV keeps its hues, of which 0 and 360 are two.
  Vec3f node_color(std::string_view text) const {
    text = text.substr(0, text.find('@'));
    if (model != Model::hsv) return color(text);
    const auto numbers = hsv(text);
    return numbers ? *numbers : rgb_to_hsv(color(text));
  }

  // "r/g/b", "h-s-v", "c/m/y/k", a grey, "#rrggbb" or a name; "@" and a transparency behind it are left out.
  Vec3f color(std::string_view text) const {
    text = text.substr(0, text.find('@'));
    if (text.starts_with('#')) {
      if (text.size() != 7) fail(fmt::format("'{}' is not a colour", text));
      try {
        return parse_color(text, "");
      } catch (const Error&) {
        fail(fmt::format("'{}' is not a colour", text));
      }
    }
    const bool dashes = model == Model::hsv && text.find('/') == std::string_view::npos && text.find('-') != std::string_view::npos;
    const auto parts = split(text, dashes ? '-' : '/');
    double v[4];
    bool numbers = parts.size() == 1 || parts.size() == 3 || parts.size() == 4;
    for (size_t i = 0; i < parts.size() && numbers; ++i) {
      const auto x = parse_double(parts[i]);
      numbers = x.has_value();
      v[i] = x.value_or(0);
    }
    if (numbers) return of_numbers(v, parts.size(), text);
    if (parts.size() != 1 || text.empty()) fail(fmt::format("'{}' is not a colour", text));
    return named(text);
  }

  double number(std::string_view text) const {
    const auto v = parse_double(text);
    if (!v || !std::isfinite(*v)) fail(fmt::format("'{}' is not a number", text));
    return *v;
  }

  void comment(std::string_view text, FileColormap& f) {
    const std::string t(trim(text.substr(1)));
    const size_t equals = t.find('=');
    const std::string key(trim(std::string_view(t).substr(0, equals)));
    const std::string value = equals == std::string::npos ? "" : std::string(trim(std::string_view(t).substr(equals + 1)));
    if (key == "COLOR_MODEL") {
      const std::string m = to_lower(value.starts_with('+') ? value.substr(1) : value);
      if (m == "hsv") model = Model::hsv;
      else if (m == "cmyk") model = Model::cmyk;
      else if (m != "rgb") fail(fmt::format("the colour model '{}' is not one of RGB, HSV, CMYK", value));
    } else if (key == "HARD_HINGE" || key == "SOFT_HINGE") {
      f.hinge = equals == std::string::npos ? 0 : parse_double(value).value_or(0);
      f.hard_hinge = key == "HARD_HINGE";
    } else if (key == "HINGE") {
      f.hinge = number(value);
      f.hard_hinge = true;
    } else if (key == "RANGE") {
      const auto parts = split(value, '/');
      if (parts.size() != 2) fail("RANGE needs two numbers");
      f.range_lo = number(parts[0]), f.range_hi = number(parts[1]);
    } else if (key == "CYCLIC") {
      f.map.kind = MapKind::cyclic;
    }
  }

  void slice(const std::vector<std::string_view>& w, std::vector<ColorNode>& nodes) const {
    const bool separate = w.size() >= 8;
    auto color_at = [&](size_t i) { return separate ? node_color(fmt::format("{}/{}/{}", w[i], w[i + 1], w[i + 2])) : node_color(w[i]); };
    const size_t second = separate ? 4 : 2;
    const double z0 = number(w[0]), z1 = number(w[second]);
    if (!(z1 > z0)) fail(fmt::format("a slice runs from {} to {}", w[0], w[second]));
    if (!nodes.empty() && std::abs(z0 - nodes.back().position) > 1e-6 * std::max(std::abs(z0), z1 - z0))
      fail(fmt::format("a slice begins at {}, but the previous one ends at {}", w[0], nodes.back().position));
    const ColorNode a{nodes.empty() ? z0 : nodes.back().position, color_at(1)}, b{z1, color_at(second + 1)};
    if (nodes.empty() || !(nodes.back().color == a.color)) nodes.push_back(a);
    nodes.push_back(b);
  }
};

}  // namespace

FileColormap parse_cpt(std::string_view text, const std::string& path) {
  FileColormap f;
  CptParser p{path};
  std::vector<ColorNode> nodes;
  std::vector<Vec3f> categories;
  bool keys_are_numbers = true, all_flat = true;
  std::vector<std::string> keys;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find('\n', at), text.size());
    std::string_view row = trim(text.substr(at, end - at));
    at = end + 1;
    ++p.line;
    if (row.empty()) continue;
    if (row[0] == '#') {
      p.comment(row, f);
      continue;
    }
    const size_t semicolon = row.find(';');
    const std::string label(semicolon == std::string_view::npos ? "" : trim(row.substr(semicolon + 1)));
    const auto w = words(row.substr(0, semicolon));
    if (w.empty()) p.fail("a label has no colour");
    if (w[0] == "B" || w[0] == "F" || w[0] == "N") {
      if (w.size() != 2 && w.size() != 4) p.fail(fmt::format("'{}' needs a colour", w[0]));
      const Vec3f c = p.color(w.size() == 2 ? std::string(w[1]) : fmt::format("{}/{}/{}", w[1], w[2], w[3]));
      (w[0] == "B" ? f.below : w[0] == "F" ? f.above : f.nan) = c;
      continue;
    }
    if (w.size() == 2) {
      categories.push_back(p.color(w[1]));
      const auto key = parse_double(w[0]);
      keys_are_numbers = keys_are_numbers && key && std::isfinite(*key);
      f.labels.push_back(key.value_or(0));
      keys.emplace_back(label.empty() ? w[0] : std::string_view(label));
      f.label_names.push_back(label.empty() && key ? "" : keys.back());
    } else if (w.size() == 4 || w.size() == 5 || w.size() == 8 || w.size() == 9) {
      p.slice(w, nodes);
      all_flat = all_flat && (w.size() < 8 ? w[1] == w[3] : w[1] == w[5] && w[2] == w[6] && w[3] == w[7]);
    } else {
      p.fail(fmt::format("{} words; a slice has 4, a category 2", w.size()));
    }
    if (!nodes.empty() && !categories.empty()) p.fail("the table mixes slices and categories");
    ++f.entries;
  }
  if (f.entries == 0) fail_data("contains neither slices nor categories", path);
  f.space = p.model == Model::hsv ? "HSV" : p.model == Model::cmyk ? "CMYK" : "RGB";
  if (!categories.empty()) {
    f.map.kind = MapKind::categorical;
    f.map.colors = std::move(categories);
    f.lo = f.labels.front(), f.hi = f.labels.back();
    if (!keys_are_numbers) {
      for (size_t i = 0; i < f.labels.size(); ++i) f.labels[i] = double(i);
      f.label_names = keys;
      f.lo = 0, f.hi = double(keys.size() - 1);
    }
    return f;
  }
  f.lo = nodes.front().position, f.hi = nodes.back().position;
  if (all_flat && f.entries >= 64) {  // a table of many flat slices is a smooth map that was rounded
    std::vector<ColorNode> flat;
    for (size_t i = 0; i < nodes.size(); ++i)
      if (flat.empty() || !(flat.back().color == nodes[i].color)) flat.push_back(nodes[i]);
    const double last = flat.back().position, scale = last > f.lo ? (f.hi - f.lo) / (last - f.lo) : 1;
    for (ColorNode& n : flat) n.position = f.lo + (n.position - f.lo) * scale;
    nodes = std::move(flat);
  }
  set_nodes(f.map, nodes, p.model == Model::hsv ? NodeSpace::hue : NodeSpace::rgb);
  const MapKind kind = kind_of_colors(f.map);
  if (f.map.kind != MapKind::cyclic || kind == MapKind::unsafe) f.map.kind = f.hinge ? MapKind::diverging : kind;
  return f;
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
// GeoJSON: features with a geometry and properties. Points, lines and polygons become one surface mesh in longitude and latitude, or a
// cloud of points where there is nothing else; properties become fields of its cells (of its points). Source: RFC 7946.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/file/file.h"
#include "data/fields/axis_notes.h"
#include "io/formats.h"
#include "io/geojson/properties.h"
#include "io/geojson/shapes.h"
#include "io/mesh/unread.h"
#include "io/text/text_scan.h"

namespace sg {

namespace geojson {
namespace {

bool is_type_name(std::string_view s) { return s == "Feature" || s == "FeatureCollection" || is_geometry_type(s); }

// The strings of a beginning of JSON, with their depth: f(depth, key, value) for a member whose value is a string or a list ("[").
template <class F>
void for_members(std::string_view text, F&& f) {
  int depth = 0;
  std::string_view key, last;
  bool after_colon = false;
  for (size_t p = 0; p < text.size(); ++p) {
    const char c = text[p];
    if (is_space(c)) continue;
    if (c == '"') {
      size_t end = p + 1;
      while (end < text.size() && text[end] != '"') end += text[end] == '\\' ? 2 : 1;
      if (end >= text.size()) return;
      last = text.substr(p + 1, end - p - 1);
      if (after_colon && f(depth, key, last)) return;
      p = end, after_colon = false;
      continue;
    }
    if (c == ':') {
      key = last, after_colon = true;
      continue;
    }
    if (c == '[' && after_colon && f(depth, key, std::string_view("["))) return;
    after_colon = false;
    if (c == '{' || c == '[') ++depth;
    else if (c == '}' || c == ']') --depth;
  }
}

std::string_view as_json_text(std::span<const std::byte> bytes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  while (!text.empty() && is_space(text[0])) text.remove_prefix(1);
  return text.starts_with('{') ? text : std::string_view();
}

struct Features {
  Shapes shapes;
  Properties properties;
  size_t count = 0;

  void add(const Json& f) {
    if (f["type"].text() == "Feature") {
      properties.add(count, f["properties"]);
      if (const Json& id = f["id"]; (id.is_number() || id.is_text()) && !f["properties"].contains("id")) properties.set(count, "id", id);
      shapes.add(f["geometry"], count);
    } else {
      shapes.add(f, count);
    }
    ++count;
  }
};

std::string crs_of(const Json& root) { return root["crs"]["properties"]["name"].text(); }

// Longitudes and latitudes in degrees, unless the file says or its numbers show otherwise.
bool is_geographic(const Json& root, const Shapes& s) {
  const std::string crs = crs_of(root);
  if (!crs.empty() && crs.find("CRS84") == crs.npos && !crs.ends_with(":4326")) return false;
  for (size_t i = 0; i + 1 < s.xy.size(); i += 2)
    if (std::abs(s.xy[i]) > 360 || std::abs(s.xy[i + 1]) > 90) return false;
  return true;
}

Array positions_of(const Shapes& s, bool geographic) {
  double* out = nullptr;
  Array a = Array::make<double>(s.point_count(), 3, &out);
  for (size_t i = 0; i < s.point_count(); ++i, out += 3) {
    out[0] = s.xy[2 * i], out[1] = s.xy[2 * i + 1];
    // Metres upwards are no lengths among degrees.
    out[2] = geographic || std::isnan(s.altitude[i]) ? 0 : s.altitude[i];
  }
  return a;
}

DatasetPtr dataset_of(const Json& root, const Features& all, const ReadOptions& options, const std::string& path, Context& context) {
  const Shapes& s = all.shapes;
  DatasetParts parts;
  const bool geographic = is_geographic(root, s);
  std::vector<int32_t> feature;
  for (const ShapeCells* c : {&s.vertices, &s.lines, &s.polygons}) feature.insert(feature.end(), c->feature.begin(), c->feature.end());
  const bool only_points = s.lines.feature.empty() && s.polygons.feature.empty();
  const Association on = only_points ? Association::point : Association::cell;
  if (only_points) {
    parts.mesh = PointCloud{{positions_of(s, geographic)}};
  } else {
    parts.mesh = SurfaceMesh{{positions_of(s, geographic)}, s.vertices.cells(), s.lines.cells(), s.polygons.cells(), {}};
  }
  if (const std::string& name = root["name"].text(); !name.empty()) parts.notes.emplace_back("title", name);
  if (geographic) {
    note_axis(parts.notes, 0, {"longitude", "degrees_east", ""});
    note_axis(parts.notes, 1, {"latitude", "degrees_north", ""});
  }
  if (const std::string crs = crs_of(root); !crs.empty()) parts.notes.emplace_back("coordinates", crs);
  parts.notes.emplace_back("features", std::to_string(all.count));
  if (s.outlined > 0) {
    parts.notes.emplace_back("outlines", fmt::format("{} polygons with very many holes are only their outlines", s.outlined));
    context.warn(fmt::format("{}: {} polygons with very many holes are only their outlines", path, s.outlined));
  }
  if (s.left_out > 0) context.warn(fmt::format("{}: {} lines of one point and rings of fewer than three are left out", path, s.left_out));
  all.properties.add_fields(feature, on, all.count, options, context, parts);
  if (geographic && s.any_altitude && is_wanted(options.fields, "altitude"))
    parts.fields.add({"altitude", Association::point, Array::from_vector(s.altitude), "m", Role::none});
  // Which cells belong together, where a feature has several.
  if (all.count > 1 && feature.size() > all.count && !all.properties.has("feature") && is_wanted(options.fields, "feature"))
    parts.fields.add({"feature", on, Array::from_vector(std::move(feature)), "", Role::labels});
  return make_dataset(std::move(parts));
}

}  // namespace
}  // namespace geojson

bool sniff_geojson(std::span<const std::byte> head) {
  bool features = false, found = false;
  geojson::for_members(geojson::as_json_text(head), [&](int depth, std::string_view key, std::string_view value) {
    features = features || (depth == 1 && key == "features" && value == "[");
    found = key == "type" && (depth == 1 || features) && geojson::is_type_name(value);
    return found || (depth == 1 && key == "type");
  });
  return found;
}

bool sniff_whole_geojson(std::span<const std::byte> whole) { return !geojson::as_json_text(whole).empty(); }

Data read_geojson(const std::string& path, const ReadOptions& options, Context& context) {
  const MappedFile file(path);
  const Json root = parse_json(file.text(), path);
  const std::string& type = root["type"].text();
  geojson::Features all{geojson::Shapes(path, context), {}};
  if (type == "FeatureCollection") {
    if (!root["features"].is_list()) fail_data("has no list of features", path, "expected \"features\": [...]");
    for (const Json& f : root["features"].items()) all.add(f);
  } else if (geojson::is_type_name(type)) {
    all.add(root);
  } else {
    fail_data(fmt::format("is of the type '{}', which is no GeoJSON", type.substr(0, 40)), path,
              "\"type\" is FeatureCollection, Feature or a geometry such as Polygon");
  }
  if (all.shapes.point_count() == 0) fail_data("has no feature with a geometry", path);
  return geojson::dataset_of(root, all, options, path, context);
}

}  // namespace sg

// SPDX-License-Identifier: Apache-2.0
#include "io/geojson/shapes.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "data/cells/triangulate_loops.h"

namespace sg::geojson {

namespace {

/// Points times rings of a polygon whose area is cut into triangles: about ten seconds.
constexpr uint64_t most_steps = 2'000'000'000;

constexpr std::string_view types[] = {"Point",   "MultiPoint",   "LineString",        "MultiLineString",
                                      "Polygon", "MultiPolygon", "GeometryCollection"};

}  // namespace

bool is_geometry_type(std::string_view type) {
  for (const std::string_view t : types)
    if (t == type) return true;
  return false;
}

CellArray ShapeCells::cells() const {
  CellArray r;
  if (feature.empty()) return r;
  r.connectivity = Array::from_vector(ids);
  r.offsets = Array::from_vector(offsets);
  return r;
}

void Shapes::fail(const std::string& problem, const std::string& hint) const {
  fail_data(fmt::format("feature {}: {}", feature_, problem), path_, hint);
}

void Shapes::add(const Json& g, size_t feature) {
  feature_ = feature;
  if (!g.is_null()) geometry(g, 0);
}

void Shapes::geometry(const Json& g, int depth) {
  context_.check();
  const std::string& type = g["type"].text();
  const Json& coordinates = g["coordinates"];
  if (depth > 8) fail("its geometry collections are nested more than 8 deep");
  if (type == "GeometryCollection") {
    for (const Json& one : g["geometries"].items()) geometry(one, depth + 1);
    return;
  }
  if (!is_geometry_type(type))
    fail(fmt::format("the type '{}' of its geometry is unknown", type.substr(0, 40)), "Point, LineString, Polygon, MultiPolygon, ...");
  if (!coordinates.is_list()) fail(fmt::format("its {} has no coordinates", type));
  if (type == "Point" && !coordinates.empty()) point(coordinates);
  else if (type == "MultiPoint") each(coordinates, &Shapes::point);
  else if (type == "LineString") line(coordinates);
  else if (type == "MultiLineString") each(coordinates, &Shapes::line);
  else if (type == "Polygon") polygon(coordinates);
  else if (type == "MultiPolygon") each(coordinates, &Shapes::polygon);
}

void Shapes::each(const Json& list, void (Shapes::*add_one)(const Json&)) {
  for (const Json& one : list.items()) (this->*add_one)(one);
}

void Shapes::point(const Json& position) {
  vertices.ids.push_back(add_position(position));
  vertices.end_cell(feature_);
}

void Shapes::line(const Json& list) {
  const Ring ids = positions(list);
  if (ids.size() < 2) return void(++left_out);
  lines.ids.insert(lines.ids.end(), ids.begin(), ids.end());
  lines.end_cell(feature_);
}

void Shapes::polygon(const Json& list) {
  if (!list.is_list()) fail("a polygon is no list of rings");
  std::vector<Ring> rings;
  for (const Json& r : list.items()) {
    Ring ring = positions(r);
    // The last position repeats the first.
    const auto same = [&](uint32_t a, uint32_t b) { return xy[2 * a] == xy[2 * b] && xy[2 * a + 1] == xy[2 * b + 1]; };
    if (ring.size() > 1 && same(ring.front(), ring.back())) {
      if (ring.back() + 1 == point_count()) xy.resize(xy.size() - 2), altitude.pop_back();
      ring.pop_back();
    }
    if (ring.size() >= 3) rings.push_back(std::move(ring));
    else ++left_out;
  }
  if (rings.empty()) return;
  if (rings.size() > 1) return with_holes(rings);
  polygons.ids.insert(polygons.ids.end(), rings[0].begin(), rings[0].end());
  polygons.end_cell(feature_);
}

void Shapes::with_holes(const std::vector<Ring>& rings) {
  const uint32_t first = rings[0][0];
  std::vector<Vec2> at;
  for (size_t i = first; i < point_count(); ++i) at.push_back({xy[2 * i], xy[2 * i + 1]});
  if (uint64_t(at.size()) * rings.size() > most_steps) {
    ++outlined;
    for (const Ring& r : rings) {
      lines.ids.insert(lines.ids.end(), r.begin(), r.end());
      lines.ids.push_back(r[0]);
      lines.end_cell(feature_);
    }
    return;
  }
  std::vector<Ring> loops = rings;
  for (Ring& r : loops)
    for (uint32_t& i : r) i -= first;
  std::vector<uint32_t> triangles;
  triangulate_loops(at, loops, triangles);
  for (size_t t = 0; t + 2 < triangles.size(); t += 3) {
    for (size_t k = 0; k < 3; ++k) polygons.ids.push_back(int64_t(first) + triangles[t + k]);
    polygons.end_cell(feature_);
  }
}

Shapes::Ring Shapes::positions(const Json& list) {
  if (!list.is_list()) fail("coordinates are no list of positions", "[[longitude, latitude], ...]");
  Ring ids;
  for (const Json& p : list.items()) {
    const uint32_t id = add_position(p);
    const bool repeated = !ids.empty() && xy[2 * id] == xy[2 * id - 2] && xy[2 * id + 1] == xy[2 * id - 1];
    if (repeated) xy.resize(xy.size() - 2), altitude.pop_back();
    else ids.push_back(id);
  }
  return ids;
}

uint32_t Shapes::add_position(const Json& position) {
  if (position.size() < 2 || !position[0].is_number() || !position[1].is_number())
    fail(fmt::format("'{}' is no position", position.dump().substr(0, 60)), "a list of longitude and latitude");
  if (point_count() >= size_t(INT32_MAX)) fail("has more than 2^31 points");
  xy.push_back(position[0].number()), xy.push_back(position[1].number());
  const bool high = position.size() > 2 && position[2].is_number();
  any_altitude = any_altitude || high;
  altitude.push_back(high ? position[2].number() : std::numeric_limits<double>::quiet_NaN());
  return uint32_t(point_count() - 1);
}

}  // namespace sg::geojson

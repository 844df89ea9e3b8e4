// SPDX-License-Identifier: Apache-2.0
// Geometries of GeoJSON as vertices, lines and polygons. Source: RFC 7946, section 3.1.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/text/json.h"
#include "data/mesh.h"

namespace sg::geojson {

/// Cells of one kind: point ids, where each cell ends, and the feature that each belongs to.
struct ShapeCells {
  std::vector<int64_t> ids, offsets{0};
  std::vector<int32_t> feature;
  CellArray cells() const;
  void end_cell(size_t of) { offsets.push_back(int64_t(ids.size())), feature.push_back(int32_t(of)); }
};

class Shapes {
 public:
  Shapes(const std::string& path, const Context& context) : path_(path), context_(context) {}

  /// A geometry object or null, with all that it holds. Throws Error(data) naming the feature.
  void add(const Json& geometry, size_t feature);

  size_t point_count() const { return altitude.size(); }

  std::vector<double> xy;        ///< two per point
  std::vector<double> altitude;  ///< one per point, NaN where none is given
  bool any_altitude = false;
  ShapeCells vertices, lines, polygons;
  size_t outlined = 0;  ///< polygons with so many holes that only their rings are there, as lines
  size_t left_out = 0;  ///< lines of one point and rings of fewer than three

 private:
  using Ring = std::vector<uint32_t>;
  [[noreturn]] void fail(const std::string& problem, const std::string& hint = {}) const;
  void geometry(const Json& g, int depth);
  void each(const Json& list, void (Shapes::*add_one)(const Json&));
  void point(const Json& position);
  void line(const Json& positions);
  void polygon(const Json& rings);
  void with_holes(const std::vector<Ring>& rings);
  /// Points of a list of positions, none twice in a row; their ids.
  Ring positions(const Json& list);
  uint32_t add_position(const Json& position);

  std::string path_;
  const Context& context_;
  size_t feature_ = 0;
};

/// Whether that is the name of a type of geometry.
bool is_geometry_type(std::string_view type);

}  // namespace sg::geojson

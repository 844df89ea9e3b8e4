// SPDX-License-Identifier: Apache-2.0
// The shapes of glyphs: small surface meshes of unit size along +x.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

/// Wind barbs have a table of shapes (glyph/barbs.h).
enum class GlyphShape { arrow, cone, needle, line, arrow2d, cylinder, disc, sphere, cube, superquadric, barbs };
constexpr auto enum_words(GlyphShape) {
  using enum GlyphShape;
  return std::array{
      Word{"arrow", arrow},       Word{"cone", cone}, Word{"needle", needle}, Word{"line", line}, Word{"arrow2d", arrow2d},
      Word{"cylinder", cylinder}, Word{"disc", disc}, Word{"sphere", sphere}, Word{"cube", cube}, Word{"superquadric", superquadric},
      Word{"barbs", barbs}};
}

/// Which part of a shape is at the point.
enum class GlyphAnchor { tail, middle, tip };
constexpr auto enum_words(GlyphAnchor) {
  using enum GlyphAnchor;
  return std::array{Word{"tail", tail}, Word{"middle", middle}, Word{"tip", tip}};
}

/// Which shape, and how finely it is made.
struct GlyphShapeParams {
  std::optional<std::string> shape = "arrow";  ///< a word of GlyphShape, or a file; none: by the data (choose.h)
  int sides = 12;
  std::optional<GlyphAnchor> anchor;
  double tip_length = 0.35, tip_radius = 0.14, shaft_radius = 0.05;
  double alpha = 1, beta = 1;
};
void describe(Schema& s, GlyphShapeParams& p);

/// None for a file, and where the data decide.
std::optional<GlyphShape> known_shape(const GlyphShapeParams& p);

/// A shape by name, or the surface of a file. Extents:
///   arrow, cone, needle, line, arrow2d   from 0 to 1 along x; arrow2d is a thin plate in the x-y plane, needle a thin double cone, line
///                                        one segment (drawn with constant width)
///   cylinder, sphere, cube, superquadric -1/2 to 1/2 along x and across it; disc: of diameter 1 across x, flat
///   a file                               its longest edge of the box is 1, the middle of the box at 0
/// `anchor`: tail, middle or tip is at the point (without: as listed). Solids are closed and their faces look outward.
/// superquadric: (cos^beta p, sgn sin^alpha t sin^beta p, cos^alpha t sin^beta p) / 2 about the x axis (Barr 1981, Kindlmann 2004).
/// Throws Error(usage) for an unknown name with a hint, Error(data) for files that cannot be read.
DatasetPtr glyph_shape_mesh(const GlyphShapeParams& p, Context& context);

/// How files are read: the reader is in a later layer, which registers it here. Without one, shapes from files are an error.
using ShapeReader = DatasetPtr (*)(const std::string& path, Context& context);
void set_shape_reader(ShapeReader reader);

/// Moves the shape's points along x.
DatasetPtr shifted_shape(const DatasetPtr& shape, double by);

/// Puts a shape together: f32 points, polygons as triangles, lines of two points.
struct ShapeBuilder {
  std::vector<float> xyz;
  std::vector<int32_t> triangles, lines;

  int32_t point(Vec3 p) {
    for (int a = 0; a < 3; ++a) xyz.push_back(float(p[a]));
    return int32_t(xyz.size() / 3) - 1;
  }
  void triangle(int32_t a, int32_t b, int32_t c) { triangles.insert(triangles.end(), {a, b, c}); }
  void line(int32_t a, int32_t b) { lines.insert(lines.end(), {a, b}); }
  DatasetPtr made() &&;
};

}  // namespace sg

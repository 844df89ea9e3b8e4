// SPDX-License-Identifier: Apache-2.0
// Input of the rasterizer: flat arrays per item. Internal to rendering.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "data/memory/memo.h"
#include "render/prepare/prepare.h"

namespace sg {

namespace raster {

/// Three point numbers per triangle over packed f32 positions relative to a double origin.
struct TriangleSet {
  Array positions;  ///< f32 x 3, packed
  Vec3 origin;
  Array triangles;  ///< u32 or i32 x 3, packed
  Array cells;      ///< u32 cell of the dataset per triangle; empty: first_cell + triangle
  uint32_t first_cell = 0;
  size_t count = 0;

  const float* xyz() const { return reinterpret_cast<const float*>(positions.raw()); }
  const uint32_t* indices() const { return reinterpret_cast<const uint32_t*>(triangles.raw()); }
  const uint32_t* cell_list() const { return cells.empty() ? nullptr : reinterpret_cast<const uint32_t*>(cells.raw()); }
  uint32_t cell(size_t triangle) const { return cells.empty() ? first_cell + uint32_t(triangle) : cell_list()[triangle]; }
};

/// Normals per point, and corners that use others where an edge splits them.
struct NormalSet {
  Array normals;  ///< f32 x 3, packed; empty = face normals
  Array corners;  ///< u32 x 3 per triangle into `normals`; empty = the triangles' own point numbers

  size_t bytes() const { return normals.bytes() + corners.bytes(); }
};

/// Two point numbers per line segment; `group` joins the segments of one polyline (empty: all of them).
struct SegmentSet {
  std::vector<uint32_t> points, cells, groups;
  /// Edges of cells: how wide the narrowest polygon beside each is, across it, in units of the positions. Lines of a mesh whose cells are
  /// smaller than pixels would be a dark surface: they fade. Empty: none does.
  std::vector<float> room;
  size_t count() const { return points.size() / 2; }
  size_t bytes() const { return 4 * (points.size() + cells.size() + groups.size() + room.size()); }
};

/// Colour of anything: one colour, a number per point or cell through a table, or linear RGBA per point or cell.
struct ColorSource {
  enum class Kind { constant, scalar, direct } kind = Kind::constant;
  Vec4f constant{1, 1, 1, 1};  ///< linear
  bool per_cell = false;
  Array values;  ///< f32, packed: 1 component (value - offset) or 4 (linear RGBA, straight alpha)
  double offset = 0;
  std::shared_ptr<const ColorScale> scale;
  std::vector<Vec4f> table;   ///< n colours of positions 0..1, then below, above, NaN
  bool linear = false;        ///< position = (stored - first) * slope
  bool nearest = false;       ///< labels are not blended: a pixel takes the value of the nearest corner
  float first = 0, last = 1;  ///< the ends of the scale as they are stored
  float slope = 1;
  bool translucent = false;  ///< some alpha may be below 1

  const float* data() const { return reinterpret_cast<const float*>(values.raw()); }
  /// Colour of a stored value (scalar kind).
  const Vec4f& of(float stored) const;
};

struct GlyphSet;
struct PictureSet;

struct PreparedItem {
  enum class Kind { surface, lines, points } kind = Kind::surface;
  DatasetPtr data;
  uint32_t id = 0;  ///< item number + 1
  ColorSource color;
  float opacity = 1;
  uint32_t first_primitive = 0, primitives = 0;  ///< numbers of this item's primitives in the picture
  // surfaces
  TriangleSet triangles;
  NormalSet normals;
  Material material;
  std::optional<SurfaceMaterial> made_of;
  bool translucent = false;
  std::shared_ptr<const SurfaceCopy> copy_of;
  std::optional<SurfaceTexture> lic;
  Array lic_vectors;                           ///< f32 x 3 packed, per point or cell
  float lic_least = 0;                         ///< vectors whose largest component is not above this have no direction
  std::shared_ptr<const PictureSet> pictures;  ///< picture_set.h; null: none
  // lines
  std::shared_ptr<const SegmentSet> segments;
  double width = 1;     ///< pixels; also the points' size
  bool shaded = false;  ///< points as little spheres, lines by their tangents
  /// Lines in the colour of the surface under them, made darker or lighter; the same all over, as a line that changes in the middle looks
  /// like two.
  enum class Contrast { none, darker, lighter } contrast = Contrast::none;
  double halo = 0;   ///< pixels
  Vec3f halo_color;  ///< linear
  // lines and points
  std::shared_ptr<const std::vector<uint32_t>> points;  ///< numbers of the dots that are drawn; null (discs only): all
  Array positions;                                      ///< f32 x 3 packed
  Vec3 origin;
  bool discs = false;               ///< points as oriented discs: opaque, drawn like triangles
  Array disc_normals, disc_radius;  ///< f32 packed, per point of the dataset
  // glyphs: polygons of shapes are a surface, their lines are lines; both stand at `origin`
  std::shared_ptr<const GlyphSet> glyphs;
};

TriangleSet triangulate(const DatasetPtr& data, bool& any_polygon);
/// `whole`: triangles of the same points, among which these are; null: no others. Edges between them are smooth, too.
NormalSet smooth_normals(const TriangleSet& triangles, double feature_angle, const TriangleSet* whole = nullptr);
/// Vectors of a texture as three packed f32 numbers, and the size below which they count as none. Throws Error(usage).
void take_texture(const SurfaceTexture& texture, PreparedItem& item);
SegmentSet line_segments(const Dataset& data, const SurfaceMesh& mesh);
/// The same of lines that are the edges of curved cells: their room is their length.
SegmentSet curved_edges(const Dataset& data, const SurfaceMesh& mesh);
/// The mesh without its hidden polygons and strips.
SurfaceMesh visible_polygons(const SurfaceMesh& mesh, const Dataset& data);
/// Every edge of the polygons and strips once, in order of its points, with its room; not those inside one face of an input cell, where a
/// filter made several polygons of it (they have the same 'original_cell' and lie in one plane).
SegmentSet polygon_edges(const Dataset& data, const SurfaceMesh& mesh);
ColorSource color_source(const DatasetPtr& data, const std::optional<FieldColor>& color, Vec3f constant, const char* where);
/// Packed f32 positions and their origin; other layouts are copied, f64 ones relative to the middle of the data.
struct Positions {
  Array xyz;
  Vec3 origin;

  size_t bytes() const { return xyz.bytes(); }
};
Positions packed_positions(const DatasetPtr& data, const Points& points);

/// What is derived from a dataset, made once and kept in its memo. `make` must not keep a pointer to `data`.
template <class F>
auto derived(const DatasetPtr& data, const std::string& what, F&& make) {
  using T = std::invoke_result_t<F>;
  const std::string key = "surfaces/" + what;
  Memo& memo = data->memo();
  if (std::shared_ptr<const T> kept = memo.find<T>(key)) return kept;
  T made = make();
  size_t bytes = 0;
  if constexpr (requires { made.bytes(); }) bytes = made.bytes();
  else bytes = made.size() * sizeof(made[0]);
  return memo.keep<T>(key, std::move(made), bytes);
}

float linear_light(float srgb);
inline Vec3f linear_light(Vec3f c) { return {linear_light(c.x), linear_light(c.y), linear_light(c.z)}; }

}  // namespace raster

class PreparedScene {
 public:
  std::vector<raster::PreparedItem> items;  ///< in scene order; edges of a surface are an item of their own
  std::vector<Light> lights;

  /// Number of the item that a primitive belongs to.
  uint32_t item_of(uint32_t primitive) const;
  bool textured() const;
};

}  // namespace sg
